"""Stations along a curve at which the integral of 1 / size passes whole numbers."""

from __future__ import annotations

import numpy as np
from numba import njit

from sizeviz.sizing._kernels import size_at

STRIDE = 0.1


@njit(nogil=True, cache=True)
def _point(points, stations, s, k):
    """Return the point at arc length s, searching onwards from vertex k, and that vertex."""
    while k < len(stations) - 2 and stations[k + 1] <= s:
        k += 1
    share = (s - stations[k]) / (stations[k + 1] - stations[k])
    share = min(max(share, 0.0), 1.0)
    a, b = points[k], points[k + 1]
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), k


@njit(nogil=True, cache=True)
def marched(points, stations, begin, end, sampler, scale):
    """March from one arc length to another in steps of a tenth of the size; return the stops and the integral there.

    Parameters
    ----------
    points : (K, 2) float64
        Vertices of the curve, the first repeated at the end where it is closed.
    stations : (K,) float64
        Their arc lengths.
    """
    capacity = 256
    stops, totals = np.empty(capacity), np.empty(capacity)
    x, y, k = _point(points, stations, begin, 0)
    size, hint = size_at(sampler, x, y, 0)
    size *= scale
    s, total, n = begin, 0.0, 1
    stops[0], totals[0] = begin, 0.0
    while s < end:
        step = min(STRIDE * size, end - s)
        while True:
            x, y, k_next = _point(points, stations, s + step, k)
            ahead, hint = size_at(sampler, x, y, hint)
            ahead *= scale
            if step <= 2.0 * STRIDE * ahead:
                break
            step *= 0.5
        s = end if s + step >= end or s + step <= s else s + step
        total += 0.5 * step * (1.0 / size + 1.0 / ahead)
        size, k = ahead, k_next
        if n == capacity:
            capacity *= 2
            longer_stops, longer_totals = np.empty(capacity), np.empty(capacity)
            longer_stops[:n], longer_totals[:n] = stops, totals
            stops, totals = longer_stops, longer_totals
        stops[n], totals[n] = s, total
        n += 1
    return stops[:n], totals[:n]


@njit(nogil=True, cache=True)
def places(points, stations, at):
    """Return the points at ascending arc lengths."""
    out = np.empty((len(at), 2))
    k = 0
    for i in range(len(at)):
        out[i, 0], out[i, 1], k = _point(points, stations, at[i], k)
    return out
