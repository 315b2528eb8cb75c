"""Constrained Delaunay: segments become edges, the outside goes, the rest is as Delaunay as it can be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sizeviz.errors import InputError
from sizeviz.geometry.delaunay import Triangulation, triangulated
from sizeviz.geometry.domain import signed_area
from sizeviz.geometry.predicates import circle_sides, orientations


def loop_edges(n: int, first: int = 0) -> NDArray[np.int32]:
    """Return the edges that join n consecutive points to a closed loop."""
    return (first + np.column_stack([np.arange(n), (np.arange(n) + 1) % n])).astype(np.int32)


def area(t: Triangulation) -> float:
    return sum(signed_area(t.points[corners]) for corners in t.triangles)


def edge_set(t: Triangulation) -> set[tuple[int, int]]:
    pairs = np.sort(t.triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    return {(int(a), int(b)) for a, b in pairs}


def check_constrained(t: Triangulation) -> None:
    """Triangles turn left, neighbours agree, and every edge that is not locked is locally Delaunay."""
    p = t.points
    a, b, c = (p[t.triangles[:, k]] for k in range(3))
    assert (orientations(a, b, c) == 1).all()
    for k in range(3):
        for row in np.flatnonzero((t.neighbours[:, k] >= 0) & ~t.locked[:, k]):
            other = t.neighbours[row, k]
            assert row in t.neighbours[other]
            apex = np.setdiff1d(t.triangles[other], t.triangles[row])
            assert len(apex) == 1
            assert circle_sides(a[row], b[row], c[row], p[apex[0]])[0] <= 0


@settings(max_examples=80, deadline=None)
@given(st.integers(3, 30), st.integers(0, 40), st.integers(0, 10_000), st.booleans())
def test_star_shaped_polygons_are_filled_exactly(corners: int, extra: int, seed: int, on_lattice: bool) -> None:
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, corners))
    assume(np.diff(np.append(angle, angle[0] + 2 * np.pi)).max() < 3.1)
    radius = rng.uniform(0.2, 1, corners)
    loop = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    inner = rng.uniform(-1, 1, (extra, 2))
    if on_lattice:
        inner = np.round(inner * 5) / 5  # collinear and coincident points
    t = triangulated(np.vstack([loop, inner]), loop_edges(corners))
    check_constrained(t)
    assert t.locked[t.neighbours == -1].all()
    assert area(t) == pytest.approx(signed_area(loop), rel=1e-12)


def test_a_hole_is_left_out_and_an_inner_line_is_not() -> None:
    outer = np.array([[0, 0], [4, 0], [4, 4], [0, 4.0]])
    hole = np.array([[1, 1], [2, 1], [2, 2], [1, 2.0]])
    line = np.array([[3, 0.5], [3, 3.5]])
    edges = np.vstack([loop_edges(4), loop_edges(4, 4), [[8, 9]]])
    t = triangulated(np.vstack([outer, hole, line]), edges, bounding=np.array([True] * 8 + [False]))
    check_constrained(t)
    assert area(t) == pytest.approx(15.0)
    assert (8, 9) in edge_set(t)


def test_a_long_edge_across_many_triangles() -> None:
    rng = np.random.default_rng(0)
    points = np.vstack([[[-0.1, 0.5], [1.1, 0.52]], rng.random((2000, 2))])
    t = triangulated(points, [[0, 1]], bounding=[False])
    check_constrained(t)
    assert (0, 1) in edge_set(t)


def test_a_segment_through_points_becomes_a_chain_of_edges() -> None:
    n = 9
    points = np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2).astype(float)
    t = triangulated(points, [[0, n * n - 1]], bounding=[False])
    check_constrained(t)
    edges = edge_set(t)
    assert all((k * (n + 1), (k + 1) * (n + 1)) in edges for k in range(n - 1))
    assert t.locked.sum() == 2 * (n - 1)


def test_segments_between_coincident_points_use_the_one_kept() -> None:
    loop = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    points = np.vstack([loop, loop])
    edges = np.array([[0, 5], [1, 6], [2, 7], [3, 4]])
    t = triangulated(points, edges)
    assert area(t) == pytest.approx(1.0)


def test_nearly_touching_loops_stay_apart() -> None:
    gap = 1e-13
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    t = triangulated(np.vstack([square, square + np.array([1 + gap, 0])]), np.vstack([loop_edges(4), loop_edges(4, 4)]))
    check_constrained(t)
    assert area(t) == pytest.approx(2.0)
    assert not any(set(row) & {0, 1, 2, 3} and set(row) & {4, 5, 6, 7} for row in t.triangles.tolist())


def test_crossing_segments_are_refused() -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    with pytest.raises(InputError, match="crosses another one"):
        triangulated(square, [[0, 2], [1, 3]], bounding=[False, False])


def test_segments_must_name_points() -> None:
    with pytest.raises(InputError, match=r"outside 0\.\.2"):
        triangulated([[0, 0], [1, 0], [0, 1]], [[0, 7]])


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 15), st.integers(0, 10_000), st.integers(2, 30))
def test_nearly_touching_loops_with_points_along_the_gap(power: int, seed: int, count: int) -> None:
    """Two squares a hair apart, their facing sides strewn with points that almost face each other."""
    gap = 10.0**-power
    rng = np.random.default_rng(seed)
    sides = [np.sort(rng.uniform(0.01, 0.99, count)) for _ in range(2)]
    right = [np.column_stack([np.ones(count), sides[0]])]
    left = [np.column_stack([np.full(count, 1.0 + gap), sides[1][::-1]])]
    one = np.vstack([[[0, 0], [1, 0]], *right, [[1, 1], [0, 1]]])
    two = np.vstack([[[1.0 + gap, 0], [2, 0], [2, 1], [1.0 + gap, 1]], *left])
    n = count + 4
    t = triangulated(np.vstack([one, two]), np.vstack([loop_edges(n), loop_edges(n, n)]))
    check_constrained(t)
    assert area(t) == pytest.approx(2.0 - gap, rel=1e-12)
    of = t.triangles >= n
    assert (of.all(axis=1) | ~of.any(axis=1)).all()


@settings(max_examples=60, deadline=None)
@given(st.integers(3, 25), st.integers(0, 10_000), st.integers(-2, 2))
def test_points_on_the_segments_or_an_ulp_beside_them(corners: int, seed: int, ulps: int) -> None:
    """Midpoints of a polygon's sides, exact or moved by the least there is, and every corner twice."""
    rng = np.random.default_rng(seed)
    angle = 2 * np.pi * (np.arange(corners) + rng.uniform(0.1, 0.9, corners)) / corners
    assume(np.diff(np.append(angle, angle[0] + 2 * np.pi)).max() < 3.0)
    loop = np.column_stack([np.cos(angle), np.sin(angle)])
    middle = 0.5 * (loop + np.roll(loop, -1, axis=0))
    middle[:, 0] += ulps * np.spacing(np.abs(middle[:, 0]))
    t = triangulated(np.vstack([loop, middle, loop]), loop_edges(corners))
    check_constrained(t)
    assert (t.same_as >= 0).sum() == corners
    assert t.locked[t.neighbours == -1].all()
    assert area(t) == pytest.approx(signed_area(loop), rel=1e-12)


@settings(max_examples=60, deadline=None)
@given(st.integers(2, 12), st.integers(0, 10_000))
def test_collinear_segments_that_share_ends(count: int, seed: int) -> None:
    """A line cut at lattice points, its pieces given in any order and direction, among points on the line itself."""
    rng = np.random.default_rng(seed)
    stations = np.arange(count + 1) / 7
    line = np.column_stack([stations, 2 * stations])
    others = np.round(rng.uniform(-1, 3, (20, 2)) * 7) / 7
    pieces = np.column_stack([np.arange(count), np.arange(1, count + 1)])
    pieces = np.where(rng.random((count, 1)) < 0.5, pieces, pieces[:, ::-1])[rng.permutation(count)]
    points = np.vstack([line, others])
    t = triangulated(points, pieces, bounding=np.zeros(count, dtype=bool))
    check_constrained(t)
    kept = np.where(t.same_as >= 0, t.same_as, np.arange(len(points)))
    edges = edge_set(t)
    assert all((min(a, b), max(a, b)) in edges for a, b in kept[pieces])
