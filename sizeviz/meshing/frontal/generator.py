"""The default mesher: packing, Delaunay triangulation, pairing."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely
from shapely import LineString, line_interpolate_point, line_locate_point

from sizeviz.errors import InputError, MeshingError
from sizeviz.geometry import QuadMesh
from sizeviz.geometry.delaunay import Triangulation, hilbert_order, triangulated
from sizeviz.meshing.checks import verify
from sizeviz.meshing.frontal.boundary import Outline, outline
from sizeviz.meshing.frontal.mending import mended
from sizeviz.meshing.frontal.narrows import fitted
from sizeviz.meshing.frontal.packing import packed, seeded
from sizeviz.meshing.frontal.pairing import paired
from sizeviz.meshing.frontal.region import RegionArrays, region_arrays
from sizeviz.meshing.frontal.splitting import split
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sizing.capped import capped

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import Domain
    from sizeviz.meshing.options import MeshOptions
    from sizeviz.sizing import SizeField


UNCROSSINGS = 6
"""How often sizes are lowered where edges of the outline cross."""


class Frontal:
    """Nodes packed from the smallest size upwards, triangulated, and the triangles paired so that none is left.

    In the ``fast`` preset, and where no perfect pairing exists, the mesh is made at twice the size and every element
    is then cut into quadrilaterals.

    References
    ----------
    Remacle et al. (2012), "Blossom-Quad", DOI 10.1002/nme.3279; Remacle et al. (2013), "A frontal Delaunay quad mesh
    generator using the L-infinity norm", DOI 10.1002/nme.4458.
    """

    name = "frontal"

    def generate(self, domain: Domain, size: SizeField, options: MeshOptions, monitor: Monitor = SILENT) -> QuadMesh:
        """Return a raw all-quadrilateral mesh; see `sizeviz.meshing.generated`."""
        if options.preset == "direct":
            rim, mesh = _triangulation(domain, size, options, SubMonitor(monitor, 0.0, 0.7))
            mesh, quads, single = mended(mesh, SubMonitor(monitor, 0.7, 0.95))
            if not len(single):
                return _checked(mesh.points, quads, rim)
        coarse = replace(options, scale=2.0 * options.scale)
        rim, mesh = _triangulation(domain, size, coarse, SubMonitor(monitor, 0.7, 0.9))
        quads, single = paired(mesh, SubMonitor(monitor, 0.9, 1.0))
        points, cells, edges = split(mesh.points, quads, mesh.triangles[single])
        halved = _halved(rim, domain, points, edges)
        return _checked(halved.points, cells, halved)


def _triangulation(
    domain: Domain, size: SizeField, options: MeshOptions, monitor: Monitor
) -> tuple[Outline, Triangulation]:
    """Return the outline, renumbered, and the triangulation of the packed nodes, sorted along a Hilbert curve."""
    monitor.step(0.0, "placing nodes on the boundary")
    rim, region, size = _uncrossed(domain, size, options.scale)
    seeds = seeded(region, size, options, SubMonitor(monitor, 0.0, 0.2))
    nodes = packed(rim, region, seeds, size, options, SubMonitor(monitor, 0.2, 0.8))
    order = hilbert_order(nodes)
    rank = np.empty(len(nodes), dtype=np.int32)
    rank[order] = np.arange(len(nodes), dtype=np.int32)
    curve, fixed = np.full(len(nodes), -1, dtype=np.int32), np.zeros(len(nodes), dtype=bool)
    at = rank[: len(rim.points)]
    curve[at], fixed[at] = rim.curve, rim.fixed
    edges = at[rim.edges]
    mesh = triangulated(nodes[order], edges, bounding=rim.bounding, monitor=SubMonitor(monitor, 0.8, 1.0))
    return Outline(mesh.points, curve, fixed, edges, rim.bounding, rim.along), mesh


def _uncrossed(domain: Domain, size: SizeField, scale: float) -> tuple[Outline, RegionArrays, SizeField]:
    """Return the outline, where points may be packed, and the sizes that there is room for.

    Edges are chords of curves, and cross where two walls almost touch. Sizes are lowered there, until they do not or
    vertices of the curves become nodes.
    """
    for n in range(UNCROSSINGS + 1):
        net, fitting = fitted(domain, size, scale)
        rim = outline(domain, fitting, scale, net)
        try:
            return rim, region_arrays(domain, rim), fitting
        except InputError as error:
            ends = rim.points[rim.edges]
            chords = shapely.linestrings(ends)
            crossed = np.unique(shapely.STRtree(chords).query(chords, predicate="crosses"))
            if n == UNCROSSINGS or not len(crossed):
                raise MeshingError(
                    f"{domain.label}: edges along two walls that almost touch cross each other; make the sizes there "
                    f"smaller, or the gap wider, or close it ({error})"
                ) from None
            size = capped(fitting, ends[crossed].mean(axis=1), 0.5 * rim.lengths[crossed] / scale)
    raise AssertionError("the last attempt returns or raises")


def _halved(rim: Outline, domain: Domain, points: NDArray[np.float64], edges: NDArray[np.int32]) -> Outline:
    """Return the outline of the split mesh: each of its edges in two halves that meet on the curve.

    Parameters
    ----------
    rim : Outline
        The outline before.
    domain : Domain
        Its curves.
    points, edges
        What ``split`` returned.
    """
    n = len(rim.points)
    keys = edges[:, 0].astype(np.int64) * n + edges[:, 1]
    low, high = rim.edges.min(axis=1).astype(np.int64), rim.edges.max(axis=1)
    order = np.argsort(keys)
    middle = n + order[np.searchsorted(keys, low * n + high, sorter=order)]
    curve, fixed = np.full(len(points), -1, dtype=np.int32), np.zeros(len(points), dtype=bool)
    curve[:n], fixed[:n], curve[middle] = rim.curve, rim.fixed, rim.along
    moved = points.copy()
    for c, one in enumerate(domain.curves):
        if len(one.points) > 2 or one.closed:
            at = middle[rim.along == c]
            path = LineString(np.vstack([one.points, one.points[:1]]) if one.closed else one.points)
            here = shapely.points(points[at])
            moved[at] = shapely.get_coordinates(line_interpolate_point(path, line_locate_point(path, here)))
    halves = np.vstack([np.column_stack([rim.edges[:, 0], middle]), np.column_stack([middle, rim.edges[:, 1]])])
    return Outline(moved, curve, fixed, halves.astype(np.int32), np.tile(rim.bounding, 2), np.tile(rim.along, 2))


def _checked(points: NDArray[np.float64], quads: NDArray[np.int32], rim: Outline) -> QuadMesh:
    """Return the mesh, after a check that it is one."""
    mesh = QuadMesh(points, quads, rim.curve, rim.fixed)
    verify(mesh, rim.edges, rim.bounding, rim.area)
    return mesh
