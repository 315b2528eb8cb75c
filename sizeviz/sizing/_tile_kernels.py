"""Both envelopes on a regular grid, for tiles of 8 x 8 nodes at a time.

The envelope is searched for at the tiles' corners. Between them the corners' minimisers, interpolated, give an upper
bound whose gap is of second order in the size of the tile, and so is the gap of the lower bounds of blocks: one descent
for the whole tile leaves a few blocks, and in them a few triangles or nodes, which are all that its nodes look at.
"""

import math

import numpy as np
from numba import njit

from sizeviz.sizing._block_kernels import BLOCK_ROWS, MOST_BLOCKS, bound_blocks, list_blocks
from sizeviz.sizing._envelope_kernels import LIMIT, PRESERVE, ROUNDING
from sizeviz.sizing._grid_kernels import search_from
from sizeviz.sizing._kernels import size_on_grid
from sizeviz.sizing._piece_kernels import (
    BLOCK_LEVEL,
    PIECES,
    SHARE,
    bound_triangles,
    bound_triangles_for_tile,
    gather_nodes,
    gather_triangles,
    improve_by_nodes,
    improve_by_triangles,
    keep_nodes,
    keep_triangles,
    raise_nodes,
    simple,
)

TILE = 8
"""Nodes along a tile."""

AWAY_X, AWAY_Y, SIZE_THERE = range(3)
"""What is kept of a corner: the way to a point that nearly attains its envelope, and the size at that point."""

DOUBT = 1e-9
"""Share by which an upper bound is raised, so that the value itself comes from a triangle or an edge."""


@njit(nogil=True, cache=True)
def envelope_corners(kind, coefficient, grid, sizes, shapes, bounds, corners, first_row, last_row):
    """Fill rows of ``corners`` (rows, columns, 3) with where the envelope of every eighth node is attained."""
    nx, ny = int(grid[4]), int(grid[5])
    stack, tested, found = np.empty((256, 3), dtype=np.int64), np.empty(256), np.zeros(2, dtype=np.int64)
    for row in range(first_row, last_row):
        for column in range(corners.shape[1]):
            i, j = min(row * TILE, ny - 1), min(column * TILE, nx - 1)
            own = sizes[i * nx + j]
            best = search_from(kind, coefficient, grid, sizes, shapes, bounds, i, j, own, stack, tested, found)
            corners[row, column, AWAY_X], corners[row, column, AWAY_Y] = 0.0, 0.0
            corners[row, column, SIZE_THERE] = own
            if best < own:
                _locate(kind, coefficient, grid, sizes, i, j, found[0], found[1], corners[row, column])


@simple
def _locate(kind, coefficient, grid, sizes, i, j, row, column, corner):
    """Write into ``corner`` the best of a cell's nodes and, for size preserving, of its planes' minimisers."""
    nx, dx, dy = int(grid[4]), grid[2], grid[3]
    left, low = (column - j) * dx, (row - i) * dy
    k = row * nx + column
    least = np.inf
    for r in range(2):
        for s in range(2):
            least = _try(kind, coefficient, left + s * dx, low + r * dy, sizes[k + r * nx + s], least, corner)
    if kind == LIMIT:
        return
    for upper in range(2):
        gx, gy = (sizes[k + 1] - sizes[k]) / dx, (sizes[k + nx + 1] - sizes[k + 1]) / dy
        if upper:
            gx, gy = (sizes[k + nx + 1] - sizes[k + nx]) / dx, (sizes[k + nx] - sizes[k]) / dy
        slope = math.sqrt(gx * gx + gy * gy)
        if slope > 0.0:
            away = coefficient * (sizes[k] - gx * left - gy * low) / (1.0 + coefficient * slope)
            px = min(max(-away * gx / slope, left), left + dx)
            py = min(max(-away * gy / slope, low), low + dy)
            size = size_on_grid(grid, sizes, grid[0] + j * dx + px, grid[1] + i * dy + py)
            least = _try(kind, coefficient, px, py, size, least, corner)


@simple
def _term(kind, coefficient, size, px, py):
    """Return max(size, distance / alpha) or size + epsilon distance."""
    distance = math.sqrt(px * px + py * py)
    if kind == PRESERVE:
        return max(size, distance / coefficient)
    return size + coefficient * distance


@simple
def _try(kind, coefficient, px, py, size, least, corner):
    value = _term(kind, coefficient, size, px, py)
    if value < least:
        corner[AWAY_X], corner[AWAY_Y], corner[SIZE_THERE] = px, py, size
    return min(value, least)


@njit(nogil=True, cache=True)
def envelope_tiles(kind, coefficient, scale, grid, sizes, shapes, bounds, corners, out, first_row, last_row):
    """Fill rows of tiles of ``out`` with ``scale`` times the envelope."""
    nx, ny = int(grid[4]), int(grid[5])
    stack, tested, found = np.empty((256, 3), dtype=np.int64), np.empty(256), np.zeros(2, dtype=np.int64)
    upper = np.empty((TILE, TILE))
    blocks, places = np.empty((BLOCK_ROWS, MOST_BLOCKS)), np.empty((MOST_BLOCKS + 1, 3), dtype=np.int64)
    kept, names = np.empty((SHARE + 1, MOST_BLOCKS * PIECES)), np.empty((MOST_BLOCKS * PIECES, 2), dtype=np.int64)
    pieces, values, attained = np.empty((SHARE + 1, PIECES)), np.empty(MOST_BLOCKS * PIECES), np.empty(PIECES)
    for row in range(first_row, last_row):
        for column in range(corners.shape[1] - 1):
            i0, j0 = row * TILE, column * TILE
            rows, columns = min(TILE, ny - i0), min(TILE, nx - j0)
            _bound_above(kind, coefficient, grid, sizes, corners, row, column, rows, columns, upper)
            value, slope_x, slope_y, most = _plane_above(grid, upper, rows, columns)
            count = list_blocks(
                kind, coefficient, grid, shapes, bounds, i0, j0, rows, columns, value, slope_x, slope_y, most, stack,
                blocks, places,
            )  # fmt: skip
            if count > 0:
                count = _gather(
                    kind, coefficient, grid, sizes, shapes, i0, j0, rows, columns, value, slope_x, slope_y, most,
                    blocks, places, count, pieces, kept, names, values,
                )  # fmt: skip
            for i in range(i0, i0 + rows):
                for j in range(j0, j0 + columns):
                    best = min(upper[i - i0, j - j0], sizes[i * nx + j])
                    if count < 0:  # too many blocks to keep: node by node
                        best = search_from(
                            kind, coefficient, grid, sizes, shapes, bounds, i, j, best, stack, tested, found
                        )
                    elif count > 0 and kind == PRESERVE:
                        best = _preserve(
                            coefficient, grid, sizes, shapes, i, j, i0, j0, best, count, blocks, places, kept, names,
                            values, attained,
                        )  # fmt: skip
                    elif count > 0:
                        raise_nodes(coefficient, kept, count, (j - j0) * grid[2], (i - i0) * grid[3], values)
                        best = improve_by_nodes(coefficient, grid, sizes, i, j, names, count, values, best)
                    out[i * nx + j] = scale * best


@simple
def _bound_above(kind, coefficient, grid, sizes, corners, row, column, rows, columns, upper):
    """Fill ``upper`` with what the corners' minimisers, and the point interpolated between them, give for each node.

    Interpolating the points is interpolating the ways to them.
    """
    nx, dx, dy = int(grid[4]), grid[2], grid[3]
    height = min(TILE, int(grid[5]) - 1 - row * TILE)
    width = min(TILE, nx - 1 - column * TILE)
    for i in range(rows):
        v = i / max(height, 1)
        for j in range(columns):
            u = j / max(width, 1)
            node_x, node_y = column * TILE + j, row * TILE + i
            best, px, py = np.inf, 0.0, 0.0
            for k in range(4):
                r, s = k >> 1, k & 1
                corner = corners[row + r, column + s]
                weight = (v if r else 1.0 - v) * (u if s else 1.0 - u)
                px += weight * corner[AWAY_X]
                py += weight * corner[AWAY_Y]
                from_x, from_y = corner[AWAY_X] + (s * width - j) * dx, corner[AWAY_Y] + (r * height - i) * dy
                best = min(best, _term(kind, coefficient, corner[SIZE_THERE], from_x, from_y))
            size = size_on_grid(grid, sizes, grid[0] + node_x * dx + px, grid[1] + node_y * dy + py)
            best = min(best, _term(kind, coefficient, size, px, py))
            upper[i, j] = min(best * (1.0 + DOUBT), sizes[node_y * nx + node_x])


@simple
def _plane_above(grid, upper, rows, columns):
    """Return an affine function that is nowhere below ``upper``, and the greatest of ``upper``.

    It is given by its value at the tile's centre and by two slopes, those between the tile's sides.
    """
    slope_x, slope_y, most = 0.0, 0.0, 0.0
    for i in range(rows):
        slope_x += upper[i, columns - 1] - upper[i, 0]
    for j in range(columns):
        slope_y += upper[rows - 1, j] - upper[0, j]
    slope_x /= rows * max(columns - 1, 1) * grid[2]
    slope_y /= columns * max(rows - 1, 1) * grid[3]
    value = -np.inf
    for i in range(rows):
        for j in range(columns):
            x, y = (j - 0.5 * (columns - 1)) * grid[2], (i - 0.5 * (rows - 1)) * grid[3]
            value = max(value, upper[i, j] - slope_x * x - slope_y * y)
            most = max(most, upper[i, j])
    return value, slope_x, slope_y, most


@simple
def _gather(
    kind, coefficient, grid, sizes, shapes, i0, j0, rows, columns, value, slope_x, slope_y, most,
    blocks, places, count, pieces, kept, names, values,
):  # fmt: skip
    """Keep the pieces of listed blocks that matter to the tile; return how many blocks, or nodes for limiting."""
    level = min(BLOCK_LEVEL, len(shapes) - 1)
    tile_x, tile_y = 0.5 * (columns - 1) * grid[2], 0.5 * (rows - 1) * grid[3]
    filled, held = 0, 0
    for k in range(count):
        first_row, first_column = places[k, 0] << level, places[k, 1] << level
        high = min(1 << level, shapes[0, 0] - first_row)
        wide = min(1 << level, shapes[0, 1] - first_column)
        if kind == LIMIT:
            n = gather_nodes(grid, sizes, first_row, first_column, high, wide, i0, j0, pieces)
            filled = keep_nodes(
                coefficient, grid, pieces, n, tile_x, tile_y, tile_x, tile_y, value, slope_x, slope_y, i0, j0,
                kept, names, filled,
            )  # fmt: skip
            continue
        n = gather_triangles(grid, sizes, first_row, first_column, high, wide, i0, j0, pieces)
        bound_triangles_for_tile(coefficient, grid, pieces, n, tile_x, tile_y, tile_x, tile_y, slope_x, slope_y, values)
        start = filled
        filled = keep_triangles(pieces, n, values, value, most, first_row, first_column, wide, kept, names, filled)
        if filled > start:
            for r in range(BLOCK_ROWS):
                blocks[r, held] = blocks[r, k]
            places[held, 2] = start
            held += 1
    if kind == LIMIT:
        return filled
    places[held, 2] = filled
    return held


@simple
def _preserve(alpha, grid, sizes, shapes, i, j, i0, j0, best, count, blocks, places, kept, names, values, attained):
    """Return the envelope at node (i, j), given an upper bound and what is kept for its tile."""
    level = min(BLOCK_LEVEL, len(shapes) - 1)
    x, y = (j - j0) * grid[2], (i - i0) * grid[3]
    least = blocks[BLOCK_ROWS - 1]
    bound_blocks(alpha, blocks, count, x, y, 0.5 * grid[2] * (1 << level), 0.5 * grid[3] * (1 << level), least)
    first = 0
    for k in range(1, count):
        if least[k] < least[first]:
            first = k
    for turn in range(count):
        # the most promising block first: most others are then out of the question
        k = first if turn == 0 else (0 if turn == first else turn)
        if least[k] < best * (1.0 - ROUNDING):
            start, stop = places[k, 2], places[k + 1, 2]
            bound_triangles(alpha, grid, kept, start, stop, x, y, values, attained)
            best = improve_by_triangles(alpha, grid, sizes, i, j, kept, names, start, stop, values, attained, best)
    return best
