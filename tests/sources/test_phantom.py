"""The drawn phantom: it says what it is, and its parts are where anatomy wants them."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.sources import load
from sizeviz.sources.phantom import PIXELS, SOFTNESS, Ellipse, short_axis_image


def test_it_is_labelled_as_synthetic():
    source = load("phantom")
    assert "synthetic" in source.label.lower()
    assert source.provenance["kind"] == "synthetic"
    assert "synthetic" in source.image.label


def test_intensities_of_the_parts():
    values = short_axis_image().values

    def at(x: float, y: float) -> float:
        return values[int((y + 1) / 2 * PIXELS), int((x + 1) / 2 * PIXELS)]

    assert values.min() >= 0 and values.max() <= 1
    pool, muscle, lung, outside = at(0.1, 0.02), at(0.38, 0.02), at(-0.52, 0.05), at(-0.95, -0.95)
    assert pool > 0.85 > 0.4 > muscle > 0.2 > lung > outside


def test_an_edge_is_as_soft_as_it_says():
    circle = Ellipse(0.0, 0.0, 0.5, 0.5, 1.0)
    x = np.linspace(0.45, 0.55, 2001)
    cover = circle.cover(x, np.zeros_like(x))
    assert np.interp(0.5, x, cover) == pytest.approx(0.5)
    steepest = np.abs(np.gradient(cover, x)).max()
    assert 1.0 / steepest == pytest.approx(2 * SOFTNESS * 2 / PIXELS, rel=0.05)


def test_sizes_are_small_at_the_edges_of_the_heart():
    field = load("phantom").field
    wall, inside = field.at(np.array([[0.5 + 0.5 * 0.315, 0.51], [0.1, 0.9]]))
    assert wall < 0.005 < inside
