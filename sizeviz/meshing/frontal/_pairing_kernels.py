"""Which triangles join to a quadrilateral: costs, belief propagation, and the first matching it gives.

``twin[3t + i]`` is the place of the edge opposite corner i of triangle t as its neighbour counts it, -1 where the two
may not be joined. Min-sum belief propagation for matchings: Bayati, Shah, Sharma (2008), "Max-product for maximum
weight matching", DOI 10.1109/TIT.2007.915695.

``_nrt=False``: a kernel that makes no array need not count references, which costs more than some of its calls.
"""

from __future__ import annotations

import numpy as np
from numba import njit

POOR = 0.6
POOR_WEIGHT = 4.0
FORBIDDEN = 20.0
DAMPING = 0.5
SQUARE = 1e-9
STRAIGHT = -0.8660254037844386


@njit(nogil=True, cache=True, _nrt=False)
def _corner_term(ux, uy, vx, vy):
    """Return (|u|^2 + |v|^2) / (u x v), infinite where the corner is flat or inverted."""
    det = ux * vy - uy * vx
    if det <= 0.0:
        return np.inf
    return (ux * ux + uy * uy + vx * vx + vy * vy) / det


@njit(nogil=True, cache=True, _nrt=False)
def quad_quality(ax, ay, bx, by, cx, cy, dx, dy):
    """Return the harmonic mean over the corners of 2 det / (sum of squares), 0 where one is flat or inverted."""
    total = _corner_term(bx - ax, by - ay, dx - ax, dy - ay)
    total += _corner_term(cx - bx, cy - by, ax - bx, ay - by)
    total += _corner_term(dx - cx, dy - cy, bx - cx, by - cy)
    total += _corner_term(ax - dx, ay - dy, cx - dx, cy - dy)
    return 8.0 / total


@njit(nogil=True, cache=True, _nrt=True)
def joinable(neighbours, locked):
    """Return the twin of each edge across which two triangles may be joined, -1 for the others."""
    n = len(neighbours)
    twin = np.full(3 * n, -1, dtype=np.int32)
    for t in range(n):
        for i in range(3):
            u = neighbours[t, i]
            if u < 0 or locked[t, i]:
                continue
            for j in range(3):
                if neighbours[u, j] == t:
                    twin[3 * t + i] = 3 * u + j
    return twin


@njit(nogil=True, cache=True, _nrt=False)
def _ripple(k):
    """Return a tiny number that breaks ties, the same in every run."""
    return ((k * 2654435761) & 0xFFFF0000) * (1e-4 / 2.0**32)


@njit(nogil=True, cache=True, _nrt=False)
def pair_costs(start, stop, points, triangles, twin, cost):
    """Fill the cost of joining across each edge whose first triangle is in a range; both its sides are filled."""
    for t in range(start, stop):
        for i in range(3):
            e = 3 * t + i
            g = twin[e]
            if g < 0:
                cost[e] = FORBIDDEN
            elif g > e:
                p, a, b = triangles[t, i], triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3]
                q = triangles[g // 3, g % 3]
                quality = quad_quality(
                    points[p, 0], points[p, 1], points[a, 0], points[a, 1],
                    points[q, 0], points[q, 1], points[b, 0], points[b, 1],
                )  # fmt: skip
                cost[e] = 0.0
                if quality < 1.0 - SQUARE:
                    cost[e] = 1.0 - quality + POOR_WEIGHT * max(0.0, POOR - quality) + _ripple(e)
                cost[g] = cost[e]


@njit(nogil=True, cache=True, _nrt=False)
def _flattens(e, g, end, points, triangles, locked):
    """Whether joining across an edge would leave a straight stretch of the outline, at one end, to one element."""
    t, i, u, j = e // 3, e % 3, g // 3, g % 3
    # opposite the corner that the end is not: the edge from the end to the triangle's apex
    k, m = (i + 3 - end) % 3, (j + end) % 3
    if not (locked[t, k] and locked[u, m]):
        return False
    a, p, q = triangles[t, (i + end) % 3], triangles[t, i], triangles[u, j]
    ux, uy = points[p, 0] - points[a, 0], points[p, 1] - points[a, 1]
    vx, vy = points[q, 0] - points[a, 0], points[q, 1] - points[a, 1]
    bend = vx * uy - vy * ux if end == 1 else ux * vy - uy * vx
    return bend <= 0.0 or ux * vx + uy * vy < STRAIGHT * np.sqrt((ux * ux + uy * uy) * (vx * vx + vy * vy))


@njit(nogil=True, cache=True, _nrt=True)
def convex(points, triangles, locked, twin):
    """Return the twins without those whose joining would bend an element around a node of the outline."""
    out = twin.copy()
    for e in range(len(twin)):
        g = twin[e]
        if g > e:
            for end in (1, 2):
                if _flattens(e, g, end, points, triangles, locked):
                    out[e] = out[g] = -1
    return out


@njit(nogil=True, cache=True, _nrt=True)
def squares_kept(twin, cost):
    """Return the twins without those that would break up a square: lattices stay whole as long as that is possible."""
    out = twin.copy()
    for e in range(len(twin)):
        if twin[e] > e and cost[e] == 0.0:
            for f in range(3 * (e // 3), 3 * (e // 3) + 3):
                _cut(f, e, out)
            for f in range(3 * (twin[e] // 3), 3 * (twin[e] // 3) + 3):
                _cut(f, twin[e], out)
    return out


@njit(nogil=True, cache=True, _nrt=False)
def _cut(f, kept, twin):
    """Remove a twin unless it is the one to be kept."""
    if f != kept and twin[f] >= 0:
        twin[twin[f]] = -1
        twin[f] = -1


@njit(nogil=True, cache=True, _nrt=False)
def _send(t, twin, cost, inbox, share):
    """Send the messages of one triangle: the cost across each edge less the best it could do elsewhere."""
    e = 3 * t
    m0, m1, m2 = inbox[e], inbox[e + 1], inbox[e + 2]
    g = twin[e]
    if g >= 0:
        inbox[g] += share * (cost[e] - min(m1, m2) - inbox[g])
    g = twin[e + 1]
    if g >= 0:
        inbox[g] += share * (cost[e + 1] - min(m0, m2) - inbox[g])
    g = twin[e + 2]
    if g >= 0:
        inbox[g] += share * (cost[e + 2] - min(m0, m1) - inbox[g])


@njit(nogil=True, cache=True, _nrt=True)
def undecided(twin, cost, inbox):
    """Return the triangles with more than one partner to choose from; those with one send their message for good."""
    n = len(twin) // 3
    out = np.empty(n, dtype=np.int32)
    count = 0
    for t in range(n):
        open_edges = 0
        for e in range(3 * t, 3 * t + 3):
            open_edges += twin[e] >= 0
        if open_edges > 1:
            out[count] = t
            count += 1
        elif open_edges == 1:
            for e in range(3 * t, 3 * t + 3):
                if twin[e] >= 0:
                    inbox[twin[e]] = cost[e] - FORBIDDEN
    return out[:count]


@njit(nogil=True, cache=True, _nrt=False)
def sweep(forwards, active, twin, cost, inbox):
    """Let the triangles of a list send their messages, in order or in reverse."""
    n = len(active)
    share = 1.0 - DAMPING
    if forwards:
        for k in range(n):
            _send(active[k], twin, cost, inbox, share)
    else:
        for k in range(n - 1, -1, -1):
            _send(active[k], twin, cost, inbox, share)


@njit(nogil=True, cache=True, _nrt=False)
def _favourite(t, twin, score, mate):
    """Return the edge across which a triangle would best join one that is free, or -1."""
    best, least = -1, np.inf
    for e in range(3 * t, 3 * t + 3):
        g = twin[e]
        if g >= 0 and mate[g // 3] < 0 and score[e] + score[g] < least:
            best, least = e, score[e] + score[g]
    return best


@njit(nogil=True, cache=True, _nrt=True)
def joined_by_belief(twin, cost, inbox, mate):
    """Join triangles that prefer each other, until no two free ones are neighbours."""
    n = len(mate)
    score = inbox - 0.5 * cost
    active = np.arange(n).astype(np.int32)
    n_active = n
    while n_active > 0:
        kept = 0
        for k in range(n_active):
            t = active[k]
            if mate[t] >= 0:
                continue
            e = _favourite(t, twin, score, mate)
            if e < 0:
                continue
            u = twin[e] // 3
            if _favourite(u, twin, score, mate) == twin[e]:
                mate[t], mate[u] = u, t
            else:
                active[kept] = t
                kept += 1
        n_active = kept


@njit(nogil=True, cache=True, _nrt=True)
def quads_of(triangles, twin, mate):
    """Return the quadrilaterals of a perfect matching, counter-clockwise."""
    quads = np.empty((len(mate) // 2, 4), dtype=np.int32)
    n = 0
    for t in range(len(mate)):
        if mate[t] > t:
            for i in range(3):
                g = twin[3 * t + i]
                if g >= 0 and g // 3 == mate[t]:
                    quads[n, 0] = triangles[t, i]
                    quads[n, 1] = triangles[t, (i + 1) % 3]
                    quads[n, 2] = triangles[g // 3, g % 3]
                    quads[n, 3] = triangles[t, (i + 2) % 3]
                    n += 1
                    break
    return quads[:n]
