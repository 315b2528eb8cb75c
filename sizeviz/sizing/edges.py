"""Gradient limiting and size preserving with distances along the edges of the background mesh.

Kept because the paper computes them so. Paths along edges are longer than straight lines, so both results are too
large, on a triangulated grid by a factor of up to sqrt 2; ``sizing.envelopes`` goes straight unless told otherwise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry.arrays import read_only
from sizeviz.monitor import SILENT, Monitor
from sizeviz.threads import default_threads, run_chunks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.sizing.background import BackgroundMesh
    from sizeviz.sizing.field import SizeField

ENTRIES_A_CHUNK = 100_000
"""Heap entries taken between two steps of the monitor."""


def edge_graph(background: BackgroundMesh) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.float64]]:
    """Return the edges of a background mesh, by node.

    Returns
    -------
    start : (V + 1,) int64
        Node i's edges are entries ``start[i]`` to ``start[i + 1]``.
    ends : (2 E,) int32
        Where each leads.
    lengths : (2 E,) float64
        How long it is, in model units.
    """
    corners, n_points = background.triangles.astype(np.int64), len(background.points)
    one, other = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    keys = np.unique(np.concatenate([one * n_points + other, other * n_points + one]))
    starts, ends = keys // n_points, keys % n_points
    start = np.searchsorted(starts, np.arange(n_points + 1))
    lengths = np.hypot(*(background.points[starts] - background.points[ends]).T)
    return read_only(start), read_only(ends.astype(np.int32)), read_only(lengths)


def limited_by_edges(field: SizeField, epsilon: float, monitor: Monitor = SILENT) -> NDArray[np.float64]:
    """Return nodal sizes whose slope along every background edge is at most epsilon, ``(V,)``."""
    from sizeviz.sizing._edge_kernels import settle  # here, so that a graph alone does not load numba

    start, ends, lengths = edge_graph(field.background)
    labels = field.sizes.copy()
    keys, nodes = np.empty(len(labels) + len(ends)), np.empty(len(labels) + len(ends), dtype=np.int64)
    order = np.argsort(labels, kind="stable")  # a sorted array is a heap
    keys[: len(order)], nodes[: len(order)] = labels[order], order
    count, total = len(order), len(order)
    while count:
        monitor.step(max(0.0, 1.0 - count / total), "Limiting the gradient along edges")
        count = settle(start, ends, lengths, epsilon, labels, keys, nodes, count, ENTRIES_A_CHUNK)
        total = max(total, count)
    monitor.step(1.0)
    return read_only(labels)


def preserved_by_edges(
    field: SizeField,
    alpha: float,
    beta: float,
    printed: bool = False,
    threads: int | None = None,
    monitor: Monitor = SILENT,
) -> NDArray[np.float64]:
    """Return the nodal sizes of Algorithms 1 and 2, ``(V,)``, of Ruiz-Gironés, Roca and Sarrate (2013).

    Parameters
    ----------
    field : SizeField
        The prescribed sizes.
    alpha, beta : float
        As in ``PreserveOptions``.
    printed : bool
        Whether to compute line 18 as it is printed, r (r - d) / (r - r') + r' (d - r') / (r - r'), which equals
        r + r' - d and jumps at both ends of its case, instead of with exchanged weights, which is r = d.
    threads : int, optional
        Worker threads; every core by default.
    monitor : Monitor
        Told of progress; may cancel.
    """
    from sizeviz.sizing._edge_kernels import shrink_balls

    start, ends, lengths = edge_graph(field.background)
    sizes = field.sizes
    out = np.empty(len(sizes))

    def fill(first: int, last: int) -> None:
        shrink_balls(start, ends, lengths, sizes, alpha, beta, printed, out, first, last)

    chunk = max(1000, len(sizes) // (64 * (threads or default_threads())))
    run_chunks(fill, len(sizes), chunk=chunk, threads=threads, monitor=monitor, message="Preserving sizes along edges")
    return read_only(out)
