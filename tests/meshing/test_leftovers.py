"""Leftover triangles walk to each other: the same nodes, the same area, quadrilaterals alone."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.errors import MeshingError
from sizeviz.geometry import QuadMesh
from sizeviz.meshing.leftovers import merged


def lattice(n: int, split: list[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return an n x n lattice of squares, some of them cut into two triangles, one of which is then re-joined oddly."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    squares = np.column_stack([corner, corner + 1, corner + n + 2, corner + n + 1])
    kept = np.setdiff1d(np.arange(n * n), split)
    halves = [squares[split][:, [0, 1, 2]], squares[split][:, [0, 2, 3]]]
    return np.column_stack([x.ravel(), y.ravel()]), np.vstack(halves).astype(np.int32), squares[kept].astype(np.int32)


def checked(points: np.ndarray, triangles: np.ndarray, quads: np.ndarray) -> QuadMesh:
    result = merged(points, triangles, quads)
    assert len(result) == len(quads) + len(triangles) // 2
    mesh = QuadMesh(points, result, np.full(len(points), -1, np.int32), np.zeros(len(points), bool))
    corners = points[triangles]
    side, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * (side[:, 0] * other[:, 1] - side[:, 1] * other[:, 0]).sum()
    for quad in quads:
        p, q = points[quad[2]] - points[quad[0]], points[quad[3]] - points[quad[1]]
        area += 0.5 * (p[0] * q[1] - p[1] * q[0])
    assert mesh.areas.sum() == pytest.approx(area, rel=1e-12)
    edges = np.sort(np.stack([result, np.roll(result, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    assert np.unique(edges, axis=0, return_counts=True)[1].max() <= 2
    return mesh


def test_neighbours_merge_into_the_square_they_were() -> None:
    points, triangles, quads = lattice(3, [4])
    mesh = checked(points, triangles, quads)
    assert np.allclose(mesh.areas, 1.0)


def test_distant_triangles_meet_and_nothing_folds_badly() -> None:
    """Cut the corner off a strip at both ends: two triangles with ten squares between them."""
    n = 10
    x = np.arange(n + 1.0)
    points = np.vstack([np.c_[x, 0 * x], np.c_[x, 0 * x + 1.0], [[-0.8, 0.5], [n + 0.8, 0.5]]])
    lower, upper = np.arange(n + 1), np.arange(n + 1, 2 * n + 2)
    quads = np.column_stack([lower[:-1], lower[1:], upper[1:], upper[:-1]]).astype(np.int32)
    triangles = np.array([[2 * n + 2, 0, n + 1], [2 * n + 3, 2 * n + 1, n]], dtype=np.int32)
    mesh = checked(points, triangles, quads)
    assert mesh.areas.min() > 0.2


@pytest.mark.parametrize("seed", range(8))
def test_random_leftovers_of_a_lattice(seed: int) -> None:
    """Merge two halves of different squares away first, so that lone triangles lie scattered about."""
    rng = np.random.default_rng(seed)
    split = rng.choice(64, size=6, replace=False).tolist()
    points, triangles, quads = lattice(8, split)
    checked(points, rng.permutation(triangles), rng.permutation(quads))


def test_no_triangle_no_change() -> None:
    points, _, quads = lattice(2, [0])
    assert merged(points, np.empty((0, 3), dtype=np.int32), quads) is quads


def test_an_odd_one_out_is_reported() -> None:
    points, triangles, quads = lattice(2, [0])
    with pytest.raises(MeshingError, match="odd number"):
        merged(points, triangles[:1], quads)


def test_triangles_that_cannot_meet_are_reported() -> None:
    points, triangles, quads = lattice(5, [0, 24])
    apart = np.array([k for k in range(len(quads)) if 12 > k or k > 17])
    lonely = triangles[[0, 3]]
    with pytest.raises(MeshingError, match="no other can be reached"):
        merged(points, lonely, quads[apart][:0])
