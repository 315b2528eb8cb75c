"""The blocks of a grid's pyramid that may matter to a tile of nodes."""

import math

from sizeviz.sizing._envelope_kernels import BASE, LEAST, PRESERVE, ROUNDING, SLOPE, SLOPE_X, SLOPE_Y, may_improve
from sizeviz.sizing._piece_kernels import BLOCK_LEVEL, simple

MOST_BLOCKS = 128
"""Blocks listed for a tile at most."""


@simple
def list_blocks(
    kind, coefficient, grid, shapes, bounds, i0, j0, rows, columns, value, slope_x, slope_y, most, stack, places
):
    """List the blocks that may lower the envelope at some node of a tile; return how many, -1 if too many.

    Parameters
    ----------
    i0, j0, rows, columns : int
        The tile's first node and its extent in nodes.
    value, slope_x, slope_y, most : float
        An affine upper bound of the envelope, by its value at the tile's centre, and the greatest upper bound.
    """
    last = len(shapes) - 1
    root = shapes[last, 2]
    radius = coefficient * most if kind == PRESERVE else max(most - bounds[root, LEAST], 0.0) / coefficient
    finest = min(BLOCK_LEVEL, last)
    level = finest
    while level < last and min(grid[2], grid[3]) * (1 << level) < radius:
        level += 1
    reach_x, reach_y = int(min(radius / grid[2], 1e9)) + 1, int(min(radius / grid[3], 1e9)) + 1
    count = 0
    for row in range(max(i0 - reach_y, 0) >> level, min((i0 + rows + reach_y) >> level, shapes[level, 0] - 1) + 1):
        for column in range(
            max(j0 - reach_x, 0) >> level, min((j0 + columns + reach_x) >> level, shapes[level, 1] - 1) + 1
        ):
            stack[0, 0], stack[0, 1], stack[0, 2] = level, row, column
            count = _list_within(
                kind, coefficient, grid, shapes, bounds, i0, j0, rows, columns, value, slope_x, slope_y, most, finest,
                stack, places, count,
            )  # fmt: skip
            if count < 0:
                return count
    return count


@simple
def _list_within(
    kind, coefficient, grid, shapes, bounds, i0, j0, rows, columns, value, slope_x, slope_y, most, finest, stack,
    places, count,
):  # fmt: skip
    """Append the blocks of the finest level below the one on the stack; return how many are listed, -1 if too many."""
    tile_x, tile_y = 0.5 * (columns - 1) * grid[2], 0.5 * (rows - 1) * grid[3]
    top = 1
    while top > 0:
        top -= 1
        level, row, column = stack[top, 0], stack[top, 1], stack[top, 2]
        side = 1 << level
        half_x, half_y = 0.5 * side * grid[2], 0.5 * side * grid[3]
        x, y = (column * side - j0) * grid[2] + half_x, (row * side - i0) * grid[3] + half_y
        block = shapes[level, 2] + row * shapes[level, 1] + column
        if not _may_improve_tile(
            kind, coefficient, bounds, block, x - tile_x, y - tile_y, half_x, half_y, tile_x, tile_y,
            value, slope_x, slope_y, most,
        ):  # fmt: skip
            continue
        if level > finest:
            for r in range(2 * row, min(2 * row + 2, shapes[level - 1, 0])):
                for s in range(2 * column, min(2 * column + 2, shapes[level - 1, 1])):
                    stack[top, 0], stack[top, 1], stack[top, 2] = level - 1, r, s
                    top += 1
            continue
        if count == MOST_BLOCKS:
            return -1
        places[count, 0], places[count, 1] = row, column
        count += 1
    return count


@simple
def _may_improve_tile(
    kind, coefficient, bounds, block, x, y, half_x, half_y, tile_x, tile_y, value, slope_x, slope_y, most
):
    """Return whether a block could lower the envelope at a node of a tile centred at the origin.

    As ``block_may_improve``, with the upper bound an affine function of the node's place: the gap is linear in that
    place and in the place in the block, and at the block that matters its slope in either nearly vanishes. For size
    preserving the distance alone is tried too.
    """
    dx, dy = max(abs(x) - half_x - tile_x, 0.0), max(abs(y) - half_y - tile_y, 0.0)
    if not may_improve(kind, coefficient, bounds[block, LEAST], dx * dx + dy * dy, most):
        return False
    distance = math.sqrt(x * x + y * y)
    per = 1.0 / distance if distance > 0.0 else 0.0
    nx, ny = x * per, y * per
    weight, factor = coefficient, 1.0
    if kind == PRESERVE:
        slack = half_x * abs(nx) + half_y * abs(ny)
        slack += tile_x * abs(coefficient * slope_x + nx) + tile_y * abs(coefficient * slope_y + ny)
        if distance - slack >= coefficient * value:
            return False
        weight = bounds[block, SLOPE]
        factor = 1.0 + coefficient * weight
    slack = half_x * abs(bounds[block, SLOPE_X] + weight * nx) + half_y * abs(bounds[block, SLOPE_Y] + weight * ny)
    slack += tile_x * abs(factor * slope_x + weight * nx) + tile_y * abs(factor * slope_y + weight * ny)
    return bounds[block, BASE] + weight * distance - slack < factor * value * (1.0 - ROUNDING)
