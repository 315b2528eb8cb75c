"""Constrained edges: recovered in a Delaunay triangulation by flips, then used to tell inside from outside.

Sloan (1993), "A fast algorithm for generating constrained Delaunay triangulations", Computers & Structures 47,
DOI 10.1016/0045-7949(93)90239-A. Same arrays as in ``_delaunay_kernels``.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from sizeviz.geometry._predicates_kernels import incircle, orient2d

DONE, CROSSING, STUCK = 0, 1, 2
FREE, INNER, BOUNDARY = 0, 1, 2


@njit(nogil=True, cache=True)
def around(n_triangles, corner, n_vertices):
    """Return for each vertex the place of one corner that is this vertex, -1 where there is none."""
    place = np.full(n_vertices, -1, dtype=np.int32)
    for e in range(3 * n_triangles):
        place[corner[e]] = e
    return place


@njit(nogil=True, cache=True)
def _next(e):
    return e - 2 if e % 3 == 2 else e + 1


@njit(nogil=True, cache=True)
def _before(e):
    return e + 2 if e % 3 == 0 else e - 1


@njit(nogil=True, cache=True)
def edge_from(a, b, corner, twin, place):
    """Return the half-edge that runs from a to b, or -1: its triangle lies on the left."""
    first = place[a]
    e = first
    while True:
        # e is a's place in its triangle; the edge from a to the next corner lies opposite the one before
        if corner[_next(e)] == b:
            return _before(e)
        e = _next(twin[_next(e)])
        if e == first:
            return -1


@njit(nogil=True, cache=True)
def flip(e, corner, twin, locked, place):
    """Exchange the diagonal e of the two triangles beside it for the other; e and its twin become the new one.

    Before: triangles (p, a, b) and (q, b, a); after: (p, a, q) and (q, b, p).
    """
    g = twin[e]
    ea, eb = _next(e), _before(e)
    gb, ga = _next(g), _before(g)
    p, a, q, b = corner[e], corner[ea], corner[g], corner[gb]
    # outer edges: (b, p) opposite a in the first, (a, q) opposite b in the second
    out_bp, lock_bp = twin[ea], locked[ea]
    out_aq, lock_aq = twin[gb], locked[gb]
    corner[eb], corner[ga] = q, p
    # first triangle (p at e, a at ea, q at eb): edge opposite p is (a, q), opposite a is (q, p)
    twin[e], locked[e] = out_aq, lock_aq
    twin[out_aq] = e
    twin[g], locked[g] = out_bp, lock_bp
    twin[out_bp] = g
    twin[ea], twin[gb] = gb, ea
    locked[ea] = locked[gb] = 0
    place[p], place[a], place[q], place[b] = e, ea, g, gb
    return ea


@njit(nogil=True, cache=True)
def _side(a, b, v, x, y):
    return orient2d(x[a], y[a], x[b], y[b], x[v], y[v])


@njit(nogil=True, cache=True)
def _ahead(a, b, v, x, y):
    """Whether v, known to be collinear with a and b, lies on b's side of a."""
    return (x[v] - x[a]) * (x[b] - x[a]) + (y[v] - y[a]) * (y[b] - y[a]) > 0.0


@njit(nogil=True, cache=True)
def _leaving(a, b, x, y, corner, twin, place):
    """Return how the segment from a to b leaves a: (1, half-edge crossed) or (0, half-edge along it to a vertex)."""
    ghost = len(x)
    first = place[a]
    e = first
    while True:
        u, v = corner[_next(e)], corner[_before(e)]
        if u != ghost:
            right = _side(a, b, u, x, y)
            if right == 0.0 and _ahead(a, b, u, x, y):
                return 0, _before(e)
            if v != ghost:
                left = _side(a, b, v, x, y)
                if left == 0.0 and _ahead(a, b, v, x, y):
                    return 0, twin[_next(e)]
                if right < 0.0 and left > 0.0:
                    return 1, e
        e = _next(twin[_next(e)])
        if e == first:
            return -1, -1


@njit(nogil=True, cache=True)
def _crossed(a, b, e, x, y, corner, twin, locked, ends):
    """List the edges that cross the segment from a, the first being e; return their number and where it ends.

    The end is b, or a vertex that lies on the segment; -1 if a locked edge is in the way.
    """
    n = 0
    while True:
        if locked[e] != FREE:
            return n, -1
        right, left = corner[_next(e)], corner[_before(e)]
        ends[2 * n], ends[2 * n + 1] = right, left
        n += 1
        g = twin[e]
        q = corner[g]
        side = 0.0 if q == b else _side(a, b, q, x, y)
        if side == 0.0:
            return n, q
        # g = (q; left, right): go on through (right, q) where q lies left of the segment, through (q, left) otherwise
        e = _next(g) if side > 0.0 else _before(g)


@njit(nogil=True, cache=True)
def _convex(e, x, y, corner, twin):
    """Whether the two triangles beside e form a strictly convex quadrilateral, so that e can be flipped."""
    g = twin[e]
    p, a, q, b = corner[e], corner[_next(e)], corner[g], corner[_before(e)]
    return _side(p, q, a, x, y) < 0.0 and _side(p, q, b, x, y) > 0.0


@njit(nogil=True, cache=True)
def _flip_away(a, b, n, x, y, corner, twin, locked, place, ends, fresh):
    """Flip the listed edges until none crosses the segment; return the number of new ones, or -1 if stuck."""
    head, count, n_fresh, idle = 0, n, 0, 0
    size = len(ends) // 2
    while count > 0:
        u, v = ends[2 * head], ends[2 * head + 1]
        head = (head + 1) % size
        count -= 1
        e = edge_from(u, v, corner, twin, place)
        crosses = True
        if _convex(e, x, y, corner, twin):
            e = flip(e, corner, twin, locked, place)
            u, v = corner[_next(e)], corner[_before(e)]
            at_end = u == a or v == a or u == b or v == b
            crosses = not at_end and (_side(a, b, u, x, y) > 0.0) != (_side(a, b, v, x, y) > 0.0)
            idle = 0
        else:
            idle += 1
            if idle > count + 1:
                return -1
        if crosses:
            tail = (head + count) % size
            ends[2 * tail], ends[2 * tail + 1] = u, v
            count += 1
        else:
            fresh[2 * n_fresh], fresh[2 * n_fresh + 1] = u, v
            n_fresh += 1
    return n_fresh


@njit(nogil=True, cache=True)
def _settle(n_fresh, x, y, corner, twin, locked, place, fresh):
    """Flip the new edges, except locked ones, until each is locally Delaunay again."""
    changed = True
    while changed:
        changed = False
        for k in range(n_fresh):
            e = edge_from(fresh[2 * k], fresh[2 * k + 1], corner, twin, place)
            if locked[e] != FREE:
                continue
            a, b, c, d = corner[e], corner[_next(e)], corner[_before(e)], corner[twin[e]]
            if incircle(x[a], y[a], x[b], y[b], x[c], y[c], x[d], y[d]) > 0.0:
                e = flip(e, corner, twin, locked, place)
                fresh[2 * k], fresh[2 * k + 1] = corner[_next(e)], corner[_before(e)]
                changed = True


@njit(nogil=True, cache=True)
def _lock(e, kind, twin, locked):
    locked[e] = max(locked[e], kind)
    locked[twin[e]] = max(locked[twin[e]], kind)


@njit(nogil=True, cache=True)
def _recover(a, b, kind, x, y, corner, twin, locked, place, ends, fresh):
    """Make the segment from a to b a chain of locked edges; return a code and the vertex it got to."""
    while a != b:
        e = edge_from(a, b, corner, twin, place)
        if e < 0:
            crosses, e = _leaving(a, b, x, y, corner, twin, place)
            if e < 0:
                return STUCK, a
            if crosses == 1:
                n, end = _crossed(a, b, e, x, y, corner, twin, locked, ends)
                if end < 0:
                    return CROSSING, a
                n_fresh = _flip_away(a, end, n, x, y, corner, twin, locked, place, ends, fresh)
                e = edge_from(a, end, corner, twin, place) if n_fresh >= 0 else -1
                if e < 0:
                    return STUCK, a
                _lock(e, kind, twin, locked)
                _settle(n_fresh, x, y, corner, twin, locked, place, fresh)
                a = end
                continue
        _lock(e, kind, twin, locked)
        a = corner[_before(e)]
    return DONE, b


@njit(nogil=True, cache=True)
def recover(segments, kinds, x, y, corner, twin, locked, place):
    """Recover every segment; return a code and the first segment that could not be."""
    ends = np.empty(len(corner) + 8, dtype=np.int32)
    fresh = np.empty(len(corner) + 8, dtype=np.int32)
    for k in range(len(segments)):
        a, b = segments[k, 0], segments[k, 1]
        code, _ = _recover(a, b, kinds[k], x, y, corner, twin, locked, place, ends, fresh)
        if code != DONE:
            return code, k
    return DONE, -1


@njit(nogil=True, cache=True)
def inside(n_triangles, ghost, corner, twin, locked):
    """Return which triangles lie inside: separated from the ghosts by an odd number of boundary edges."""
    depth = np.full(n_triangles, -1, dtype=np.int8)
    stack = np.empty(3 * n_triangles, dtype=np.int32)
    top = 0
    for t in range(n_triangles):
        if corner[3 * t] == ghost or corner[3 * t + 1] == ghost or corner[3 * t + 2] == ghost:
            depth[t] = 0
            stack[top] = t
            top += 1
    while top > 0:
        top -= 1
        t = stack[top]
        for i in range(3):
            u = twin[3 * t + i] // 3
            if depth[u] < 0:
                depth[u] = depth[t] ^ np.int8(locked[3 * t + i] == BOUNDARY)
                stack[top] = u
                top += 1
    return depth == 1
