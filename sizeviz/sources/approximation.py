"""A background mesh for a formula: refined until the piecewise-linear field is close to it everywhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.convert import EXTREME
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
"""Refinements after which what remains is taken for a jump; the error reached is then told."""

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
    from sizeviz.geometry.delaunay import delaunay  # here, so that listing the examples does not load numba

    points = _first_nodes(domain, seeds)
    sizes = _checked(function, points, label)
    triangles = delaunay(points)
    seen, by_length, error = np.empty(0, dtype=np.int64), False, 0.0
    for turn in range(ROUNDS + 1):
        monitor.step(turn / (ROUNDS + 1), "Approximating the formula")
        new, good, left, right = _on_edges(function, points, sizes, triangles, seen, by_length, label)
        seen, error = np.sort(np.concatenate([seen, good])), max(error, right)
        if not len(new):
            new, left, right = _within(function, points, sizes, triangles, label)
        if turn == ROUNDS:
            error = max(error, left, right)
        if turn == ROUNDS or (not len(new) and by_length):
            error = max(error, right)
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
    return AnalyticSize(function, field, label, float(error))


def shortfall(size: AnalyticSize) -> str:
    """Return what to add to a label where the field is further from its formula than it should be, else nothing."""
    if size.error is None or size.error <= TOLERANCE:
        return ""
    return f" (its background is off by up to {100.0 * size.error:.3g} %: does the formula jump?)"


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
        If one is not finite and above 0, or beyond all measure.
    """
    told = function(points[..., 0], points[..., 1])
    try:
        sizes = np.broadcast_to(np.asarray(told, dtype=np.float64), points.shape[:-1])
    except (TypeError, ValueError):
        raise InputError(f"{label}: it must return numbers, as many as it is given places") from None
    bad = ~(np.isfinite(sizes) & (sizes > 0))
    if bad.any():
        x, y = points[bad][0]
        raise InputError(
            f"{label}: the size is {sizes[bad][0]:g} at ({x:g}, {y:g}); it must be finite and above 0 everywhere"
        )
    if sizes.max() > EXTREME:
        raise InputError(f"{label}: the size reaches {sizes.max():g}, beyond {EXTREME:g}; change its unit")
    return sizes


def _distinct(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return sorted keys, each once; several times as fast as numpy's hashing."""
    keys = np.sort(keys)
    return keys[np.concatenate([[True], keys[1:] != keys[:-1]])]


def _on_edges(
    function: Function,
    points: NDArray[np.float64],
    sizes: NDArray[np.float64],
    triangles: NDArray[np.int32],
    seen: NDArray[np.int64],
    by_length: bool,
    label: str,
) -> tuple[NDArray[np.float64], NDArray[np.int64], float, float]:
    """Return what the edges that are not among those ``seen``, sorted, ask for.

    Returns
    -------
    new : (N, 2) float64
        Nodes on edges that are not good.
    good : (G,) int64
        Edges found good.
    left, right : float
        Largest relative error on those that are not good, and on those that are.
    """
    a, b = triangles.astype(np.int64), np.roll(triangles, -1, axis=1).astype(np.int64)
    keys = _distinct((np.minimum(a, b) << 32 | np.maximum(a, b)).ravel())
    if len(seen):
        keys = keys[seen[np.minimum(np.searchsorted(seen, keys), len(seen) - 1)] != keys]
    a, b = keys >> 32, keys & 0xFFFFFFFF
    span = points[b] - points[a]
    true = _checked(function, points[a][:, None] + STATIONS[:, None] * span[:, None], label)
    error = np.abs(sizes[a][:, None] + STATIONS * (sizes[b] - sizes[a])[:, None] - true) / true
    worst = error.argmax(axis=1)
    most = error[np.arange(len(keys)), worst]
    off = most > TOLERANCE
    least = np.minimum(true.min(axis=1), np.minimum(sizes[a], sizes[b]))
    wanted = off | (by_length & (np.hypot(span[:, 0], span[:, 1]) > LONGEST_EDGE * least))
    share = np.full(len(keys), 0.5)
    share[off] = _worst_places(function, points[a[off]], span[off], sizes[a[off]], sizes[b[off]], STATIONS[worst[off]])
    new = (points[a] + share[:, None] * span)[wanted]
    return new, keys[~wanted], float(most[off].max(initial=0.0)), float(most[~wanted].max(initial=0.0))


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
) -> tuple[NDArray[np.float64], float, float]:
    """Return the centroids of the triangles where the field is off by more than the tolerance, and the largest errors.

    The first error is that of those triangles, the second that of the others.
    """
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    centres = (points[a] + points[b] + points[c]) / 3.0
    true = _checked(function, centres, label)
    error = np.abs((sizes[a] + sizes[b] + sizes[c]) / 3.0 - true) / true
    off = error > TOLERANCE
    return centres[off], float(error[off].max(initial=0.0)), float(error[~off].max(initial=0.0))
