"""Keeping the promise R <= 1: where a mesh cannot be repaired, another is made with smaller sizes just there.

What moves and operations can repair depends on the room that the mesh leaves. Where sizes change very fast, or a domain
is hardly wider than its elements, too few are left to work with. The tight field is then lowered around the elements
that are left, which costs few elements more, and meshed again: first just the patches around them, and where that
does not help, or they are all over the mesh, everything.
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
from sizeviz.study.patches import patches_around, repatched, sharp_corners

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
LONGEST = 1.5
"""R above which an element's edge no longer tells how far to reach."""
POOR, POOR_SHARE, POOR_REACH = 0.6, 0.8, 1.5
"""Shape quality from which down sizes are lowered although R <= 1; by how much, and how far around."""
FAIR = 0.7
"""The same where patches can be made anew; a whole mesh is not."""
SHARP = np.deg2rad(38.0)
"""Angle between two lines below which the element between them is poor whatever its mesh; it has at most its sine."""
BETTER, DEARER, FEW = 3, 1.15, 100
"""How often this is tried, and what it may cost in elements: times their number, or so many."""
TRIES = len(REACH) + BETTER
MANY, MUCH_DEARER = 0.05, 1.25
"""The same where this share of the elements or more is poor."""
FAR, FAR_SHARE = 0.5, 0.8
"""Share of wrong elements from which nearly all of a mesh is lowered at once, where spots overlap; by how much then."""
PATCHED = 0.8
"""Share of a mesh up to which patches are made anew by themselves."""
LARGEST = 1_000_000
"""Elements from which a mesh is not made again as a whole where patches would do, however often they fail."""
HOPELESS = 0.1
"""Share of wrong elements from which a mesh that is not the last is not repaired."""


@dataclass(frozen=True, eq=False)
class Promise:
    """The mesh that came nearest to the promise, and what it was made from.

    Parameters
    ----------
    tight : SizeField
        The field it was generated for, lowered where patches of it were made anew.
    raw : QuadMesh
        As generated, without such patches.
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
    for n in range(TRIES):
        held, fair = best.report.holds, _fair(best)
        if (n >= len(REACH) and not held) or better == BETTER or not len(_asking(best)):
            break
        better = BETTER if fair else better + held
        part = SubMonitor(monitor, 0.6 + 0.4 * n / TRIES, 0.6 + 0.4 * (n + 1) / TRIES)
        last = _again(domain, reference, best, n, meshing, options, part)
        if last is best and held:  # the same again would come to the same
            break
        best = last
    monitor.step(1.0)
    return best


def _again(
    domain: Domain,
    reference: SizeFunction,
    best: Promise,
    n: int,
    meshing: MeshOptions,
    options: GuaranteeOptions,
    monitor: Monitor,
) -> Promise:
    """Return a mesh made for smaller sizes around what is left, the n-th one; or the best so far if it is no better."""
    reach = REACH[min(n, len(REACH) - 1)]
    finer = _with_room(best, reference, reach, SPARED ** (n + 1))
    last = _patched(domain, reference, finer, best, reach, meshing, options, SubMonitor(monitor, 0.0, 0.2))
    large = last is not None and best.mesh.n_quads > LARGEST
    if (last is None or last is best) and not large and not _fair(best):
        strict = options if n >= len(REACH) - 1 else replace(options, hopeless=HOPELESS)
        try:
            mesh = generated(domain, finer, meshing, SubMonitor(monitor, 0.2, 0.5))
        except MeshingError:  # the finer field may pass the limit of elements; what there is stays
            return best
        last = _repaired(domain, reference, finer, mesh, strict, SubMonitor(monitor, 0.5, 1.0))
    if last is None or (best.report.holds and _dear(last.mesh, best.mesh)):
        return best
    return last if _demerit(last.mesh, last.report) <= _demerit(best.mesh, best.report) else best


def _patched(
    domain: Domain,
    reference: SizeFunction,
    finer: SizeField,
    best: Promise,
    reach: float,
    meshing: MeshOptions,
    options: GuaranteeOptions,
    monitor: Monitor,
) -> Promise | None:
    """Return the mesh with patches made anew, the same where none becomes better, or none where they are too large."""
    mesh, report = best.mesh, best.report
    elements = _asking(best)
    if len(elements) > HOPELESS * mesh.n_quads:
        return None
    patches = patches_around(mesh, elements, int(np.ceil(2.0 * reach)) + 1)
    if sum(len(patch.rows) for patch in patches) > PATCHED * mesh.n_quads:
        return None
    mended, left = repatched(mesh, report, patches, domain, reference, finer, meshing, options, _better, monitor)
    return best if mended is mesh else Promise(finer, best.raw, mended, left)


def _better(mesh: QuadMesh, report: GuaranteeReport, other: QuadMesh, left: GuaranteeReport) -> bool:
    return _demerit(other, left) < _demerit(mesh, report)


def _demerit(mesh: QuadMesh, report: GuaranteeReport) -> tuple[int, int, int, float]:
    poor, fair = _below(POOR, mesh), _below(FAIR, mesh)
    return len(report.elements), len(poor), len(fair), -float(shape_quality(mesh)[fair].min(initial=1.0))


def _dear(mesh: QuadMesh, before: QuadMesh) -> bool:
    """Say whether a mesh has so many more elements than the one before it that better shapes are not worth it."""
    share = DEARER if len(_below(POOR, before)) < MANY * before.n_quads else MUCH_DEARER
    return mesh.n_quads > max(share * before.n_quads, before.n_quads + FEW)


def _fair(promise: Promise) -> bool:
    """Say whether nothing is left but shapes that are not worth another mesh, only patches."""
    return promise.report.holds and not len(_below(POOR, promise.mesh))


def _asking(promise: Promise) -> NDArray[np.int64]:
    """Return the elements that smaller sizes are to help: those that are left, else poor ones, else only fair ones."""
    if not promise.report.holds:
        return promise.report.elements
    poor = _below(POOR, promise.mesh)
    return poor if len(poor) else _below(FAIR, promise.mesh)


def _with_room(promise: Promise, reference: SizeFunction, reach: float, spared: float) -> SizeField:
    """Return the field that a mesh was made for, lower around the elements that are left of it, or of poor shape."""
    mesh, held = promise.mesh, promise.report.holds
    quads = mesh.quads[_asking(promise)]
    corner = mesh.points[quads]
    longest = np.sqrt(((np.roll(corner, -1, axis=1) - corner) ** 2).sum(axis=2).max(axis=1))
    least = reference.min_over(mesh.points, quads)
    ratio = longest / least
    lowest = FAR_SHARE if len(quads) > FAR * mesh.n_quads else LEAST_SHARE
    if held:  # the tight field may be far smaller than what the element is judged against
        least = np.minimum(least, promise.tight.at(corner.mean(axis=1)))
        spots = POOR_REACH * np.maximum(least, longest), np.full(len(quads), POOR_SHARE)
    else:  # of an element far too large, the part that its edges should have had
        spots = reach * longest * np.minimum(1.0, LONGEST / ratio), np.clip(SHARE / ratio, lowest, MOST_SHARE)
    return lowered(promise.tight, corner.mean(axis=1), *spots, spared * least)


def _below(quality: float, mesh: QuadMesh) -> NDArray[np.int64]:
    """Return the elements of lower quality, but those in sharp corners, which the domain or its lines make so."""
    low = np.flatnonzero(shape_quality(mesh) < quality)
    quads = mesh.quads[low]
    around = np.bincount(mesh.quads.ravel(), minlength=mesh.n_points)
    sharp = sharp_corners(mesh, quads, SHARP)
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
