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
    from sizeviz.meshing.frontal.boundary import Outline

BEYOND = 1.5
"""How much wider than the box the four nodes around it lie."""

RegionArrays = tuple[
    NDArray[np.float64], NDArray[np.float64], NDArray[np.int32], NDArray[np.int32], NDArray[np.bool_], NDArray[np.bool_]
]


def is_box(domain: Domain) -> bool:
    """Return whether the domain is an axis-parallel rectangle without holes."""
    x0, y0, x1, y1 = domain.bounds
    on_side = np.isin(domain.outer[:, 0], (x0, x1)) | np.isin(domain.outer[:, 1], (y0, y1))
    return not domain.holes and bool(on_side.all()) and domain.area == (x1 - x0) * (y1 - y0)


def region_arrays(domain: Domain, rim: Outline) -> RegionArrays:
    """Return what ``_region_kernels.within`` asks.

    Parameters
    ----------
    domain : Domain
        For its box; a rectangle without inner lines needs no triangles.
    rim : Outline
        Nodes and edges on the boundary and on inner lines.

    Returns
    -------
    tuple
        Bounding box, points, triangles, neighbours, which triangles are inside (those of kites are not), which of
        their edges are locked.
    """
    box = read_only(np.array(domain.bounds))
    if is_box(domain) and not domain.lines:
        none = read_only(np.empty((0, 3), dtype=np.int32))
        flags = read_only(np.empty((0, 3), dtype=np.bool_))
        return box, read_only(np.empty((0, 2))), none, none, read_only(np.empty(0, dtype=np.bool_)), flags
    return enclosed(box, rim)


def enclosed(box: NDArray[np.float64], rim: Outline) -> RegionArrays:
    """Return the same of what an outline encloses, from the triangles of its nodes; ``box`` is its bounding box.

    Four nodes around the box make triangles of what is outside too, so that squares there are known to be.
    """
    around = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners = 0.5 * (box[:2] + box[2:]) + BEYOND * 0.5 * (box[2:] - box[:2]) * around
    hull = triangulated(
        np.vstack([rim.points, corners]), rim.edges, bounding=np.zeros(len(rim.edges), dtype=bool)
    )  # fmt: skip
    ends = np.sort(hull.triangles[:, [[1, 2], [2, 0], [0, 1]]].astype(np.int64), axis=-1)
    bounds = np.sort(rim.edges[rim.bounding].astype(np.int64), axis=1)
    width = len(hull.points)
    bounding = np.isin(ends[..., 0] * width + ends[..., 1], bounds[:, 0] * width + bounds[:, 1])
    inside = kernels.parity(hull.neighbours, bounding & hull.locked)
    for kite in rim.kites:
        inside &= ~np.isin(hull.triangles, kite).all(axis=1)
    return box, hull.points, hull.triangles, hull.neighbours, read_only(inside), hull.locked
