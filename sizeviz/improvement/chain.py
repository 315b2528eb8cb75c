"""Everything a raw mesh goes through, in the order that costs least."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.improvement.smoothing import smoothed
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from sizeviz.geometry.domain import Domain
    from sizeviz.geometry.quadmesh import QuadMesh
    from sizeviz.improvement.options import SmoothOptions
    from sizeviz.sizing import SizeField


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
    return smoothed(mesh, domain, size, options, monitor)
