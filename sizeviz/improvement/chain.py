"""Everything a raw mesh goes through, in the order that costs least."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.improvement._workspace import Workspace
from sizeviz.improvement.cleanup import clean_fast, clean_wide, rescue
from sizeviz.improvement.options import SmoothOptions
from sizeviz.improvement.room import with_room
from sizeviz.monitor import SILENT, Monitor, SubMonitor

if TYPE_CHECKING:
    from sizeviz.geometry.domain import Domain
    from sizeviz.geometry.quadmesh import QuadMesh
    from sizeviz.sizing import SizeField

RESCUED = 0.3
"""Quality below which an element's connectivity is changed whatever the valences become."""

FLAT = 0.15
"""The same beside inner lines, whose nodes may have a single element on one side: valences do not show that."""


def improved(
    mesh: QuadMesh,
    domain: Domain,
    size: SizeField,
    options: SmoothOptions | None = None,
    monitor: Monitor = SILENT,
) -> QuadMesh:
    """Return the mesh with better connectivity and shapes at the same sizes.

    Parameters
    ----------
    mesh : QuadMesh
        A raw mesh.
    domain : Domain
        The domain it was made for.
    size : SizeField
        Target sizes, up to a common factor.
    options : SmoothOptions, optional
        What to do.
    monitor : Monitor
        Told of progress.

    Raises
    ------
    InputError
        If the mesh is empty or does not belong to the domain.
    Cancelled
        If the monitor says so.
    """
    work = begun(mesh, domain, size, options or SmoothOptions())
    improve(work, work.options.rounds, monitor)
    return work.result()


def begun(mesh: QuadMesh, domain: Domain, size: SizeField, options: SmoothOptions) -> Workspace:
    """Return the workspace that a mesh is improved in, with the targets that its boundary has room for."""
    return Workspace(mesh, domain, with_room(mesh, size), options)


def improve(work: Workspace, rounds: int, monitor: Monitor) -> None:
    """Do what ``improved`` does, with some rounds of wide clean-up, in a workspace; for those who go on from there."""
    options = work.options
    if options.cleanup:
        work.sweep(2, SubMonitor(monitor, 0.0, 0.05))
        clean_fast(work, SubMonitor(monitor, 0.05, 0.2))
        work.sweep(4, SubMonitor(monitor, 0.2, 0.3))
        rescue(work, FLAT)  # before flat elements on lines or the boundary draw their neighbours in
        clean_wide(work, rounds, SubMonitor(monitor, 0.3, 0.85))
    work.sweep(options.sweeps, SubMonitor(monitor, 0.85, 1.0))
    work.lift(options.floor)
    if options.cleanup:
        rescue(work, RESCUED)
