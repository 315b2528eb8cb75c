"""Nodes along the curves of a domain, spaced by the size field, an even number of edges around every region."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.meshing.frontal import _boundary_kernels as kernels
from sizeviz.meshing.frontal.network import Network, Piece, network, unrolled

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import Curve, Domain
    from sizeviz.sizing import SizeField

SLACK = 0.15
SLACK_SHARE = 0.03
"""How much of an element a piece may lack before it gets one more edge: sizes are kept rather than exceeded."""

SHARPEST = np.pi / 4
"""A smooth curve turns by at most this (radians) along one edge."""


@dataclass(frozen=True, eq=False)
class Outline:
    """The nodes and edges that the mesh of a domain must have.

    Parameters
    ----------
    points : (B, 2) float64
        Nodes.
    curve : (B,) int32
        A curve of ``Domain.curves`` each lies on; -1 for fixed points inside.
    fixed : (B,) bool
        Nodes that never move.
    edges : (E, 2) int32
        Pairs of nodes.
    bounding : (E,) bool
        Whether an edge lies on the boundary, not on an inner line; the domain is then on its left.
    along : (E,) int32
        The curve of ``Domain.curves`` that each edge follows.
    kites : (K, 4) int32
        The nodes of elements that are settled already, which no other node may lie in.
    """

    points: NDArray[np.float64]
    curve: NDArray[np.int32]
    fixed: NDArray[np.bool_]
    edges: NDArray[np.int32]
    bounding: NDArray[np.bool_]
    along: NDArray[np.int32]
    kites: NDArray[np.int32] = field(default_factory=lambda: np.empty((0, 4), dtype=np.int32))

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Length of each edge, ``(E,)``."""
        return np.hypot(*(self.points[self.edges[:, 1]] - self.points[self.edges[:, 0]]).T)

    @property
    def area(self) -> float:
        """Area that the boundary edges enclose."""
        a, b = (self.points[self.edges[self.bounding, k]] - self.points[0] for k in range(2))
        return float(0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())


def outline(domain: Domain, size: SizeField, scale: float, net: Network | None = None) -> Outline:
    """Return nodes along every curve of the domain.

    Parameters
    ----------
    domain : Domain
        Its corners, the ends and bends of its lines, and its fixed points all become nodes.
    size : SizeField
        Sizes; nodes are placed at equal steps of the integral of 1 / (scale · size).
    scale : float
        Element size asked for relative to the field.
    net : Network, optional
        The domain's pieces; by default ``network`` of it.
    """
    net = net or network(domain, size, scale)
    marches = [_march(domain.curves[piece.curve], piece.begin, piece.end, size, scale) for piece in net.pieces]
    counts = _counts(net, domain.curves, np.array([totals[-1] for _, totals in marches]))
    points, curve, fixed, edges, along = [net.points], [net.curve], [net.fixed], [], []
    n = len(net.points)
    for piece, (stops, totals), count in zip(net.pieces, marches, counts, strict=True):
        at = np.interp(np.arange(1, count) * (totals[-1] / count), totals, stops)
        inner = kernels.places(*unrolled(domain.curves[piece.curve]), at)
        points.append(inner)
        curve.append(np.full(count - 1, piece.curve, dtype=np.int32))
        fixed.append(np.zeros(count - 1, dtype=bool))
        path = np.concatenate([[piece.first], np.arange(n, n + count - 1), [piece.last]])
        edges.append(np.column_stack([path[:-1], path[1:]]))
        along.append(np.full(count, piece.curve, dtype=np.int32))
        n += count - 1
    follows = np.concatenate(along)
    return Outline(
        np.vstack(points),
        np.concatenate(curve).astype(np.int32),
        np.concatenate(fixed),
        np.vstack(edges).astype(np.int32),
        np.array([not one.inner for one in domain.curves])[follows],
        follows,
        net.kites,
    )


def _march(
    curve: Curve, begin: float, end: float, size: SizeField, scale: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    stops, totals = kernels.marched(*unrolled(curve), begin, end, size.sampler, scale)
    return stops, totals


def _counts(net: Network, curves: tuple[Curve, ...], ideal: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the number of edges of each piece: as the sizes ask, then even for every chain that separates."""
    counts = np.array([least_count(curves[piece.curve], piece, ideal[k]) for k, piece in enumerate(net.pieces)])
    for chain in net.chains():
        closed = len(chain) >= 3 or net.pieces[chain[0]].first == net.pieces[chain[0]].last
        while (counts[chain].sum() % 2 and not net.dangles(chain)) or (closed and counts[chain].sum() < 4):
            counts[max(chain, key=lambda k: 0.0 if net.pieces[k].whole else ideal[k] / counts[k])] += 1
    return counts


def least_count(curve: Curve, piece: Piece, ideal: float) -> int:
    """Return into how many edges a piece must be cut at least, where its sizes ask for ``ideal``."""
    if piece.whole:
        return 1
    turning = int(np.ceil(_turning(curve, piece.begin, piece.end) / SHARPEST - 1e-9))
    return max(int(np.ceil(ideal - min(SLACK, SLACK_SHARE * ideal))), turning, 3 if piece.first == piece.last else 1)


def _turning(curve: Curve, begin: float, end: float) -> float:
    """Return by how much a stretch of a curve turns in all, in radians."""
    points, stations = unrolled(curve)
    between = points[(stations > begin) & (stations < end)]
    if len(between) == 0:
        return 0.0
    step = np.diff(between, axis=0)
    if curve.closed and end - begin >= curve.length:
        step = np.diff(np.vstack([curve.points, curve.points[:2]]), axis=0)
    elif len(step) < 2:
        return 0.0
    cross = step[:-1, 0] * step[1:, 1] - step[:-1, 1] * step[1:, 0]
    return float(np.abs(np.arctan2(cross, (step[:-1] * step[1:]).sum(axis=1))).sum())
