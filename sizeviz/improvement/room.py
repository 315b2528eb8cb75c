"""Targets that grow from short edges of the boundary, which no smoothing can lengthen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.sizing.capped import capped

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry.quadmesh import QuadMesh
    from sizeviz.sizing import SizeField

SHORT = 0.6
"""Boundary edges shorter than this share of the target lower it."""


def with_room(mesh: QuadMesh, size: SizeField) -> SizeField:
    """Return the targets that a mesh of these boundary nodes can have.

    In sharp corners, gaps and beside nodes that must lie close together the domain decides how large elements are;
    a target far above that would stretch them.

    Parameters
    ----------
    mesh : QuadMesh
        A raw mesh, which follows the sizes where the domain has room for them.
    size : SizeField
        The sizes it was made for.

    Returns
    -------
    SizeField
        The sizes, lower and graded where boundary edges are far shorter; the field itself where none is.
    """
    edges = np.vstack([_boundary_edges(mesh), _fixed_edges(mesh)])
    if not len(edges):
        return size
    length = np.hypot(*(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]).T)
    longest = np.zeros(mesh.n_points)
    for k in range(2):
        np.maximum.at(longest, edges[:, k], length)
    nodes = np.flatnonzero(longest > 0.0)
    short = longest[nodes] < SHORT * size.at(mesh.points[nodes])
    return capped(size, mesh.points[nodes[short]], longest[nodes[short]])


def _fixed_edges(mesh: QuadMesh) -> NDArray[np.int32]:
    """Return the edges ``(E, 2)`` of fixed nodes on no curve, some of them twice."""
    inner = mesh.fixed & (mesh.curve < 0)
    sides = np.vstack([mesh.quads[:, [k, (k + 1) % 4]] for k in range(4)])
    return sides[inner[sides].any(axis=1)]


def _boundary_edges(mesh: QuadMesh) -> NDArray[np.int32]:
    """Return the edges ``(E, 2)`` between nodes on curves that one element has."""
    on = mesh.curve >= 0
    sides = np.vstack([mesh.quads[:, [k, (k + 1) % 4]] for k in range(4)])
    sides = np.sort(sides[on[sides].all(axis=1)], axis=1)
    key = sides[:, 0].astype(np.int64) * mesh.n_points + sides[:, 1]
    _, index, count = np.unique(key, return_index=True, return_counts=True)
    return sides[index[count == 1]]
