"""Diagonals exchanged where the triangles as they are cannot all be joined in pairs.

The usual obstacle is a triangle with two neighbours that have no other neighbour, such as two sharp corners side by
side: no matching serves both, but another diagonal does.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry.arrays import read_only
from sizeviz.geometry.predicates import orientations
from sizeviz.meshing.frontal.pairing import paired
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sizeviz.geometry.delaunay import Triangulation

MOST_TRIES = 40
"""Diagonals tried before giving up: each costs a pairing."""

LARGEST = 200_000
"""Above this number of triangles no diagonal is tried: the time is better spent on splitting a coarser mesh."""


def mended(
    mesh: Triangulation, monitor: Monitor = SILENT
) -> tuple[Triangulation, NDArray[np.int32], NDArray[np.int32]]:
    """Pair the triangles, exchanging diagonals as long as that leaves fewer of them single.

    Parameters
    ----------
    mesh : Triangulation
        Triangles.
    monitor : Monitor
        Progress and cancel.

    Returns
    -------
    mesh : Triangulation
        The triangles that were paired.
    quads : (Q, 4) int32
        Their pairs.
    single : (S,) int32
        Those left over, usually none.
    """
    quads, single = paired(mesh, monitor, strict=True)
    mesh, quads, single = _with_flips(mesh, quads, single, monitor, strict=True)
    if len(single):
        quads, single = paired(mesh, monitor)
        mesh, quads, single = _with_flips(mesh, quads, single, monitor, strict=False)
    return mesh, quads, single


def _with_flips(
    mesh: Triangulation, quads: NDArray[np.int32], single: NDArray[np.int32], monitor: Monitor, *, strict: bool
) -> tuple[Triangulation, NDArray[np.int32], NDArray[np.int32]]:
    """Exchange diagonals as long as that leaves fewer triangles single."""
    if len(mesh.triangles) > LARGEST:
        return mesh, quads, single
    tried: set[tuple[int, int]] = set()
    progress = True
    while progress and len(single) and len(tried) < MOST_TRIES:
        progress = False
        for t, i in _suspects(mesh, single):
            key = (min(t, int(mesh.neighbours[t, i])), max(t, int(mesh.neighbours[t, i])))
            if key in tried or len(tried) >= MOST_TRIES:
                continue
            tried.add(key)
            other = flipped(mesh, t, i)
            if other is None:
                continue
            monitor.step(0.95, "joining triangles")
            other_quads, other_single = paired(other, strict=strict)
            if len(other_single) < len(single):
                mesh, quads, single, progress = other, other_quads, other_single, True
                break
    return mesh, quads, single


def _suspects(mesh: Triangulation, single: NDArray[np.int32]) -> Iterator[tuple[int, int]]:
    """Name the edges to try: of triangles with one neighbour, then of the single ones and of those beside them."""
    open_edges = (mesh.neighbours >= 0) & ~mesh.locked
    ears = np.flatnonzero(open_edges.sum(axis=1) == 1)
    beside = mesh.neighbours[single].ravel()
    for group in (ears, single, beside[beside >= 0]):
        for t in group:
            for i in np.flatnonzero(open_edges[t]):
                yield int(t), int(i)


def flipped(mesh: Triangulation, t: int, i: int) -> Triangulation | None:
    """Return the triangulation with the edge opposite corner i of triangle t exchanged for the other diagonal.

    None where the two triangles beside it do not form a strictly convex quadrilateral.
    """
    u = int(mesh.neighbours[t, i])
    j = int(np.flatnonzero(mesh.neighbours[u] == t)[0])
    p, a, b = (int(mesh.triangles[t, (i + k) % 3]) for k in range(3))
    q = int(mesh.triangles[u, j])
    at = mesh.points
    if not (orientations(at[p], at[a], at[q])[0] > 0 and orientations(at[q], at[b], at[p])[0] > 0):
        return None
    triangles, neighbours, locked = mesh.triangles.copy(), mesh.neighbours.copy(), mesh.locked.copy()
    # around the quadrilateral p a q b: edges pa, bp belong to t, aq, qb to u
    sides = {
        "bp": (neighbours[t, (i + 1) % 3], locked[t, (i + 1) % 3]),
        "pa": (neighbours[t, (i + 2) % 3], locked[t, (i + 2) % 3]),
        "aq": (neighbours[u, (j + 1) % 3], locked[u, (j + 1) % 3]),
        "qb": (neighbours[u, (j + 2) % 3], locked[u, (j + 2) % 3]),
    }
    triangles[t], triangles[u] = (p, a, q), (q, b, p)
    for row, (first, second) in ((t, ("aq", "pa")), (u, ("bp", "qb"))):
        neighbours[row] = (sides[first][0], u if row == t else t, sides[second][0])
        locked[row] = (sides[first][1], False, sides[second][1])
    for name, old, new in (("aq", u, t), ("bp", t, u)):
        beyond = int(sides[name][0])
        if beyond >= 0:
            neighbours[beyond, neighbours[beyond] == old] = new
    return replace(mesh, triangles=read_only(triangles), neighbours=read_only(neighbours), locked=read_only(locked))
