"""Smoothing: one safeguarded Newton step per node and sweep, Gauss-Seidel over coloured blocks of nodes.

The objective is section 4 of Ruiz-Girones, Roca, Sarrate (2013), https://doi.org/10.1007/978-3-319-02335-9, after
Gargallo-Peiro, Roca, Sarrate; the untangling is that of Escobar et al. (2003),
https://doi.org/10.1016/S0045-7825(03)00299-8.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.improvement._workspace import Workspace
from sizeviz.improvement.options import SmoothOptions
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from sizeviz.geometry.domain import Domain
    from sizeviz.geometry.quadmesh import QuadMesh
    from sizeviz.sizing import SizeField


def smoothed(
    mesh: QuadMesh,
    domain: Domain,
    size: SizeField,
    options: SmoothOptions | None = None,
    monitor: Monitor = SILENT,
) -> QuadMesh:
    """Return the mesh with its nodes where the objective of eq. (7) is low; the connectivity stays.

    Parameters
    ----------
    mesh : QuadMesh
        What to smooth; inverted elements are untangled.
    domain : Domain
        The domain it was made for; boundary nodes slide along its curves.
    size : SizeField
        Target sizes. Only their ratios count: they are scaled so that the mesh's own number of elements fits.
    options : SmoothOptions, optional
        ``objective``, ``sweeps`` and ``threads`` are used.
    monitor : Monitor
        Told after every block of nodes.

    Raises
    ------
    InputError
        If the mesh is empty or does not belong to the domain.
    Cancelled
        If the monitor says so.
    """
    options = options or SmoothOptions()
    work = Workspace(mesh, domain, size, options)
    work.sweep(options.sweeps, monitor)
    return work.moved(mesh)
