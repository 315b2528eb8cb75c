"""Exchange of a few elements for others, with the adjacency kept up to date and an exact way back.

``patch`` is (xy, quads, ring, count); ``old`` and ``new`` list elements by number and by corners.
"""

from __future__ import annotations

from sizeviz.improvement._jit import compiled
from sizeviz.improvement._mesh_kernels import find_next

MOST_ELEMENTS = 24
"""Elements that one operation may take away or put in."""
MOST_CORE = 56
"""Nodes that one operation may touch."""


@compiled
def fan(v, patch, boundary, nodes, across, codes):
    """List the elements around node v counter-clockwise, from the boundary on where v lies there.

    Writes the corner codes, the m + 1 edge neighbours (the first again at the end inside the domain) and the
    opposite corners. Returns m, or -1 where the elements do not form one fan.
    """
    _, quads, ring, count = patch
    m = count[v]
    if m == 0 or m > MOST_ELEMENTS:
        return -1
    code = ring[v, 0]
    if boundary[v]:
        for j in range(m):
            first = quads[ring[v, j] >> 2, ((ring[v, j] & 3) + 1) & 3]
            if find_next(first, v, quads, ring, count) < 0:
                code = ring[v, j]
                break
    for j in range(m):
        q, k = code >> 2, code & 3
        codes[j], nodes[j], across[j] = code, quads[q, (k + 1) & 3], quads[q, (k + 2) & 3]
        nodes[j + 1] = quads[q, (k + 3) & 3]
        if j + 1 < m:
            code = find_next(v, nodes[j + 1], quads, ring, count)
            if code < 0:
                return -1
    if boundary[v] != (nodes[m] != nodes[0]):
        return -1
    return m


@compiled
def add_once(node, nodes, n):
    """Append a node to a short list unless it is there; return the new length."""
    for j in range(n):
        if nodes[j] == node:
            return n
    if n < len(nodes):
        nodes[n] = node
    return n + 1


@compiled
def core_nodes(old, n_old, new, n_new, quads, core):
    """List the nodes of the old and the new elements; return their number, which may exceed the room."""
    n = 0
    for i in range(n_old):
        for k in range(4):
            n = add_once(quads[old[i], k], core, n)
    for i in range(n_new):
        for k in range(4):
            n = add_once(new[i, k], core, n)
    return n


@compiled
def remove_corner(v, code, ring, count):
    """Take one corner off the list around node v."""
    last = count[v] - 1
    for j in range(last + 1):
        if ring[v, j] == code:
            ring[v, j] = ring[v, last]
            count[v] = last
            return


@compiled
def exchange(old, n_old, new, n_new, slots, patch):
    """Replace elements ``old`` by ``new``, which take the rows ``slots``; False where a node's list is full."""
    _, quads, ring, count = patch
    for i in range(n_old):
        q = old[i]
        for k in range(4):
            remove_corner(quads[q, k], 4 * q + k, ring, count)
        quads[q, 0] = -1
    fits = True
    for i in range(n_new):
        q = slots[i]
        for k in range(4):
            v = new[i, k]
            quads[q, k] = v
            if count[v] < ring.shape[1]:
                ring[v, count[v]] = 4 * q + k
                count[v] += 1
            else:
                fits = False
    return fits


@compiled
def copy_row(source, i, target, j):
    """Copy row i of one table to row j of another of the same width."""
    for k in range(source.shape[1]):
        target[j, k] = source[i, k]


@compiled
def save_links(old, n_old, core, n_core, patch, kept):
    """Copy what ``exchange`` is about to change; ``kept`` is (element rows, adjacency rows, counts)."""
    _, quads, ring, count = patch
    for i in range(n_old):
        copy_row(quads, old[i], kept[0], i)
    for i in range(n_core):
        copy_row(ring, core[i], kept[1], i)
        kept[2][i] = count[core[i]]


@compiled
def restore_links(old, n_old, core, n_core, slots, n_new, patch, kept):
    """Put back, bit for bit, what ``save_links`` copied."""
    _, quads, ring, count = patch
    for i in range(n_new):
        quads[slots[i], 0] = -1
    for i in range(n_old):
        copy_row(kept[0], i, quads, old[i])
    for i in range(n_core):
        copy_row(kept[1], i, ring, core[i])
        count[core[i]] = kept[2][i]
