"""Delaunay triangulations of points in the plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry import _delaunay_kernels as kernels
from sizeviz.geometry.arrays import as_points, read_only
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

CHUNK = 50_000
"""Points inserted between two steps of the monitor: about 30 ms."""


@dataclass(frozen=True, eq=False)
class Triangulation:
    """Triangles over a set of points, and who lies next to whom.

    Parameters
    ----------
    points : (N, 2) float64
        All points, also those that no triangle uses.
    triangles : (T, 3) int32
        Corners, counter-clockwise.
    neighbours : (T, 3) int32
        The triangle across the edge opposite each corner; -1 where there is none.
    same_as : (N,) int32
        For a point that coincides with another, the one that stands for it; -1 for all others.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    neighbours: NDArray[np.int32]
    same_as: NDArray[np.int32]


def delaunay(points: ArrayLike, monitor: Monitor = SILENT) -> NDArray[np.int32]:
    """Return the Delaunay triangles ``(T, 3)``, counter-clockwise, of points ``(N, 2)``; see `triangulated`."""
    return triangulated(points, monitor=monitor).triangles


def triangulated(points: ArrayLike, monitor: Monitor = SILENT) -> Triangulation:
    """Return the Delaunay triangulation of the points' convex hull.

    Parameters
    ----------
    points : (N, 2) float64
        Any order; of points that coincide one is kept. Where all are collinear there are no triangles.
    monitor : Monitor
        Progress and cancel.

    Raises
    ------
    InputError
        If a coordinate is not finite.

    Notes
    -----
    Insertion in a biased random order along a Hilbert curve, with exact predicates: expected time O(N log N).
    Bowyer (1981), DOI 10.1093/comjnl/24.2.162; Amenta, Choi, Rote (2003), DOI 10.1145/777792.777824.
    """
    checked = as_points(points, "delaunay")
    n = len(checked)
    order = insertion_order(checked)
    ordered = checked[order]
    x, y = ordered[:, 0].copy(), ordered[:, 1].copy()
    corner, twin = np.empty(6 * n + 12, dtype=np.int32), np.empty(6 * n + 12, dtype=np.int32)
    state = np.zeros(kernels.STATE_SIZE, dtype=np.int64)
    same_as = np.full(n, -1, dtype=np.int32)
    first = kernels.first_triangle(x, y) if n >= 3 else (-1, -1, -1)
    if first[0] < 0:
        empty = read_only(np.empty((0, 3), dtype=np.int32))
        return Triangulation(checked, empty, empty, read_only(same_as))
    kernels.begin(*first, n, corner, twin, state)
    same_as[list(first)] = -2
    work = [np.empty(2 * n + 4, dtype=np.int32) for _ in range(3)]
    for start in range(0, n, CHUNK):
        stop = min(start + CHUNK, n)
        kernels.insert(start, stop, x, y, corner, twin, state, same_as, *work)
        monitor.step(stop / n, "triangulating")
    triangles, neighbours = kernels.collected(n, int(state[kernels.N_TRIANGLES]), corner, twin, order)
    kept = np.full(n, -1, dtype=np.int32)
    copies = same_as >= 0
    kept[order[copies]] = order[same_as[copies]]
    return Triangulation(checked, read_only(triangles), read_only(neighbours), read_only(kept))


def hilbert_order(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the indices ``(N,)`` that sort points along a Hilbert curve over their bounding box."""
    keys, shift, _ = _keys(points)
    return _unpacked(keys, shift)


def insertion_order(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return a biased random insertion order ``(N,)``: rounds of doubling size, each along a Hilbert curve."""
    keys, shift, bits = _keys(points)
    kernels.with_rounds(keys, shift + 2 * bits, max(1, min(31, len(points).bit_length() - 6)))
    return _unpacked(keys, shift)


def _keys(points: NDArray[np.float64]) -> tuple[NDArray[np.uint64], int, int]:
    shift = max(1, len(points).bit_length())
    bits = min((64 - 5 - shift) // 2, 20)
    low = points.min(axis=0) if len(points) else np.zeros(2)
    extent = float((points.max(axis=0) - low).max()) if len(points) else 0.0
    scale = 2.0**bits / extent if extent > 0 else 0.0
    return kernels.hilbert_keys(points, low, scale, bits, shift), shift, bits


def _unpacked(keys: NDArray[np.uint64], shift: int) -> NDArray[np.int64]:
    keys.sort()
    return (keys & np.uint64((1 << shift) - 1)).astype(np.int64)
