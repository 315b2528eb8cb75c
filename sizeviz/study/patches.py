"""Parts of a mesh around the elements that could not be repaired, meshed and repaired again by themselves.

Between two looks at a large mesh all but a few hundred elements stay what they are. A patch is some rings of elements
around those that are left: its core is packed anew for smaller sizes, between the nodes along its own rim; then the
whole patch is cleaned up, smoothed and repaired like a mesh of its own whose outermost nodes do not move.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sizeviz.errors import MeshingError
from sizeviz.geometry import QuadMesh
from sizeviz.improvement import GuaranteeOptions, GuaranteeReport, guaranteed
from sizeviz.improvement.lines import line_pairs
from sizeviz.meshing.checks import edges_of
from sizeviz.meshing.frontal.refill import refilled
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sizing.part import part_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sizeviz.geometry import Domain
    from sizeviz.meshing import MeshOptions
    from sizeviz.sizing import SizeField, SizeFunction

MARGIN = 4
"""Rings of elements around a core that are cleaned up and smoothed with it."""
SHARP = np.deg2rad(62.0)
"""Elements in corners below this angle are what the corner allows, and are not replaced."""
FILLINGS = 4
"""How often the elements around nodes that a patch touches only with a corner are added to it."""


@dataclass(frozen=True, eq=False)
class Patch:
    """A part of a mesh.

    Parameters
    ----------
    rows : (R,) int64
        Its elements, in the mesh.
    nodes : (N,) int64
        Its nodes, in the mesh, ascending.
    rim : (N,) bool
        Which of them elements outside share.
    core : (R,) bool
        Which of the elements are replaced.
    """

    rows: NDArray[np.int64]
    nodes: NDArray[np.int64]
    rim: NDArray[np.bool_]
    core: NDArray[np.bool_]


def patches_around(mesh: QuadMesh, elements: NDArray[np.int64], rings: int) -> list[Patch]:
    """Return the parts of a mesh around some of its elements, in the order of their first elements.

    Parameters
    ----------
    mesh : QuadMesh
        The mesh.
    elements : (K,) int64
        What parts are wanted around; parts that meet are one.
    rings : int
        Rings of elements around each that its core consists of; ``MARGIN`` more make the part.
    """
    quads = mesh.quads
    inside = np.zeros(mesh.n_quads, dtype=bool)
    inside[elements] = True
    inside = _grown(mesh, inside, rings)
    core = inside & ~_in_sharp_corners(mesh, inside)
    inside = _grown(mesh, inside, MARGIN)
    for _ in range(FILLINGS):
        pinched = _pinched(mesh, np.flatnonzero(inside))
        if not pinched.any():
            break
        inside = np.asarray(inside | pinched[quads].any(axis=1))
    rows = np.flatnonzero(inside)
    outer = np.zeros(mesh.n_points, dtype=bool)
    outer[quads[~inside]] = True
    part = _parts(quads[rows], mesh.n_points)
    found = []
    for k in range(int(part.max(initial=-1)) + 1):
        mine = rows[part == k]
        nodes = np.unique(quads[mine]).astype(np.int64)
        found.append(Patch(mine, nodes, outer[nodes], core[mine]))
    return found


def sharp_corners(mesh: QuadMesh, quads: NDArray[np.int32], below: float) -> NDArray[np.bool_]:
    """Say which corners of some elements of a mesh fill a sharp corner between curves.

    Parameters
    ----------
    mesh : QuadMesh
        The mesh.
    quads : (K, 4) int32
        Corners of the elements.
    below : float
        Angle in radians below which a corner is sharp.

    Returns
    -------
    (K, 4) bool
    """
    corner, on = mesh.points[quads], (mesh.curve >= 0)[quads]
    ahead, behind = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    across = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    sharp = np.arctan2(across, (ahead * behind).sum(axis=2)) < below
    return np.asarray(sharp & mesh.fixed[quads] & np.roll(on, -1, axis=1) & np.roll(on, 1, axis=1))


def repatched(
    mesh: QuadMesh,
    report: GuaranteeReport,
    patches: list[Patch],
    domain: Domain,
    reference: SizeFunction,
    tight: SizeField,
    meshing: MeshOptions,
    options: GuaranteeOptions,
    better: Callable[[QuadMesh, GuaranteeReport, QuadMesh, GuaranteeReport], bool],
    monitor: Monitor = SILENT,
) -> tuple[QuadMesh, GuaranteeReport]:
    """Return the mesh with those patches made anew that become better by it, and what is left of it then.

    Parameters
    ----------
    mesh : QuadMesh
        A repaired mesh.
    report : GuaranteeReport
        What is left of it.
    patches : list of Patch
        Parts of it that share no node.
    domain, reference
        What is meshed, and the user's field.
    tight : SizeField
        The field that cores are packed for, and that all is smoothed for.
    meshing, options
        How cores are packed, and how hard patches are repaired.
    better : callable
        Says whether a part of a mesh with its report, the last two arguments, is better than the first two.
    monitor : Monitor
        Told of progress.
    """
    made: list[tuple[Patch, QuadMesh, GuaranteeReport]] = []
    for k, patch in enumerate(patches):
        part = SubMonitor(monitor, k / len(patches), (k + 1) / len(patches))
        before = _cut_out(mesh, patch)
        left = np.isin(report.elements, patch.rows)
        old = GuaranteeReport(
            before.n_quads,
            np.searchsorted(patch.rows, report.elements[left]),
            report.ratios[left],
            tuple(reason for reason, mine in zip(report.reasons, left, strict=True) if mine),
        )
        low, high = before.points.min(axis=0), before.points.max(axis=0)
        size = part_of(tight, low - (high - low), high + (high - low))
        try:
            raw = _with_new_core(before, patch, domain, size, meshing, part)
            after, new = guaranteed(raw, domain, size, reference, options, part)
        except MeshingError:  # what there is stays
            continue
        if better(before, old, after, new) and _same_rim(before, patch, after):
            made.append((patch, after, new))
    return _joined(mesh, report, made)


def _grown(mesh: QuadMesh, inside: NDArray[np.bool_], rings: int) -> NDArray[np.bool_]:
    near = np.zeros(mesh.n_points, dtype=bool)
    for _ in range(rings):
        near[mesh.quads[inside]] = True
        inside = np.asarray(near[mesh.quads].any(axis=1))
    return inside


def _in_sharp_corners(mesh: QuadMesh, among: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Say which elements of some fill a sharp corner between curves."""
    rows = np.flatnonzero(among)
    found = np.zeros(mesh.n_quads, dtype=bool)
    found[rows[sharp_corners(mesh, mesh.quads[rows], SHARP).any(axis=1)]] = True
    return found


def _pinched(mesh: QuadMesh, rows: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Say at which nodes some elements meet in their corners only."""
    edges, count = edges_of(mesh.quads[rows])
    return np.asarray(np.bincount(edges[count == 1].ravel(), minlength=mesh.n_points) > 2)


def _parts(quads: NDArray[np.int32], n_points: int) -> NDArray[np.int64]:
    """Return the number of the connected part that each element belongs to, parts in the order of their elements."""
    rows = np.repeat(np.arange(len(quads)), 4)
    of = coo_array((np.ones(quads.size), (rows, quads.ravel())), shape=(len(quads), n_points)).tocsr()
    _, part = connected_components(of @ of.T, directed=False)
    _, first, part = np.unique(part, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[part]


def _cut_out(mesh: QuadMesh, patch: Patch) -> QuadMesh:
    """Return a patch as a mesh whose rim does not move."""
    quads = np.searchsorted(patch.nodes, mesh.quads[patch.rows]).astype(np.int32)
    nodes = patch.nodes
    return QuadMesh(mesh.points[nodes], quads, mesh.curve[nodes], mesh.fixed[nodes] | patch.rim)


def _with_new_core(
    whole: QuadMesh, patch: Patch, domain: Domain, size: SizeField, meshing: MeshOptions, monitor: Monitor
) -> QuadMesh:
    """Return a patch, cut out, with its core packed anew."""
    if not patch.core.any():
        return whole
    nodes = np.unique(whole.quads[patch.core])
    quads = np.searchsorted(nodes, whole.quads[patch.core]).astype(np.int32)
    width = float(np.ptp(whole.points, axis=0).max())
    core = QuadMesh(whole.points[nodes], quads, whole.curve[nodes], whole.fixed[nodes])
    pairs = line_pairs(domain, core.points, core.curve, core.fixed, width)
    return _joined_at(whole, ~patch.core, refilled(core, pairs, size, meshing, monitor))


def _joined_at(whole: QuadMesh, kept: NDArray[np.bool_], other: QuadMesh) -> QuadMesh:
    """Return the kept elements of a mesh and those of another, nodes at the very same places being one."""
    nodes = np.unique(whole.quads[kept])
    rank = np.full(whole.n_points, -1, dtype=np.int64)
    rank[nodes] = np.arange(len(nodes))
    at = {point.tobytes(): rank[v] for v, point in zip(nodes, whole.points[nodes], strict=True)}
    number = np.empty(other.n_points, dtype=np.int64)
    new: list[int] = []
    for v, point in enumerate(other.points):
        number[v] = at.get(point.tobytes(), -1)
        if number[v] < 0:
            number[v] = len(nodes) + len(new)
            new.append(v)
    return QuadMesh(
        np.vstack([whole.points[nodes], other.points[new]]),
        np.vstack([rank[whole.quads[kept]], number[other.quads]]).astype(np.int32),
        np.concatenate([whole.curve[nodes], other.curve[new]]),
        np.concatenate([whole.fixed[nodes], other.fixed[new]]),
    )


def _same_rim(before: QuadMesh, patch: Patch, after: QuadMesh) -> bool:
    """Say whether every node of the rim is still there, so that the patch fits."""
    there = {point.tobytes() for point in after.points}
    rim = before.points[patch.rim]
    return len({point.tobytes() for point in before.points}) == before.n_points and all(
        point.tobytes() in there for point in rim
    )


def _joined(
    mesh: QuadMesh, report: GuaranteeReport, made: list[tuple[Patch, QuadMesh, GuaranteeReport]]
) -> tuple[QuadMesh, GuaranteeReport]:
    """Return the mesh with patches exchanged, all else where it was, and what is left in it."""
    if not made:
        return mesh, report
    gone = np.concatenate([patch.rows for patch, _, _ in made])
    kept = np.ones(mesh.n_quads, dtype=bool)
    kept[gone] = False
    inner = np.concatenate([patch.nodes[~patch.rim] for patch, _, _ in made])
    alive = np.ones(mesh.n_points, dtype=bool)
    alive[inner] = False
    rank = np.cumsum(alive) - 1
    points, quads = [mesh.points[alive]], [rank[mesh.quads[kept]]]
    curve, fixed = [mesh.curve[alive]], [mesh.fixed[alive]]
    left = ~np.isin(report.elements, gone)
    elements, ratios = [(np.cumsum(kept) - 1)[report.elements[left]]], [report.ratios[left]]
    reasons = [reason for reason, stays in zip(report.reasons, left, strict=True) if stays]
    n, first = int(alive.sum()), int(kept.sum())
    for patch, after, new in made:
        held = patch.nodes[patch.rim]
        at = {point.tobytes(): rank[v] for v, point in zip(held, mesh.points[held], strict=True)}
        number = np.array([at.get(point.tobytes(), -1) for point in after.points], dtype=np.int64)
        more = number < 0
        number[more] = n + np.arange(more.sum())
        points.append(after.points[more])
        quads.append(number[after.quads])
        curve.append(after.curve[more])
        fixed.append(after.fixed[more])
        elements.append(first + new.elements)
        ratios.append(new.ratios)
        reasons += new.reasons
        n, first = n + int(more.sum()), first + after.n_quads
    joined = QuadMesh(
        np.vstack(points), np.vstack(quads).astype(np.int32), np.concatenate(curve), np.concatenate(fixed)
    )
    found = GuaranteeReport(first, np.concatenate(elements), np.concatenate(ratios), tuple(reasons))
    return joined, found
