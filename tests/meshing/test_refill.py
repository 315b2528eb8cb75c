"""Parts of a mesh packed anew between the nodes along their boundary."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.geometry import Domain, QuadMesh
from sizeviz.meshing import MeshOptions
from sizeviz.meshing.checks import edges_of
from sizeviz.meshing.frontal.refill import refilled
from sizeviz.sizing import BackgroundMesh, SizeField
from tests.meshes import square_grid

NO_LINES = np.empty((0, 2), dtype=np.int64)
DOMAIN = Domain.unit_square()


def even(size: float) -> SizeField:
    return SizeField(BackgroundMesh.unit_square_grid(9, 9), np.full(81, size), "even")


def with_curves(mesh: QuadMesh) -> QuadMesh:
    """Return a mesh of the unit square whose boundary nodes slide along its sides."""
    x, y = mesh.points.T
    curve = np.select([y == 0.0, x == 1.0, y == 1.0, x == 0.0], [0, 1, 2, 3], -1)
    return QuadMesh(mesh.points, mesh.quads, curve, np.isin(x, (0, 1)) & np.isin(y, (0, 1)))


def rim_of(mesh: QuadMesh) -> set[tuple[bytes, bytes]]:
    """Return the boundary edges by the places of their ends."""
    edges, count = edges_of(mesh.quads)
    ends = [mesh.points[row].tolist() for row in edges[count == 1]]
    return {tuple(sorted(map(tuple, pair))) for pair in ends}


@pytest.mark.parametrize("size", [0.1, 0.06, 0.03])
def test_the_boundary_stays_edge_by_edge_whatever_the_sizes_inside(size: float) -> None:
    before = with_curves(square_grid(10, 10))
    after = refilled(before, NO_LINES, even(size), MeshOptions(scale=1.0))
    assert rim_of(after) == rim_of(before)
    kept = before.curve >= 0
    n = int(kept.sum())
    np.testing.assert_array_equal(after.points[:n], before.points[kept])
    np.testing.assert_array_equal(after.curve[:n], before.curve[kept])
    np.testing.assert_array_equal(after.fixed[:n], before.fixed[kept])
    assert (after.curve[n:] == -1).all() and not after.fixed[n:].any()
    assert after.areas.sum() == pytest.approx(1.0, abs=1e-12)
    assert after.n_quads == pytest.approx(1.0 / size**2, rel=0.35)


def test_an_inner_line_and_a_hole_are_kept() -> None:
    grid = with_curves(square_grid(12, 12))
    centre = grid.points[grid.quads].mean(axis=1)
    hollow = QuadMesh(
        grid.points, grid.quads[(np.abs(centre - [0.25, 0.5]) > 0.17).any(axis=1)], grid.curve, grid.fixed
    )
    used = np.unique(hollow.quads)
    rank = np.full(hollow.n_points, -1)
    rank[used] = np.arange(len(used))
    before = QuadMesh(grid.points[used], rank[hollow.quads].astype(np.int32), grid.curve[used], grid.fixed[used])
    on = np.flatnonzero(before.points[:, 0] == 0.75)
    on = on[np.argsort(before.points[on, 1])]
    curve = before.curve.copy()
    curve[on[1:-1]] = 4
    before = QuadMesh(before.points, before.quads, curve, before.fixed)
    after = refilled(before, np.column_stack([on[:-1], on[1:]]), even(0.05), MeshOptions(scale=1.0))
    assert rim_of(after) == rim_of(before)
    assert after.areas.sum() == pytest.approx(before.areas.sum(), abs=1e-12)
    edges, _ = edges_of(after.quads)
    assert (after.points[edges][:, :, 0] == 0.75).all(axis=1).sum() == 12


def test_the_same_for_any_number_of_threads() -> None:
    before = with_curves(square_grid(10, 10))
    one, two = (refilled(before, NO_LINES, even(0.04), MeshOptions(scale=1.0, threads=n)) for n in (1, 2))
    np.testing.assert_array_equal(one.points, two.points)
    np.testing.assert_array_equal(one.quads, two.quads)
