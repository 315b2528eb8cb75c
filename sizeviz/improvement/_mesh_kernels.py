"""Adjacency, order along a Hilbert curve, and blocks of nodes that may move at the same time."""

from __future__ import annotations

import math

import numpy as np

from sizeviz.improvement._jit import allocating, compiled, inlined

HILBERT_LEVELS = 16


@compiled
def hilbert_key(i, j, levels):
    """Return the position of cell (i, j) of a 2^levels grid along the Hilbert curve."""
    key = 0
    for level in range(levels - 1, -1, -1):
        bit = 1 << level
        right, up = (i & bit) != 0, (j & bit) != 0
        key = 4 * key + (3 if right and not up else 2 if right else 1 if up else 0)
        if not up:
            if right:
                i, j = ~i, ~j
            i, j = j, i
    return key


@allocating
def hilbert_keys(xy):
    """Return the Hilbert position of each point within the bounding box of all, ``(N,) int64``."""
    n = len(xy)
    keys = np.empty(n, np.int64)
    if n == 0:
        return keys
    x0, x1, y0, y1 = xy[0, 0], xy[0, 0], xy[0, 1], xy[0, 1]
    for v in range(n):
        x0, x1 = min(x0, xy[v, 0]), max(x1, xy[v, 0])
        y0, y1 = min(y0, xy[v, 1]), max(y1, xy[v, 1])
    extent = max(x1 - x0, y1 - y0)
    cells = (1 << HILBERT_LEVELS) - 1
    scale = cells / extent if extent > 0.0 else 0.0
    for v in range(n):
        keys[v] = hilbert_key(int((xy[v, 0] - x0) * scale), int((xy[v, 1] - y0) * scale), HILBERT_LEVELS)
    return keys


@compiled
def corner_counts(quads, count):
    """Count the elements at each node."""
    count[:] = 0
    for q in range(len(quads)):
        if quads[q, 0] >= 0:
            for k in range(4):
                count[quads[q, k]] += 1


@compiled
def fill_rings(quads, ring, count):
    """Write the corners 4 q + k around each node, in the order of the elements."""
    count[:] = 0
    for q in range(len(quads)):
        if quads[q, 0] >= 0:
            for k in range(4):
                v = quads[q, k]
                ring[v, count[v]] = 4 * q + k
                count[v] += 1


@compiled
def find_next(v, w, quads, ring, count):
    """Return the corner around v whose next node is w, or -1: the element on the left of the edge v -> w."""
    for j in range(count[v]):
        code = ring[v, j]
        if quads[code >> 2, ((code & 3) + 1) & 3] == w:
            return code
    return -1


@inlined
def scattered(v):
    """Return 64 bits that say nothing of how close two numbers are, so that sums of them differ with their terms."""
    z = np.uint64(v + 1) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    return z ^ (z >> np.uint64(27))


@compiled
def mark_boundary(quads, ring, count, boundary):
    """Mark the nodes of edges that only one element has."""
    boundary[:] = False
    for v in range(len(count)):
        after = before = np.uint64(0)
        for j in range(count[v]):
            q, k = ring[v, j] >> 2, ring[v, j] & 3
            after += scattered(quads[q, (k + 1) & 3])
            before += scattered(quads[q, (k + 3) & 3])
        # around an inner node the elements' next nodes and their previous ones are the same
        boundary[v] = after != before


@allocating
def block_pairs(size, quads, n_blocks):
    """Return the blocks below each one that share an element with it, some more than once, and where each one's end."""
    split = np.empty(len(quads), np.int32)
    n = 0
    for q in range(len(quads)):
        if quads[q, 0] >= 0:
            b = quads[q, 0] // size
            if quads[q, 1] // size != b or quads[q, 2] // size != b or quads[q, 3] // size != b:
                split[n] = q
                n += 1
    ends = np.zeros(n_blocks + 2, np.int64)
    for turn in range(2):
        across = np.empty(ends[n_blocks + 1], np.int64)
        for i in range(n):
            for k in range(4):
                high = quads[split[i], k] // size
                for j in range(4):
                    low = quads[split[i], j] // size
                    if low < high:
                        if turn == 1:
                            across[ends[high + 1]] = low
                        ends[high + (2 if turn == 0 else 1)] += 1
        if turn == 0:
            for b in range(n_blocks + 1):
                ends[b + 1] += ends[b]
    return across, ends


@allocating
def colour_blocks(size, quads, colour):
    """Give each block of ``size`` consecutive nodes a colour that no block sharing an element with it has.

    Returns the number of colours. Blocks of one colour read and write disjoint nodes.
    """
    across, ends = block_pairs(size, quads, len(colour))
    colour[:] = -1
    taken = np.full(len(colour) + 1, -1, np.int64)
    most = 0
    for b in range(len(colour)):
        for i in range(ends[b], ends[b + 1]):
            taken[colour[across[i]]] = b
        c = 0
        while taken[c] == b:
            c += 1
        colour[b] = c
        most = max(most, c + 1)
    return most


@compiled
def corner_angle(code, xy, quads):
    """Return the angle of an element's corner, in radians, -pi / 2 to 3 pi / 2."""
    q, k = code >> 2, code & 3
    v, n, p = quads[q, k], quads[q, (k + 1) & 3], quads[q, (k + 3) & 3]
    ax, ay, bx, by = xy[n, 0] - xy[v, 0], xy[n, 1] - xy[v, 1], xy[p, 0] - xy[v, 0], xy[p, 1] - xy[v, 1]
    turn = math.atan2(ax * by - ay * bx, ax * bx + ay * by)
    # a straight side seen from one element may come out as minus pi
    return turn if turn > -0.5 * math.pi else turn + 2.0 * math.pi


@compiled
def linked(v, w, links):
    """Say whether the edge between two nodes lies on an inner line; row v of ``links`` names its neighbours there."""
    for j in range(links.shape[1]):
        if links[v, j] == w:
            return True
    return False


@compiled
def sector_counts(v, patch, links):
    """Return the elements wanted at a node in all its sectors, which the boundary and inner lines bound."""
    xy, quads, ring, count = patch
    wanted = 0
    for j in range(count[v]):
        start = ring[v, j]
        w = quads[start >> 2, ((start & 3) + 1) & 3]
        if not linked(v, w, links) and find_next(w, v, quads, ring, count) >= 0:
            continue
        angle, code = 0.0, start
        for _ in range(count[v]):
            angle += corner_angle(code, xy, quads)
            last = quads[code >> 2, ((code & 3) + 3) & 3]
            code = find_next(v, last, quads, ring, count)
            if code < 0 or linked(v, last, links):
                break
        wanted += max(1, round(angle / (0.5 * math.pi)))
    return wanted


@compiled
def ideal_counts(patch, boundary, links, ideal):
    """Write the number of elements wanted at each node: 4 inside, one for each right angle between fixed edges."""
    xy, quads, ring, count = patch
    for v in range(len(count)):
        ideal[v] = 4
        if links[v, 0] >= 0:
            wanted = sector_counts(v, patch, links)
            ideal[v] = wanted if wanted > 0 else 4
        elif boundary[v]:
            angle = 0.0
            for j in range(count[v]):
                angle += corner_angle(ring[v, j], xy, quads)
            ideal[v] = max(1, round(angle / (0.5 * math.pi)))


@compiled
def own_nodes(tile_of, patch, zone):
    """Write to each node its tile where every node around it has the same, else -1."""
    _, quads, ring, count = patch
    for v in range(len(count)):
        zone[v] = tile_of[v]
        for j in range(count[v]):
            for k in range(4):
                if tile_of[quads[ring[v, j] >> 2, k]] != tile_of[v]:
                    zone[v] = -1


@allocating
def order_by_lowest(quads, n_nodes):
    """Return the elements sorted by the lowest number among their corners, equal ones as they come, ``(Q,) int64``."""
    start = np.zeros(n_nodes + 1, np.int64)
    lowest = np.empty(len(quads), np.int32)
    for q in range(len(quads)):
        lowest[q] = min(min(quads[q, 0], quads[q, 1]), min(quads[q, 2], quads[q, 3]))
        start[lowest[q] + 1] += 1
    for v in range(n_nodes):
        start[v + 1] += start[v]
    order = np.empty(len(quads), np.int64)
    for q in range(len(quads)):
        order[start[lowest[q]]] = q
        start[lowest[q]] += 1
    return order
