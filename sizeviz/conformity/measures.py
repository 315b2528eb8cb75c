"""The size of an element, and its shape quality."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import QuadMesh

Measure = Literal["mean-edge", "sqrt-area", "max-edge"]
"""What stands for an element's size mu(e), which the paper leaves open: mean edge, root of the area, longest edge."""

MEASURES: tuple[Measure, ...] = get_args(Measure)


def edge_lengths(mesh: QuadMesh) -> NDArray[np.float64]:
    """Return the length of each element's four edges, from corner k to k + 1, ``(Q, 4)``, in model units."""
    corners = mesh.points[mesh.quads]
    edges = np.roll(corners, -1, axis=1) - corners
    return np.hypot(edges[:, :, 0], edges[:, :, 1])


def element_sizes(mesh: QuadMesh, measure: Measure = "mean-edge") -> NDArray[np.float64]:
    """Return the size of each element, ``(Q,)``, in model units.

    Raises
    ------
    InputError
        If the measure has another name than those of ``MEASURES``.
    """
    if measure == "mean-edge":
        return edge_lengths(mesh).mean(axis=1)
    if measure == "max-edge":
        return edge_lengths(mesh).max(axis=1)
    if measure == "sqrt-area":
        return np.sqrt(np.maximum(mesh.areas, 0.0))
    raise InputError(f"measure {measure!r} is unknown; choose one of {', '.join(MEASURES)}")


def shape_quality(mesh: QuadMesh) -> NDArray[np.float64]:
    """Return the shape quality of each element, ``(Q,)``: 1 for a square, 0 where a corner is flat or inverted.

    The harmonic mean over the four corners of 2 sigma / |S|^2, where S holds the two edges at the corner and sigma is
    its determinant (Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comput. 23, 2001, DOI
    10.1137/S1064827500371499).
    """
    corners = mesh.points[mesh.quads]
    ahead = np.roll(corners, -1, axis=1) - corners
    behind = np.roll(corners, 1, axis=1) - corners
    sigma = ahead[:, :, 0] * behind[:, :, 1] - ahead[:, :, 1] * behind[:, :, 0]
    norm2 = (ahead**2).sum(axis=2) + (behind**2).sum(axis=2)
    valid = (sigma > 0.0).all(axis=1)
    distortion = norm2[valid] / (2.0 * sigma[valid])
    quality = np.zeros(len(corners))
    quality[valid] = 4.0 / distortion.sum(axis=1)
    return quality


def irregular_fraction(mesh: QuadMesh) -> float:
    """Return the share of interior nodes that do not have four elements, 0 to 1; 0 where no node is interior."""
    corners = mesh.quads
    valence = np.bincount(corners.ravel(), minlength=mesh.n_points)
    interior = valence > 0
    interior[boundary_nodes(mesh)] = False
    return float(np.mean(valence[interior] != 4)) if interior.any() else 0.0


def boundary_nodes(mesh: QuadMesh) -> NDArray[np.int64]:
    """Return the nodes of edges that only one element has, ascending."""
    one, other = mesh.quads.astype(np.int64), np.roll(mesh.quads, -1, axis=1).astype(np.int64)
    keys = np.sort((np.minimum(one, other) * mesh.n_points + np.maximum(one, other)).ravel())
    same = np.flatnonzero(keys[1:] == keys[:-1])
    single = np.ones(len(keys), dtype=bool)
    single[same] = False
    single[same + 1] = False
    return np.unique(np.concatenate([keys[single] // mesh.n_points, keys[single] % mesh.n_points]))
