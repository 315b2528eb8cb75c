"""The edges of a mesh, by counting sort over their lower nodes."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(nogil=True, cache=True)
def _sort(values, start, stop):
    """Sort a short stretch in place, by insertion."""
    for i in range(start + 1, stop):
        value, j = values[i], i - 1
        while j >= start and values[j] > value:
            values[j + 1] = values[j]
            j -= 1
        values[j + 1] = value


@njit(nogil=True, cache=True)
def distinct_edges(cells, n_nodes):
    """Return each edge once, lower node first, sorted; and how many times the cells (M, k) name it."""
    m, corners = cells.shape
    start = np.zeros(n_nodes + 1, dtype=np.int64)
    for c in range(m):
        for i in range(corners):
            start[min(cells[c, i], cells[c, (i + 1) % corners]) + 1] += 1
    for v in range(n_nodes):
        start[v + 1] += start[v]
    high = np.empty(m * corners, dtype=np.int32)
    at = start[:-1].copy()
    for c in range(m):
        for i in range(corners):
            a, b = cells[c, i], cells[c, (i + 1) % corners]
            low = min(a, b)
            high[at[low]] = max(a, b)
            at[low] += 1
    edges, count = np.empty((m * corners, 2), dtype=np.int32), np.zeros(m * corners, dtype=np.int32)
    n = 0
    for v in range(n_nodes):
        first = n
        _sort(high, start[v], start[v + 1])
        for k in range(start[v], start[v + 1]):
            h = high[k]
            if n > first and edges[n - 1, 1] == h:
                count[n - 1] += 1
            else:
                edges[n, 0], edges[n, 1], count[n] = v, h, 1
                n += 1
    return edges[:n].copy(), count[:n].copy()
