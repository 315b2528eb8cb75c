"""One loop from many: cuts that join holes, inner lines and inner points to the loop around them.

A cut is passed twice, once on the way in and once on the way out, so the joined loop has an even number of edges
where the loops had one together, whatever the number on the cut. An inner line counts as a hole without area,
passed on both sides; an inner point as a line without length.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import MeshingError
from sizeviz.meshing.decomposition import _chord_kernels, _cut_kernels, _loop_kernels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sizeviz.sizing import SizeField

PAIRS = 1_000_000
"""About how many pairs of nodes are looked at for one cut."""


def joined(
    points: NDArray[np.float64], loops: Sequence[NDArray[np.int32]], size: SizeField, scale: float
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Return the points with those of the cuts added, and one loop that passes every given one.

    Parameters
    ----------
    points : (N, 2) float64
        Nodes.
    loops : sequence of (K,) int32
        The outer loop, then holes, lines there and back, single points; the region on the left of each.
    size : SizeField
        Sets the nodes on the cuts.
    scale : float
        Element size relative to the field.

    Raises
    ------
    MeshingError
        If a hole cannot be reached: loops cross each other.
    """
    main, *others = loops
    while others:
        points, main, done = _joined_once(points, main, others, size, scale)
        others.pop(done)
    return points, main


def _joined_once(
    points: NDArray[np.float64], main: NDArray[np.int32], others: list[NDArray[np.int32]], size: SizeField, scale: float
) -> tuple[NDArray[np.float64], NDArray[np.int32], int]:
    loops = [main, *others]
    starts = np.concatenate([[0], np.cumsum([len(loop) for loop in loops])])
    ids = np.concatenate(loops).astype(np.int32)
    xy, direction, angle, spacing = _measured(points, loops)
    low, high = points.min(axis=0), points.max(axis=0)
    stride = 1 + len(main) * (len(ids) - len(main)) // PAIRS
    a = b = -1
    for clearance in (0.3, 0.0):
        a, b = _cut_kernels.best_cut(
            ids, starts, xy, direction, angle, spacing, float(np.hypot(*(high - low))), stride, clearance
        )
        if a >= 0:
            break
    if a < 0:
        raise MeshingError("decomposition: a hole or inner line cannot be reached; do the domain's loops cross?")
    done = int(np.searchsorted(starts, b, side="right")) - 2
    extra = _cut_points(points[ids[a]], points[ids[b]], size, scale)
    cut = np.arange(len(points), len(points) + len(extra), dtype=np.int32)
    turned = np.roll(others[done], -(b - int(starts[done + 1])))
    closing = turned[:1] if len(turned) > 1 else turned[:0]
    loop = np.concatenate([main[: a + 1], cut, turned, closing, cut[::-1], main[a:]])
    return np.vstack([points, extra]), loop.astype(np.int32), done


def _measured(points: NDArray[np.float64], loops: list[NDArray[np.int32]]) -> tuple[NDArray[np.float64], ...]:
    parts = []
    for loop in loops:
        n = len(loop)
        part = np.empty((n, 2)), np.empty(n), np.empty(n), np.empty(n)
        _loop_kernels.unpack(loop, n, points, *part)
        if n == 1:  # a point is open on every side
            part[2][:] = 2.0 * np.pi
        parts.append(part)
    return tuple(np.concatenate([part[k] for part in parts]) for k in range(4))


def _cut_points(a: NDArray[np.float64], b: NDArray[np.float64], size: SizeField, scale: float) -> NDArray[np.float64]:
    count, _ = _chord_kernels.chord_count(size.sampler, scale, a[0], a[1], b[0], b[1], 0)
    edges = max(1, round(count))
    extra = np.empty((edges - 1, 2))
    _chord_kernels.place(size.sampler, scale, a[0], a[1], b[0], b[1], edges, extra, 0, 0)
    return extra
