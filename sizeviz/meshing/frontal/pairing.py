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

LONGEST = 20_000
"""How many triangles the search for one alternating path through blossoms may touch."""
LONGEST_AT_FIRST = 1000
"""The same as long as squares are kept whole: what finds no path then may break one up."""


def paired(
    mesh: Triangulation, monitor: Monitor = SILENT, *, strict: bool = False
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Join neighbouring triangles to quadrilaterals of high quality, across edges that are not locked.

    Parameters
    ----------
    mesh : Triangulation
        Triangles.
    monitor : Monitor
        Progress and cancel.
    strict : bool
        Whether to leave triangles single rather than bend an element around a node of a straight outline.

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
    every = kernels.joinable(mesh.neighbours, mesh.locked)
    cost = np.empty(3 * n)
    kernels.pair_costs(0, n, mesh.points, mesh.triangles, every, cost)
    convex = kernels.convex(mesh.points, mesh.triangles, mesh.locked, every)
    twin = kernels.squares_kept(convex, cost)
    inbox = np.where(twin < 0, kernels.FORBIDDEN, 0.0)
    active = kernels.undecided(twin, cost, inbox)
    for k in range(SWEEPS):
        kernels.sweep(k % 2 == 0, active, twin, cost, inbox)
        monitor.step(0.8 * (k + 1) / SWEEPS, "joining triangles")
    mate = np.full(n, -1, dtype=np.int32)
    kernels.joined_by_belief(twin, cost, inbox, mate)
    for allowed in (twin, convex) if strict else (twin, convex, every):
        if (mate < 0).any():
            _augment(allowed, mate, LONGEST_AT_FIRST if allowed is twin else LONGEST, monitor)
    return kernels.quads_of(mesh.triangles, every, mate), np.flatnonzero(mate < 0).astype(np.int32)


def _augment(twin: NDArray[np.int32], mate: NDArray[np.int32], most: int, monitor: Monitor) -> None:
    """Join the free triangles along alternating paths, as far as that is possible."""
    n = len(mate)
    root, parent, queue = (np.empty(n, dtype=np.int32) for _ in range(3))
    dead = np.empty(n, dtype=np.bool_)
    while matching.forest(twin, mate, root, parent, dead, queue):
        monitor.step(0.8, "joining triangles")
    free = np.flatnonzero(mate < 0).astype(np.int32)
    if len(free):
        work = np.zeros((n, matching.WORK_COLUMNS), dtype=np.int32)
        work[:, : matching.OUTER] = -1
        for k in range(len(free)):
            matching.augment(k, k + 1, free, most, twin, mate, work, parent, queue)
            monitor.step(0.9, "joining triangles")
