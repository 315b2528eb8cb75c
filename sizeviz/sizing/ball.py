"""What Algorithm 1 does at one node, step by step: a ball that shrinks until it holds no smaller size.

Ruiz-Gironés, Roca, Sarrate, 22nd International Meshing Roundtable, 2013, DOI 10.1007/978-3-319-02335-9.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import read_only
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sizing.edges import edge_graph

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import NDArray

    from sizeviz.sizing.field import SizeField
    from sizeviz.sizing.line import LineField
    from sizeviz.sizing.options import PreserveOptions

    Edges = Callable[[int], Iterable[tuple[int, float]]]

STEPS_A_WORD = 2048
"""Nodes looked at between two steps of the monitor."""

Case = Literal["i", "ii", "iii", "iv", "v"]
"""The five cases of section 3."""


@dataclass(frozen=True)
class BallStep:
    """One node taken from the heap of Algorithm 1.

    Parameters
    ----------
    node : int
        Which one.
    distance : float
        d, along the edges from the ball's centre, in model units.
    allowed : float
        r', the radius that the node's own size allows.
    before, after : float
        r before and after the step.
    case : {'i', 'ii', 'iii', 'iv', 'v'}
        Smaller ball that holds the node; smaller ball that does not, so that the node lies on the new rim; smaller ball
        but outside the present one; no smaller ball, inside; no smaller ball, outside.
    """

    node: int
    distance: float
    allowed: float
    before: float
    after: float
    case: Case


@dataclass(frozen=True, eq=False)
class BallTrace:
    """The ball of one node, from its prescribed size to the size preserved.

    Parameters
    ----------
    centre : (2,) or (1,) float64
        Where the node lies.
    start : float
        Radius to begin with, alpha times the prescribed size.
    steps : tuple of BallStep
        Nodes in the order in which the heap gives them.
    radius, size : float
        Last radius, and beta / alpha times it: the size preserved with distances along edges.
    blocking : (2,) or (1,) float64
        Where max(h(y), |x - y| / alpha) is least over the whole field: the point that stops the exact ball.
    exact_radius, exact_size : float
        Radius and preserved size with straight distances.
    """

    centre: NDArray[np.float64]
    start: float
    steps: tuple[BallStep, ...]
    radius: float
    size: float
    blocking: NDArray[np.float64]
    exact_radius: float
    exact_size: float


def case_of(radius: float, allowed: float, distance: float) -> Case:
    """Return the case of Algorithm 1 for r, r' and d."""
    if allowed < radius:
        if distance <= allowed:
            return "i"
        return "ii" if distance <= radius else "iii"
    return "iv" if distance <= radius else "v"


def ball_at(field: SizeField, node: int, options: PreserveOptions, monitor: Monitor = SILENT) -> BallTrace:
    """Return how the ball shrinks at one node of a field's background.

    Parameters
    ----------
    field : SizeField
        The prescribed sizes.
    node : int
        Index of the node.
    options : PreserveOptions
        ``distance='edges-as-printed'`` takes line 18 as printed, anything else r = d.
    monitor : Monitor
        Told how much of the ball has been looked at; may cancel.

    Raises
    ------
    InputError
        If there is no such node.
    Cancelled
        If the monitor says so.
    """
    _check_node(node, len(field.sizes))
    begins, ends, lengths = edge_graph(field.background)

    def edges(of: int) -> Iterable[tuple[int, float]]:
        row = slice(begins[of], begins[of + 1])
        return zip(ends[row].tolist(), lengths[row].tolist(), strict=True)

    centre = field.background.points[node]
    places, sizes = _candidates(field, centre, options.alpha)
    return _trace(field.sizes, node, edges, centre, places, sizes, options, monitor)


def ball_on_line(field: LineField, node: int, options: PreserveOptions) -> BallTrace:
    """Return how the ball shrinks at one node of a line; as ``ball_at``."""
    _check_node(node, len(field.x))

    def edges(of: int) -> Iterable[tuple[int, float]]:
        near = (other for other in (of - 1, of + 1) if 0 <= other < len(field.x))
        return ((other, abs(float(field.x[other] - field.x[of]))) for other in near)

    share, row = _crossings(field.x[:-1, None], field.x[1:, None], field.sizes, field.x[node : node + 1], options.alpha)
    places = np.concatenate([field.x, field.x[row] + share * (field.x[row + 1] - field.x[row])])
    return _trace(field.sizes, node, edges, field.x[node : node + 1], places[:, None], field.at(places), options)


def _check_node(node: int, count: int) -> None:
    if not 0 <= node < count:
        raise InputError(f"ball at node {node}: choose a node from 0 to {count - 1}")


def _trace(
    sizes: NDArray[np.float64],
    origin: int,
    edges: Edges,
    centre: NDArray[np.float64],
    places: NDArray[np.float64],
    place_sizes: NDArray[np.float64],
    options: PreserveOptions,
    monitor: Monitor = SILENT,
) -> BallTrace:
    start = options.alpha * float(sizes[origin])
    steps: list[BallStep] = []
    for step in _steps(sizes, origin, edges, options):
        if len(steps) % STEPS_A_WORD == 0:
            monitor.step(min(step.distance / step.before, 1.0), "Shrinking the ball")
        steps.append(step)
    radius = steps[-1].after
    value = np.maximum(place_sizes, np.sqrt(((places - centre) ** 2).sum(axis=1)) / options.alpha)
    best = int(value.argmin())
    return BallTrace(
        centre=read_only(centre.copy()),
        start=start,
        steps=tuple(steps),
        radius=radius,
        size=options.beta * radius / options.alpha,
        blocking=read_only(places[best].copy()),
        exact_radius=options.alpha * float(value[best]),
        exact_size=options.beta * float(value[best]),
    )


def _steps(sizes: NDArray[np.float64], origin: int, edges: Edges, options: PreserveOptions) -> Iterable[BallStep]:
    """Yield the steps of Algorithm 1; Algorithm 2 is the loop at its end."""
    reached, heap = {origin: 0.0}, [(0.0, origin)]
    radius = options.alpha * float(sizes[origin])
    while heap:
        distance, node = heapq.heappop(heap)
        if distance > reached[node]:
            continue
        allowed = options.alpha * float(sizes[node])
        case = case_of(radius, allowed, distance)
        after = radius
        if case == "i":
            after = allowed
        elif case == "ii":
            after = radius + allowed - distance if options.distance == "edges-as-printed" else distance
        yield BallStep(node, distance, allowed, radius, after, case)
        radius = after
        if case not in ("i", "iv"):
            continue
        for other, length in edges(node):
            through = distance + length
            if through < radius and through < reached.get(other, math.inf):
                reached[other] = through
                heapq.heappush(heap, (through, other))


def _candidates(
    field: SizeField, centre: NDArray[np.float64], alpha: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places (N, 2) and their sizes (N,), among them the minimiser of max(h(y), |x - y| / alpha).

    On a triangle it is a corner, the foot of x on an edge, a place on an edge where both terms are equal, or the place
    inside where they are equal on the line of steepest descent through x.
    """
    corners, sizes = field.background.points[field.background.triangles], field.sizes[field.background.triangles]
    least = float(np.maximum(field.sizes, np.hypot(*(field.background.points - centre).T) / alpha).min())
    away = np.maximum(np.maximum(corners.min(axis=1) - centre, centre - corners.max(axis=1)), 0.0)
    near = (sizes.min(axis=1) <= least) & (np.hypot(*away.T) <= alpha * least)
    corners, sizes = corners[near], sizes[near]
    start, stop = corners.reshape(-1, 2), np.roll(corners, -1, axis=1).reshape(-1, 2)
    ends = np.column_stack([sizes.ravel(), np.roll(sizes, -1, axis=1).ravel()])
    share, row = _crossings(start, stop, ends, centre, alpha)
    on_edges = start[row] + share[:, None] * (stop[row] - start[row])
    size_on_edges = ends[row, 0] + share * (ends[row, 1] - ends[row, 0])
    inside, size_inside = _descents(corners, sizes, centre, alpha)
    places = np.vstack([field.background.points, on_edges, inside])
    return places, np.concatenate([field.sizes, size_on_edges, size_inside])


def _crossings(
    start: NDArray[np.float64],
    stop: NDArray[np.float64],
    sizes: NDArray[np.float64],
    centre: NDArray[np.float64],
    alpha: float,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return shares along segments, and which segments: feet of x, and roots of alpha h(y) = |x - y|.

    ``sizes`` are (E, 2), or (E + 1,) where segments follow each other.
    """
    ends = np.column_stack([sizes[:-1], sizes[1:]]) if sizes.ndim == 1 else sizes
    along, back = stop - start, start - centre
    rise = ends[:, 1] - ends[:, 0]
    a = (along**2).sum(axis=1) - (alpha * rise) ** 2
    b = (back * along).sum(axis=1) - alpha**2 * ends[:, 0] * rise
    c = (back**2).sum(axis=1) - (alpha * ends[:, 0]) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        q = -(b + np.copysign(np.sqrt(b * b - a * c), b))
        shares = np.concatenate([q / a, c / q, -(back * along).sum(axis=1) / (along**2).sum(axis=1)])
    rows = np.tile(np.arange(len(start)), 3)
    valid = (shares >= 0.0) & (shares <= 1.0)
    return shares[valid], rows[valid]


def _descents(
    corners: NDArray[np.float64], sizes: NDArray[np.float64], centre: NDArray[np.float64], alpha: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where, inside triangles, size equals distance / alpha on the line of steepest descent through x."""
    frames = corners[:, 1:] - corners[:, :1]
    gradient = np.linalg.solve(frames, (sizes[:, 1:] - sizes[:, :1])[:, :, None])[:, :, 0]
    slope = np.hypot(*gradient.T)
    value = (sizes[:, 0] + (gradient * (centre - corners[:, 0])).sum(axis=1)) / (1.0 + alpha * slope)
    down = np.divide(gradient, slope[:, None], out=np.zeros_like(gradient), where=slope[:, None] > 0.0)
    places = centre - alpha * value[:, None] * down
    weights = np.linalg.solve(frames.transpose(0, 2, 1), (places - corners[:, 0])[:, :, None])[:, :, 0]
    inside = (weights >= 0.0).all(axis=1) & (weights.sum(axis=1) <= 1.0) & (value > 0.0)
    return places[inside], value[inside]
