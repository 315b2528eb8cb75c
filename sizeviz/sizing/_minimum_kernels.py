"""The exact minimum of a piecewise-linear field over a quadrilateral.

It is attained at a corner, at a background node inside, or where an element edge crosses a background edge.
"""

import math

import numpy as np
from numba import njit

from sizeviz.sizing._kernels import size_at
from sizeviz.sizing._tree_kernels import FANOUT, uncounted

SMALL_BLOCK = 2
"""Level of the blocks (4 x 4 cells) whose nodes are looked at one by one."""


@uncounted
def element_min(searcher, xy):
    """Return the least size over a quadrilateral.

    Parameters
    ----------
    searcher : tuple
        ``SizeField.searcher``.
    xy : (4, 2) float64
        Corners in order; the quadrilateral may be concave. Corners outside the background count with the nearest
        point of it, the rest of the element only as far as it lies inside.
    """
    return quad_min(
        searcher, xy[0, 0], xy[0, 1], xy[1, 0], xy[1, 1], xy[2, 0], xy[2, 1], xy[3, 0], xy[3, 1]
    )  # fmt: skip


@uncounted
def quad_min(searcher, x0, y0, x1, y1, x2, y2, x3, y3):
    """Return the least size over the quadrilateral with these corners; as ``element_min``, without an array."""
    quad = (x0, y0, x1, y1, x2, y2, x3, y3)
    grid, sizes = searcher[0], searcher[1]
    sampler = (grid, sizes, searcher[2], searcher[3], searcher[4])
    best, hint = np.inf, 0
    if grid[4] == 0.0:
        best, hint = _least_on_triangles(searcher[2], searcher[3], searcher[5], searcher[6], quad)
    for k in range(4):
        size, hint = size_at(sampler, quad[2 * k], quad[2 * k + 1], hint)
        best = min(best, size)
    if grid[4] > 0.0:
        best = _least_on_grid(sampler, searcher[5], searcher[6], quad, best)
    return best


@uncounted
def elements_min(searcher, points, quads, out, start, stop):
    """Fill ``out[start:stop]`` with the least size over each quadrilateral."""
    for q in range(start, stop):
        a, b, c, d = quads[q, 0], quads[q, 1], quads[q, 2], quads[q, 3]
        out[q] = quad_min(
            searcher,
            points[a, 0], points[a, 1], points[b, 0], points[b, 1],
            points[c, 0], points[c, 1], points[d, 0], points[d, 1],
        )  # fmt: skip


@uncounted
def _box_of(quad):
    return (
        min(min(quad[0], quad[2]), min(quad[4], quad[6])),
        min(min(quad[1], quad[3]), min(quad[5], quad[7])),
        max(max(quad[0], quad[2]), max(quad[4], quad[6])),
        max(max(quad[1], quad[3]), max(quad[5], quad[7])),
    )


@uncounted
def _holds(quad, x, y):
    """Return whether a quadrilateral holds a point, by counting crossings."""
    inside = False
    for k in range(4):
        ax, ay = quad[2 * k], quad[2 * k + 1]
        bx, by = quad[(2 * k + 2) % 8], quad[(2 * k + 3) % 8]
        if (ay > y) != (by > y):
            side = (x - ax) * (by - ay) - (bx - ax) * (y - ay)
            if (side < 0.0) == (by > ay):
                inside = not inside
    return inside


@uncounted
def _least_on_grid(sampler, shapes, lowest, quad, best):
    """Return the least of ``best``, of the nodes inside, and of where edges cross the lines of the grid."""
    grid = sampler[0]
    x0, y0, x1, y1 = _box_of(quad)
    cells_x, cells_y = int(grid[4]) - 1, int(grid[5]) - 1
    left = min(max(math.floor((x0 - grid[0]) / grid[2]), 0), cells_x - 1)
    right = min(max(math.floor((x1 - grid[0]) / grid[2]), 0), cells_x - 1)
    lower = min(max(math.floor((y0 - grid[1]) / grid[3]), 0), cells_y - 1)
    upper = min(max(math.floor((y1 - grid[1]) / grid[3]), 0), cells_y - 1)
    if left == right and lower == upper and lowest[lower * cells_x + left] >= best:
        return best
    best = _least_of_nodes(grid, sampler[1], shapes, lowest, quad, left, lower, right, upper, best)
    for k in range(4):
        best = _least_along(sampler, quad[2 * k], quad[2 * k + 1], quad[(2 * k + 2) % 8], quad[(2 * k + 3) % 8], best)
    return best


@uncounted
def _least_of_nodes(grid, sizes, shapes, lowest, quad, left, lower, right, upper, best):
    """Return the least of ``best`` and the nodes inside a quadrilateral that lies in a range of cells."""
    extent = max(right - left, upper - lower)
    level = min(SMALL_BLOCK, len(shapes) - 1)
    while level < len(shapes) - 1 and (extent >> level) > 3:
        level += 1
    for row in range(lower >> level, (upper >> level) + 1):
        for column in range(left >> level, (right >> level) + 1):
            if lowest[shapes[level, 2] + row * shapes[level, 1] + column] >= best:
                continue
            if level <= SMALL_BLOCK:
                best = _least_in_block(grid, sizes, quad, level, row, column, left, lower, right, upper, best)
            else:
                best = _descend(grid, sizes, shapes, lowest, quad, level, row, column, left, lower, right, upper, best)
    return best


@njit(nogil=True, cache=True, _nrt=True)
def _descend(grid, sizes, shapes, lowest, quad, level, row, column, left, lower, right, upper, best):
    """Look into one large block through its quarters."""
    stack = np.empty((4 * len(shapes), 3), dtype=np.int64)
    stack[0, 0], stack[0, 1], stack[0, 2] = level, row, column
    top = 1
    while top > 0:
        top -= 1
        level, row, column = stack[top, 0], stack[top, 1], stack[top, 2]
        if lowest[shapes[level, 2] + row * shapes[level, 1] + column] >= best:
            continue
        if level <= SMALL_BLOCK:
            best = _least_in_block(grid, sizes, quad, level, row, column, left, lower, right, upper, best)
            continue
        level -= 1
        for r in range(max(2 * row, lower >> level), min(2 * row + 1, upper >> level) + 1):
            for s in range(max(2 * column, left >> level), min(2 * column + 1, right >> level) + 1):
                stack[top, 0], stack[top, 1], stack[top, 2] = level, r, s
                top += 1
    return best


@uncounted
def _least_in_block(grid, sizes, quad, level, row, column, left, lower, right, upper, best):
    """Return the least of ``best`` and a small block's nodes inside the quadrilateral."""
    nx = int(grid[4])
    for i in range(max(row << level, lower), min((row + 1) << level, upper + 1) + 1):
        for j in range(max(column << level, left), min((column + 1) << level, right + 1) + 1):
            size = sizes[i * nx + j]
            if size < best and _holds(quad, grid[0] + j * grid[2], grid[1] + i * grid[3]):
                best = size
    return best


@uncounted
def _least_along(sampler, ax, ay, bx, by, best):
    """Return the least of ``best`` and the sizes where a segment crosses grid lines and diagonals."""
    grid = sampler[0]
    u0, v0 = (ax - grid[0]) / grid[2], (ay - grid[1]) / grid[3]
    u1, v1 = (bx - grid[0]) / grid[2], (by - grid[1]) / grid[3]
    nx, ny = int(grid[4]), int(grid[5])
    best = _least_at_crossings(sampler, ax, ay, bx, by, u0, u1, 0, nx - 1, best)
    best = _least_at_crossings(sampler, ax, ay, bx, by, v0, v1, 0, ny - 1, best)
    return _least_at_crossings(sampler, ax, ay, bx, by, u0 - v0, u1 - v1, 1 - ny, nx - 1, best)


@uncounted
def _least_at_crossings(sampler, ax, ay, bx, by, start, stop, first, last, best):
    """Return the least of ``best`` and the sizes where a coordinate that runs from start to stop is an integer."""
    low, high = min(start, stop), max(start, stop)
    for k in range(max(math.ceil(low), first), min(math.floor(high), last) + 1):
        if stop != start:
            s = (k - start) / (stop - start)
            size, _ = size_at(sampler, ax + s * (bx - ax), ay + s * (by - ay), 0)
            best = min(best, size)
    return best


@uncounted
def _least_on_triangles(cells, boxes, shapes, lowest, quad):
    """Return the least size over a quadrilateral's part inside the background, and a triangle that it meets.

    The tree is walked depth first without a stack: node k of a level has the nodes 4 k to 4 k + 3 of the level below.
    """
    x0, y0, x1, y1 = _box_of(quad)
    level, k, best, met = len(shapes) - 1, 0, np.inf, 0
    while True:
        node = shapes[level, 2] + k
        if (
            lowest[node] < best
            and boxes[node, 0] <= x1 and boxes[node, 2] >= x0
            and boxes[node, 1] <= y1 and boxes[node, 3] >= y0
        ):  # fmt: skip
            if level > 0:
                level, k = level - 1, FANOUT * k
                continue
            for t in range(FANOUT * k, min(FANOUT * k + FANOUT, len(cells))):
                lower = _least_on_one(cells, t, quad, x0, y0, x1, y1, best)
                if lower < best:
                    best, met = lower, t
        while k % FANOUT == FANOUT - 1 or k + 1 == shapes[level, 0]:
            if level == len(shapes) - 1:
                return best, met
            level, k = level + 1, k // FANOUT
        k += 1


@uncounted
def _least_on_one(cells, t, quad, x0, y0, x1, y1, best):
    """Return the least of ``best`` and the sizes of triangle ``t`` over its part in the quadrilateral."""
    if min(cells[t, 6], cells[t, 7], cells[t, 8]) >= best:
        return best
    ax, ay, bx, by, cx, cy = cells[t, 0], cells[t, 1], cells[t, 2], cells[t, 3], cells[t, 4], cells[t, 5]
    if min(ax, bx, cx) > x1 or max(ax, bx, cx) < x0 or min(ay, by, cy) > y1 or max(ay, by, cy) < y0:
        return best
    for k in range(3):
        if cells[t, 6 + k] < best and _holds(quad, cells[t, 2 * k], cells[t, 2 * k + 1]):
            best = cells[t, 6 + k]
    for k in range(4):
        best = _least_on_segment(
            cells, t, quad[2 * k], quad[2 * k + 1], quad[(2 * k + 2) % 8], quad[(2 * k + 3) % 8], best
        )
    return best


@uncounted
def _least_on_segment(cells, t, px, py, qx, qy, best):
    """Return the least of ``best`` and the sizes of triangle ``t`` along a segment, clipped by its three edges."""
    enter, leave = 0.0, 1.0
    size_p, size_q, area = 0.0, 0.0, 0.0
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        ex, ey = cells[t, 2 * j] - cells[t, 2 * i], cells[t, 2 * j + 1] - cells[t, 2 * i + 1]
        at_p = ex * (py - cells[t, 2 * i + 1]) - ey * (px - cells[t, 2 * i])
        at_q = ex * (qy - cells[t, 2 * i + 1]) - ey * (qx - cells[t, 2 * i])
        size_p += at_p * cells[t, 6 + k]
        size_q += at_q * cells[t, 6 + k]
        area += at_p
        if at_p < 0.0 and at_q < 0.0:
            return best
        if at_p < 0.0:
            enter = max(enter, at_p / (at_p - at_q))
        elif at_q < 0.0:
            leave = min(leave, at_p / (at_p - at_q))
    if enter > leave:
        return best
    size_p, size_q = size_p / area, size_q / area
    return min(best, size_p + enter * (size_q - size_p), size_p + leave * (size_q - size_p))
