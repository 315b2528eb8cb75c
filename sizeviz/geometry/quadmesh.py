"""All-quadrilateral meshes of planar domains."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import as_cells, as_points, read_only

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class QuadMesh:
    """Quadrilaterals that cover a domain, and how their nodes may move.

    Parameters
    ----------
    points : (N, 2) float64
        Nodes, in model units.
    quads : (Q, 4) int32
        Corners of each element, counter-clockwise.
    curve : (N,) int32
        The curve of ``Domain.curves`` each node slides along, -1 inside the domain.
    fixed : (N,) bool
        Nodes that never move: corners of the domain and prescribed points.
    """

    points: NDArray[np.float64]
    quads: NDArray[np.int32]
    curve: NDArray[np.int32]
    fixed: NDArray[np.bool_]

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", as_points(self.points, "quad mesh"))
        object.__setattr__(self, "quads", as_cells(self.quads, 4, len(self.points), "quad mesh"))
        object.__setattr__(self, "curve", read_only(np.asarray(self.curve, dtype=np.int32)))
        object.__setattr__(self, "fixed", read_only(np.asarray(self.fixed, dtype=bool)))
        if self.curve.shape != (len(self.points),) or self.fixed.shape != (len(self.points),):
            raise InputError(f"quad mesh: curve and fixed must have one entry for each of {len(self.points)} nodes")

    @property
    def n_points(self) -> int:
        """Number of nodes."""
        return len(self.points)

    @property
    def n_quads(self) -> int:
        """Number of elements."""
        return len(self.quads)

    @property
    def areas(self) -> NDArray[np.float64]:
        """Signed area of each element, ``(Q,)``, from its diagonals."""
        corner = self.points[self.quads]
        p, q = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
        return 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])

    def with_points(self, points: NDArray[np.float64]) -> QuadMesh:
        """Return the same mesh with its nodes elsewhere, ``points`` of shape (N, 2)."""
        return replace(self, points=points)
