"""Both envelopes at a node of a regular grid: branch and bound over a pyramid of blocks, located by arithmetic."""

import numpy as np
from numba import njit

from sizeviz.sizing._envelope_kernels import (
    BASE,
    LEAST,
    PRESERVE,
    SLOPE_X,
    SLOPE_Y,
    block_may_improve,
    join_bounds,
    on_triangle,
    start_bounds,
)
from sizeviz.sizing._tree_kernels import uncounted


@njit(nogil=True, cache=True)
def block_minima(sizes, nx, ny, shapes):
    """Return the least size of each cell, then of each block of 2 x 2, 4 x 4, ..., one after the other, ``(M,)``."""
    lowest = np.empty(shapes[-1, 2] + 1)
    for i in range(ny - 1):
        for j in range(nx - 1):
            k = i * nx + j
            lowest[i * (nx - 1) + j] = min(min(sizes[k], sizes[k + 1]), min(sizes[k + nx], sizes[k + nx + 1]))
    for level in range(1, len(shapes)):
        rows, columns, below = shapes[level - 1, 0], shapes[level - 1, 1], shapes[level - 1, 2]
        block = shapes[level, 2]
        for i in range(shapes[level, 0]):
            for j in range(shapes[level, 1]):
                r, s = min(2 * i + 1, rows - 1) * columns, min(2 * j + 1, columns - 1)
                first = below + 2 * i * columns
                least = min(lowest[first + 2 * j], lowest[first + s])
                lowest[block] = min(least, min(lowest[below + r + 2 * j], lowest[below + r + s]))
                block += 1
    return lowest


@njit(nogil=True, cache=True)
def block_bounds(grid, sizes, shapes):
    """Return the bounds of each cell, then of each block of 2 x 2, 4 x 4, ..., one after the other, ``(M, 5)``.

    Parameters
    ----------
    grid : (6,) float64
        x0, y0, dx, dy, nx, ny.
    sizes : (ny * nx,) float64
        Nodal sizes.
    shapes : (L, 3) int64
        Rows, columns and first block of each level.
    """
    bounds = np.empty((shapes[-1, 2] + 1, 5))
    _bound_cells(grid, sizes, bounds)
    for level in range(1, len(shapes)):
        below = level - 1
        half_x, half_y = 0.5 * grid[2] * (1 << below), 0.5 * grid[3] * (1 << below)
        for i in range(shapes[level, 0]):
            for j in range(shapes[level, 1]):
                _bound_block(bounds, shapes, level, i, j, half_x, half_y)
    return bounds


@uncounted
def _bound_cells(grid, sizes, bounds):
    nx, ny, dx, dy = int(grid[4]), int(grid[5]), grid[2], grid[3]
    for i in range(ny - 1):
        for j in range(nx - 1):
            k, cell = i * nx + j, i * (nx - 1) + j
            h00, h01, h10, h11 = sizes[k], sizes[k + 1], sizes[k + nx], sizes[k + nx + 1]
            rise_x, rise_y = 0.5 * (h01 - h00 + h11 - h10), 0.5 * (h10 - h00 + h11 - h01)
            start_bounds(bounds, cell, rise_x / dx, rise_y / dy)
            bounds[cell, LEAST] = min(min(h00, h01), min(h10, h11))
            p, q = 0.5 * (rise_x + rise_y), 0.5 * (rise_x - rise_y)
            bounds[cell, BASE] = min(min(h00 + p, h11 - p), min(h01 - q, h10 + q))


@uncounted
def _bound_block(bounds, shapes, level, i, j, half_x, half_y):
    rows, columns, first = shapes[level - 1, 0], shapes[level - 1, 1], shapes[level - 1, 2]
    slope_x, slope_y, count = 0.0, 0.0, 0
    for r in range(2 * i, min(2 * i + 2, rows)):
        for s in range(2 * j, min(2 * j + 2, columns)):
            slope_x += bounds[first + r * columns + s, SLOPE_X]
            slope_y += bounds[first + r * columns + s, SLOPE_Y]
            count += 1
    block = shapes[level, 2] + i * shapes[level, 1] + j
    start_bounds(bounds, block, slope_x / count, slope_y / count)
    for r in range(2 * i, min(2 * i + 2, rows)):
        for s in range(2 * j, min(2 * j + 2, columns)):
            x, y = (2 * (s - 2 * j) - 1) * half_x, (2 * (r - 2 * i) - 1) * half_y
            join_bounds(bounds, block, first + r * columns + s, x, y, half_x, half_y)


@uncounted
def search_from(kind, coefficient, grid, sizes, shapes, bounds, i, j, best, stack, tested, found):
    """Return the envelope at node (i, j), given an upper bound, beginning with the cell found last.

    ``found`` is left as it is where no cell is lower than the bound.
    """
    # the neighbour's minimum is nearly this node's: most blocks are then skipped at once
    best = _on_cell(kind, coefficient, grid, sizes, i, j, found[0], found[1], best)
    return _search(kind, coefficient, grid, sizes, shapes, bounds, i, j, best, stack, tested, found)


@uncounted
def _search(kind, coefficient, grid, sizes, shapes, bounds, i, j, best, stack, tested, found):
    """Descend into every block that may lower the envelope at node (i, j); remember the cell that was best."""
    top = _push_around(kind, coefficient, grid, shapes, bounds, i, j, best, stack, tested)
    while top > 0:
        top -= 1
        level, row, column = stack[top, 0], stack[top, 1], stack[top, 2]
        if best < tested[top] and not _may_improve(
            kind, coefficient, grid, shapes, bounds, i, j, level, row, column, best
        ):
            continue
        if level == 0:
            lower = _on_cell(kind, coefficient, grid, sizes, i, j, row, column, best)
            if lower < best:
                best = lower
                found[0], found[1] = row, column
            continue
        top = _push_children(
            kind, coefficient, grid, shapes, bounds, i, j, best, level, row, column, stack, tested, top
        )
    return best


@uncounted
def _push_around(kind, coefficient, grid, shapes, bounds, i, j, best, stack, tested):
    """Push the blocks, about as large as the ball that matters, that meet it."""
    radius = coefficient * best if kind == PRESERVE else (best - bounds[shapes[-1, 2], LEAST]) / coefficient
    spacing = min(grid[2], grid[3])
    level = 0
    while level < len(shapes) - 1 and spacing * (1 << level) < radius:
        level += 1
    reach_x, reach_y = int(radius / grid[2]) + 1, int(radius / grid[3]) + 1
    rows, columns = shapes[level, 0], shapes[level, 1]
    top = 0
    for row in range(max(i - reach_y, 0) >> level, min((i + reach_y) >> level, rows - 1) + 1):
        for column in range(max(j - reach_x, 0) >> level, min((j + reach_x) >> level, columns - 1) + 1):
            if _may_improve(kind, coefficient, grid, shapes, bounds, i, j, level, row, column, best):
                stack[top, 0], stack[top, 1], stack[top, 2] = level, row, column
                tested[top] = best
                top += 1
    return top


@uncounted
def _push_children(kind, coefficient, grid, shapes, bounds, i, j, best, level, row, column, stack, tested, top):
    """Push the quarters of a block that may improve, the one nearest to node (i, j) last."""
    below = level - 1
    rows, columns = shapes[below, 0], shapes[below, 1]
    far_row = 1 if i < (2 * row + 1) << below else 0
    far_column = 1 if j < (2 * column + 1) << below else 0
    for k in range(4):
        r = 2 * row + (far_row if k < 2 else 1 - far_row)
        s = 2 * column + (far_column if k % 2 == 0 else 1 - far_column)
        if r >= rows or s >= columns:
            continue
        if _may_improve(kind, coefficient, grid, shapes, bounds, i, j, below, r, s, best):
            stack[top, 0], stack[top, 1], stack[top, 2] = below, r, s
            tested[top] = best
            top += 1
    return top


@uncounted
def _may_improve(kind, coefficient, grid, shapes, bounds, i, j, level, row, column, best):
    """Return whether a block (which may overhang the grid) could lower the envelope at node (i, j)."""
    side = 1 << level
    half_x, half_y = 0.5 * side * grid[2], 0.5 * side * grid[3]
    x, y = (column * side - j) * grid[2] + half_x, (row * side - i) * grid[3] + half_y
    block = shapes[level, 2] + row * shapes[level, 1] + column
    return block_may_improve(kind, coefficient, bounds, block, x, y, half_x, half_y, best)


@uncounted
def _on_cell(kind, coefficient, grid, sizes, i, j, row, column, best):
    """Return the envelope of the two triangles of a cell at node (i, j), or ``best`` where that is lower."""
    nx = int(grid[4])
    corner = row * nx + column
    h00, h01, h10, h11 = sizes[corner], sizes[corner + 1], sizes[corner + nx], sizes[corner + nx + 1]
    x0, y0 = (column - j) * grid[2], (row - i) * grid[3]
    x1, y1 = (column + 1 - j) * grid[2], (row + 1 - i) * grid[3]
    best = on_triangle(kind, coefficient, x0, y0, h00, x1, y0, h01, x1, y1, h11, best)
    return on_triangle(kind, coefficient, x0, y0, h00, x1, y1, h11, x0, y1, h10, best)
