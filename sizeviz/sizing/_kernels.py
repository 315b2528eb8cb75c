"""The size at a point, for every kernel that asks: arithmetic on a grid, a walk with a hint on a triangulation."""

import numpy as np
from numba import njit

from sizeviz.sizing._tree_kernels import box_distance2

LONGEST_WALK = 32
"""Triangles crossed before the walk gives up and the tree is asked."""

ROUNDING = 1e-12
"""How far outside a triangle, in barycentric terms, a point still counts as inside."""


@njit(nogil=True, cache=True)
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
        return _size_on_grid(grid, sampler[1], x, y), hint
    return _size_on_triangles(sampler[1], sampler[2], sampler[3], sampler[4], sampler[5], sampler[6], x, y, hint)


@njit(nogil=True, cache=True)
def sizes_at(sampler, points, out, start, stop):
    """Fill rows ``start`` to ``stop`` of ``out`` with the sizes at ``points``."""
    hint = 0
    for i in range(start, stop):
        out[i], hint = size_at(sampler, points[i, 0], points[i, 1], hint)


@njit(nogil=True, cache=True)
def _size_on_grid(grid, sizes, x, y):
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


@njit(nogil=True, cache=True)
def _size_on_triangles(sizes, points, triangles, neighbours, boxes, children, x, y, hint):
    current = hint if 0 <= hint < len(triangles) else 0
    came_from = -1
    for _ in range(LONGEST_WALK):
        a, b, c = triangles[current, 0], triangles[current, 1], triangles[current, 2]
        ax, ay = points[a, 0] - x, points[a, 1] - y
        bx, by = points[b, 0] - x, points[b, 1] - y
        cx, cy = points[c, 0] - x, points[c, 1] - y
        wa, wb, wc = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
        area = wa + wb + wc
        slack = -ROUNDING * area
        if wa >= slack and wb >= slack and wc >= slack:
            return _blend(sizes[a], sizes[b], sizes[c], wa, wb, wc), current
        onward = _way_out(neighbours, current, came_from, wa, wb, wc, slack)
        if onward < 0:
            break
        came_from = current
        current = onward
    nearest = _nearest_triangle(points, triangles, boxes, children, x, y)
    return _size_on_one(sizes, points, triangles, nearest, x, y), nearest


@njit(nogil=True, cache=True)
def _blend(ha, hb, hc, wa, wb, wc):
    """Interpolate with weights cut off at zero, so that rounding never leaves the range of the three sizes."""
    wa, wb, wc = max(wa, 0.0), max(wb, 0.0), max(wc, 0.0)
    return (wa * ha + wb * hb + wc * hc) / (wa + wb + wc)


@njit(nogil=True, cache=True)
def _way_out(neighbours, current, came_from, wa, wb, wc, slack):
    """Return the neighbour across the edge that the point lies furthest behind, -1 at the background's edge."""
    best, onward = slack, -1
    for k in range(3):
        weight = wa if k == 0 else (wb if k == 1 else wc)
        if weight < best and neighbours[current, k] != came_from:
            best = weight
            onward = neighbours[current, k]
    return onward


@njit(nogil=True, cache=True)
def _nearest_triangle(points, triangles, boxes, children, x, y):
    """Return the triangle that holds a point or lies nearest to it, by branch and bound."""
    n_leaves = (len(triangles) + 3) // 4
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
                px, py = _nearest_point(points, triangles, t, x, y)
                d2 = (px - x) ** 2 + (py - y) ** 2
                if d2 < best:
                    best, nearest = d2, t
            continue
        top = push_nearer_last(boxes, children, node, x, y, stack, top)
    return nearest


@njit(nogil=True, cache=True)
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


@njit(nogil=True, cache=True)
def _weights_in(points, triangles, t, x, y):
    a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
    ax, ay = points[a, 0] - x, points[a, 1] - y
    bx, by = points[b, 0] - x, points[b, 1] - y
    cx, cy = points[c, 0] - x, points[c, 1] - y
    return bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx


@njit(nogil=True, cache=True)
def _nearest_point(points, triangles, t, x, y):
    """Return the point of a triangle nearest to (x, y)."""
    wa, wb, wc = _weights_in(points, triangles, t, x, y)
    if wa >= 0.0 and wb >= 0.0 and wc >= 0.0:
        return x, y
    best, bx, by = np.inf, x, y
    for k in range(3):
        a, b = triangles[t, k], triangles[t, (k + 1) % 3]
        ex, ey = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        s = ((x - points[a, 0]) * ex + (y - points[a, 1]) * ey) / (ex * ex + ey * ey)
        s = min(max(s, 0.0), 1.0)
        px, py = points[a, 0] + s * ex, points[a, 1] + s * ey
        d2 = (px - x) ** 2 + (py - y) ** 2
        if d2 < best:
            best, bx, by = d2, px, py
    return bx, by


@njit(nogil=True, cache=True)
def _size_on_one(sizes, points, triangles, t, x, y):
    """Return the size at the point of triangle ``t`` nearest to (x, y)."""
    px, py = _nearest_point(points, triangles, t, x, y)
    wa, wb, wc = _weights_in(points, triangles, t, px, py)
    return _blend(sizes[triangles[t, 0]], sizes[triangles[t, 1]], sizes[triangles[t, 2]], wa, wb, wc)
