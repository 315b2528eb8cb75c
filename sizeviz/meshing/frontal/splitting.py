"""Every element cut into quadrilaterals: four from a quadrilateral, three from a triangle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.meshing.checks import edges_of

if TYPE_CHECKING:
    from numpy.typing import NDArray


def split(
    points: NDArray[np.float64], quads: NDArray[np.int32], triangles: NDArray[np.int32]
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]:
    """Cut every element at its centre and the middles of its edges.

    Parameters
    ----------
    points : (N, 2) float64
        Nodes.
    quads : (Q, 4) int32
        Quadrilaterals.
    triangles : (T, 3) int32
        Triangles that remain beside them.

    Returns
    -------
    points : (N + E + Q + T, 2) float64
        The nodes, then the middles of the edges, then the elements' centres.
    quads : (4 Q + 3 T, 4) int32
        Counter-clockwise where the elements were.
    edges : (E, 2) int32
        The edges, in the order of their middles.
    """
    closed = np.column_stack([triangles, triangles[:, 0]])  # the repeated corner adds an edge from it to itself
    edges, _ = edges_of(np.vstack([quads, closed]).astype(np.int32))
    edges = edges[edges[:, 0] != edges[:, 1]]
    width = np.int64(len(points))
    keys = edges[:, 0].astype(np.int64) * width + edges[:, 1]
    order = np.argsort(keys)
    new, first_centre = [points, points[edges].mean(axis=1)], len(points) + len(edges)
    cells = []
    for corners in (quads, triangles):
        ahead = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1), axis=-1).astype(np.int64)
        middle = len(points) + order[np.searchsorted(keys, ahead[..., 0] * width + ahead[..., 1], sorter=order)]
        centre = first_centre + np.arange(len(corners))
        for k in range(corners.shape[1]):
            cells.append(np.column_stack([corners[:, k], middle[:, k], centre, middle[:, k - 1]]))
        new.append(points[corners].mean(axis=1))
        first_centre += len(corners)
    return np.vstack(new), np.vstack(cells).astype(np.int32), edges
