"""Delaunay triangulations of points in the plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry import _constraint_kernels as constraints
from sizeviz.geometry import _delaunay_kernels as kernels
from sizeviz.geometry.arrays import as_cells, as_points, read_only
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
    locked : (T, 3) bool
        Whether the edge opposite each corner is (part of) a constrained segment.
    same_as : (N,) int32
        For a point that coincides with another, the one that stands for it; -1 for all others.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    neighbours: NDArray[np.int32]
    locked: NDArray[np.bool_]
    same_as: NDArray[np.int32]


def delaunay(points: ArrayLike, segments: ArrayLike | None = None, monitor: Monitor = SILENT) -> NDArray[np.int32]:
    """Return the Delaunay triangles ``(T, 3)``, counter-clockwise, of points ``(N, 2)``; see `triangulated`."""
    return triangulated(points, segments, monitor=monitor).triangles


def triangulated(
    points: ArrayLike,
    segments: ArrayLike | None = None,
    *,
    bounding: ArrayLike | None = None,
    monitor: Monitor = SILENT,
) -> Triangulation:
    """Return the Delaunay triangulation of the points, constrained to hold the segments.

    Parameters
    ----------
    points : (N, 2) float64
        Any order; of points that coincide one is kept. Where all are collinear there are no triangles.
    segments : (S, 2) int, optional
        Pairs of points that edges must join; a segment that runs through further points becomes several edges.
    bounding : (S,) bool, optional
        Which segments bound the region; all of them by default. They must form closed loops. Triangles that an
        even number of them separates from infinity are left out. Without any, the convex hull is triangulated.
    monitor : Monitor
        Progress and cancel.

    Raises
    ------
    InputError
        If a coordinate is not finite, or two segments cross.

    Notes
    -----
    Insertion in a biased random order along a Hilbert curve, with exact predicates: expected time O(N log N).
    Bowyer (1981), DOI 10.1093/comjnl/24.2.162; Amenta, Choi, Rote (2003), DOI 10.1145/777792.777824;
    constraints by flips, Sloan (1993), DOI 10.1016/0045-7949(93)90239-A.
    """
    checked = as_points(points, "delaunay")
    n = len(checked)
    order = insertion_order(checked)
    ordered = checked[order]
    x, y = ordered[:, 0].copy(), ordered[:, 1].copy()
    corner, twin = np.empty(6 * n + 12, dtype=np.int32), np.empty(6 * n + 12, dtype=np.int32)
    same_as = np.full(n, -1, dtype=np.int32)
    count = _inserted(x, y, corner, twin, same_as, monitor)
    kept = np.full(n, -1, dtype=np.int32)
    copies = same_as >= 0
    kept[order[copies]] = order[same_as[copies]]
    locked = np.zeros(3 * count, dtype=np.uint8)
    keep = kernels.real(count, n, corner)
    if segments is not None and count:
        pairs = as_cells(segments, 2, n, "delaunay: segments")
        kinds = np.where(True if bounding is None else np.asarray(bounding, dtype=bool), 2, 1).astype(np.uint8)
        kinds = np.ascontiguousarray(np.broadcast_to(kinds, len(pairs)))
        rank = np.empty(n, dtype=np.int32)
        rank[order] = np.arange(n, dtype=np.int32)
        rank[kept >= 0] = rank[kept[kept >= 0]]
        _constrain(rank[pairs], kinds, (x, y, corner, twin, locked), count)
        if (kinds == constraints.BOUNDARY).any():
            keep = constraints.inside(count, n, corner, twin, locked)
    triangles, neighbours, lock = kernels.collected(keep, corner, twin, locked, order)
    return Triangulation(checked, *(read_only(a) for a in (triangles, neighbours, lock, kept)))


def _inserted(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    corner: NDArray[np.int32],
    twin: NDArray[np.int32],
    same_as: NDArray[np.int32],
    monitor: Monitor,
) -> int:
    """Fill ``corner``, ``twin`` and ``same_as``; return the number of triangles, ghosts included."""
    n = len(x)
    first = kernels.first_triangle(x, y) if n >= 3 else (-1, -1, -1)
    if first[0] < 0:
        return 0
    state = np.zeros(kernels.STATE_SIZE, dtype=np.int64)
    kernels.begin(*first, n, corner, twin, state)
    same_as[list(first)] = -2
    work = [np.empty(2 * n + 4, dtype=np.int32) for _ in range(3)]
    for start in range(0, n, CHUNK):
        stop = min(start + CHUNK, n)
        kernels.insert(start, stop, x, y, corner, twin, state, same_as, *work)
        monitor.step(stop / n, "triangulating")
    return int(state[kernels.N_TRIANGLES])


def _constrain(
    pairs: NDArray[np.int32],
    kinds: NDArray[np.uint8],
    mesh: tuple[NDArray[Any], ...],
    count: int,
) -> None:
    """Recover the segments in place."""
    x, y, corner, twin, locked = mesh
    place = constraints.around(count, corner, len(x) + 1)
    code, where = constraints.recover(pairs, kinds, x, y, corner, twin, locked, place)
    if code != constraints.DONE:
        a, b = pairs[where]
        raise InputError(
            f"the segment from ({x[a]:g}, {y[a]:g}) to ({x[b]:g}, {y[b]:g}) crosses another one; "
            "mend the outline or the inner lines so that segments meet only at their ends"
        )


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
