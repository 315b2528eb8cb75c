"""The curves of a domain cut where they meet: pieces between nodes that must exist."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry.domain import CORNER_ANGLE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import Curve, Domain
    from sizeviz.sizing import SizeField

STRAIGHT = 1e-9
"""A vertex that turns by less than this (radians) need not be kept."""

TOUCHING = 1e-9
"""Two things closer than this, relative to the domain's extent, touch."""


@dataclass(frozen=True)
class Piece:
    """A stretch of a curve between two nodes.

    Parameters
    ----------
    curve : int
        Index into ``Domain.curves``.
    begin, end : float
        Arc lengths along the curve.
    first, last : int
        The nodes at both ends; equal where the piece is a whole closed curve.
    whole : bool
        Whether the piece is to be one edge.
    """

    curve: int
    begin: float
    end: float
    first: int
    last: int
    whole: bool = False


@dataclass(frozen=True, eq=False)
class Network:
    """Pieces and the nodes they meet at.

    Parameters
    ----------
    points : (M, 2) float64
        Nodes at ends of pieces, and fixed points inside.
    curve : (M,) int32
        A curve each node lies on; -1 for fixed points inside.
    fixed : (M,) bool
        Nodes that must stay; the arbitrary first node of a smooth closed curve need not.
    pieces : tuple of Piece
        In the order of the curves, along each.
    kites : (K, 4) int32
        The nodes of the element in each sharp corner, counter-clockwise from its tip.
    """

    points: NDArray[np.float64]
    curve: NDArray[np.int32]
    fixed: NDArray[np.bool_]
    pieces: tuple[Piece, ...]
    kites: NDArray[np.int32] = field(default_factory=lambda: np.empty((0, 4), dtype=np.int32))

    def chains(self) -> list[list[int]]:
        """Return the pieces, by number, joined wherever just two of them meet: loops, and runs between junctions."""
        ends: dict[int, list[int]] = {}
        for k, piece in enumerate(self.pieces):
            ends.setdefault(piece.first, []).append(k)
            ends.setdefault(piece.last, []).append(k)
        left = set(range(len(self.pieces)))
        chains = []
        for k in range(len(self.pieces)):
            if k not in left:
                continue
            left.discard(k)
            chain = [k]
            for node in (self.pieces[k].first, self.pieces[k].last):
                while len(ends[node]) == 2:
                    onward = [j for j in ends[node] if j in left]
                    if not onward:
                        break
                    left.discard(onward[0])
                    chain.append(onward[0])
                    piece = self.pieces[onward[0]]
                    node = piece.last if piece.first == node else piece.first
            chains.append(chain)
        return chains

    def dangles(self, chain: list[int]) -> bool:
        """Return whether a chain ends at a node that no other piece shares: both its sides are one region's."""
        ends = [node for piece in self.pieces for node in (piece.first, piece.last)]
        count = np.bincount(ends, minlength=len(self.points))
        return any(count[node] == 1 for k in chain for node in (self.pieces[k].first, self.pieces[k].last))


class _Nodes:
    """Nodes found so far; one that touches an earlier one is that one."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.points: list[tuple[float, float]] = []
        self.curve: list[int] = []
        self.fixed: list[bool] = []
        self._at: dict[tuple[float, float], int] = {}

    def at(self, point: NDArray[np.float64], curve: int, *, fixed: bool, snap: bool) -> int:
        key = (float(point[0]), float(point[1]))
        found = self._at.get(key, -1)
        if found < 0 and snap and self.points:
            gap = np.hypot(*(np.array(self.points) - key).T)
            found = int(gap.argmin()) if gap.min() <= self.tolerance else -1
        if found < 0:
            found = self._at[key] = len(self.points)
            self.points.append(key)
            self.curve.append(curve)
            self.fixed.append(fixed)
        self.fixed[found] = self.fixed[found] or fixed
        self.curve[found] = max(self.curve[found], curve) if self.curve[found] < 0 else self.curve[found]
        return found


def network(domain: Domain, size: SizeField, scale: float) -> Network:
    """Return the domain's curves cut at their corners and wherever they meet lines or fixed points.

    A vertex is a node too where the segments beside it are longer than the elements: there the outline is a polygon
    to be kept, not the sampling of a curve.
    """
    x0, y0, x1, y1 = domain.bounds
    tolerance = TOUCHING * max(x1 - x0, y1 - y0)
    curves = domain.curves
    stops = _stops(curves, domain.fixed_points, tolerance)
    for k, curve in enumerate(curves):
        stops[k] += _long_vertices(curve, size, scale)
    nodes = _Nodes(tolerance)
    pieces: list[Piece] = []
    for c, (curve, cuts) in enumerate(zip(curves, stops, strict=True)):
        at = _merged(cuts, curve, tolerance)
        ids = [
            nodes.at(position_on(curve, s), c, fixed=bool(cuts) or not curve.closed, snap=bool(domain.lines))
            for s in at
        ]
        if curve.closed:
            at, ids = [*at, at[0] + curve.length], [*ids, ids[0]]
        pieces += [Piece(c, at[k], at[k + 1], ids[k], ids[k + 1]) for k in range(len(at) - 1)]
    for point in domain.fixed_points:
        nodes.at(point, -1, fixed=True, snap=True)
    return Network(
        np.array(nodes.points).reshape(-1, 2),
        np.array(nodes.curve, dtype=np.int32),
        np.array(nodes.fixed),
        tuple(pieces),
    )


def unrolled(curve: Curve) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return vertices and arc lengths in which any stretch of a curve is one range: a closed curve goes round twice."""
    if not curve.closed:
        return curve.points, curve.stations
    points = np.vstack([curve.points, curve.points, curve.points[:1]])
    return points, np.concatenate([curve.stations[:-1], curve.stations + curve.length])


def position_on(curve: Curve, station: float) -> NDArray[np.float64]:
    """Return the point at an arc length."""
    points, stations = unrolled(curve)
    k = int(np.clip(np.searchsorted(stations, station, side="right") - 1, 0, len(stations) - 2))
    share = (station - stations[k]) / (stations[k + 1] - stations[k])
    if share == 1.0:
        return points[k + 1]
    return points[k] + share * (points[k + 1] - points[k])


def _merged(cuts: list[float], curve: Curve, tolerance: float) -> list[float]:
    """Return the cuts in order, without near repeats, with the ends of an open curve among them."""
    if curve.closed:
        at = sorted(s % curve.length for s in cuts) or [0.0]
        kept = [s for k, s in enumerate(at) if k == 0 or s - at[k - 1] > tolerance]
        return kept[:-1] if len(kept) > 1 and kept[0] + curve.length - kept[-1] <= tolerance else kept
    inner = [s for s in sorted(cuts) if tolerance < s < curve.length - tolerance]
    inner = [s for k, s in enumerate(inner) if k == 0 or s - inner[k - 1] > tolerance]
    return [0.0, *inner, curve.length]


def _stops(curves: tuple[Curve, ...], fixed: NDArray[np.float64], tolerance: float) -> list[list[float]]:
    """Return the arc lengths at which each curve must have a node, its own ends aside."""
    stops: list[list[float]] = [[] for _ in curves]
    for c, curve in enumerate(curves):
        if curve.inner:
            stops[c] += list(_bends(curve))
        stops[c] += _touches(curve, fixed, tolerance)
        for other in curves[c + 1 :]:
            if curve.inner or other.inner:
                d = next(k for k in range(c + 1, len(curves)) if curves[k] is other)
                mine, its = _meetings(curve, other, tolerance)
                stops[c] += mine
                stops[d] += its
    return stops


def _turns(curve: Curve) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return arc length, unsigned turn and the shorter of the two segments beside it, but at open ends."""
    points = np.vstack([curve.points[-1:], curve.points, curve.points[:1]]) if curve.closed else curve.points
    step = np.diff(points, axis=0)
    cross = step[:-1, 0] * step[1:, 1] - step[:-1, 1] * step[1:, 0]
    turn = np.abs(np.arctan2(cross, (step[:-1] * step[1:]).sum(axis=1)))
    length = np.hypot(*step.T)
    return curve.stations[:-1] if curve.closed else curve.stations[1:-1], turn, np.minimum(length[:-1], length[1:])


def _bends(curve: Curve) -> NDArray[np.float64]:
    """Return where an inner line turns by more than a corner's angle."""
    stations, turn, _ = _turns(curve)
    return stations[turn > CORNER_ANGLE]


def _long_vertices(curve: Curve, size: SizeField, scale: float) -> list[float]:
    """Return the vertices at which the curve turns and whose segments are longer than the elements there."""
    stations, turn, length = _turns(curve)
    at = np.flatnonzero(turn > STRAIGHT)
    if not len(at):
        return []
    vertices = curve.points if curve.closed else curve.points[1:-1]
    elements = length[at] / (scale * size.at(vertices[at]))
    kept = elements > np.where(turn[at] > CORNER_ANGLE / 2, 0.3, 2.0)
    return [float(s) for s in stations[at[kept]]]


def _touches(curve: Curve, points: NDArray[np.float64], tolerance: float) -> list[float]:
    """Return the arc lengths of the points that lie on a curve."""
    vertices = np.vstack([curve.points, curve.points[:1]]) if curve.closed else curve.points
    a, step = vertices[:-1], np.diff(vertices, axis=0)
    length2 = np.maximum((step**2).sum(axis=1), 1e-300)
    found = []
    for point in points:
        share = np.clip(((point - a) * step).sum(axis=1) / length2, 0.0, 1.0)
        gap = np.hypot(*(a + share[:, None] * step - point).T)
        k = int(gap.argmin())
        if gap[k] <= tolerance:
            found.append(float(curve.stations[k] + share[k] * np.sqrt(length2[k])))
    return found


def _meetings(one: Curve, two: Curve, tolerance: float) -> tuple[list[float], list[float]]:
    """Return the arc lengths on both curves at which they touch or cross."""
    on_one = _touches(one, two.points, tolerance)
    on_two = _touches(two, one.points, tolerance)
    p = np.vstack([one.points, one.points[:1]]) if one.closed else one.points
    q = np.vstack([two.points, two.points[:1]]) if two.closed else two.points
    r, s = np.diff(p, axis=0), np.diff(q, axis=0)
    for j in range(len(s)):
        det = r[:, 0] * s[j, 1] - r[:, 1] * s[j, 0]
        gap = q[j] - p[:-1]
        safe = np.where(det == 0.0, 1.0, det)
        t = (gap[:, 0] * s[j, 1] - gap[:, 1] * s[j, 0]) / safe
        u = (gap[:, 0] * r[:, 1] - gap[:, 1] * r[:, 0]) / safe
        for i in np.flatnonzero((det != 0.0) & (t > 0.0) & (t < 1.0) & (u > 0.0) & (u < 1.0)):
            on_one.append(float(one.stations[i] + t[i] * np.hypot(*r[i])))
            on_two.append(float(two.stations[j] + u[i] * np.hypot(*s[j])))
    return on_one, on_two
