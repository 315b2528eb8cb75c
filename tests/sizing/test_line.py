"""The one-dimensional lesson against its closed form."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.sizing.line import (
    LineField,
    advanced,
    limited_on_line,
    paper_valley,
    preserved_on_line,
    ratios_on_line,
)

X = np.linspace(0, 1, 501)


@pytest.mark.parametrize("alpha", [0.25, 0.5, 1.0, 2.0])
def test_equation_one_has_its_closed_form(alpha):
    offset = np.abs(X - 0.75)
    wanted = np.minimum(0.5, np.maximum(0.1, (0.1 + 3 * offset) / (1 + 3 * alpha)))
    np.testing.assert_allclose(preserved_on_line(paper_valley(), alpha, 1.0, X), wanted, rtol=1e-12)
    wanted = np.minimum(0.5, 0.1 + np.minimum(1.0, 3.0) * offset)
    np.testing.assert_allclose(limited_on_line(paper_valley(), 1.0, X), wanted, rtol=1e-12)


def test_random_lines_agree_with_dense_sampling():
    rng = np.random.default_rng(3)
    field = LineField(np.sort(rng.random(9)), 0.05 + rng.random(9))
    y = np.linspace(field.x[0], field.x[-1], 200_001)
    x = np.linspace(field.x[0], field.x[-1], 37)
    for alpha in (0.5, 2.0):
        dense = np.array([np.maximum(field.at(y), np.abs(y - at) / alpha).min() for at in x])
        found = preserved_on_line(field, alpha, 1.0, x)
        assert (found <= dense * (1 + 1e-12)).all()
        steps = np.diff(field.sizes) / np.diff(field.x)
        assert (dense - found).max() <= (np.abs(steps).max() + 1 / alpha) * (y[1] - y[0])


def test_figures_one_and_three():
    field = paper_valley()
    original = advanced(field, 0.0, 1.0)
    assert len(original) == 3  # two elements, as in the paper
    assert ratios_on_line(field, original).max() == pytest.approx(5.0)
    smooth = np.linspace(0, 1, 2001)
    preserved = LineField(smooth, preserved_on_line(field, 1.0, 1.0, smooth))
    limited = LineField(smooth, limited_on_line(field, 1.0, smooth))
    ours = ratios_on_line(field, advanced(preserved, 0.0, 1.0))
    theirs = ratios_on_line(field, advanced(limited, 0.0, 1.0))
    assert ours[:-1].max() <= 1 + 1e-9  # the last element takes what the front leaves
    assert theirs.max() > 1.5


def test_unusable_lines_are_refused():
    with pytest.raises(InputError, match="greater than the last"):
        LineField(np.array([0.0, 0.0]), np.ones(2))
    with pytest.raises(InputError, match="end after"):
        advanced(paper_valley(), 1.0, 0.0)
    with pytest.raises(InputError, match="larger sizes"):
        advanced(LineField(np.array([0.0, 1.0]), np.full(2, 1e-7)), 0.0, 1.0)
