from __future__ import annotations

import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sources.painting import Brush, Stroke, falloff, inside_polygon, painted, stroke_weights


def field(nodes: int = 41, value: float = 0.1) -> SizeField:
    background = BackgroundMesh.unit_square_grid(nodes, nodes)
    return SizeField(background, np.full(nodes * nodes, value))


def triangulated(grid_field: SizeField) -> SizeField:
    background = BackgroundMesh(grid_field.background.points, grid_field.background.triangles)
    return SizeField(background, grid_field.sizes)


def test_a_hard_stroke_sets_exactly_the_nodes_within_its_radius() -> None:
    brush = Brush(mode="set", value=0.01, radius=0.2, hardness=1.0)
    result = painted(field(), Stroke(brush, np.array([[0.5, 0.5]])))
    away = np.hypot(*(result.background.points - 0.5).T)
    assert np.all(result.sizes[away < 0.2 - 1e-9] == 0.01)
    assert np.all(result.sizes[away > 0.2 + 1e-9] == 0.1)


def test_more_points_on_the_same_path_paint_the_same() -> None:
    brush = Brush(radius=0.08)
    sparse = np.array([[0.1, 0.2], [0.9, 0.6]])
    dense = sparse[0] + np.linspace(0, 1, 50)[:, None] * (sparse[1] - sparse[0])
    a, b = (stroke_weights(field().background, Stroke(brush, path)) for path in (sparse, dense))
    np.testing.assert_allclose(a, b, atol=1e-12)


def test_grid_and_triangulation_paint_alike() -> None:
    start = field()
    stroke = Stroke(Brush(radius=0.1, mode="multiply", value=0.5), np.array([[0.2, 0.3], [0.7, 0.8], [0.7, 0.1]]))
    np.testing.assert_array_equal(painted(start, stroke).sizes, painted(triangulated(start), stroke).sizes)


def test_multiply_twice_is_the_square_where_the_brush_is_hard() -> None:
    stroke = Stroke(Brush(radius=0.2, mode="multiply", value=0.5, hardness=1.0), np.array([[0.5, 0.5]]))
    twice = painted(painted(field(), stroke), stroke)
    assert twice.sizes.min() == pytest.approx(0.025, rel=1e-14)


def test_at_most_never_raises_a_size() -> None:
    start = field()
    rough = start.with_sizes(np.random.default_rng(1).uniform(0.01, 0.5, len(start.sizes)))
    result = painted(rough, Stroke(Brush(mode="at-most", value=0.1, radius=0.4), np.array([[0.5, 0.5]])))
    assert np.all(result.sizes <= rough.sizes)
    assert np.all(result.sizes >= np.minimum(rough.sizes, 0.1) - 1e-15)


def test_erase_brings_the_original_back_bit_by_bit() -> None:
    start = field()
    path = np.array([[0.3, 0.5], [0.6, 0.5]])
    changed = painted(start, Stroke(Brush(radius=0.1, value=0.02), path))
    erased = painted(changed, Stroke(Brush(radius=0.2, mode="erase", hardness=0.9), path), start)
    np.testing.assert_array_equal(erased.sizes, start.sizes)


@pytest.mark.parametrize("make", [lambda f: f, triangulated])
def test_smoothing_lessens_the_roughness_under_the_brush_only(make) -> None:
    start = make(field())
    rough = start.with_sizes(np.exp(np.random.default_rng(2).normal(-3, 0.5, len(start.sizes))))
    result = painted(rough, Stroke(Brush(mode="smooth", radius=0.3, hardness=1.0), np.array([[0.5, 0.5]])))
    away = np.hypot(*(start.background.points - 0.5).T)
    under = away <= 0.3 - 1e-9
    assert np.log(result.sizes[under]).std() < 0.5 * np.log(rough.sizes[under]).std()
    np.testing.assert_array_equal(result.sizes[away > 0.3 + 1e-9], rough.sizes[away > 0.3 + 1e-9])


def test_the_mask_protects_sizes_outside_its_range() -> None:
    start = field()
    halves = start.with_sizes(np.where(start.background.points[:, 0] < 0.5, 0.1, 0.2))
    brush = Brush(radius=2.0, value=0.01, hardness=1.0, mask=(0.15, 0.3))
    result = painted(halves, Stroke(brush, np.array([[0.5, 0.5]])))
    assert set(np.unique(result.sizes)) == {0.01, 0.1}


def test_a_polygon_fills_its_inside() -> None:
    outline = np.array([[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]])
    brush = Brush(radius=1e-6, value=0.01, hardness=1.0)
    result = painted(field(), Stroke(brush, outline, "polygon"))
    inner = (np.abs(result.background.points - 0.5) < 0.3 - 1e-9).all(axis=1)
    outer = (np.abs(result.background.points - 0.5) > 0.3 + 1e-5).any(axis=1)
    assert np.all(result.sizes[inner] == 0.01) and np.all(result.sizes[outer] == 0.1)


def test_inside_polygon_agrees_with_matplotlib() -> None:
    from matplotlib.path import Path

    rng = np.random.default_rng(3)
    angle = np.sort(rng.uniform(0, 2 * np.pi, 12))
    outline = np.column_stack([np.cos(angle), np.sin(angle)]) * rng.uniform(0.3, 1.0, 12)[:, None]
    points = rng.uniform(-1, 1, (2000, 2))
    np.testing.assert_array_equal(inside_polygon(points, outline), Path(outline).contains_points(points))


def test_falloff_is_one_at_the_path_zero_at_the_radius_and_never_rises() -> None:
    effect = falloff(np.linspace(0, 1.2, 300), 0.4)
    assert effect[0] == 1.0 and effect[-1] == 0.0 and np.all(np.diff(effect) <= 1e-15)


@pytest.mark.parametrize("bad", [{"radius": 0.0}, {"value": -1.0}, {"hardness": 1.5}, {"mask": (2.0, 1.0)}])
def test_impossible_brushes_are_refused(bad) -> None:
    with pytest.raises(InputError, match="brush"):
        Brush(**bad)
