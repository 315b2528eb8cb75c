"""Keeping the promise R <= 1: where a mesh cannot be repaired, another is made with smaller sizes just there.

What moves and operations can repair depends on the room that the mesh leaves. Where sizes change very fast, or a domain
is hardly wider than its elements, too few are left to work with. The tight field is then lowered around the elements
that are left, which costs few elements more, and all is meshed again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.conformity import shape_quality
from sizeviz.errors import MeshingError
from sizeviz.improvement import GuaranteeOptions, GuaranteeReport, guaranteed
from sizeviz.meshing import MeshOptions, generated
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sizing.lowered import lowered

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import Domain, QuadMesh
    from sizeviz.sizing import SizeField, SizeFunction

REACH = (1.5, 1.75, 2.0, 2.5, 3.0, 4.0)
"""How far around an element that is left sizes are lowered, in edges of it, before each of the meshes that follow."""
SHARE, LEAST_SHARE, MOST_SHARE = 0.92, 0.6, 0.88
"""By how much: the first over the element's R, within the other two."""
SPARED = 0.75
"""Share of the least size over an element, to the power of the attempt, below which none is lowered."""
LARGEST = 1.5
"""R above which an element's edge no longer tells how far to reach."""
POOR, POOR_SHARE, POOR_REACH = 0.6, 0.8, 1.5
"""Shape quality from which down sizes are lowered although R <= 1; by how much, and how far around."""
SHARP = np.deg2rad(38.0)
"""Angle between two lines below which the element between them is poor whatever its mesh; it has at most its sine."""
BETTER, DEARER, FEW = 3, 1.15, 100
"""How often this is tried, and what it may cost in elements: times their number, or so many."""
FAR, FAR_SHARE = 0.5, 0.8
"""Share of wrong elements from which nearly all of a mesh is lowered at once, where spots overlap; by how much then."""
HOPELESS = 0.1
"""Share of wrong elements from which a mesh that is not the last is not repaired."""


@dataclass(frozen=True, eq=False)
class Promise:
    """The mesh that came nearest to the promise, and what it was made from.

    Parameters
    ----------
    tight : SizeField
        The field it was generated for.
    raw : QuadMesh
        As generated.
    mesh : QuadMesh
        As repaired.
    report : GuaranteeReport
        Whether the promise holds, or what is left and why.
    """

    tight: SizeField
    raw: QuadMesh
    mesh: QuadMesh
    report: GuaranteeReport


def promised(
    domain: Domain,
    reference: SizeFunction,
    tight: SizeField,
    raw: QuadMesh,
    meshing: MeshOptions | None = None,
    options: GuaranteeOptions | None = None,
    monitor: Monitor = SILENT,
) -> Promise:
    """Return a mesh with R <= 1 on every element, from the raw one given or from one that is finer where needed.

    Parameters
    ----------
    domain : Domain
        What is meshed.
    reference : SizeFunction
        The user's field.
    tight : SizeField
        The tight field.
    raw : QuadMesh
        A mesh generated for it.
    meshing : MeshOptions, optional
        How others are generated; the scale is always 1.
    options : GuaranteeOptions, optional
        How hard each is repaired.
    monitor : Monitor
        Told of progress.

    Raises
    ------
    MeshingError
        If no valid mesh could be made.
    Cancelled
        If the monitor says so.
    """
    meshing, options = replace(meshing or MeshOptions(), scale=1.0), options or GuaranteeOptions()
    part = SubMonitor(monitor, 0.0, 0.6)
    best = _repaired(domain, reference, tight, raw, replace(options, hopeless=HOPELESS), part)
    better = 0
    for n, reach in enumerate(REACH):
        held = best.report.holds
        if held and (better == BETTER or not len(_poor(best))):
            break
        better += held
        part = SubMonitor(monitor, 0.6 + 0.4 * n / len(REACH), 0.6 + 0.4 * (n + 1) / len(REACH))
        try:
            finer = _with_room(best, reference, reach, SPARED ** (n + 1))
            mesh = generated(domain, finer, meshing, SubMonitor(part, 0.0, 0.4))
        except MeshingError:  # the finer field may pass the limit of elements; what there is stays
            break
        strict = options if n == len(REACH) - 1 else replace(options, hopeless=HOPELESS)
        last = _repaired(domain, reference, finer, mesh, strict, SubMonitor(part, 0.4, 1.0))
        most = max(DEARER * best.mesh.n_quads, best.mesh.n_quads + FEW)
        dear = held and last.mesh.n_quads > most
        if not dear and _demerit(last) <= _demerit(best):
            best = last
    monitor.step(1.0)
    return best


def _demerit(promise: Promise) -> tuple[int, int, float]:
    poor = _poor(promise)
    return len(promise.report.elements), len(poor), -float(shape_quality(promise.mesh)[poor].min(initial=1.0))


def _with_room(promise: Promise, reference: SizeFunction, reach: float, spared: float) -> SizeField:
    """Return the field that a mesh was made for, lower around the elements that are left of it, or of poor shape."""
    mesh, held = promise.mesh, promise.report.holds
    quads = mesh.quads[_poor(promise) if held else promise.report.elements]
    corner = mesh.points[quads]
    longest = np.sqrt(((np.roll(corner, -1, axis=1) - corner) ** 2).sum(axis=2).max(axis=1))
    least = reference.min_over(mesh.points, quads)
    ratio = longest / least
    lowest = FAR_SHARE if len(quads) > FAR * mesh.n_quads else LEAST_SHARE
    if held:  # the tight field may be far smaller than what the element is judged against
        least = np.minimum(least, promise.tight.at(corner.mean(axis=1)))
        spots = POOR_REACH * np.maximum(least, longest), np.full(len(quads), POOR_SHARE)
    else:  # of an element far too large, the part that its edges should have had
        spots = reach * longest * np.minimum(1.0, LARGEST / ratio), np.clip(SHARE / ratio, lowest, MOST_SHARE)
    return lowered(promise.tight, corner.mean(axis=1), *spots, spared * least)


def _poor(promise: Promise) -> NDArray[np.int64]:
    """Return the elements of poor shape, but those in sharp corners, which the domain or its lines make so."""
    mesh = promise.mesh
    low = np.flatnonzero(shape_quality(mesh) < POOR)
    quads = mesh.quads[low]
    around = np.bincount(mesh.quads.ravel(), minlength=mesh.n_points)
    corner, on = mesh.points[quads], (mesh.curve >= 0)[quads]
    ahead, behind = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    across = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    sharp = np.arctan2(across, (ahead * behind).sum(axis=2)) < SHARP
    sharp &= mesh.fixed[quads] & np.roll(on, -1, axis=1) & np.roll(on, 1, axis=1)
    cornered = (sharp | ((around == 1) & mesh.fixed)[quads]).any(axis=1)
    return low[~cornered]


def _repaired(
    domain: Domain,
    reference: SizeFunction,
    tight: SizeField,
    raw: QuadMesh,
    options: GuaranteeOptions,
    monitor: Monitor,
) -> Promise:
    mesh, report = guaranteed(raw, domain, tight, reference, options, monitor)
    return Promise(tight, raw, mesh, report)
