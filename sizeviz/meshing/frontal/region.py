"""Inside or outside: what the packing asks about every point it wants to place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sizeviz.geometry.arrays import read_only
from sizeviz.geometry.delaunay import triangulated
from sizeviz.meshing.frontal import _region_kernels as kernels

if TYPE_CHECKING:
    from sizeviz.geometry import Domain

RegionArrays = tuple[NDArray, NDArray, NDArray, NDArray, NDArray]


def is_box(domain: Domain) -> bool:
    """Return whether the domain is an axis-parallel rectangle without holes."""
    x0, y0, x1, y1 = domain.bounds
    on_side = np.isin(domain.outer[:, 0], (x0, x1)) | np.isin(domain.outer[:, 1], (y0, y1))
    return not domain.holes and bool(on_side.all()) and domain.area == (x1 - x0) * (y1 - y0)


def region_arrays(domain: Domain, points: NDArray[np.float64], edges: NDArray[np.int32]) -> RegionArrays:
    """Return what ``_region_kernels.within`` asks: bounding box, points, triangles, neighbours, which are inside.

    Parameters
    ----------
    domain : Domain
        For its box; a rectangle needs no triangles.
    points : (B, 2) float64
        Nodes on the boundary.
    edges : (E, 2) int32
        Boundary edges, closed loops.
    """
    box = read_only(np.array(domain.bounds))
    if is_box(domain):
        none = read_only(np.empty((0, 3), dtype=np.int32))
        return box, read_only(np.empty((0, 2))), none, none, read_only(np.empty(0, dtype=np.bool_))
    hull = triangulated(points, edges, bounding=np.zeros(len(edges), dtype=bool))
    inside = kernels.parity(hull.neighbours, hull.locked)
    return box, hull.points, hull.triangles, hull.neighbours, read_only(inside)
