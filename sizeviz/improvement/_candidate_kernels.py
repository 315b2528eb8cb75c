"""Which operations near an irregular node would lower the valence energy, and by how much, without applying any."""

from __future__ import annotations

import numpy as np

from sizeviz.improvement._cavity_kernels import copy_row, fan
from sizeviz.improvement._jit import compiled
from sizeviz.improvement._mesh_kernels import linked
from sizeviz.improvement._operation_kernels import (
    CLOCKWISE,
    COLLAPSE,
    COUNTER,
    DOUBLET,
    GAIN,
    LOSS,
    NONE,
    OPEN,
    PILLOW,
    ROTATE,
    SWAP,
    gain,
    hexagon,
    inner_energy,
    node_energy,
)

MOST_CANDIDATES = 24
IMPOSSIBLE = np.int64(1 << 20)


@compiled
def offer(kind, code, arg, change, limit, found, n):
    """Insert an operation into the list sorted by its change of energy; return the new length."""
    if change > limit:
        return n
    at = n
    while at > 0 and found[at - 1, 3] > change:
        at -= 1
    if at >= len(found):
        return n
    last = min(n, len(found) - 1)
    for i in range(last, at, -1):
        copy_row(found, i - 1, found, i)
    found[at, 0], found[at, 1], found[at, 2], found[at, 3] = kind, code, arg, change
    return last + 1


@compiled
def collapse_change(a, c, b, d, count, topo):
    """Return the change of energy when opposite corners a and c become one, or a large number."""
    ideal, guard, boundary, _ = topo
    if guard[c]:
        a, c = c, a
    if guard[c]:
        return IMPOSSIBLE
    n_a, n_c, wanted = np.int64(count[a]), np.int64(count[c]), np.int64(ideal[a])
    merged = node_energy(n_a + n_c - 2, wanted, boundary[a])
    before = node_energy(n_a, wanted, boundary[a]) + inner_energy(n_c)
    return merged - before + gain(b, LOSS, count, ideal, boundary) + gain(d, LOSS, count, ideal, boundary)


@compiled
def swap_change(code, turn, patch, topo):
    """Return the change of energy when an edge is turned, or a large number where it cannot be."""
    ideal, _, boundary, links = topo
    other, v, y1, y2, w, x1, x2 = hexagon(code, patch)
    if other < 0 or linked(v, w, links):
        return IMPOSSIBLE
    s, t = (y1, x1) if turn == CLOCKWISE else (y2, x2)
    count = patch[3]
    change = gain(v, LOSS, count, ideal, boundary) + gain(w, LOSS, count, ideal, boundary)
    return change + gain(s, GAIN, count, ideal, boundary) + gain(t, GAIN, count, ideal, boundary)


@compiled
def offer_collapses(v, m, patch, topo, work, limit, found, n):
    """Offer both diagonals of every element around the node."""
    nodes, across, codes = work
    count = patch[3]
    for j in range(m):
        code = codes[j]
        change = collapse_change(v, across[j], nodes[j], nodes[j + 1], count, topo)
        n = offer(COLLAPSE, code, NONE, change, limit, found, n)
        change = collapse_change(nodes[j], nodes[j + 1], v, across[j], count, topo)
        n = offer(COLLAPSE, (code & ~3) | ((code + 1) & 3), NONE, change, limit, found, n)
    return n


@compiled
def offer_swaps(m, patch, topo, work, limit, found, n):
    """Offer to turn every edge of the node, and every edge opposite so that it ends there."""
    codes = work[2]
    for j in range(m):
        code = codes[j]
        for turn in (CLOCKWISE, COUNTER):
            n = offer(SWAP, code, turn, swap_change(code, turn, patch, topo), limit, found, n)
        after = (code & ~3) | ((code + 1) & 3)
        n = offer(SWAP, after, COUNTER, swap_change(after, COUNTER, patch, topo), limit, found, n)
        after = (code & ~3) | ((code + 2) & 3)
        n = offer(SWAP, after, CLOCKWISE, swap_change(after, CLOCKWISE, patch, topo), limit, found, n)
    return n


@compiled
def offer_opens(v, m, patch, topo, work, limit, found, n):
    """Offer every split of an inner node that leaves at least two elements on each side."""
    ideal, boundary = topo[0], topo[2]
    nodes, _, codes = work
    count = patch[3]
    before = inner_energy(m)
    for k in range(2, m // 2 + 1):
        split = inner_energy(k + 1) + inner_energy(m - k + 1) - before
        for j in range(m if 2 * k < m else k):
            change = split + gain(nodes[j], GAIN, count, ideal, boundary)
            change += gain(nodes[(j + k) % m], GAIN, count, ideal, boundary)
            n = offer(OPEN, codes[j], k, change, limit, found, n)
    return n


@compiled
def splits(v, patch, topo, work, limit, found):
    """List the splits of an inner node as ``candidates`` does, and nothing else."""
    if topo[1][v]:
        return NONE
    m = fan(v, patch, topo[2], work[0], work[1], work[2])
    if m < 4:
        return NONE
    return offer_opens(v, m, patch, topo, work, limit, found, NONE)


@compiled
def is_flat(v, a, b, xy):
    """Say whether the directions from v to two of its neighbours differ by more than 135 degrees."""
    ux, uy = xy[a, 0] - xy[v, 0], xy[a, 1] - xy[v, 1]
    wx, wy = xy[b, 0] - xy[v, 0], xy[b, 1] - xy[v, 1]
    dot = ux * wx + uy * wy
    return dot < 0.0 and 2.0 * dot * dot > (ux * ux + uy * uy) * (wx * wx + wy * wy)


@compiled
def candidates(v, patch, topo, work, limit, found):
    """List the operations near node v that change the energy by at most ``limit``, best first; return their number.

    ``topo`` is (ideal, guard, boundary, links): elements wanted at each node, whether it may not be removed or split,
    whether it lies on the boundary, its neighbours along inner lines. Rows of ``found`` are (kind, code, argument,
    change).
    """
    ideal, guard, boundary, _ = topo
    nodes, across, codes = work
    count = patch[3]
    m = fan(v, patch, boundary, nodes, across, codes)
    if m < 1:
        return 0
    if m == 2 and not guard[v]:
        change = gain(nodes[0], LOSS, count, ideal, boundary) + gain(nodes[1], LOSS, count, ideal, boundary)
        return offer(DOUBLET, codes[0], NONE, change - inner_energy(m), limit, found, NONE)
    n = offer_collapses(v, m, patch, topo, work, limit, found, NONE)
    n = offer_swaps(m, patch, topo, work, limit, found, n)
    if not guard[v]:
        n = offer_opens(v, m, patch, topo, work, limit, found, n)
        change = NONE
        for j in range(m):
            change += gain(nodes[j], LOSS, count, ideal, boundary) + gain(across[j], GAIN, count, ideal, boundary)
        n = offer(ROTATE, codes[0], NONE, change, limit, found, n)
    if m == 1 and boundary[v] and ideal[v] > 1:
        change = 4 + gain(v, GAIN, count, ideal, boundary)
        for w in (nodes[0], across[0], nodes[1]):
            change += gain(w, GAIN, count, ideal, boundary)
        n = offer(PILLOW, codes[0], NONE, change, limit, found, n)
    elif guard[v]:
        # a node that cannot move may have a single element where there is room for two, beside an inner line or in a
        # reentrant corner; no move betters its shape
        for j in range(m):
            if is_flat(v, nodes[j], nodes[j + 1], patch[0]):
                change = 4 + gain(v, GAIN, count, ideal, boundary)
                for w in (nodes[j], across[j], nodes[j + 1]):
                    change += gain(w, GAIN, count, ideal, boundary)
                n = offer(PILLOW, codes[j], NONE, change, limit, found, n)
    return n
