"""The elements of a part of a mesh replaced by others, between the same boundary nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import MeshingError
from sizeviz.geometry import QuadMesh
from sizeviz.geometry.arrays import read_only
from sizeviz.geometry.delaunay import hilbert_order, triangulated
from sizeviz.meshing.checks import edges_of, verify
from sizeviz.meshing.frontal.boundary import Outline
from sizeviz.meshing.frontal.mending import mended
from sizeviz.meshing.frontal.packing import packed, seeded
from sizeviz.meshing.frontal.region import enclosed
from sizeviz.monitor import SILENT, Monitor, SubMonitor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.meshing.options import MeshOptions
    from sizeviz.sizing import SizeField


def refilled(
    mesh: QuadMesh,
    lines: NDArray[np.integer],
    size: SizeField,
    options: MeshOptions,
    monitor: Monitor = SILENT,
) -> QuadMesh:
    """Return a mesh of the same boundary, inner lines and fixed nodes, whose other nodes are packed anew.

    Unlike `sizeviz.meshing.generated`, which lays nodes along curves, it takes those that there are: a part of a mesh
    can be replaced, and still fits what is around it.

    Parameters
    ----------
    mesh : QuadMesh
        What is replaced; no element may be inverted.
    lines : (E, 2) int
        Pairs of nodes along inner lines; those that are no edges of the mesh are ignored.
    size : SizeField
        Sizes.
    options : MeshOptions
        Seed, scale and limit of elements.
    monitor : Monitor
        Progress and cancel.

    Returns
    -------
    QuadMesh
        The nodes that were kept come first, in their order.

    Raises
    ------
    MeshingError
        If nodes so placed cannot be joined to quadrilaterals.
    """
    kept, rim = _outline(mesh, lines)
    box = read_only(np.concatenate([rim.points.min(axis=0), rim.points.max(axis=0)]))
    region = enclosed(box, rim)
    seeds = seeded(region, size, options, SubMonitor(monitor, 0.0, 0.2))
    nodes = packed(rim, region, seeds, size, options, SubMonitor(monitor, 0.2, 0.7))
    order = hilbert_order(nodes)
    rank = np.empty(len(nodes), dtype=np.int32)
    rank[order] = np.arange(len(nodes), dtype=np.int32)
    triangles = triangulated(nodes[order], rank[rim.edges], bounding=rim.bounding)
    triangles, quads, single = mended(triangles, SubMonitor(monitor, 0.7, 1.0))
    if len(single):
        raise MeshingError(f"{len(single)} triangles of a part that was to be meshed again could not be joined")
    curve, fixed = np.full(len(nodes), -1, dtype=np.int32), np.zeros(len(nodes), dtype=bool)
    curve[: len(kept)], fixed[: len(kept)] = rim.curve, rim.fixed
    filled = QuadMesh(nodes, read_only(order[quads].astype(np.int32)), curve, fixed)
    verify(filled, rim.edges, rim.bounding, rim.area)
    return filled


def _outline(mesh: QuadMesh, lines: NDArray[np.integer]) -> tuple[NDArray[np.int64], Outline]:
    """Return the nodes that are kept, and the outline they make, whose boundary edges have the mesh on their left."""
    width = mesh.n_points
    edges, count = edges_of(mesh.quads)
    keys = edges[:, 0].astype(np.int64) * width + edges[:, 1]
    sides = np.vstack([mesh.quads[:, [k, (k + 1) % 4]] for k in range(4)]).astype(np.int64)
    single = keys[count == 1]
    bounding = sides[np.isin(sides.min(axis=1) * width + sides.max(axis=1), single)]
    inner = np.unique(np.sort(np.asarray(lines, dtype=np.int64), axis=1), axis=0)
    mine = inner[:, 0] * width + inner[:, 1]
    inner = inner[np.isin(mine, keys) & ~np.isin(mine, single)]
    keep = mesh.fixed | (mesh.curve >= 0)
    keep[bounding] = True
    kept = np.flatnonzero(keep)
    rank = np.cumsum(keep) - 1
    both = rank[np.vstack([bounding, inner])].astype(np.int32)
    return kept, Outline(
        mesh.points[kept],
        mesh.curve[kept],
        mesh.fixed[kept],
        both,
        np.arange(len(both)) < len(bounding),
        np.full(len(both), -1, dtype=np.int32),
    )
