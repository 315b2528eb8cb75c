"""A size field that is smaller around some places, and what it was everywhere else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from sizeviz.sizing.capped import renewed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.sizing.field import SizeField

INNER, OUTER = 6, 9
"""Nodes put around each place on the circles where the share ends and where the field is itself again."""


def lowered(
    field: SizeField,
    places: NDArray[np.float64],
    reach: NDArray[np.float64],
    share: NDArray[np.float64],
    least: NDArray[np.float64],
) -> SizeField:
    """Return the field times a share within a distance of some places; beyond twice that distance it is as before.

    Parameters
    ----------
    field : SizeField
        Sizes.
    places : (M, 2) float64
        Where sizes are to be smaller.
    reach : (M,) float64
        Up to which distance the whole share counts, in model units.
    share : (M,) float64
        By how much sizes are multiplied there, above 0 and at most 1; where places overlap the smallest size counts.
    least : (M,) float64
        Size that each place lowers none below, in model units.
    """
    if not len(places):
        return field
    x0, y0, x1, y1 = field.background.bounds
    extra = np.clip(np.vstack([places, _pattern(places, reach)]), [x0, y0], [x1, y1])
    extra = _thinned(extra, np.tile(reach, INNER + OUTER + 1))
    everywhere = np.vstack([field.background.points, extra])
    before = np.concatenate([field.sizes, field.at(extra)])
    sizes = before.copy()
    for k, rows in enumerate(cKDTree(everywhere).query_ball_point(places, 2.0 * reach)):
        away = np.hypot(*(everywhere[rows] - places[k]).T) / reach[k]
        factor = share[k] + (1.0 - share[k]) * np.clip(away - 1.0, 0.0, 1.0)
        low = np.maximum(factor * before[rows], np.minimum(before[rows], least[k]))
        sizes[rows] = np.minimum(sizes[rows], low)
    return renewed(field, extra, sizes, np.zeros(len(field.background.triangles), dtype=bool))


def _pattern(places: NDArray[np.float64], reach: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return two circles of points around every place, the points of all places together in turn."""
    rings = []
    for count, radius in ((INNER, 1.0), (OUTER, 2.0)):
        for angle in 2.0 * np.pi * np.arange(count) / count:
            rings.append(places + (radius * reach)[:, None] * [np.cos(angle), np.sin(angle)])
    return np.vstack(rings)


def _thinned(points: NDArray[np.float64], reach: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points without those that share a cell, about a third of a reach wide, with an earlier one."""
    level = np.floor(np.log2(reach / 3.0)).astype(np.int64)
    cells = np.floor(points / np.exp2(level)[:, None]).astype(np.int64)
    _, first = np.unique(np.column_stack([level, cells]), axis=0, return_index=True)
    kept = points[np.sort(first)]
    _, single = np.unique(kept, axis=0, return_index=True)
    return np.asarray(kept[np.sort(single)])
