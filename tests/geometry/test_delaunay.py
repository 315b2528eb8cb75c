"""Delaunay triangulations: hull covered, circles empty, neighbours true, against scipy where it is unique."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial import Delaunay as ScipyDelaunay

from sizeviz.errors import Cancelled, InputError
from sizeviz.geometry.delaunay import Triangulation, delaunay, hilbert_order, triangulated
from sizeviz.geometry.predicates import circle_sides, orientations


def canonical(triangles) -> set[tuple[int, ...]]:
    return {tuple(sorted(int(v) for v in t)) for t in triangles}


def check(t: Triangulation) -> None:
    """Every local property from which the global ones follow: positive, neighbours mutual, locally Delaunay."""
    p = t.points
    a, b, c = (p[t.triangles[:, k]] for k in range(3))
    assert (orientations(a, b, c) == 1).all()
    for k in range(3):
        across = t.neighbours[:, k]
        has = np.flatnonzero(across >= 0)
        edge = np.sort(np.column_stack([t.triangles[:, (k + 1) % 3], t.triangles[:, (k + 2) % 3]]), axis=1)
        other = t.triangles[across[has]]
        shared = (other[:, :, None] == edge[has][:, None, :]).any(axis=2)
        assert (shared.sum(axis=1) == 2).all()
        assert (t.neighbours[across[has]] == has[:, None]).any(axis=1).all()
        apex = other[~shared]
        assert (circle_sides(a[has], b[has], c[has], p[apex]) <= 0).all()


@pytest.mark.parametrize("n", [3, 10, 500, 20_000])
def test_agrees_with_scipy_on_random_points(n) -> None:
    points = np.random.default_rng(n).random((n, 2))
    t = triangulated(points)
    check(t)
    if n < 1000:
        assert canonical(t.triangles) == canonical(ScipyDelaunay(points).simplices)
    hull = ConvexHull(points)
    assert len(t.triangles) == 2 * n - 2 - len(hull.vertices)
    assert (t.neighbours == -1).sum() == len(hull.vertices)


small = st.integers(0, 6).map(float)


@settings(max_examples=150, deadline=None)
@given(st.lists(st.tuples(small, small), min_size=1, max_size=40), st.sampled_from([1.0, 0.1, 1 / 3]))
def test_lattice_points_with_duplicates(rows, step) -> None:
    """Collinear, cocircular and coincident points by the dozen."""
    points = np.array(rows) * step
    t = triangulated(points)
    check(t)
    distinct = np.unique(points, axis=0)
    kept = np.flatnonzero(t.same_as < 0)
    if len(t.triangles):
        assert len(kept) == len(distinct)
        assert np.array_equal(np.unique(t.triangles), kept)
        assert np.array_equal(points[t.same_as[t.same_as >= 0]], points[t.same_as >= 0])
        corner = points[t.triangles]
        u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum()
        assert area == pytest.approx(shapely.MultiPoint(distinct).convex_hull.area, rel=1e-9, abs=1e-15)
    else:
        assert (orientations(distinct[0], distinct[-1], distinct) == 0).all()


def test_lattice_that_binary_fractions_cannot_hold() -> None:
    n = 40
    points = np.stack(np.meshgrid(np.arange(n) / 39, np.arange(n) / 39), axis=-1).reshape(-1, 2)
    t = triangulated(points)
    check(t)
    assert len(t.triangles) == 2 * (n - 1) ** 2


def test_points_on_a_circle_and_its_centre() -> None:
    angle = 2 * np.pi * np.arange(64) / 64
    t = triangulated(np.vstack([np.column_stack([np.cos(angle), np.sin(angle)]), [[0.0, 0.0]]]))
    check(t)
    assert len(t.triangles) == 64
    assert (t.triangles == 64).any(axis=1).all()


@pytest.mark.parametrize(
    "points", [np.empty((0, 2)), [[1, 2]], [[0, 0], [1, 1]], [[0, 0], [1, 1], [2, 2], [3, 3]], np.zeros((9, 2))]
)
def test_no_triangles_where_there_is_no_area(points) -> None:
    assert delaunay(np.asarray(points, dtype=float)).shape == (0, 3)


def test_same_result_every_time_whatever_the_scale() -> None:
    points = np.random.default_rng(5).random((3000, 2))
    assert np.array_equal(delaunay(points), delaunay(points))
    assert canonical(delaunay(points)) == canonical(delaunay(points * 1024.0))


def test_strongly_graded_points() -> None:
    rng = np.random.default_rng(6)
    radius = 10.0 ** rng.uniform(-9, 0, 4000)
    angle = rng.uniform(0, 2 * np.pi, 4000)
    check(triangulated(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])))


def test_not_finite_is_refused() -> None:
    with pytest.raises(InputError, match="point 1 is not finite"):
        delaunay([[0, 0], [np.nan, 0], [1, 1]])


def test_cancel_stops_it() -> None:
    class Stop:
        def step(self, fraction: float, message: str = "") -> None:
            raise Cancelled

    with pytest.raises(Cancelled):
        triangulated(np.random.default_rng(7).random((100, 2)), monitor=Stop())


def test_hilbert_order_keeps_neighbours_close() -> None:
    points = np.random.default_rng(8).random((4000, 2))
    order = hilbert_order(points)
    assert np.array_equal(np.sort(order), np.arange(4000))
    jumps = np.hypot(*np.diff(points[order], axis=0).T)
    assert jumps.mean() < 2 / np.sqrt(4000)
