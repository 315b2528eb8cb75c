"""Positions on the polylines that boundary nodes slide along.

``curves`` is (vertices (M, 2), stations (M,), start (C + 1,), closed (C,)): the vertices of all curves one after the
other, the first of a closed one repeated at its end; stations are arc lengths.
"""

from __future__ import annotations

import math

import numpy as np

from sizeviz.improvement._jit import allocating, compiled


@compiled
def curve_frame(curves, c, s):
    """Return the point of curve c at arc length s and the unit tangent there: (x, y, tx, ty)."""
    vertices, stations, start, _ = curves
    low, high = start[c], start[c + 1] - 1
    while high - low > 1:
        middle = (low + high) >> 1
        if stations[middle] <= s:
            low = middle
        else:
            high = middle
    dx, dy = vertices[high, 0] - vertices[low, 0], vertices[high, 1] - vertices[low, 1]
    length = stations[high] - stations[low]
    u = (s - stations[low]) / length
    if u >= 1.0:
        return vertices[high, 0], vertices[high, 1], dx / length, dy / length
    return vertices[low, 0] + u * dx, vertices[low, 1] + u * dy, dx / length, dy / length


@compiled
def curve_shift(curves, c, s, step):
    """Return the arc length s + step: wrapped on a closed curve, kept within an open one."""
    _, stations, start, closed = curves
    length = stations[start[c + 1] - 1]
    there = s + step
    if closed[c]:
        return there - length * math.floor(there / length)
    return min(max(there, 0.0), length)


@compiled
def nearest_station(curves, c, x, y, first):
    """Return the arc length of the point of curve c nearest to (x, y), its distance squared, and its segment.

    The search begins at segment ``first`` and ends early where a segment passes through the point, so that the
    nodes of a loop taken in order cost a step or two each.
    """
    vertices, stations, start, _ = curves
    n = start[c + 1] - start[c] - 1
    tiny = (1e-13 * stations[start[c + 1] - 1]) ** 2
    best, where, segment = math.inf, 0.0, 0
    for j in range(n):
        i = start[c] + (first + j) % n
        dx, dy = vertices[i + 1, 0] - vertices[i, 0], vertices[i + 1, 1] - vertices[i, 1]
        length = stations[i + 1] - stations[i]
        px, py = x - vertices[i, 0], y - vertices[i, 1]
        along = min(max((px * dx + py * dy) / (length * length), 0.0), 1.0)
        away = (px - along * dx) ** 2 + (py - along * dy) ** 2
        if away < best:
            best, where, segment = away, stations[i] + along * length, i - start[c]
            if away <= tiny:
                break
    return where, best, segment


@allocating
def project_nodes(curves, nodes, slide, xy, station, off):
    """Write the arc length of each of ``nodes`` on its curve and its squared distance from it."""
    hint = np.zeros(len(curves[3]), np.int64)
    for v in nodes:
        c = slide[v]
        where, away, segment = nearest_station(curves, c, xy[v, 0], xy[v, 1], hint[c])
        station[v], off[v], hint[c] = where, away, segment
