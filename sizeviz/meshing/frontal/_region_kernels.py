"""Whether a point lies in the domain: a comparison in a rectangle, a walk through a triangulation elsewhere."""

from __future__ import annotations

import numpy as np
from numba import njit

from sizeviz.geometry._predicates_kernels import orient2d

CERTAIN = 1.0 + 1e-6
"""How much larger a square is taken than it is, for what rounding hides."""


@njit(nogil=True, cache=True, _nrt=False)
def within(region, x, y, gap, hint):
    """Return whether a point lies inside, at least ``gap`` from the nearest edge, and a hint for the next point nearby.

    ``region`` is what ``region_arrays`` returned: box, points, triangles, neighbours, inside, locked.
    """
    box, triangles = region[0], region[2]
    if len(triangles) == 0:
        return box[0] + gap < x < box[2] - gap and box[1] + gap < y < box[3] - gap, hint
    if not (box[0] < x < box[2] and box[1] < y < box[3]):
        return False, hint
    t = _triangle_at(region[1], triangles, region[3], x, y, hint)
    if t < 0:
        return False, 0
    return region[4][t] and _clear(region[1], triangles, region[5], t, x, y, gap), t


@njit(nogil=True, cache=True, _nrt=False)
def outside(region, x, y, half, hint, around):
    """Return whether a square lies outside for certain, ``half`` its side, and a hint for the next one nearby.

    Asked are the triangles that it may reach, one after the other; ``around`` has room for so many, and where there
    are more the answer is no.
    """
    points, triangles, neighbours, inside = region[1], region[2], region[3], region[4]
    if len(triangles) == 0:
        return False, hint
    start = _triangle_at(points, triangles, neighbours, x, y, hint)
    if start < 0:
        return False, 0
    if inside[start]:
        return False, start
    around[0] = start
    n, at = 1, 0
    while at < n:
        t = around[at]
        at += 1
        for i in range(3):
            if not _reaches(points, triangles, t, i, x, y, half):
                continue
            u = neighbours[t, i]
            if u < 0:
                continue
            if inside[u]:
                return False, start
            known = False
            for j in range(n):
                known = known or around[j] == u
            if not known:
                if n == len(around):
                    return False, start
                around[n] = u
                n += 1
    return True, start


@njit(nogil=True, cache=True, _nrt=False)
def _reaches(points, triangles, t, i, x, y, half):
    """Whether a square around a point reaches, or nearly, the outer side of edge i of triangle t."""
    a, b = triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3]
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    off = ux * (y - points[a, 1]) - uy * (x - points[a, 0])
    return off <= CERTAIN * half * (abs(ux) + abs(uy))


@njit(nogil=True, cache=True, _nrt=False)
def _clear(points, triangles, locked, t, x, y, gap):
    """Whether a point in triangle t is at least ``gap`` from those of its edges that are locked."""
    for i in range(3):
        if locked[t, i]:
            a, b = triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3]
            ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
            if ux * (y - points[a, 1]) - uy * (x - points[a, 0]) <= gap * np.sqrt(ux * ux + uy * uy):
                return False
    return True


@njit(nogil=True, cache=True, _nrt=False)
def _triangle_at(points, triangles, neighbours, x, y, start):
    """Walk to the triangle that holds a point; -1 where none does.

    The edges are tried in a changing order, as a walk that always tries them in the same can run in circles where
    the triangulation is constrained (Devillers, Pion, Teillaud 2002, DOI 10.1142/S0129054102001047).
    """
    t = start
    turn = start + 1
    while True:
        turn = (turn * 1664525 + 1013904223) & 0xFFFFFFFF
        first = (turn >> 16) % 3
        onward = -2
        for k in range(3):
            i = (first + k) % 3
            a, b = triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3]
            if orient2d(points[a, 0], points[a, 1], points[b, 0], points[b, 1], x, y) < 0.0:
                onward = neighbours[t, i]
                break
        if onward == -2:
            return t
        if onward < 0:
            return -1
        t = onward


@njit(nogil=True, cache=True, _nrt=True)
def parity(neighbours, locked):
    """Return which triangles an odd number of locked edges separates from the outside of the hull."""
    n = len(neighbours)
    depth = np.full(n, -1, dtype=np.int8)
    stack = np.empty(n, dtype=np.int32)
    top = 0
    for t in range(n):
        for i in range(3):
            if neighbours[t, i] < 0 and depth[t] < 0:
                depth[t] = locked[t, i]
                stack[top] = t
                top += 1
    while top > 0:
        top -= 1
        t = stack[top]
        for i in range(3):
            u = neighbours[t, i]
            if u >= 0 and depth[u] < 0:
                depth[u] = depth[t] ^ np.int8(locked[t, i])
                stack[top] = u
                top += 1
    return depth == 1
