"""The size at a point, for every kernel that asks: arithmetic on a grid, a walk with a hint on a triangulation."""

import numpy as np
from numba import njit

from sizeviz.sizing._tree_kernels import FANOUT, box_distance2, uncounted

LONGEST_WALK = 32
"""Triangles crossed before the walk gives up and the tree is asked."""

ROUNDING = 1e-12
"""How far outside a triangle, in barycentric terms, a point still counts as inside."""


@uncounted
def size_at(sampler, x, y, hint):
    """Return the piecewise-linear size at a point, and a hint for the next point nearby.

    Parameters
    ----------
    sampler : tuple
        ``SizeField.sampler``.
    x, y : float
        The point, in model units; outside the background the nearest point of it counts.
    hint : int
        What the last call returned; 0 to begin with.
    """
    grid = sampler[0]
    if grid[4] > 0.0:
        return size_on_grid(grid, sampler[1], x, y), hint
    cells = sampler[2]
    current = hint if 0 <= hint < len(cells) else 0
    wa, wb, wc = _weights(cells, current, x, y)
    # most queries stay in the triangle of the last one: this much is worth inlining into the caller
    if wa >= 0.0 and wb >= 0.0 and wc >= 0.0:
        return (wa * cells[current, 6] + wb * cells[current, 7] + wc * cells[current, 8]) / (wa + wb + wc), current
    return _size_by_walking(cells, sampler[3], sampler[4], x, y, current)


@uncounted
def sizes_at(sampler, points, out, start, stop):
    """Fill rows ``start`` to ``stop`` of ``out`` with the sizes at ``points``."""
    hint = 0
    for i in range(start, stop):
        out[i], hint = size_at(sampler, points[i, 0], points[i, 1], hint)


@uncounted
def size_on_grid(grid, sizes, x, y):
    nx, ny = int(grid[4]), int(grid[5])
    u = min(max((x - grid[0]) / grid[2], 0.0), nx - 1.0)
    v = min(max((y - grid[1]) / grid[3], 0.0), ny - 1.0)
    column, row = min(int(u), nx - 2), min(int(v), ny - 2)
    u -= column
    v -= row
    corner = row * nx + column
    here, across = sizes[corner], sizes[corner + nx + 1]
    if v <= u:
        right = sizes[corner + 1]
        return (1.0 - u) * here + (u - v) * right + v * across
    above = sizes[corner + nx]
    return (1.0 - v) * here + (v - u) * above + u * across


@uncounted
def _weights(cells, t, x, y):
    """Return a point's unscaled barycentric weights in triangle ``t``: negative outside the opposite edge."""
    ax, ay = cells[t, 0] - x, cells[t, 1] - y
    bx, by = cells[t, 2] - x, cells[t, 3] - y
    cx, cy = cells[t, 4] - x, cells[t, 5] - y
    return bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx


@uncounted
def _blend(cells, t, wa, wb, wc):
    """Interpolate with weights cut off at zero, so that rounding never leaves the range of the three sizes."""
    wa, wb, wc = max(wa, 0.0), max(wb, 0.0), max(wc, 0.0)
    return (wa * cells[t, 6] + wb * cells[t, 7] + wc * cells[t, 8]) / (wa + wb + wc)


@uncounted
def _size_by_walking(cells, boxes, children, x, y, current):
    """Walk towards the point from triangle to triangle; ask the tree where the walk meets an edge or takes long."""
    for _ in range(LONGEST_WALK):
        wa, wb, wc = _weights(cells, current, x, y)
        slack = -ROUNDING * (wa + wb + wc)
        if wa >= slack and wb >= slack and wc >= slack:
            return _blend(cells, current, wa, wb, wc), current
        onward = cells[current, 9]
        if wb < wa and wb <= wc:
            onward = cells[current, 10]
        elif wc < wa:
            onward = cells[current, 11]
        if onward < 0.0:
            break
        current = int(onward)
    nearest = _nearest_triangle(cells, boxes, children, x, y)
    px, py = _nearest_point(cells, nearest, x, y)
    wa, wb, wc = _weights(cells, nearest, px, py)
    return _blend(cells, nearest, wa, wb, wc), nearest


@njit(nogil=True, cache=True, _nrt=True)
def _nearest_triangle(cells, boxes, children, x, y):
    """Return the triangle that holds a point or lies nearest to it, by branch and bound."""
    n_leaves = (len(cells) + FANOUT - 1) // FANOUT
    stack = np.empty(128, dtype=np.int64)
    stack[0] = len(children) - 1
    top = 1
    best, nearest = np.inf, 0
    while top > 0:
        top -= 1
        node = stack[top]
        if box_distance2(boxes, node, x, y) >= best:
            continue
        if node < n_leaves:
            for t in range(children[node, 0], children[node, 1]):
                px, py = _nearest_point(cells, t, x, y)
                d2 = (px - x) ** 2 + (py - y) ** 2
                if d2 < best:
                    best, nearest = d2, t
            continue
        top = push_nearer_last(boxes, children, node, x, y, stack, top)
    return nearest


@uncounted
def push_nearer_last(boxes, children, node, x, y, stack, top):
    """Push a node's children so that the nearest box is popped first; return the new top."""
    base = top
    for child in range(children[node, 0], children[node, 1]):
        d2 = box_distance2(boxes, child, x, y)
        at = top
        while at > base and box_distance2(boxes, stack[at - 1], x, y) < d2:
            stack[at] = stack[at - 1]
            at -= 1
        stack[at] = child
        top += 1
    return top


@uncounted
def _nearest_point(cells, t, x, y):
    """Return the point of a triangle nearest to (x, y)."""
    wa, wb, wc = _weights(cells, t, x, y)
    if wa >= 0.0 and wb >= 0.0 and wc >= 0.0:
        return x, y
    best, bx, by = np.inf, x, y
    for k in range(3):
        a, b = 2 * k, 2 * ((k + 1) % 3)
        ex, ey = cells[t, b] - cells[t, a], cells[t, b + 1] - cells[t, a + 1]
        s = ((x - cells[t, a]) * ex + (y - cells[t, a + 1]) * ey) / (ex * ex + ey * ey)
        s = min(max(s, 0.0), 1.0)
        px, py = cells[t, a] + s * ex, cells[t, a + 1] + s * ey
        d2 = (px - x) ** 2 + (py - y) ** 2
        if d2 < best:
            best, bx, by = d2, px, py
    return bx, by
