"""A background mesh for a formula: refined until the piecewise-linear field is close to it everywhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.delaunay import delaunay
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sizing import AnalyticSize, BackgroundMesh, SizeField

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sizeviz.geometry import Domain

    Function = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

TOLERANCE = 0.01
"""Largest error of the piecewise-linear field, relative to the formula."""

LONGEST_EDGE = 1.5
"""Longest edge of a triangle, in sizes there: its cell is then no larger than the size."""

START = 33
"""Nodes along the longer side of the first background."""

STATIONS = np.linspace(0.0, 1.0, 17)[1:-1]
"""Where along an edge the error is looked for."""

SECTIONS = 40
"""Golden sections that find the worst place on an edge, to 1e-9 of its length."""

ROUNDS = 60
"""Refinements after which what remains is accepted as a jump."""

MOST_NODES = 2_000_000
"""Nodes of a background that are worth building."""


def approximated(
    function: Function,
    domain: Domain,
    label: str,
    seeds: NDArray[np.float64] | None = None,
    monitor: Monitor = SILENT,
) -> AnalyticSize:
    """Return a formula with a piecewise-linear field within 1 % of it over a domain's bounding box.

    A Delaunay triangulation is refined edge by edge: an edge longer than the size at it, or along which the field is
    off by more than the tolerance, gets a node where the error is greatest (its middle if there is none). At a kink the
    error is greatest on the kink, so nodes gather there and edges come to follow it. A feature is found for certain
    where the formula's slope is at most 1; a narrower one can lie between all samples.

    Parameters
    ----------
    function : callable
        Takes x and y, arrays of one shape, and returns the size at each point.
    domain : Domain
        Its bounding box is covered.
    label : str
        What to call the result.
    seeds : (N, 2) float64, optional
        Nodes to begin with, where more is known of the formula; they save rounds, not accuracy.
    monitor : Monitor
        Told of progress; may cancel.

    Raises
    ------
    InputError
        If the formula is not finite and above 0 somewhere, or needs too many nodes.
    """
    points = _first_nodes(domain, seeds)
    sizes = _checked(function, points, label)
    triangles = delaunay(points)
    seen, by_length = np.empty(0, dtype=np.int64), False
    for turn in range(ROUNDS):
        monitor.step(turn / ROUNDS, "Approximating the formula")
        new, seen = _wanted(function, points, sizes, triangles, seen, by_length, label)
        if not len(new) and by_length:
            break
        if not len(new):  # kinks are followed by edges before long edges are halved: fewer nodes fall beside them
            seen, by_length = np.empty(0, dtype=np.int64), True
            continue
        points = np.vstack([points, new])
        if len(points) > MOST_NODES:
            raise InputError(f"{label}: its sizes need more than {MOST_NODES:,} nodes; ask for larger sizes")
        sizes = np.concatenate([sizes, _checked(function, new, label)])
        triangles = delaunay(points)
    monitor.step(1.0)
    field = SizeField(BackgroundMesh(points, triangles), sizes, label)
    return AnalyticSize(function, field, label)


def _first_nodes(domain: Domain, seeds: NDArray[np.float64] | None) -> NDArray[np.float64]:
    """Return a coarse grid over the domain's box, or the seeds in it and the box's corners."""
    x0, y0, x1, y1 = domain.bounds
    step = max(x1 - x0, y1 - y0) / (START - 1)
    if seeds is not None:
        inside = (seeds > (x0, y0)).all(axis=1) & (seeds < (x1, y1)).all(axis=1)
        return np.vstack([seeds[inside], [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]])
    x = np.linspace(x0, x1, max(2, round((x1 - x0) / step) + 1))
    y = np.linspace(y0, y1, max(2, round((y1 - y0) / step) + 1))
    return np.column_stack([grid.ravel() for grid in np.meshgrid(x, y)])


def _checked(function: Function, points: NDArray[np.float64], label: str) -> NDArray[np.float64]:
    """Return the sizes at points (..., 2).

    Raises
    ------
    InputError
        If one is not finite and above 0.
    """
    sizes = np.asarray(function(points[..., 0], points[..., 1]), dtype=np.float64)
    bad = ~(np.isfinite(sizes) & (sizes > 0))
    if bad.any():
        x, y = points[bad][0]
        raise InputError(
            f"{label}: the size is {sizes[bad][0]:g} at ({x:g}, {y:g}); it must be finite and above 0 everywhere"
        )
    return sizes


def _wanted(
    function: Function,
    points: NDArray[np.float64],
    sizes: NDArray[np.float64],
    triangles: NDArray[np.int32],
    seen: NDArray[np.int64],
    by_length: bool,
    label: str,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the nodes that the edges and triangles not yet found good ask for, and all edges now known to be good."""
    pairs = np.sort(np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    keys = np.unique(pairs[:, 0].astype(np.int64) << 32 | pairs[:, 1])
    fresh = keys[~np.isin(keys, seen, assume_unique=True)]
    a, b = fresh >> 32, fresh & 0xFFFFFFFF
    span = points[b] - points[a]
    at = points[a][:, None] + STATIONS[:, None] * span[:, None]
    true = _checked(function, at, label)
    linear = sizes[a][:, None] + STATIONS * (sizes[b] - sizes[a])[:, None]
    error = np.abs(linear - true) / true
    worst = error.argmax(axis=1)
    rows = np.arange(len(fresh))
    off = error[rows, worst] > TOLERANCE
    least = np.minimum(true.min(axis=1), np.minimum(sizes[a], sizes[b]))
    long = by_length & (np.hypot(span[:, 0], span[:, 1]) > LONGEST_EDGE * least)
    share = np.full(len(fresh), 0.5)
    share[off] = _worst_places(function, points[a[off]], span[off], sizes[a[off]], sizes[b[off]], STATIONS[worst[off]])
    new = (points[a] + share[:, None] * span)[off | long]
    inner = _within(function, points, sizes, triangles, label)
    return np.unique(np.vstack([new, inner]), axis=0), np.concatenate([seen, fresh[~(off | long)]])


def _worst_places(
    function: Function,
    start: NDArray[np.float64],
    span: NDArray[np.float64],
    size_a: NDArray[np.float64],
    size_b: NDArray[np.float64],
    near: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return where along edges the error is greatest, by golden sections around the worst station.

    On an edge across a kink the error peaks on the kink, and only nodes that lie on it let edges follow it.
    """
    ratio = (np.sqrt(5.0) - 1.0) / 2.0
    low, high = near - STATIONS[0], near + STATIONS[0]

    def error(share: NDArray[np.float64]) -> NDArray[np.float64]:
        at = start + share[:, None] * span
        return np.abs(size_a + share * (size_b - size_a) - function(at[:, 0], at[:, 1]))

    for _ in range(SECTIONS):
        left, right = high - ratio * (high - low), low + ratio * (high - low)
        better = error(left) > error(right)
        low, high = np.where(better, low, left), np.where(better, right, high)
    return np.clip(0.5 * (low + high), 0.02, 0.98)


def _within(
    function: Function,
    points: NDArray[np.float64],
    sizes: NDArray[np.float64],
    triangles: NDArray[np.int32],
    label: str,
) -> NDArray[np.float64]:
    """Return the centroids of the triangles where the field is off by more than the tolerance."""
    centres = points[triangles].mean(axis=1)
    true = _checked(function, centres, label)
    return centres[np.abs(sizes[triangles].mean(axis=1) - true) > TOLERANCE * true]
