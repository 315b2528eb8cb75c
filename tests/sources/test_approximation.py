"""Backgrounds for formulas: the error promised is kept, and told where it is not."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.geometry import Domain
from sizeviz.sources import Formula, approximation
from sizeviz.sources.approximation import approximated, shortfall

SQUARE = Domain.unit_square()


@pytest.mark.parametrize(
    "text",
    [
        "0.1",
        "0.05 + 0.1*x + 0.2*y*y",
        "min(0.2, 0.01 + 0.7*abs(y - 0.3 - 0.4*x*x))",
        "0.03 + 0.02*sin(9*x)*cos(7*y)",
    ],
)
def test_field_is_within_a_hundredth_and_cells_within_their_size(text):
    formula = Formula(text)
    size = approximated(formula, SQUARE, "test")
    assert size.error is not None
    assert size.error <= approximation.TOLERANCE
    assert shortfall(size) == ""
    where = np.random.default_rng(2).random((20_000, 2))
    off = np.abs(size.field.at(where) / formula(where[:, 0], where[:, 1]) - 1)
    assert off.max() < 2 * approximation.TOLERANCE  # between the places that are looked at
    assert np.quantile(off, 0.999) <= approximation.TOLERANCE
    points, triangles = size.field.background.points, size.field.background.triangles
    edges = np.roll(points[triangles], -1, axis=1) - points[triangles]
    longest = np.hypot(edges[..., 0], edges[..., 1]).max(axis=1)
    assert (longest <= 1.5 * size.field.sizes[triangles].max(axis=1) * 1.02).all()


def test_a_jump_is_told(monkeypatch):
    monkeypatch.setattr(approximation, "ROUNDS", 3)
    size = approximated(lambda x, y: np.where(x + 0.3 * y > 0.612, 0.2, 0.1), SQUARE, "jump")
    assert size.error is not None
    assert size.error > 0.3
    assert "jump" in shortfall(size)


def test_sizes_that_are_not_sizes_are_refused(monkeypatch):
    with pytest.raises(InputError, match="above 0 everywhere"):
        approximated(Formula("x - 0.5"), SQUARE, "negative")
    monkeypatch.setattr(approximation, "MOST_NODES", 2000)
    with pytest.raises(InputError, match="more than 2,000 nodes"):
        approximated(Formula("0.001"), SQUARE, "tiny")
