"""Background meshes: the triangulations that size fields live on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import as_cells, as_points, read_only

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.sizing.tree import TriangleTree


@dataclass(frozen=True)
class Grid:
    """A regular grid of nodes; node (i, j) has index ``i * nx + j`` and lies at ``(x0 + j dx, y0 + i dy)``.

    Parameters
    ----------
    x0, y0 : float
        Node (0, 0), in model units.
    dx, dy : float
        Spacing, in model units, above 0.
    nx, ny : int
        Number of nodes along x and y, at least 2.
    """

    x0: float
    y0: float
    dx: float
    dy: float
    nx: int
    ny: int

    def __post_init__(self) -> None:
        if self.nx < 2 or self.ny < 2:
            raise InputError(f"grid of {self.ny} x {self.nx} nodes: at least 2 x 2 are needed")
        if not (self.dx > 0 and self.dy > 0):
            raise InputError(f"grid spacing {self.dx} x {self.dy}: it must be above 0")


@dataclass(frozen=True, eq=False)
class BackgroundMesh:
    """A triangulation that carries nodal sizes.

    Parameters
    ----------
    points : (V, 2) float64
        Nodes.
    triangles : (T, 3) int32
        Counter-clockwise corners.
    grid : Grid, optional
        Set where the nodes form a regular grid whose cells are cut along the diagonal from (i, j) to
        (i + 1, j + 1); location is then arithmetic.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    grid: Grid | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", as_points(self.points, "background mesh"))
        object.__setattr__(self, "triangles", as_cells(self.triangles, 3, len(self.points), "background mesh"))

    @cached_property
    def tree(self) -> TriangleTree:
        """The bounding-box tree over the triangles, built when first asked for."""
        from sizeviz.sizing.tree import tree_over  # here, so that reading a field does not load numba

        return tree_over(self.points, self.triangles)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Smallest x, smallest y, largest x, largest y of the nodes."""
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @classmethod
    def regular(cls, grid: Grid) -> BackgroundMesh:
        """Return the triangulation of a regular grid, two triangles a cell."""
        x = grid.x0 + grid.dx * np.arange(grid.nx)
        y = grid.y0 + grid.dy * np.arange(grid.ny)
        points = np.column_stack([np.tile(x, grid.ny), np.repeat(y, grid.nx)])
        corner = (np.arange(grid.ny - 1)[:, None] * grid.nx + np.arange(grid.nx - 1)).ravel().astype(np.int32)
        right, above, across = corner + 1, corner + grid.nx, corner + grid.nx + 1
        triangles = np.empty((2 * len(corner), 3), dtype=np.int32)
        triangles[0::2] = np.column_stack([corner, right, across])
        triangles[1::2] = np.column_stack([corner, across, above])
        return cls(read_only(points), read_only(triangles), grid)

    @classmethod
    def unit_square_grid(cls, nx: int, ny: int) -> BackgroundMesh:
        """Return a regular grid of ``ny`` rows and ``nx`` columns of nodes over the unit square."""
        return cls.regular(Grid(0.0, 0.0, 1.0 / (nx - 1), 1.0 / (ny - 1), nx, ny))
