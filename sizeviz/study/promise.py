"""Keeping the promise R <= 1: where one mesh cannot be repaired, a finer one is made.

What moves and operations can repair depends on the room that the mesh leaves. Where sizes change very fast, or a domain
is hardly wider than its elements, too few are left to work with; meshing again with smaller sizes that grow more slowly
then costs less than any repair.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sizeviz.errors import MeshingError
from sizeviz.improvement import GuaranteeOptions, GuaranteeReport, guaranteed
from sizeviz.meshing import MeshOptions, generated
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sizing import LimitOptions, limited

if TYPE_CHECKING:
    from sizeviz.geometry import Domain, QuadMesh
    from sizeviz.sizing import SizeField, SizeFunction

FINER: tuple[tuple[float, float], ...] = ((0.9, 0.7), (0.8, 0.5), (0.7, 0.35))
"""Share of the tight field's sizes, and the slope that they may have, of the second mesh and those after it."""
HOPELESS = 0.1
"""Share of wrong elements from which a mesh that is not the last is not repaired."""
HELD = "with an edge between two fixed nodes"
"""The reason that no finer field removes."""


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
    """Return a mesh with R <= 1 on every element, from the raw one given or from a finer one.

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
        How finer ones are generated; the scale is always 1.
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
    for n, (share, slope) in enumerate(FINER):
        if best.report.holds or set(best.report.reasons) == {HELD}:
            break
        part = SubMonitor(monitor, 0.6 + 0.4 * n / len(FINER), 0.6 + 0.4 * (n + 1) / len(FINER))
        last = n == len(FINER) - 1
        finer = limited(tight.with_sizes(share * tight.sizes), LimitOptions(epsilon=slope))
        try:
            mesh = generated(domain, finer, meshing, SubMonitor(part, 0.0, 0.4))
        except MeshingError:  # the finer field may pass the limit of elements; what there is stays
            break
        strict = options if last else replace(options, hopeless=HOPELESS)
        other = _repaired(domain, reference, finer, mesh, strict, SubMonitor(part, 0.4, 1.0))
        best = min(best, other, key=lambda one: len(one.report.elements))
    monitor.step(1.0)
    return best


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
