"""Which nodes follow one another along the inner lines of a domain."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.improvement import _curve_kernels
from sizeviz.improvement._workspace import curve_arrays

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry.domain import Domain

ON_LINE = 1e-9
"""Distance from an inner line, over the mesh's width, up to which a fixed node lies on it."""


def line_pairs(
    domain: Domain,
    points: NDArray[np.float64],
    curve: NDArray[np.int32],
    fixed: NDArray[np.bool_],
    width: float,
) -> NDArray[np.int64]:
    """Return pairs of nodes ``(E, 2)`` that are neighbours along an inner line, of which no other lies between.

    Parameters
    ----------
    domain : Domain
        Its inner lines.
    points : (N, 2) float64
        Nodes of a mesh, or of a part of one: where some are left out, pairs may be no edges.
    curve : (N,) int32
        The curve each slides along, -1 for none.
    fixed : (N,) bool
        Which never move: lines may begin, end and meet there.
    width : float
        Of the mesh.
    """
    pairs = [np.empty((0, 2), dtype=np.int64)]
    arrays = curve_arrays(domain)
    for c, one in enumerate(domain.curves):
        if not one.inner:
            continue
        nodes = np.flatnonzero((curve == c) | fixed)
        station, off = np.zeros(len(points)), np.zeros(len(points))
        of = np.full(len(points), c, dtype=np.int32)
        _curve_kernels.project_nodes(arrays, nodes, of, points, station, off)
        on = nodes[off[nodes] <= (ON_LINE * width) ** 2]
        on = on[np.argsort(station[on], kind="stable")]
        pairs.append(np.column_stack([on[:-1], on[1:]]))
        if one.closed or np.array_equal(one.points[0], one.points[-1]):
            pairs.append(np.column_stack([on[-1:], on[:1]]))
    return np.vstack(pairs)
