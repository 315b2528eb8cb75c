"""A size field with an upper bound at some points, from which sizes grow at a steady slope."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sizeviz.geometry.delaunay import triangulated
from sizeviz.sizing._capped_kernels import triangles_into
from sizeviz.sizing.background import BackgroundMesh
from sizeviz.sizing.field import SizeField

if TYPE_CHECKING:
    from numpy.typing import NDArray

SLOPE = 0.5
"""Growth of the bound with distance: every element may be half as large again as the one before it."""

STEP = 0.25
"""Bounds within a factor of 2 to this power are looked up together, so sizes may lie above the bound by as much."""


def capped(field: SizeField, points: NDArray[np.float64], caps: NDArray[np.float64], slope: float = SLOPE) -> SizeField:
    """Return the least of a field and of ``cap + slope · distance`` from every point.

    The points become background nodes. Triangles that no bound reaches stay as they are, and with them the field
    there; the others are triangulated anew.

    Parameters
    ----------
    field : SizeField
        Sizes.
    points : (M, 2) float64
        Where sizes are bounded; points outside the background count where its box is nearest.
    caps : (M,) float64
        Largest size at each point, in model units.
    slope : float
        Growth of the bound with distance.
    """
    x0, y0, x1, y1 = field.background.bounds
    points = np.clip(points, [x0, y0], [x1, y1])
    order = np.lexsort((caps, points[:, 1], points[:, 0]))
    points, caps = points[order], caps[order]
    first = np.append(True, (np.diff(points, axis=0) != 0).any(axis=1)) if len(points) else np.empty(0, dtype=bool)
    points, caps = points[first], caps[first]
    needed = caps < field.at(points)
    points, caps = points[needed], caps[needed]
    if not len(points):
        return field
    at, triangles = field.background.points, field.background.triangles
    bound = _bounds(at, points, caps, slope, float(field.sizes.max()))
    lowered = bound < field.sizes
    own = np.minimum(caps, _bounds(points, points, caps, slope, float(caps.max())))
    sizes = np.concatenate([np.minimum(field.sizes, bound), own])
    return renewed(field, points, sizes, np.asarray(lowered[triangles].any(axis=1)))


def renewed(
    field: SizeField, points: NDArray[np.float64], sizes: NDArray[np.float64], touched: NDArray[np.bool_]
) -> SizeField:
    """Return a field with more background nodes; triangles far from them stay as they are.

    Parameters
    ----------
    field : SizeField
        The field before.
    points : (M, 2) float64
        The additional nodes, all different, in the background's box.
    sizes : (V + M,) float64
        Sizes at the old nodes and at the new ones.
    touched : (T,) bool
        Triangles that are to be made anew even where no point lies in them.
    """
    at, triangles = field.background.points, field.background.triangles
    inside = np.empty(len(points), dtype=np.int64)
    triangles_into(field.sampler, points, inside)
    touched = touched.copy()
    touched[inside] = True
    near = np.zeros(len(at), dtype=bool)
    near[triangles[touched]] = True
    # one ring more, so that no new node lies on the rim of what is made anew
    touched = np.asarray(near[triangles].any(axis=1))
    sides = triangles[touched][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    key = np.sort(sides, axis=1)
    _, index, count = np.unique(key[:, 0].astype(np.int64) * len(at) + key[:, 1], return_index=True, return_counts=True)
    rim = sides[index[count == 1]]
    nodes = np.unique(triangles[touched])
    rank = np.full(len(at), -1, dtype=np.int32)
    rank[nodes] = np.arange(len(nodes), dtype=np.int32)
    anew = triangulated(np.vstack([at[nodes], points]), rank[rim])
    number = np.concatenate([nodes, len(at) + np.arange(len(points))])
    cells = np.vstack([triangles[~touched], number[anew.triangles].astype(np.int32)])
    everywhere = np.vstack([at, points])
    used = np.zeros(len(everywhere), dtype=bool)
    used[cells] = True
    renumbered = np.cumsum(used, dtype=np.int32) - 1
    return SizeField(BackgroundMesh(everywhere[used], renumbered[cells]), sizes[used], field.label)


def _bounds(
    at: NDArray[np.float64], points: NDArray[np.float64], caps: NDArray[np.float64], slope: float, highest: float
) -> NDArray[np.float64]:
    """Return the bound at every place, ``highest`` where none is lower; points of about the same cap go together."""
    bound = np.full(len(at), highest)
    group = np.floor(np.log2(caps) / STEP).astype(np.int64)
    for g in np.unique(group):
        mine = np.flatnonzero(group == g)
        reach = max((highest - float(caps[mine].min())) / slope, 0.0)
        low, high = points[mine].min(axis=0) - reach, points[mine].max(axis=0) + reach
        rows = np.flatnonzero(((at >= low) & (at <= high)).all(axis=1))
        away, which = cKDTree(points[mine]).query(at[rows], distance_upper_bound=reach * (1.0 + 1e-12))
        found = np.isfinite(away)
        rows, away, which = rows[found], away[found], mine[which[found]]
        bound[rows] = np.minimum(bound[rows], caps[which] + slope * away)
    return bound
