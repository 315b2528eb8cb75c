"""The operations on the connectivity: what each takes away and puts in, and its change of valence energy.

An operation is named by its kind, the code 4 q + k of a corner and an argument:

- DOUBLET: the two elements around the corner's node become one;
- COLLAPSE: the element vanishes, the corner's node and its opposite become one (diamond collapse);
- SWAP: the edge from the corner's node to the next is replaced by one of the two others that cut the hexagon of its
  two elements (argument 0: turned clockwise, 1: counter-clockwise);
- ROTATE: edges and diagonals around the corner's node change places;
- OPEN: the corner's node is split along the path over its neighbour next to the corner and the one ``argument``
  elements further; a new element fills the gap;
- PILLOW: the element gets a copy of itself inside and four elements around that.

Builders fill ``old``, ``new`` and ``spots`` (node, x, y of nodes that begin elsewhere) and return the number of old
elements, new elements and spots; no old element means that the operation is impossible.
"""

from __future__ import annotations

import numpy as np

from sizeviz.improvement._cavity_kernels import fan
from sizeviz.improvement._jit import compiled
from sizeviz.improvement._mesh_kernels import find_next, linked

DOUBLET, COLLAPSE, SWAP, ROTATE, OPEN, PILLOW = (np.int64(kind) for kind in range(6))
CLOCKWISE, COUNTER = np.int64(0), np.int64(1)
LOSS, NONE, GAIN = np.int64(-1), np.int64(0), np.int64(1)
"""Typed, as are the kinds, because a literal argument would make numba compile one more variant of a kernel."""
DEGENERATE = 10_000
"""Extra energy of an inner node with two elements, and of a flat boundary node with one: they must go."""
APART, TOGETHER = 0.5, 0.2
"""Where nodes of a turned edge begin, over their distance from its middle."""


@compiled
def node_energy(count, ideal, boundary):
    """Return the valence energy of a node with ``count`` elements where ``ideal`` are wanted."""
    off = count - ideal
    energy = off * off
    if (not boundary and count < 3) or (boundary and count < 2 <= ideal):
        energy += DEGENERATE
    return energy


@compiled
def inner_energy(count):
    """Return the valence energy of an inner node."""
    off = count - 4
    return off * off if count > 2 else off * off + DEGENERATE


@compiled
def gain(v, change, count, ideal, boundary):
    """Return the change of a node's energy when its number of elements changes."""
    now, wanted = np.int64(count[v]), np.int64(ideal[v])
    return node_energy(now + change, wanted, boundary[v]) - node_energy(now, wanted, boundary[v])


@compiled
def put(new, i, a, b, c, d):
    """Write the corners of new element i."""
    new[i, 0], new[i, 1], new[i, 2], new[i, 3] = a, b, c, d


@compiled
def build_doublet(code, patch, old, new):
    """Join the two elements around an inner node."""
    _, quads, ring, count = patch
    v = quads[code >> 2, code & 3]
    if count[v] != 2:
        return 0, 0, 0
    first, second = ring[v, 0], ring[v, 1]
    q, k = first >> 2, first & 3
    a, b, c = quads[q, (k + 1) & 3], quads[q, (k + 2) & 3], quads[q, (k + 3) & 3]
    d = quads[second >> 2, ((second & 3) + 2) & 3]
    if d == b:
        return 0, 0, 0
    old[0], old[1] = first >> 2, second >> 2
    put(new, np.int64(0), np.int64(a), np.int64(b), np.int64(c), np.int64(d))
    return 2, 1, 0


@compiled
def touch(a, c, b, d, patch):
    """Say whether a and c, opposite in (a, b, c, d), meet elsewhere, so that they cannot become one."""
    _, quads, ring, count = patch
    shared = 0
    for i in range(count[c]):
        q = ring[c, i] >> 2
        for k in range(4):
            if quads[q, k] == a:
                shared += 1
    if shared > 1:
        return True
    for i in range(count[a]):
        for s in (1, 3):
            w = quads[ring[a, i] >> 2, ((ring[a, i] & 3) + s) & 3]
            if w == b or w == d:
                continue
            for j in range(count[c]):
                q, k = ring[c, j] >> 2, ring[c, j] & 3
                if w == quads[q, (k + 1) & 3] or w == quads[q, (k + 3) & 3]:
                    return True
    return False


@compiled
def build_collapse(code, patch, guard, old, new, spots):
    """Make the corner's node and its opposite one, at the one that may not move or between the two."""
    xy, quads, ring, count = patch
    q, k = code >> 2, code & 3
    a, b, c, d = quads[q, k], quads[q, (k + 1) & 3], quads[q, (k + 2) & 3], quads[q, (k + 3) & 3]
    if guard[c]:
        a, c = c, a
    if guard[c] or touch(a, c, b, d, patch) or count[c] > len(old):
        return 0, 0, 0
    n_old = n_new = 0
    for i in range(count[c]):
        other = ring[c, i] >> 2
        old[n_old] = other
        n_old += 1
        if other != q:
            for s in range(4):
                w = quads[other, s]
                new[n_new, s] = a if w == c else w
            n_new += 1
    if guard[a]:
        return n_old, n_new, 0
    spots[0, 0], spots[0, 1], spots[0, 2] = a, 0.5 * (xy[a, 0] + xy[c, 0]), 0.5 * (xy[a, 1] + xy[c, 1])
    return n_old, n_new, 1


@compiled
def hexagon(code, patch):
    """Return the other element's number and the six nodes counter-clockwise from the edge's start, or -1."""
    _, quads, ring, count = patch
    q, k = code >> 2, code & 3
    v, w = np.int64(quads[q, k]), np.int64(quads[q, (k + 1) & 3])
    x1, x2 = np.int64(quads[q, (k + 2) & 3]), np.int64(quads[q, (k + 3) & 3])
    other = np.int64(find_next(w, v, quads, ring, count))
    if other < 0:
        return other, v, v, v, w, x1, x2
    p, s = other >> 2, other & 3
    return p, v, np.int64(quads[p, (s + 2) & 3]), np.int64(quads[p, (s + 3) & 3]), w, x1, x2


@compiled
def spread(v, w, s, t, xy, guard, spots):
    """Place the ends v, w of the old edge further apart and those of the new one, s and t, nearer; return how many.

    Turned within a rectangle of two squares, the new edge leaves flat corners at v and w, which would take the
    smoother half a dozen sweeps to open.
    """
    n = 0
    x, y = 0.5 * (xy[v, 0] + xy[w, 0]), 0.5 * (xy[v, 1] + xy[w, 1])
    for node, share in ((v, APART), (w, APART), (s, -TOGETHER), (t, -TOGETHER)):
        if not guard[node]:
            spots[n, 0] = node
            spots[n, 1] = xy[node, 0] + share * (xy[node, 0] - x)
            spots[n, 2] = xy[node, 1] + share * (xy[node, 1] - y)
            n += 1
    return n


@compiled
def build_swap(code, turn, patch, guard, links, old, new, spots):
    """Turn the edge between two elements within their hexagon, unless it lies on an inner line."""
    xy, quads, ring, count = patch
    other, v, y1, y2, w, x1, x2 = hexagon(code, patch)
    if other < 0 or linked(v, w, links):
        return 0, 0, 0
    s, t = (y1, x1) if turn == CLOCKWISE else (y2, x2)
    if s == x1 or s == x2 or t == y1 or t == y2:
        return 0, 0, 0
    if find_next(s, t, quads, ring, count) >= 0 or find_next(t, s, quads, ring, count) >= 0:
        return 0, 0, 0
    old[0], old[1] = code >> 2, other
    if turn == CLOCKWISE:
        put(new, np.int64(0), y1, y2, w, x1)
        put(new, np.int64(1), x1, x2, v, y1)
    else:
        put(new, np.int64(0), y2, w, x1, x2)
        put(new, np.int64(1), x2, v, y1, y2)
    return 2, 2, spread(v, w, s, t, xy, guard, spots)


@compiled
def build_rotate(code, patch, guard, boundary, old, new, work):
    """Exchange the edges and the diagonals around an inner node; ``work`` is the room of ``fan``."""
    quads = patch[1]
    v = np.int64(quads[code >> 2, code & 3])
    if guard[v]:
        return 0, 0, 0
    nodes, across, codes = work
    m = fan(v, patch, boundary, nodes, across, codes)
    if m < 3:
        return 0, 0, 0
    for j in range(m):
        old[j] = codes[j] >> 2
        put(new, j, v, across[j], nodes[j + 1], across[(j + 1) % m])
    return m, m, 0


@compiled
def build_open(code, k, born, patch, guard, boundary, old, new, spots, work):
    """Split an inner node: ``born`` takes the elements beyond the ``k`` that begin at the corner."""
    xy, quads = patch[0], patch[1]
    v = np.int64(quads[code >> 2, code & 3])
    nodes, across, codes = work
    if guard[v] or born < 0:
        return 0, 0, 0
    m = fan(v, patch, boundary, nodes, across, codes)
    first = 0
    while first < m and codes[first] != code:
        first += 1
    if m < 4 or first >= m or k < 2 or m - k < 2:
        return 0, 0, 0
    a, b = nodes[first], nodes[(first + k) % m]
    put(new, NONE, a, v, b, born)
    ux = uy = wx = wy = 0.0
    for j in range(m):
        i = (first + j) % m
        dx, dy = xy[across[i], 0] - xy[v, 0], xy[across[i], 1] - xy[v, 1]
        if j < k:
            ux, uy = ux + dx / k, uy + dy / k
            continue
        wx, wy = wx + dx / (m - k), wy + dy / (m - k)
        q = codes[i] >> 2
        old[j - k] = q
        for s in range(4):
            new[j - k + 1, s] = born if quads[q, s] == v else quads[q, s]
    spots[0, 0], spots[0, 1], spots[0, 2] = v, xy[v, 0] + 0.25 * ux, xy[v, 1] + 0.25 * uy
    spots[1, 0], spots[1, 1], spots[1, 2] = born, xy[v, 0] + 0.25 * wx, xy[v, 1] + 0.25 * wy
    return m - k, m - k + 1, 2


@compiled
def build_pillow(code, births, patch, old, new, spots):
    """Put a smaller copy of the element inside it; ``births`` are its four new nodes."""
    xy, quads = patch[0], patch[1]
    q = code >> 2
    if births[3] < 0:
        return 0, 0, 0
    x = y = 0.0
    for k in range(4):
        x, y = x + 0.25 * xy[quads[q, k], 0], y + 0.25 * xy[quads[q, k], 1]
    for k in range(4):
        after = (k + 1) & 3
        spots[k, 0] = births[k]
        spots[k, 1], spots[k, 2] = 0.5 * (x + xy[quads[q, k], 0]), 0.5 * (y + xy[quads[q, k], 1])
        put(new, k, np.int64(quads[q, k]), np.int64(quads[q, after]), births[after], births[k])
    put(new, np.int64(4), births[0], births[1], births[2], births[3])
    old[0] = q
    return 1, 5, 4
