"""Doublets: two quadrilaterals that share two edges, and what is left when the node between those goes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.meshing.decomposition import _doublet_kernels

if TYPE_CHECKING:
    from numpy.typing import NDArray


def without_doublets(
    points: NDArray[np.float64], quads: NDArray[np.int32], kept: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.bool_]]:
    """Return the mesh without nodes that only two quadrilaterals share, wherever their union is convex.

    Parameters
    ----------
    points : (N, 2) float64
        Nodes.
    quads : (Q, 4) int32
        Elements.
    kept : (N,) bool
        Nodes that stay: those on the boundary, on inner lines and prescribed ones.

    Returns
    -------
    points, quads
        The mesh that is left, its nodes renumbered in order.
    used : (N,) bool
        Which of the given nodes are left.
    """
    quads = np.array(quads)
    while _doublet_kernels.merge(points, quads, kept):
        quads = quads[quads[:, 0] >= 0]
    used = np.array(kept)
    used[quads] = True
    number = np.cumsum(used, dtype=np.int32) - 1
    return points[used], number[quads].astype(np.int32), used
