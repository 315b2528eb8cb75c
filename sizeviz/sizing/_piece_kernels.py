"""Both envelopes for a tile of grid nodes, from the triangles or nodes of a few blocks, bounded side by side.

Places are relative to the tile's first node. The loops over pieces hold no branches, so that they are vectorised.
"""

import math

import numpy as np
from numba import njit

from sizeviz.sizing._envelope_kernels import LIMIT, PRESERVE, ROUNDING, on_edge, on_triangle

simple = njit(nogil=True, cache=True, _nrt=False, error_model="numpy")
"""As ``uncounted``; a division by zero gives infinity, without which no loop that divides would be vectorised."""

BLOCK_LEVEL = 2
"""Level in the pyramid of the blocks that are listed: 4 x 4 cells."""

CELLS = 1 << BLOCK_LEVEL
"""Cells along a block."""

PIECES = 2 * CELLS * CELLS
"""Triangles of a block; it has fewer nodes."""

X, Y, SIZE, LEAST_SIZE, UPHILL_X, UPHILL_Y, SLOPE, SIDE, SHARE = range(9)
"""Rows of what is kept of pieces: centroids with their sizes, or nodes with theirs, which fill the first three."""


@simple
def gather_triangles(grid, sizes, first_row, first_column, rows, columns, i0, j0, pieces):
    """Write the triangles of a block of cells, the lower of each cell (side 1) and the upper (-1); return how many."""
    nx, dx, dy = int(grid[4]), grid[2], grid[3]
    per_x, per_y = 1.0 / dx, 1.0 / dy
    count = 0
    for r in range(first_row, first_row + rows):
        for s in range(first_column, first_column + columns):
            k = r * nx + s
            h00, h01, h10, h11 = sizes[k], sizes[k + 1], sizes[k + nx], sizes[k + nx + 1]
            x, y = (s - j0) * dx, (r - i0) * dy
            pieces[X, count], pieces[Y, count] = x + 2.0 / 3.0 * dx, y + dy / 3.0
            pieces[UPHILL_X, count], pieces[UPHILL_Y, count] = (h01 - h00) * per_x, (h11 - h01) * per_y
            pieces[SIZE, count], pieces[LEAST_SIZE, count] = (h00 + h01 + h11) / 3.0, min(min(h00, h01), h11)
            pieces[SIDE, count] = 1.0
            count += 1
            pieces[X, count], pieces[Y, count] = x + dx / 3.0, y + 2.0 / 3.0 * dy
            pieces[UPHILL_X, count], pieces[UPHILL_Y, count] = (h11 - h10) * per_x, (h10 - h00) * per_y
            pieces[SIZE, count], pieces[LEAST_SIZE, count] = (h00 + h10 + h11) / 3.0, min(min(h00, h10), h11)
            pieces[SIDE, count] = -1.0
            count += 1
    return count


@simple
def bound_triangles_for_tile(alpha, grid, pieces, count, x, y, tile_x, tile_y, slope_x, slope_y, gaps):
    """Fill ``gaps`` with a lower bound of the envelope less the tile's affine upper bound, least over its nodes.

    Two combinations of size and distance are bounded, each linear in the place y in the triangle and, with the distance
    replaced by its projection on one direction, in the node x: that which does not change along the steepest
    descent, and the distance alone. The least is then at a corner of the triangle, whose centroid is known.
    Gradients are split into slope and direction on the way.

    Parameters
    ----------
    x, y, tile_x, tile_y : float
        The tile's centre and half extents.
    slope_x, slope_y : float
        Those of the affine bound; its value at the centre is left to the caller.
    """
    third_x, third_y = grid[2] / 3.0, grid[3] / 3.0
    at_x, at_y, size, side = pieces[X], pieces[Y], pieces[SIZE], pieces[SIDE]
    uphill_x, uphill_y, slope, share = pieces[UPHILL_X], pieces[UPHILL_Y], pieces[SLOPE], pieces[SHARE]
    for k in range(count):
        gx, gy = uphill_x[k], uphill_y[k]
        steep = math.sqrt(gx * gx + gy * gy)
        px, py = at_x[k] - x, at_y[k] - y
        distance = math.sqrt(px * px + py * py)
        per = 1.0 / max(distance, 1e-300)
        px, py = px * per, py * per
        factor = 1.0 + alpha * steep
        qx, qy = side[k] * third_x * (gx + steep * px), side[k] * third_y * (gy + steep * py)
        slack = max(max(2.0 * qx + qy, qy - qx), -qx - 2.0 * qy)
        slack += tile_x * abs(factor * slope_x + steep * px) + tile_y * abs(factor * slope_y + steep * py)
        share[k] = 1.0 / factor
        both = (size[k] + steep * distance - slack) * share[k]
        qx, qy = side[k] * third_x * px, side[k] * third_y * py
        slack = max(max(2.0 * qx + qy, qy - qx), -qx - 2.0 * qy)
        slack += tile_x * abs(alpha * slope_x + px) + tile_y * abs(alpha * slope_y + py)
        gaps[k] = max(both, (distance - slack) / alpha)
        per = 1.0 / max(steep, 1e-300)
        slope[k], uphill_x[k], uphill_y[k] = steep, gx * per, gy * per


@simple
def keep_triangles(pieces, count, gaps, value, most, first_row, first_column, columns, kept, names, filled):
    """Append those triangles that may lower the tile's envelope; return how many are kept then."""
    for k in range(count):
        if gaps[k] >= value * (1.0 - ROUNDING) or pieces[LEAST_SIZE, k] >= most:
            continue
        for row in range(SHARE + 1):
            kept[row, filled] = pieces[row, k]
        cell = k >> 1
        names[filled, 0], names[filled, 1] = first_row + cell // columns, first_column + cell % columns
        filled += 1
    return filled


@simple
def narrow_triangles(
    alpha, grid, kept, names, count, x, y, tile_x, tile_y, value, slope_x, slope_y, most, gaps, near, near_names
):
    """Copy those kept triangles that may lower a part of the tile; return how many, filled up to a multiple of four.

    As ``bound_triangles_for_tile``; the envelope of the whole plane, linear in the node, is a third lower bound.
    """
    third_x, third_y, each = grid[2] / 3.0, grid[3] / 3.0, 1.0 / alpha
    at_x, at_y, size, side = kept[X], kept[Y], kept[SIZE], kept[SIDE]
    uphill_x, uphill_y, slope, share = kept[UPHILL_X], kept[UPHILL_Y], kept[SLOPE], kept[SHARE]
    for k in range(count):
        px, py = at_x[k] - x, at_y[k] - y
        distance = math.sqrt(px * px + py * py)
        weight = slope[k] * share[k]
        own = size[k] * share[k]
        gap = own - weight * (uphill_x[k] * px + uphill_y[k] * py)
        gap -= tile_x * abs(slope_x - weight * uphill_x[k]) + tile_y * abs(slope_y - weight * uphill_y[k])
        per = 1.0 / max(distance, 1e-300)
        px, py = px * per, py * per
        qx, qy = side[k] * third_x * px, side[k] * third_y * py
        slack = max(max(2.0 * qx + qy, qy - qx), -qx - 2.0 * qy)
        away = (distance - slack) * each
        gap = max(gap, away - tile_x * abs(slope_x + each * px) - tile_y * abs(slope_y + each * py))
        qx, qy = qx + side[k] * third_x * uphill_x[k], qy + side[k] * third_y * uphill_y[k]
        slack = max(max(2.0 * qx + qy, qy - qx), -qx - 2.0 * qy)
        both = own + weight * (distance - slack)
        gaps[k] = max(gap, both - tile_x * abs(slope_x + weight * px) - tile_y * abs(slope_y + weight * py))
    filled = 0
    for k in range(count):
        if gaps[k] < value * (1.0 - ROUNDING) and kept[LEAST_SIZE, k] < most:
            for row in range(SHARE + 1):
                near[row, filled] = kept[row, k]
            near_names[filled, 0], near_names[filled, 1] = names[k, 0], names[k, 1]
            filled += 1
    return _filled_up(near, filled)


@simple
def _filled_up(kept, filled):
    """Fill up to a multiple of four with triangles that improve nothing."""
    while filled % 4:
        for row in range(SHARE + 1):
            kept[row, filled] = 0.0
        kept[LEAST_SIZE, filled] = np.inf
        filled += 1
    return filled


@simple
def bound_triangles(alpha, grid, kept, count, x, y, values, attained):
    """Fill ``values`` with lower bounds of each kept triangle's envelope at (x, y), and ``attained`` where it is known.

    The greatest of four bounds: the least size; the distance; the envelope of the whole plane, which is attained if its
    minimiser, where size and distance / alpha are equal down the steepest descent, lies in the triangle; and, as in
    ``block_may_improve``, the plane with the distance replaced by its projection, least at a corner of the triangle.
    ``attained`` is infinite elsewhere.
    """
    third_x, third_y, each = grid[2] / 3.0, grid[3] / 3.0, 1.0 / alpha
    at_x, at_y, size, least = kept[X], kept[Y], kept[SIZE], kept[LEAST_SIZE]
    uphill_x, uphill_y, slope, side, share = kept[UPHILL_X], kept[UPHILL_Y], kept[SLOPE], kept[SIDE], kept[SHARE]
    for k in range(count):
        px, py = at_x[k] - x, at_y[k] - y
        distance = math.sqrt(px * px + py * py)
        per = 1.0 / max(distance, 1e-300)
        qx, qy = side[k] * third_x * per * px, side[k] * third_y * per * py
        slack = max(max(2.0 * qx + qy, qy - qx), -qx - 2.0 * qy)
        bound = max((distance - slack) * each, least[k])
        qx, qy = qx + side[k] * third_x * uphill_x[k], qy + side[k] * third_y * uphill_y[k]
        slack = max(max(2.0 * qx + qy, qy - qx), -qx - 2.0 * qy)
        bound = max(bound, (size[k] + slope[k] * (distance - slack)) * share[k])
        plane = (size[k] - slope[k] * (uphill_x[k] * px + uphill_y[k] * py)) * share[k]
        values[k] = max(bound, plane)
        px, py = side[k] * (-px - alpha * plane * uphill_x[k]), side[k] * (-py - alpha * plane * uphill_y[k])
        outside = max(max(px - third_x, -py - third_y), (py * third_x - px * third_y) - third_x * third_y)
        attained[k] = plane if (outside <= 0.0) & (plane > 0.0) else np.inf


@simple
def improve_by_triangles(alpha, grid, sizes, i, j, kept, names, count, values, attained, best, last):
    """Return the least of ``best`` and of the kept triangles' envelopes at node (i, j), and the triangle it is from.

    ``values`` bounds the envelopes below. The triangle ``last``, that of the node before, is tried first: it nearly
    attains the least, and most others are then out of the question.
    """
    a, b, c, d = best, best, best, best
    for k in range(0, count, 4):
        a, b = min(a, attained[k]), min(b, attained[k + 1])
        c, d = min(c, attained[k + 2]), min(d, attained[k + 3])
    best = min(min(a, b), min(c, d))
    if values[last] < best * (1.0 - ROUNDING):
        best = _on_triangle(alpha, grid, sizes, i, j, names[last], kept[SIDE, last], best)
    found = last
    for k in range(count):
        if values[k] < best * (1.0 - ROUNDING) and k != last:
            lower = _on_triangle(alpha, grid, sizes, i, j, names[k], kept[SIDE, k], best)
            if lower < best:
                best, found = lower, k
    return best, found


@simple
def _on_triangle(alpha, grid, sizes, i, j, cell, side, best):
    nx, dx, dy = int(grid[4]), grid[2], grid[3]
    k = cell[0] * nx + cell[1]
    x0, y0, x1, y1 = (cell[1] - j) * dx, (cell[0] - i) * dy, (cell[1] + 1 - j) * dx, (cell[0] + 1 - i) * dy
    h00, h11 = sizes[k], sizes[k + nx + 1]
    if side > 0.0:
        return on_triangle(PRESERVE, alpha, x0, y0, h00, x1, y0, sizes[k + 1], x1, y1, h11, best)
    return on_triangle(PRESERVE, alpha, x0, y0, h00, x1, y1, h11, x0, y1, sizes[k + nx], best)


@simple
def gather_nodes(grid, sizes, first_row, first_column, rows, columns, i0, j0, pieces):
    """Write the nodes of a block of cells; return how many."""
    nx, count = int(grid[4]), 0
    for r in range(first_row, first_row + rows + 1):
        for s in range(first_column, first_column + columns + 1):
            pieces[X, count], pieces[Y, count] = (s - j0) * grid[2], (r - i0) * grid[3]
            pieces[SIZE, count] = sizes[r * nx + s]
            count += 1
    return count


@simple
def sag(epsilon, length, distance):
    """Return how far size + epsilon distance may lie below its chord on an edge of a length at a distance or beyond.

    Half the edge times epsilon at most; the second derivative of a distance is at most 1 over it.
    """
    return epsilon * length * min(0.5, length / (8.0 * max(distance, 1e-300)))


@simple
def keep_nodes(
    epsilon, grid, pieces, count, x, y, tile_x, tile_y, value, slope_x, slope_y, i0, j0, kept, names, filled
):
    """Append those nodes that, or whose edges, may lower the tile's envelope; return how many are kept then."""
    length = math.sqrt(grid[2] * grid[2] + grid[3] * grid[3])
    reach = length + math.sqrt(tile_x * tile_x + tile_y * tile_y)
    for k in range(count):
        px, py = pieces[X, k] - x, pieces[Y, k] - y
        distance = math.sqrt(px * px + py * py)
        pull = epsilon / max(distance, 1e-300)
        slack = tile_x * abs(slope_x + pull * px) + tile_y * abs(slope_y + pull * py)
        slack += sag(epsilon, length, distance - reach)
        if pieces[SIZE, k] + epsilon * distance - slack >= value * (1.0 - ROUNDING):
            continue
        kept[X, filled], kept[Y, filled], kept[SIZE, filled] = pieces[X, k], pieces[Y, k], pieces[SIZE, k]
        names[filled, 0] = i0 + round(pieces[Y, k] / grid[3])
        names[filled, 1] = j0 + round(pieces[X, k] / grid[2])
        filled += 1
    return filled


@simple
def raise_nodes(epsilon, kept, count, x, y, values):
    """Fill ``values`` with size + epsilon distance from (x, y) for each kept node."""
    at_x, at_y, size = kept[X], kept[Y], kept[SIZE]
    for k in range(count):
        px, py = at_x[k] - x, at_y[k] - y
        values[k] = size[k] + epsilon * math.sqrt(px * px + py * py)


@simple
def improve_by_nodes(epsilon, grid, sizes, i, j, names, count, values, best):
    """Return the least of ``best``, of the kept nodes' ``values``, and of edges at them that may be lower still.

    On a triangle that does not hold node (i, j) inside, size + epsilon distance is least on an edge.
    There it is convex.
    """
    for k in range(count):
        best = min(best, values[k])
    length = math.sqrt(grid[2] * grid[2] + grid[3] * grid[3])
    for k in range(count):
        if values[k] - 0.5 * epsilon * length >= best:
            continue
        px, py = (names[k, 1] - j) * grid[2], (names[k, 0] - i) * grid[3]
        if values[k] - sag(epsilon, length, math.sqrt(px * px + py * py) - length) < best:
            best = _improve_by_edges(epsilon, grid, sizes, i, j, names[k, 0], names[k, 1], best)
    return best


@simple
def _improve_by_edges(epsilon, grid, sizes, i, j, row, column, best):
    """Lower ``best`` by the edges at a node whose slope does not settle it in favour of an end."""
    nx, ny, dx, dy = int(grid[4]), int(grid[5]), grid[2], grid[3]
    k = row * nx + column
    ax, ay = (column - j) * dx, (row - i) * dy
    for edge in range(6):
        # right, across, up, and back
        back = 1 if edge < 3 else -1
        step_row, step_column = back * min(edge % 3, 1), back * min(2 - edge % 3, 1)
        if not (0 <= row + step_row < ny and 0 <= column + step_column < nx):
            continue
        other = sizes[k + step_row * nx + step_column]
        ex, ey = step_column * dx, step_row * dy
        rise = other - sizes[k]
        if rise * rise < epsilon * epsilon * (ex * ex + ey * ey):
            best = on_edge(LIMIT, epsilon, ax, ay, sizes[k], ax + ex, ay + ey, other, best)
    return best
