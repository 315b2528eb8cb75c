"""Meshes of the unit square, with their boundary marked, that the tests of this folder share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import Delaunay

from sizeviz.geometry import Domain, QuadMesh
from sizeviz.sizing import BackgroundMesh, SizeField

if TYPE_CHECKING:
    from numpy.typing import NDArray


def on_square(points: NDArray[np.float64], quads: NDArray[np.int32]) -> QuadMesh:
    """Mark which side of the unit square each node slides along."""
    x, y = points.T
    sides = [y == 0.0, x == 1.0, y == 1.0, x == 0.0]
    curve = np.full(len(points), -1)
    for c, side in enumerate(sides):
        curve[side] = c
    return QuadMesh(points, quads, curve, np.sum(sides, axis=0) == 2)


def disturbed(n: int, amount: float, seed: int) -> QuadMesh:
    """Return an n x n grid whose free nodes were moved by up to ``amount`` of a side."""
    ticks = np.arange(n + 1) / n
    x, y = np.meshgrid(ticks, ticks)
    points = np.column_stack([x.ravel(), y.ravel()])
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = np.column_stack([first, first + 1, first + n + 2, first + n + 1]).astype(np.int32)
    inside = (points > 0).all(axis=1) & (points < 1).all(axis=1)
    shift = amount / n * np.random.default_rng(seed).uniform(-1, 1, points.shape)
    return on_square(points + np.where(inside[:, None], shift, 0.0), quads)


def thirds(count: int, seed: int) -> QuadMesh:
    """Return a random triangulation whose triangles are cut in three: a mesh with many irregular nodes."""
    rng = np.random.default_rng(seed)
    rim = np.arange(count) / count
    nil, one = np.zeros(count), np.ones(count)
    border = np.vstack([np.column_stack(p) for p in ((rim, nil), (one, rim), (1 - rim, one), (nil, 1 - rim))])
    # a jittered grid: random, but without slivers
    x, y = np.meshgrid((np.arange(count - 1) + 1) / count, (np.arange(count - 1) + 1) / count)
    inner = np.column_stack([x.ravel(), y.ravel()]) + 0.3 / count * rng.uniform(-1, 1, ((count - 1) ** 2, 2))
    corners = np.vstack([border, inner])
    triangles = Delaunay(corners).simplices
    sides = np.sort(np.vstack([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    edges, which = np.unique(sides, axis=0, return_inverse=True)
    middle = which.reshape(3, -1).T + len(corners)
    centre = np.arange(len(triangles)) + len(corners) + len(edges)
    points = np.vstack([corners, corners[edges].mean(axis=1), corners[triangles].mean(axis=1)])
    quads = np.vstack(
        [np.column_stack([triangles[:, k], middle[:, k], centre, middle[:, (k + 2) % 3]]) for k in range(3)]
    )
    return on_square(points, quads.astype(np.int32))


def uniform(size: float = 0.1) -> SizeField:
    """Return a constant size on the unit square."""
    background = BackgroundMesh.unit_square_grid(9, 9)
    return SizeField(background, np.full(81, size), "uniform")


def graded() -> SizeField:
    """Return sizes that grow from left to right."""
    background = BackgroundMesh.unit_square_grid(33, 33)
    return SizeField(background, 0.02 + 0.1 * background.points[:, 0], "graded")


def unit() -> Domain:
    """Return the unit square."""
    return Domain.unit_square()


def edge_uses(mesh: QuadMesh) -> NDArray[np.int64]:
    """Return how many elements share each edge."""
    edges = np.sort(np.vstack([mesh.quads[:, [k, (k + 1) % 4]] for k in range(4)]), axis=1)
    return np.unique(edges, axis=0, return_counts=True)[1]
