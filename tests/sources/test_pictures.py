"""Sizes from pictures: closed forms, scale and refusals."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.files import Image
from sizeviz.sources.pictures import MOST_NODES_ALONG, extent, size_from_curvature, size_from_intensity


def parabola(count=64, spacing=0.1):
    x = np.tile((np.arange(count) - 0.5 * (count - 1)) / count, (count, 1))
    return Image(4 * x * x, (spacing, spacing), (0.5 * spacing, 0.5 * spacing), label="parabola")


def test_a_parabola_has_one_size():
    image = parabola()
    field = size_from_curvature(image, finest=1e-4, coarsest=1.0, tolerance=0.01)
    x, y = field.background.points.T
    inside = (np.abs(x - 3.2) < 1.5) & (np.abs(y - 3.2) < 1.5)
    bending = 8.0 / np.ptp(image.values)
    # the filter is cut off at four deviations, which its second derivative feels
    np.testing.assert_allclose(field.sizes[inside], 6.4 * np.sqrt(0.08 / bending), rtol=0.01)


def test_sizes_grow_with_the_picture_and_stay_in_range():
    small, large = parabola(spacing=0.1), parabola(spacing=0.3)
    np.testing.assert_allclose(size_from_curvature(large).sizes, 3 * size_from_curvature(small).sizes, rtol=1e-12)
    noise = Image(np.random.default_rng(1).random((30, 50)), (1.0, 1.0), (0.5, 0.5), label="noise")
    sizes = size_from_curvature(noise, finest=0.01, coarsest=0.2).sizes
    assert sizes.min() >= 50 * 0.01 * (1 - 1e-12)
    assert sizes.max() <= 50 * 0.2 * (1 + 1e-12)


def test_intensity_is_linear_and_large_pictures_are_thinned():
    field = size_from_intensity(parabola(), finest=0.01, coarsest=0.1)
    assert field.sizes.min() == pytest.approx(0.064, rel=0.02)
    assert field.sizes.max() == pytest.approx(0.64, rel=1e-9)
    wide = Image(np.random.default_rng(2).random((3, 3000)), (1.0, 1.0), (0.5, 0.5), label="wide")
    grid = size_from_intensity(wide).background.grid
    assert grid is not None
    assert grid.nx == MOST_NODES_ALONG
    assert extent(wide).bounds == (0.0, 0.0, 3000.0, 3.0)


def test_a_flat_picture_is_coarse_and_bad_options_are_refused():
    flat = Image(np.full((8, 8), 3.0), (1.0, 1.0), (0.5, 0.5), label="flat")
    np.testing.assert_allclose(size_from_curvature(flat, coarsest=0.1).sizes, 0.8, rtol=1e-12)
    with pytest.raises(InputError, match="finest first"):
        size_from_curvature(flat, finest=0.2, coarsest=0.1)
    with pytest.raises(InputError, match="must be above 0"):
        size_from_curvature(flat, tolerance=0.0)
