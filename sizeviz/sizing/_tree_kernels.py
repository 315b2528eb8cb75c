"""Kernels that order triangles along a Hilbert curve, link neighbours and bound groups of four by boxes."""

import numpy as np
from numba import njit

uncounted = njit(nogil=True, cache=True, _nrt=False)
"""``njit`` for small functions that allocate nothing.

Numba counts references to arrays that are taken out of a tuple or handed on, with atomic operations: threads that ask
one field then wait for each other at every query. Without its run-time (``_nrt``) there is nothing to count, nor to
allocate with.
"""

FANOUT = 4
"""Triangles in a leaf, and children of an inner node."""


@njit(nogil=True, cache=True)
def hilbert_key(column, row, bits):
    """Return the position of cell (column, row) of a 2^bits square grid along its Hilbert curve."""
    key = 0
    side = 1 << (bits - 1)
    while side > 0:
        right = 1 if column & side else 0
        upper = 1 if row & side else 0
        key += side * side * ((3 * right) ^ upper)
        if upper == 0:
            if right == 1:
                column = (side << 1) - 1 - (column & ((side << 1) - 1))
                row = (side << 1) - 1 - (row & ((side << 1) - 1))
            column, row = row, column
        side >>= 1
    return key


@njit(nogil=True, cache=True)
def hilbert_keys(points, triangles):
    """Return the Hilbert position of each triangle's centroid, ``(T,)`` int64, on a grid of 2^28 cells a side."""
    low = np.array([np.inf, np.inf])
    high = -low
    for i in range(len(points)):
        for k in range(2):
            low[k] = min(low[k], points[i, k])
            high[k] = max(high[k], points[i, k])
    bits = 28
    extent = max(high[0] - low[0], high[1] - low[1])
    scale = (2.0**bits - 1.0) / extent if extent > 0.0 else 0.0
    keys = np.empty(len(triangles), dtype=np.int64)
    for t in range(len(triangles)):
        a, b, c = triangles[t]
        x = (points[a, 0] + points[b, 0] + points[c, 0]) / 3.0
        y = (points[a, 1] + points[b, 1] + points[c, 1]) / 3.0
        keys[t] = hilbert_key(np.int64((x - low[0]) * scale), np.int64((y - low[1]) * scale), bits)
    return keys


@njit(nogil=True, cache=True)
def link_neighbours(triangles, n_points):
    """Return the triangle across the edge opposite each corner, ``(T, 3)`` int32, -1 where there is none."""
    neighbours = np.full(triangles.shape, -1, dtype=np.int32)
    start = np.zeros(n_points + 1, dtype=np.int64)
    for t in range(len(triangles)):
        for k in range(3):
            start[min(triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]) + 1] += 1
    for i in range(n_points):
        start[i + 1] += start[i]
    filled = start[:-1].copy()
    slots = np.empty(3 * len(triangles), dtype=np.int64)
    for t in range(len(triangles)):
        for k in range(3):
            a, b = triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]
            low, high = min(a, b), max(a, b)
            for s in range(start[low], filled[low]):
                other, side = slots[s] // 3, slots[s] % 3
                if neighbours[other, side] < 0 and high == max(
                    triangles[other, (side + 1) % 3], triangles[other, (side + 2) % 3]
                ):
                    neighbours[other, side] = t
                    neighbours[t, k] = other
                    break
            if neighbours[t, k] < 0:
                slots[filled[low]] = 3 * t + k
                filled[low] += 1
    return neighbours


@njit(nogil=True, cache=True)
def bound_boxes(points, triangles, children, n_leaves):
    """Return the box of every tree node, ``(M, 4)``: smallest x, smallest y, largest x, largest y."""
    boxes = np.empty((len(children), 4))
    for node in range(len(children)):
        x0, y0, x1, y1 = np.inf, np.inf, -np.inf, -np.inf
        for child in range(children[node, 0], children[node, 1]):
            if node < n_leaves:
                for k in range(3):
                    corner = triangles[child, k]
                    x0, x1 = min(x0, points[corner, 0]), max(x1, points[corner, 0])
                    y0, y1 = min(y0, points[corner, 1]), max(y1, points[corner, 1])
            else:
                x0, y0 = min(x0, boxes[child, 0]), min(y0, boxes[child, 1])
                x1, y1 = max(x1, boxes[child, 2]), max(y1, boxes[child, 3])
        boxes[node, 0], boxes[node, 1], boxes[node, 2], boxes[node, 3] = x0, y0, x1, y1
    return boxes


@njit(nogil=True, cache=True)
def bound_sizes(sizes, triangles, children, n_leaves):
    """Return the smallest size under every tree node, ``(M,)``."""
    lowest = np.empty(len(children))
    for node in range(len(children)):
        least = np.inf
        for child in range(children[node, 0], children[node, 1]):
            if node < n_leaves:
                for k in range(3):
                    least = min(least, sizes[triangles[child, k]])
            else:
                least = min(least, lowest[child])
        lowest[node] = least
    return lowest


@uncounted
def box_distance2(boxes, node, x, y):
    """Return the squared distance from a point to a node's box."""
    dx = max(boxes[node, 0] - x, 0.0, x - boxes[node, 2])
    dy = max(boxes[node, 1] - y, 0.0, y - boxes[node, 3])
    return dx * dx + dy * dy
