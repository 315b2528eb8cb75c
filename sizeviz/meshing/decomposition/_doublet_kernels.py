"""One pass over the nodes that two quadrilaterals share."""

import numpy as np
from numba import njit

from sizeviz.meshing.decomposition._loop_kernels import worst_corner

FLATTEST = 0.05
"""A merged element's worst corner must be better than this, or the doublet stays for smoothing to open."""


@njit(nogil=True, cache=True)
def _owners(quads, n):
    """Return the number of elements at each node, and the first two of them."""
    count, owner = np.zeros(n, dtype=np.int32), np.full((n, 2), -1, dtype=np.int32)
    for e in range(len(quads)):
        for c in range(4):
            v = quads[e, c]
            if count[v] < 2:
                owner[v, count[v]] = e
            count[v] += 1
    return count, owner


@njit(nogil=True, cache=True)
def _corner_of(quads, e, v):
    for c in range(4):
        if quads[e, c] == v:
            return c
    return -1


@njit(nogil=True, cache=True)
def merge(points, quads, kept):
    """Merge doublets that do not touch each other; the second element of each becomes -1. Return their number."""
    count, owner = _owners(quads, len(points))
    merged = 0
    for v in range(len(points)):
        if count[v] != 2 or kept[v]:
            continue
        e, f = owner[v, 0], owner[v, 1]
        c, d = _corner_of(quads, e, v), _corner_of(quads, f, v)
        if c < 0 or d < 0:  # merged away in this pass
            continue
        a, b, opposite, other = (
            quads[e, (c + 1) % 4],
            quads[e, (c + 3) % 4],
            quads[e, (c + 2) % 4],
            quads[f, (d + 2) % 4],
        )
        if opposite == other or quads[f, (d + 1) % 4] != b or quads[f, (d + 3) % 4] != a:
            continue
        if worst_corner(points[other], points[a], points[opposite], points[b]) <= FLATTEST:
            continue
        quads[e, 0], quads[e, 1], quads[e, 2], quads[e, 3] = other, a, opposite, b
        for k in range(4):
            quads[f, k] = -1
        merged += 1
    return merged
