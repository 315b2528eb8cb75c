"""The catalogue of quad meshes that tests share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry import QuadMesh

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def quad_mesh(points: ArrayLike, quads: ArrayLike) -> QuadMesh:
    """Return a mesh whose nodes are all free."""
    nodes = np.asarray(points, dtype=np.float64)
    return QuadMesh(nodes, np.asarray(quads), np.full(len(nodes), -1), np.zeros(len(nodes), dtype=bool))


def square_grid(nx: int, ny: int, width: float = 1.0, height: float = 1.0) -> QuadMesh:
    """Return nx by ny rectangles that cover a rectangle with a corner at the origin."""
    x, y = np.meshgrid(np.linspace(0, width, nx + 1), np.linspace(0, height, ny + 1))
    first = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    quads = np.column_stack([first, first + 1, first + nx + 2, first + nx + 1])
    return quad_mesh(np.column_stack([x.ravel(), y.ravel()]), quads)


def perturbed_grid(n: int, amount: float, seed: int) -> QuadMesh:
    """Return n by n quadrilaterals whose nodes were moved by up to ``amount`` of a side."""
    mesh = square_grid(n, n)
    rng = np.random.default_rng(seed)
    return mesh.with_points(mesh.points + amount / n * rng.uniform(-1, 1, mesh.points.shape))


def one(corners: ArrayLike) -> QuadMesh:
    """Return a mesh of one quadrilateral."""
    return quad_mesh(corners, [[0, 1, 2, 3]])


def star(arms: int) -> QuadMesh:
    """Return quadrilaterals around one node, ``arms`` of them."""
    angle = 2 * np.pi * np.arange(2 * arms) / (2 * arms)
    radius = np.where(np.arange(2 * arms) % 2 == 0, 1.0, 1.3)
    rim = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    start = 2 * np.arange(arms)
    quads = np.column_stack([np.zeros(arms, dtype=int), 1 + start, 2 + start, 1 + (start + 2) % (2 * arms)])
    return quad_mesh(np.vstack([[0.0, 0.0], rim]), quads)
