"""Which element lies at a point."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import QuadMesh

CANDIDATES = 24
"""Elements looked at around a point, nearest centres first."""


class ElementLocator:
    """Finds a mesh's elements by their centres; built on a worker, asked in the window.

    Parameters
    ----------
    mesh : QuadMesh
        The mesh; it is not kept.
    """

    def __init__(self, mesh: QuadMesh) -> None:
        from scipy.spatial import cKDTree

        self._corners = mesh.points[mesh.quads]
        self._tree = cKDTree(self._corners.mean(axis=1))

    def element_at(self, x: float, y: float) -> int | None:
        """Return the element that holds the point, its border included, None where there is none."""
        point = np.array([x, y])
        _, near = self._tree.query(point, k=min(CANDIDATES, len(self._corners)))
        near = np.atleast_1d(near)
        inside = contains(self._corners[near], point)
        return int(near[np.argmax(inside)]) if inside.any() else None

    def areas(self, elements: list[int]) -> NDArray[np.float64]:
        """Return the areas of some elements."""
        corner = self._corners[elements]
        p, q = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
        return 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])

    def elements_in(self, x: float, y: float, radius: float) -> NDArray[np.intp]:
        """Return the elements whose centre is within a distance of a point."""
        return np.array(self._tree.query_ball_point((x, y), radius), dtype=np.intp)


def contains(corners: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which counter-clockwise convex quadrilaterals ``(N, 4, 2)`` hold a point, ``(N,)``."""
    along = np.roll(corners, -1, axis=1) - corners
    away = point - corners
    turn = along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]
    return (turn >= -1e-12 * (along**2).sum(axis=2)).all(axis=1)
