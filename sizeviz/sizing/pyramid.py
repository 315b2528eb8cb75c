"""Blocks of 1, 2 x 2, 4 x 4, ... cells over a regular grid, for branch and bound."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry.arrays import read_only
from sizeviz.sizing import _grid_kernels

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.sizing.background import Grid


def pyramid(grid: Grid) -> NDArray[np.int64]:
    """Return rows, columns and first entry of each level of blocks over a grid's cells, ``(L, 3)``, finest first."""
    rows, columns, first = grid.ny - 1, grid.nx - 1, 0
    shapes = [(rows, columns, first)]
    while rows > 1 or columns > 1:
        first += rows * columns
        rows, columns = -(-rows // 2), -(-columns // 2)
        shapes.append((rows, columns, first))
    return read_only(np.array(shapes, dtype=np.int64))


def block_minima(grid: Grid, sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the least nodal size of every block, in the order of ``pyramid``."""
    return read_only(_grid_kernels.block_minima(sizes, grid.nx, grid.ny, pyramid(grid)))
