"""Incremental Delaunay triangulation: insertion in a biased random, spatially sorted order.

Bowyer (1981) and Watson (1981), DOI 10.1093/comjnl/24.2.162 and 10.1093/comjnl/24.2.167; the order is that of
Amenta, Choi, Rote (2003), "Incremental constructions con BRIO", DOI 10.1145/777792.777824.

A triangle t has corners ``corner[3t + i]``; ``twin[3t + i]`` is the same edge seen from the other side, the edge
that lies opposite corner i. Outside the hull lie ghost triangles, whose one ghost corner has the index ``len(x)``.

``_nrt=False``: a kernel that makes no array need not count references, which costs more than some of its calls.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from sizeviz.geometry._predicates_kernels import incircle, orient2d

N_TRIANGLES, LAST, STATE_SIZE = 0, 1, 2


@njit(nogil=True, cache=True, _nrt=False)
def _hilbert(ix, iy, bits):
    """Return the position of a cell along the Hilbert curve of a 2^bits x 2^bits grid."""
    key = np.uint64(0)
    s = np.int64(1) << (bits - 1)
    while s > 0:
        rx = np.int64((ix & s) != 0)
        ry = np.int64((iy & s) != 0)
        key = (key << np.uint64(2)) | np.uint64((3 * rx) ^ ry)
        if ry == 0:
            if rx == 1:
                ix, iy = s - 1 - (ix & (s - 1)), s - 1 - (iy & (s - 1))
            ix, iy = iy, ix
        s >>= 1
    return key


@njit(nogil=True, cache=True, _nrt=False)
def _scrambled(i):
    """Return a 64-bit hash of an index (splitmix64): the same order in every run."""
    z = np.uint64(i) * np.uint64(0x9E3779B97F4A7C15) + np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@njit(nogil=True, cache=True, _nrt=True)
def hilbert_keys(points, low, scale, bits, shift):
    """Return the place of each point along a Hilbert curve over the box, shifted left, with the index below it."""
    n = len(points)
    keys = np.empty(n, dtype=np.uint64)
    top = (np.int64(1) << bits) - 1
    for i in range(n):
        ix = min(np.int64((points[i, 0] - low[0]) * scale), top)
        iy = min(np.int64((points[i, 1] - low[1]) * scale), top)
        keys[i] = (_hilbert(ix, iy, bits) << np.uint64(shift)) | np.uint64(i)
    return keys


@njit(nogil=True, cache=True, _nrt=False)
def with_rounds(keys, shift, rounds):
    """Put a random round above each key: the last holds half of the points, the one before a quarter, and so on."""
    for i in range(len(keys)):
        draw = _scrambled(i)
        back = 0
        while back < rounds - 1 and (draw & np.uint64(1)) == 0:
            draw >>= np.uint64(1)
            back += 1
        keys[i] |= np.uint64(rounds - 1 - back) << np.uint64(shift)


@njit(nogil=True, cache=True, _nrt=False)
def first_triangle(x, y):
    """Return three points that are not collinear, counter-clockwise, the first of them 0; or -1s if there are none."""
    n = len(x)
    b = 1
    while b < n and x[b] == x[0] and y[b] == y[0]:
        b += 1
    for c in range(b + 1, n):
        side = orient2d(x[0], y[0], x[b], y[b], x[c], y[c])
        if side > 0:
            return 0, b, c
        if side < 0:
            return 0, c, b
    return -1, -1, -1


@njit(nogil=True, cache=True, _nrt=False)
def _pair(twin, e, f):
    twin[e] = f
    twin[f] = e


@njit(nogil=True, cache=True, _nrt=False)
def begin(a, b, c, ghost, corner, twin, state):
    """Set up the triangle abc and the three ghosts around it."""
    vertices = (a, b, c)
    for i in range(3):
        corner[i] = vertices[i]
        g = 3 * (i + 1)
        corner[g], corner[g + 1], corner[g + 2] = vertices[(i + 2) % 3], vertices[(i + 1) % 3], ghost
        _pair(twin, i, g + 2)
    for i in range(3):  # ghost i runs from vertex i + 2 to i + 1; the next round the hull begins where it began
        _pair(twin, 3 * (i + 1) + 1, 3 * ((i + 1) % 3 + 1))
    state[N_TRIANGLES], state[LAST] = 4, 0


@njit(nogil=True, cache=True, _nrt=False)
def _beyond(ax, ay, bx, by, px, py):
    """Whether p conflicts with the ghost outside the hull edge from a to b: left of it, or on it between a and b."""
    side = orient2d(ax, ay, bx, by, px, py)
    if side != 0.0:
        return side > 0.0
    if ax != bx:
        return (ax < px) != (bx < px) and px != ax and px != bx
    return (ay < py) != (by < py) and py != ay and py != by


@njit(nogil=True, cache=True, _nrt=False)
def _conflicts(t, px, py, x, y, corner):
    """Whether p lies strictly inside the circumcircle of triangle t."""
    ghost = len(x)
    a, b, c = corner[3 * t], corner[3 * t + 1], corner[3 * t + 2]
    if c == ghost:
        return _beyond(x[a], y[a], x[b], y[b], px, py)
    if a == ghost:
        return _beyond(x[b], y[b], x[c], y[c], px, py)
    if b == ghost:
        return _beyond(x[c], y[c], x[a], y[a], px, py)
    return incircle(x[a], y[a], x[b], y[b], x[c], y[c], px, py) > 0.0


@njit(nogil=True, cache=True, _nrt=False)
def located(t, px, py, x, y, corner, twin):
    """Walk from triangle t to one that holds p, or to a ghost beyond whose hull edge p lies."""
    ghost = len(x)
    for i in range(3):
        if corner[3 * t + i] == ghost:
            t = twin[3 * t + i] // 3
            break
    came = -1
    while True:
        onward = -1
        for i in range(3):
            e = 3 * t + i
            if e == came:
                continue
            a, b = corner[3 * t + (i + 1) % 3], corner[3 * t + (i + 2) % 3]
            if orient2d(x[a], y[a], x[b], y[b], px, py) < 0.0:
                onward = e
                break
        if onward < 0:
            return t
        came = twin[onward]
        t = came // 3
        if corner[3 * t] == ghost or corner[3 * t + 1] == ghost or corner[3 * t + 2] == ghost:
            return t


@njit(nogil=True, cache=True, _nrt=False)
def _duplicate(t, px, py, x, y, corner):
    """Return the corner of t that coincides with p, or -1."""
    for i in range(3):
        v = corner[3 * t + i]
        if v < len(x) and x[v] == px and y[v] == py:
            return v
    return -1


@njit(nogil=True, cache=True, _nrt=False)
def _cavity(t, px, py, x, y, corner, twin, stack, removed, rim):
    """List the triangles whose circle holds p, and the edges around them, counter-clockwise, as seen from outside.

    The removed triangles form a tree (no vertex lies inside the cavity), so a depth-first walk meets each once.
    """
    removed[0] = t
    n_removed, n_rim, top = 1, 0, 3
    stack[0], stack[1], stack[2] = 3 * t + 2, 3 * t + 1, 3 * t
    while top > 0:
        top -= 1
        g = twin[stack[top]]
        u = g // 3
        if _conflicts(u, px, py, x, y, corner):
            removed[n_removed] = u
            n_removed += 1
            j = g - 3 * u
            stack[top] = 3 * u + (j + 2) % 3
            stack[top + 1] = 3 * u + (j + 1) % 3
            top += 2
        else:
            rim[n_rim] = g
            n_rim += 1
    return n_removed, n_rim


@njit(nogil=True, cache=True, _nrt=False)
def _star(p, n_removed, n_rim, corner, twin, removed, rim, state):
    """Join p to every edge of the cavity's rim, reusing the removed triangles' places."""
    before = -1
    first = -1
    for k in range(n_rim):
        if k < n_removed:
            t = removed[k]
        else:
            t = state[N_TRIANGLES]
            state[N_TRIANGLES] += 1
        g = rim[k]
        u = g // 3
        j = g - 3 * u
        # the outer triangle sees the edge the other way round
        b, a = corner[3 * u + (j + 1) % 3], corner[3 * u + (j + 2) % 3]
        corner[3 * t], corner[3 * t + 1], corner[3 * t + 2] = a, b, p
        twin[3 * t + 2] = g
        twin[g] = 3 * t + 2
        if before >= 0:
            _pair(twin, 3 * before, 3 * t + 1)
        else:
            first = t
        before = t
    _pair(twin, 3 * before, 3 * first + 1)
    state[LAST] = first


@njit(nogil=True, cache=True, _nrt=False)
def insert(start, stop, x, y, corner, twin, state, same_as, stack, removed, rim):
    """Insert points start..stop; one that coincides with an earlier one is left out and named in ``same_as``.

    ``same_as`` is -2 for the corners of the first triangle, -1 for every other point.
    """
    for p in range(start, stop):
        if same_as[p] == -2:  # a corner of the first triangle
            same_as[p] = -1
            continue
        px, py = x[p], y[p]
        t = located(state[LAST], px, py, x, y, corner, twin)
        twin_of = _duplicate(t, px, py, x, y, corner)
        if twin_of >= 0:
            same_as[p] = twin_of
            continue
        n_removed, n_rim = _cavity(t, px, py, x, y, corner, twin, stack, removed, rim)
        _star(p, n_removed, n_rim, corner, twin, removed, rim, state)


@njit(nogil=True, cache=True, _nrt=True)
def real(n_triangles, ghost, corner):
    """Return which triangles have no ghost corner."""
    keep = np.empty(n_triangles, dtype=np.bool_)
    for t in range(n_triangles):
        keep[t] = corner[3 * t] != ghost and corner[3 * t + 1] != ghost and corner[3 * t + 2] != ghost
    return keep


@njit(nogil=True, cache=True, _nrt=True)
def _ranked(keep, corner, index):
    """Return each kept triangle's place when sorted by its lowest point, -1 for the others, and their number."""
    start = np.zeros(len(index) + 1, dtype=np.int32)
    place = np.full(len(keep), -1, dtype=np.int32)
    for t in range(len(keep)):
        if keep[t]:
            lowest = min(index[corner[3 * t]], index[corner[3 * t + 1]], index[corner[3 * t + 2]])
            place[t] = lowest
            start[lowest + 1] += 1
    for v in range(len(index)):
        start[v + 1] += start[v]
    for t in range(len(keep)):
        if keep[t]:
            lowest = place[t]
            place[t] = start[lowest]
            start[lowest] += 1
    return place, start[len(index)]


@njit(nogil=True, cache=True, _nrt=True)
def collected(keep, corner, twin, locked, index):
    """Return the kept triangles by the points' own numbers, their neighbours (-1: none), their locked edges.

    They come in the order of their lowest points, so that points sorted in space give triangles sorted in space.
    """
    place, count = _ranked(keep, corner, index)
    triangles = np.empty((count, 3), dtype=np.int32)
    neighbours = np.empty((count, 3), dtype=np.int32)
    lock = np.empty((count, 3), dtype=np.bool_)
    for t in range(len(keep)):
        k = place[t]
        if k >= 0:
            for i in range(3):
                triangles[k, i] = index[corner[3 * t + i]]
                neighbours[k, i] = place[twin[3 * t + i] // 3]
                lock[k, i] = locked[3 * t + i] != 0
    return triangles, neighbours, lock
