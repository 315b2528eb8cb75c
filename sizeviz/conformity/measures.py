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
    x, y = (mesh.points[:, k][mesh.quads] for k in range(2))
    x, y = np.roll(x, -1, axis=1) - x, np.roll(y, -1, axis=1) - y
    return np.sqrt(x * x + y * y)


def element_sizes(mesh: QuadMesh, measure: Measure = "mean-edge") -> NDArray[np.float64]:
    """Return the size of each element, ``(Q,)``, in model units.

    Raises
    ------
    InputError
        If the measure has another name than those of ``MEASURES``.
    """
    if measure == "sqrt-area":
        return np.sqrt(np.maximum(mesh.areas, 0.0))
    if measure not in MEASURES:
        raise InputError(f"measure {measure!r} is unknown; choose one of {', '.join(MEASURES)}")
    return _mean_edge(edge_lengths(mesh)) if measure == "mean-edge" else _max_edge(edge_lengths(mesh))


def all_element_sizes(mesh: QuadMesh) -> dict[Measure, NDArray[np.float64]]:
    """Return the size of each element by every measure, ``(Q,)`` each, in model units."""
    lengths = edge_lengths(mesh)
    return {
        "mean-edge": _mean_edge(lengths),
        "sqrt-area": element_sizes(mesh, "sqrt-area"),
        "max-edge": _max_edge(lengths),
    }


def _mean_edge(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b, c, d = lengths.T  # numpy's own sums over four columns take several times as long
    return 0.25 * ((a + b) + (c + d))


def _max_edge(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b, c, d = lengths.T
    return np.maximum(np.maximum(a, b), np.maximum(c, d))


def shape_quality(mesh: QuadMesh) -> NDArray[np.float64]:
    """Return the shape quality of each element, ``(Q,)``: 1 for a square, 0 where a corner is flat or inverted.

    The harmonic mean over the four corners of 2 sigma / |S|^2, where S holds the two edges at the corner and sigma is
    its determinant (Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comput. 23, 2001, DOI
    10.1137/S1064827500371499).
    """
    x, y = (mesh.points[:, k][mesh.quads] for k in range(2))
    x, y = np.roll(x, -1, axis=1) - x, np.roll(y, -1, axis=1) - y  # from corner k to k + 1
    before_x, before_y = np.roll(x, 1, axis=1), np.roll(y, 1, axis=1)
    sigma = before_x * y - before_y * x
    norm2 = x * x + y * y
    norm2 = norm2 + np.roll(norm2, 1, axis=1)
    valid = (sigma > 0.0).all(axis=1)
    a, b, c, d = (norm2[valid] / sigma[valid]).T
    quality = np.zeros(len(sigma))
    quality[valid] = 8.0 / ((a + b) + (c + d))
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
