"""Both envelopes on a regular grid, for tiles of 8 x 8 nodes at a time.

The envelope is searched for at the tiles' corners. Between them the corners' minimisers, interpolated, give an upper
bound whose gap is of second order in the size of the tile, and so is the gap of the lower bounds of blocks: one descent
for the whole tile leaves a few blocks, and in them a few triangles or nodes, which are all that its nodes look at.
"""

import math

import numpy as np
from numba import njit

from sizeviz.sizing._block_kernels import MOST_BLOCKS, list_blocks
from sizeviz.sizing._envelope_kernels import LIMIT, PRESERVE
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
    narrow_triangles,
    raise_nodes,
    simple,
)

TILE, PART = 8, 4
"""Nodes along a tile, and along the parts of it for which its triangles are sifted again."""

AWAY_X, AWAY_Y, SIZE_THERE = range(3)
"""What is kept of a corner: the way to a point that nearly attains its envelope, and the size at that point."""

DOUBT = 1e-9
"""Share by which an upper bound is raised, so that the value itself comes from a triangle or an edge."""


@njit(nogil=True, cache=True)
def envelope_corners(kind, coefficient, grid, sizes, shapes, bounds, wanted, corners, first_row, last_row):
    """Fill rows of ``corners`` (rows, columns, 3) with where the envelope of every eighth node is attained.

    Corners of tiles none of which is ``wanted`` (rows - 1, columns - 1) are left alone.
    """
    nx, ny = int(grid[4]), int(grid[5])
    stack, tested, found = np.empty((256, 3), dtype=np.int64), np.empty(256), np.zeros(2, dtype=np.int64)
    for row in range(first_row, last_row):
        for column in range(corners.shape[1]):
            if not _touches(wanted, row, column):
                continue
            i, j = min(row * TILE, ny - 1), min(column * TILE, nx - 1)
            own = sizes[i * nx + j]
            best = search_from(kind, coefficient, grid, sizes, shapes, bounds, i, j, own, stack, tested, found)
            corners[row, column, AWAY_X], corners[row, column, AWAY_Y] = 0.0, 0.0
            corners[row, column, SIZE_THERE] = own
            if best < own:
                _locate(kind, coefficient, grid, sizes, i, j, found[0], found[1], corners[row, column])


@simple
def _touches(wanted, row, column):
    """Return whether one of the four tiles round a corner is wanted."""
    for r in range(max(row - 1, 0), min(row + 1, wanted.shape[0])):
        for c in range(max(column - 1, 0), min(column + 1, wanted.shape[1])):
            if wanted[r, c]:
                return True
    return False


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
def envelope_tiles(kind, coefficient, scale, grid, sizes, shapes, bounds, wanted, corners, out, first_row, last_row):
    """Fill rows of tiles of ``out``, those that are ``wanted``, with ``scale`` times the envelope."""
    nx, ny = int(grid[4]), int(grid[5])
    stack, tested, found = np.empty((256, 3), dtype=np.int64), np.empty(256), np.zeros(2, dtype=np.int64)
    upper = np.empty((TILE, TILE))
    places = np.empty((MOST_BLOCKS, 2), dtype=np.int64)
    kept, names = np.empty((SHARE + 1, MOST_BLOCKS * PIECES)), np.empty((MOST_BLOCKS * PIECES, 2), dtype=np.int64)
    near, near_names = np.empty_like(kept), np.empty_like(names)
    pieces, values, attained = np.empty((SHARE + 1, PIECES)), np.empty(len(names)), np.empty(len(names))
    for row in range(first_row, last_row):
        for column in range(corners.shape[1] - 1):
            if not wanted[row, column]:
                continue
            i0, j0 = row * TILE, column * TILE
            rows, columns = min(TILE, ny - i0), min(TILE, nx - j0)
            _bound_above(kind, coefficient, grid, sizes, corners, row, column, rows, columns, upper)
            value, slope_x, slope_y, most = _plane_above(grid, upper, rows, columns)
            count = list_blocks(
                kind, coefficient, grid, shapes, bounds, i0, j0, rows, columns, value, slope_x, slope_y, most, stack,
                places,
            )  # fmt: skip
            if count > 0:
                count = _gather(
                    kind, coefficient, grid, sizes, shapes, i0, j0, rows, columns, value, slope_x, slope_y, most,
                    places, count, pieces, kept, names, values,
                )  # fmt: skip
            if kind == PRESERVE and count > 0:
                _preserve(
                    coefficient, scale, grid, sizes, i0, j0, rows, columns, upper, kept, names, count, values, near,
                    near_names, attained, out,
                )  # fmt: skip
                continue
            for i in range(i0, i0 + rows):
                for j in range(j0, j0 + columns):
                    best = min(upper[i - i0, j - j0], sizes[i * nx + j])
                    if count < 0:  # too many blocks to keep: node by node
                        best = search_from(
                            kind, coefficient, grid, sizes, shapes, bounds, i, j, best, stack, tested, found
                        )
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
    places, count, pieces, kept, names, values,
):  # fmt: skip
    """Keep the triangles, or for limiting the nodes, of listed blocks that matter to the tile; return how many."""
    level = min(BLOCK_LEVEL, len(shapes) - 1)
    tile_x, tile_y = 0.5 * (columns - 1) * grid[2], 0.5 * (rows - 1) * grid[3]
    filled = 0
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
        filled = keep_triangles(pieces, n, values, value, most, first_row, first_column, wide, kept, names, filled)
    return filled


@simple
def _preserve(
    alpha, scale, grid, sizes, i0, j0, rows, columns, upper, kept, names, count, values, near, near_names, attained, out
):
    """Fill a tile of ``out``, part by part, from the triangles kept for it."""
    nx = int(grid[4])
    for r in range(0, rows, PART):
        for s in range(0, columns, PART):
            high, wide = min(PART, rows - r), min(PART, columns - s)
            value, slope_x, slope_y, most = _plane_above(grid, upper[r : r + high, s : s + wide], high, wide)
            half_x, half_y = 0.5 * (wide - 1) * grid[2], 0.5 * (high - 1) * grid[3]
            n = narrow_triangles(
                alpha, grid, kept, names, count, s * grid[2] + half_x, r * grid[3] + half_y, half_x, half_y, value,
                slope_x, slope_y, most, values, near, near_names,
            )  # fmt: skip
            last = 0
            for i in range(r, r + high):
                for j in range(s, s + wide):
                    best = min(upper[i, j], sizes[(i0 + i) * nx + j0 + j])
                    if n > 0:
                        bound_triangles(alpha, grid, near, n, j * grid[2], i * grid[3], values, attained)
                        best, last = improve_by_triangles(
                            alpha, grid, sizes, i0 + i, j0 + j, near, near_names, n, values, attained, best, last
                        )
                    out[(i0 + i) * nx + j0 + j] = scale * best
