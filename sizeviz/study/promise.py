"""Keeping the promise R <= 1: where a mesh cannot be repaired, another is made with smaller sizes just there.

What moves and operations can repair depends on the room that the mesh leaves. Where sizes change very fast, or a domain
is hardly wider than its elements, too few are left to work with. The tight field is then lowered around the elements
that are left, which costs few elements more, and all is meshed again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import MeshingError
from sizeviz.improvement import GuaranteeOptions, GuaranteeReport, guaranteed
from sizeviz.meshing import MeshOptions, generated
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sizing.lowered import lowered

if TYPE_CHECKING:
    from sizeviz.geometry import Domain, QuadMesh
    from sizeviz.sizing import SizeField, SizeFunction

REACH = (1.5, 1.5, 2.0, 2.0, 3.0, 4.0)
"""How far around an element that is left sizes are lowered, in edges of it, before each of the meshes that follow."""
SHARE, LEAST_SHARE = 0.88, 0.6
"""By how much: this share, over the element's R, but no less than the second."""
LARGEST = 1.5
"""R above which an element's edge no longer tells how far to reach."""
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
    best = last = _repaired(domain, reference, tight, raw, replace(options, hopeless=HOPELESS), part)
    for n, reach in enumerate(REACH):
        if best.report.holds:
            break
        part = SubMonitor(monitor, 0.6 + 0.4 * n / len(REACH), 0.6 + 0.4 * (n + 1) / len(REACH))
        finer = _with_room(last, reach)
        try:
            mesh = generated(domain, finer, meshing, SubMonitor(part, 0.0, 0.4))
        except MeshingError:  # the finer field may pass the limit of elements; what there is stays
            break
        strict = options if n == len(REACH) - 1 else replace(options, hopeless=HOPELESS)
        last = _repaired(domain, reference, finer, mesh, strict, SubMonitor(part, 0.4, 1.0))
        best = min(best, last, key=lambda one: len(one.report.elements))
    monitor.step(1.0)
    return best


def _with_room(promise: Promise, reach: float) -> SizeField:
    """Return the field that a mesh was made for, lower around the elements that are left of it."""
    corner = promise.mesh.points[promise.mesh.quads[promise.report.elements]]
    longest = np.sqrt(((np.roll(corner, -1, axis=1) - corner) ** 2).sum(axis=2).max(axis=1))
    ratio = promise.report.ratios
    # of an element far too large, the part that its edges should have had
    part = longest * np.minimum(1.0, LARGEST / ratio)
    return lowered(promise.tight, corner.mean(axis=1), reach * part, np.clip(SHARE / ratio, LEAST_SHARE, SHARE))


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
