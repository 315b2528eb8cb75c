"""Pairing: a perfect matching wherever there is one, and nearly the cheapest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_matrix

from sizeviz.geometry.delaunay import triangulated
from sizeviz.meshing.frontal import _pairing_kernels as kernels
from sizeviz.meshing.frontal.pairing import paired
from sizeviz.meshing.frontal.splitting import split

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry.delaunay import Triangulation


def random_mesh(n: int, seed: int) -> Triangulation:
    """Return random points with a boundary of 4 corners, so that the number of triangles is even."""
    inner = np.random.default_rng(seed).uniform(0.05, 0.95, (n, 2))
    return triangulated(np.vstack([[[0, 0], [1, 0], [1, 1], [0, 1]], inner]))


@pytest.mark.parametrize("seed", range(6))
def test_no_triangle_remains(seed: int) -> None:
    mesh = random_mesh(400, seed)
    quads, single = paired(mesh)
    assert len(single) == 0
    assert 2 * len(quads) == len(mesh.triangles)
    corner = mesh.points[quads]
    p, q = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    assert 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum() == pytest.approx(1.0)


def test_locked_edges_are_not_crossed() -> None:
    """A square cut by its diagonal cannot be paired across it."""
    mesh = triangulated([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 2]], bounding=[False])
    quads, single = paired(mesh)
    assert len(quads) == 0
    assert len(single) == 2


def test_an_odd_number_leaves_one() -> None:
    mesh = triangulated([[0, 0], [1, 0], [0.5, 1], [0.5, 0.3]])
    quads, single = paired(mesh)
    assert len(quads) == 1
    assert len(single) == 1


def test_cost_is_close_to_the_least() -> None:
    mesh = random_mesh(60, 11)
    n = len(mesh.triangles)
    twin = kernels.joinable(mesh.neighbours, mesh.locked)
    cost = np.empty(3 * n)
    kernels.pair_costs(0, n, mesh.points, mesh.triangles, twin, cost)
    edge = np.flatnonzero(twin > np.arange(3 * n))
    rows, columns = np.concatenate([edge // 3, twin[edge] // 3]), np.tile(np.arange(len(edge)), 2)
    incidence = csr_matrix((np.ones(2 * len(edge)), (rows, columns)), shape=(n, len(edge)))
    best = milp(
        cost[edge], constraints=LinearConstraint(incidence, 1, 1), integrality=np.ones(len(edge)), bounds=Bounds(0, 1)
    )
    quads, _ = paired(mesh)
    ours = sum(_cost(mesh.points[q]) for q in quads)
    assert best.fun <= ours + 0.01
    assert ours <= 1.35 * best.fun


def _cost(corner: NDArray[np.float64]) -> float:
    quality = kernels.quad_quality(*corner.ravel())
    return 1 - quality + kernels.POOR_WEIGHT * max(0.0, kernels.POOR - quality)


def test_quality_of_known_shapes() -> None:
    assert kernels.quad_quality(0, 0, 1, 0, 1, 1, 0, 1) == pytest.approx(1.0)
    assert kernels.quad_quality(0, 0, 2, 0, 2, 1, 0, 1) == pytest.approx(0.8)
    assert kernels.quad_quality(0, 0, 1, 0, 0.1, 0.1, 0, 1) == 0.0


def test_splitting_keeps_area_and_leaves_quadrilaterals_only() -> None:
    points = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [3, 1.0]])
    new, cells, edges = split(points, np.array([[0, 1, 2, 3]], np.int32), np.array([[1, 4, 2]], np.int32))
    assert len(cells) == 7
    assert len(new) == 5 + len(edges) + 2
    corner = new[cells]
    p, q = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    areas = 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(5.0)
