"""Triangles joined to quadrilaterals, so that none is left."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.meshing.frontal import _matching_kernels as matching
from sizeviz.meshing.frontal import _pairing_kernels as kernels
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry.delaunay import Triangulation

SWEEPS = 24
"""Rounds of messages; more change little."""

REACHES = (60, 600, 6000)
"""How many triangles a search for an alternating path may touch in each round; the last round has no limit."""

CHUNK = 200
"""Searches between two steps of the monitor."""


def paired(mesh: Triangulation, monitor: Monitor = SILENT) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Join neighbouring triangles to quadrilaterals of high quality, across edges that are not locked.

    Parameters
    ----------
    mesh : Triangulation
        Triangles.
    monitor : Monitor
        Progress and cancel.

    Returns
    -------
    quads : (Q, 4) int32
        Corners, counter-clockwise.
    single : (S,) int32
        Triangles that no matching can join; empty where a perfect matching exists.

    References
    ----------
    Bayati, Shah, Sharma (2008), DOI 10.1109/TIT.2007.915695; Edmonds (1965), DOI 10.4153/CJM-1965-045-4.
    """
    n = len(mesh.triangles)
    twin = kernels.joinable(mesh.neighbours, mesh.locked)
    cost = np.empty(3 * n)
    kernels.pair_costs(0, n, mesh.points, mesh.triangles, twin, cost)
    inbox = np.where(twin < 0, kernels.FORBIDDEN, 0.0)
    for k in range(SWEEPS):
        kernels.sweep(k % 2 == 0, twin, cost, inbox)
        monitor.step(0.8 * (k + 1) / SWEEPS, "joining triangles")
    mate = np.full(n, -1, dtype=np.int32)
    kernels.joined_by_belief(twin, cost, inbox, mate)
    _augment(twin, mate, monitor)
    return kernels.quads_of(mesh.triangles, twin, mate), np.flatnonzero(mate < 0).astype(np.int32)


def _augment(twin: NDArray[np.int32], mate: NDArray[np.int32], monitor: Monitor) -> None:
    """Join the free triangles along alternating paths, short ones first, as far as that is possible."""
    n = len(mate)
    work = np.zeros((n, matching.WORK_COLUMNS), dtype=np.int32)
    work[:, : matching.OUTER] = -1
    touched, queue = np.empty(n, dtype=np.int32), np.empty(n, dtype=np.int32)
    for most in (*REACHES, n + 1):
        free = np.flatnonzero(mate < 0).astype(np.int32)
        for start in range(0, len(free), CHUNK):
            stop = min(start + CHUNK, len(free))
            matching.augment(start, stop, free, most, twin, mate, work, touched, queue)
            monitor.step(0.8, "joining triangles")
