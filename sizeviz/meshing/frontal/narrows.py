"""Places where a domain leaves less room than the sizes ask for: sharp corners, gaps, short pieces of its outline.

There the domain decides how large an element can be. Sizes shrink towards such places and grow away from them, so
that elements keep their shape; a sharp corner gets one element, a kite between two nodes on its sides and one inside.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.spatial import cKDTree

from sizeviz.meshing.frontal import _boundary_kernels as kernels
from sizeviz.meshing.frontal.boundary import least_count
from sizeviz.meshing.frontal.network import TOUCHING, Network, Piece, network, position_on, unrolled
from sizeviz.sizing.capped import capped

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import Curve, Domain
    from sizeviz.sizing import SizeField

SHARP = np.deg2rad(62.0)
"""Corners below this angle get a kite."""

BLUNTEST = 0.05
"""Least growth from row to row in a sharp corner, half of whose angle has a smaller tangent."""

SHORT = 0.7
"""A piece whose edges are shorter than this share of the size lets the size grow from there."""

WIDE = 0.8
"""A gap narrower than this share of the size is filled by elements as wide as it is."""

NARROWEST = 0.125
"""Gaps narrower than this share of the size are filled by longer elements: a crack would need countless square ones."""

BEYOND = 0.3
"""Where a kite's inner node lies; at 0.25 all four would lie on one circle, and its diagonal might be the wrong one."""

FACING = -0.7
"""Scalar product of the normals of walls that face each other."""

REFINED = 3
"""Times that samples are added between those in a gap."""


@dataclass(frozen=True)
class _End:
    """One end of a piece, at a node."""

    piece: int
    last: bool
    angle: float


@dataclass(frozen=True)
class _Corner:
    """A sharp corner: its node, the two piece ends that form it, counter-clockwise, and its angle in radians."""

    node: int
    right: _End
    left: _End
    angle: float


def fitted(domain: Domain, size: SizeField, scale: float) -> tuple[Network, SizeField]:
    """Return the network of a domain with a kite in every sharp corner, and the sizes that the domain has room for.

    Parameters
    ----------
    domain : Domain
        Its loops, lines and points.
    size : SizeField
        Sizes; where there is room enough they are what is returned.
    scale : float
        Element size asked for relative to the field.
    """
    net = network(domain, size, scale)
    net, places, caps, tips = _with_kites(net, domain.curves, size, scale)
    points, bounds = [*places], [*caps]
    for piece in net.pieces:
        if not piece.whole:
            more, least = _short(domain.curves[piece.curve], piece, size, scale)
            points.append(more)
            bounds.append(least)
    for more, least in (_gaps(net, domain.curves, size, scale, tips), _near_points(domain, size, scale)):
        points.append(more)
        bounds.append(least)
    return net, capped(size, np.vstack(points), np.concatenate(bounds) / scale)


def _with_kites(
    net: Network, curves: tuple[Curve, ...], size: SizeField, scale: float
) -> tuple[Network, list[NDArray[np.float64]], list[NDArray[np.float64]], NDArray[np.float64]]:
    """Cut the pieces beside every sharp corner; return the places and bounds of sizes there, and each tip's reach.

    The last array has a row ``x, y, reach`` for each corner.
    """
    pieces = list(net.pieces)
    points, curve, fixed = [net.points], [net.curve], [net.fixed]
    places, caps, tips, kites = [], [], [], []
    cut: dict[tuple[int, bool], tuple[float, int]] = {}
    n = len(net.points)
    for corner in _corners(net, curves, size, scale):
        tip = net.points[corner.node]
        growth = max(float(np.tan(0.5 * corner.angle)), BLUNTEST)
        length = scale * float(size.at(tip[None])[0])
        for end in (corner.right, corner.left):
            piece = pieces[end.piece]
            length = min(length, 0.4 * (piece.end - piece.begin))
        for _ in range(3):
            sides = [_from(curves, pieces[end.piece], end.last, length) for end in (corner.right, corner.left)]
            middle = 0.5 * (sides[0] + sides[1])
            length = min(length, scale * float(size.at(np.vstack([*sides, middle])).min()))
        sides = [_from(curves, pieces[end.piece], end.last, length) for end in (corner.right, corner.left)]
        middle = 0.5 * (sides[0] + sides[1])
        axis, across = middle - tip, sides[1] - sides[0]
        inner = middle + BEYOND * axis * float(across @ across) / max(float(axis @ axis), 1e-300)
        for k, end in enumerate((corner.right, corner.left)):
            cut[end.piece, end.last] = length, n + k
        points.append(np.vstack([*sides, inner]))
        curve.append(np.array([pieces[corner.right.piece].curve, pieces[corner.left.piece].curve, -1]))
        fixed.append(np.array([True, True, False]))
        kites.append([corner.node, n, n + 2, n + 1])
        n += 3
        reach = scale * float(size.sizes.max()) / growth
        at = length * 1.2 ** np.arange(1 + max(0, int(np.log(max(reach / length, 1.0)) / np.log(1.2))))
        rows = [np.vstack([tip[None], inner[None]])]
        bounds = [np.full(2, growth * length)]
        for end in (corner.right, corner.left):
            piece = pieces[end.piece]
            near = at[at < 0.9 * (piece.end - piece.begin)]
            rows.append(np.array([_from(curves, piece, end.last, s) for s in near]).reshape(-1, 2))
            bounds.append(growth * near)
        places += rows
        caps += bounds
        tips.append([*tip, min(reach, float(at[-1]))])
    for (k, last), (length, node) in cut.items():
        piece = pieces[k]
        if last:
            pieces[k] = replace(piece, end=piece.end - length, last=node)
            pieces.append(Piece(piece.curve, piece.end - length, piece.end, node, piece.last, whole=True))
        else:
            pieces[k] = replace(piece, begin=piece.begin + length, first=node)
            pieces.append(Piece(piece.curve, piece.begin, piece.begin + length, piece.first, node, whole=True))
    merged = Network(
        np.vstack(points),
        np.concatenate(curve).astype(np.int32),
        np.concatenate(fixed),
        tuple(pieces),
        np.array(kites, dtype=np.int32).reshape(-1, 4),
    )
    return merged, places, caps, np.array(tips).reshape(-1, 3)


def _from(curves: tuple[Curve, ...], piece: Piece, last: bool, length: float) -> NDArray[np.float64]:
    """Return the point of a piece at an arc length from one of its ends."""
    return position_on(curves[piece.curve], piece.end - length if last else piece.begin + length)


def _corners(net: Network, curves: tuple[Curve, ...], size: SizeField, scale: float) -> list[_Corner]:
    """Return the corners of the domain's regions below the angle ``SHARP``."""
    ends: dict[int, list[_End]] = {}
    for k, piece in enumerate(net.pieces):
        for last, node in ((False, piece.first), (True, piece.last)):
            at = net.points[node]
            length = min(0.3 * scale * float(size.at(at[None])[0]), 0.3 * (piece.end - piece.begin))
            away = _from(curves, piece, last, length) - at
            ends.setdefault(node, []).append(_End(k, last, float(np.arctan2(away[1], away[0]))))
    found = []
    for node, around in ends.items():
        if len(around) < 2:
            continue
        ordered = sorted(around, key=lambda end: end.angle)
        for right, left in zip(ordered, [*ordered[1:], ordered[0]], strict=True):
            angle = (left.angle - right.angle) % (2.0 * np.pi)
            # the domain is on the left of its boundary: beyond an end that arrives here it is outside
            inside = curves[net.pieces[right.piece].curve].inner or not right.last
            if inside and 1e-6 < angle < SHARP:
                found.append(_Corner(node, right, left, angle))
    return found


def _short(
    curve: Curve, piece: Piece, size: SizeField, scale: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return nodes of a piece that must be divided more finely than its sizes ask, and the length of its edges."""
    points, stations = unrolled(curve)
    _, totals = kernels.marched(points, stations, piece.begin, piece.end, size.sampler, scale)
    count = least_count(curve, piece, float(totals[-1]))
    if totals[-1] > SHORT * count:
        return np.empty((0, 2)), np.empty(0)
    at = np.linspace(piece.begin, piece.end, count + 1)
    return kernels.places(points, stations, at), np.full(count + 1, (piece.end - piece.begin) / count)


def _gaps(
    net: Network, curves: tuple[Curve, ...], size: SizeField, scale: float, tips: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places on walls that face each other across less than an element, and how far apart they are."""
    walls = _Walls(curves)
    places, widths = [np.empty((0, 2))], [np.empty(0)]
    for piece in net.pieces:
        curve = curves[piece.curve]
        points, stations = unrolled(curve)
        stops, totals = kernels.marched(points, stations, piece.begin, piece.end, size.sampler, scale)
        n = max(2, int(np.ceil(2.0 * totals[-1])))
        at = np.interp((np.arange(n) + 0.5) * (totals[-1] / n), totals, stops)
        done = np.empty(0)
        for _ in range(REFINED):
            at = np.setdiff1d(at, done)
            if not len(at):
                break
            here = kernels.places(points, stations, at)
            asked = scale * size.at(here)
            normal = _normals(points, stations, at)
            room = np.full(len(at), np.inf)
            for side in (1.0, -1.0) if curve.inner else (1.0,):
                room = np.minimum(room, walls.across(here, side * normal, asked))
            for x, y, reach in tips:
                room[np.hypot(here[:, 0] - x, here[:, 1] - y) < reach] = np.inf
            narrow = room < WIDE * asked
            places.append(here[narrow])
            widths.append(np.maximum(room, NARROWEST * asked)[narrow])
            done = np.concatenate([done, at])
            step = np.maximum(room, NARROWEST * asked)[narrow]
            at = np.unique(np.concatenate([at[narrow] - 0.5 * step, at[narrow] + 0.5 * step]))
            at = at[(at > piece.begin) & (at < piece.end)]
    return np.vstack(places), np.concatenate(widths)


def _near_points(domain: Domain, size: SizeField, scale: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return fixed points that lie closer to a curve or to one another than the sizes ask, and how close.

    The place on the curve that is nearest counts too. A point, unlike a gap, may be as narrow as it likes: the
    elements that sizes need to grow from there are few.
    """
    at = np.unique(domain.fixed_points, axis=0)
    if not len(at):
        return np.empty((0, 2)), np.empty(0)
    x0, y0, x1, y1 = domain.bounds
    paths = [np.vstack([c.points, c.points[:1]]) if c.closed else c.points for c in domain.curves]
    lines = shapely.linestrings(np.vstack(paths), indices=np.repeat(np.arange(len(paths)), [len(p) for p in paths]))
    near, away = shapely.STRtree(lines).query_nearest(shapely.points(at), return_distance=True, all_matches=False)
    path, away = lines[near[1]], away.astype(np.float64)
    foot = shapely.get_coordinates(
        shapely.line_interpolate_point(path, shapely.line_locate_point(path, shapely.points(at)))
    )
    off = away > TOUCHING * max(x1 - x0, y1 - y0)
    at, foot, away = at[off], foot[off], away[off]
    if len(at) > 1:
        away = np.minimum(away, cKDTree(at).query(at, k=2)[0][:, 1])
    narrow = away < WIDE * scale * size.at(at)
    at, foot, away = at[narrow], foot[narrow], away[narrow]
    # to a place on a curve further away than another point, sizes grow from both
    return np.vstack([at, foot]), np.concatenate([away, np.maximum(away, np.hypot(*(foot - at).T))])


def _normals(
    points: NDArray[np.float64], stations: NDArray[np.float64], at: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the unit normals to the left of a polyline at some arc lengths."""
    k = np.clip(np.searchsorted(stations, at, side="right") - 1, 0, len(stations) - 2)
    step = points[k + 1] - points[k]
    return np.column_stack([-step[:, 1], step[:, 0]]) / np.hypot(*step.T)[:, None]


class _Walls:
    """The segments of all curves, to be looked for along rays."""

    def __init__(self, curves: tuple[Curve, ...]) -> None:
        rings = [np.vstack([c.points, c.points[:1]]) if c.closed else c.points for c in curves]
        self.start = np.vstack([ring[:-1] for ring in rings])
        self.step = np.vstack([np.diff(ring, axis=0) for ring in rings])
        self.two_sided = np.repeat([c.inner for c in curves], [len(ring) - 1 for ring in rings])
        self.tree = shapely.STRtree(shapely.linestrings(np.stack([self.start, self.start + self.step], axis=1)))

    def across(
        self, here: NDArray[np.float64], normal: NDArray[np.float64], reach: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return how far each place is, along its normal, from the first wall that faces it; infinity if too far."""
        rays = shapely.linestrings(np.stack([here, here + reach[:, None] * normal], axis=1))
        ray, wall = self.tree.query(rays, predicate="intersects")
        n, s = normal[ray], self.step[wall]
        gap = self.start[wall] - here[ray]
        det = n[:, 0] * s[:, 1] - n[:, 1] * s[:, 0]
        away = (gap[:, 0] * s[:, 1] - gap[:, 1] * s[:, 0]) / np.where(det == 0.0, np.inf, det)
        # the wall's own normal, to its left, times the ray's: negative where the two look at each other
        facing = -det / np.hypot(*s.T)
        facing = np.where(self.two_sided[wall], -np.abs(facing), facing)
        room = np.full(len(here), np.inf)
        seen = (facing < FACING) & (away > 1e-9 * reach[ray])
        np.minimum.at(room, ray[seen], away[seen])
        return room
