"""Painting sizes: what one stroke of a brush does to a size field, as a pure function of stroke and field."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import as_points, read_only

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.sizing import BackgroundMesh, SizeField

BrushMode = Literal["set", "multiply", "at-most", "smooth", "erase"]
"""Set the size, multiply it, cap it, even it out, or bring the original back."""

StrokeShape = Literal["freehand", "line", "polygon"]
"""A path drawn by hand, a straight polyline, or the inside of a closed one."""

SMOOTHING_ROUNDS = 12
"""Rounds of averaging over the neighbours that one smoothing stroke stands for."""


@dataclass(frozen=True, kw_only=True)
class Brush:
    """What a stroke does and how far it reaches.

    Parameters
    ----------
    mode : {'set', 'multiply', 'at-most', 'smooth', 'erase'}
        What happens under the brush.
    radius : float
        Reach of the brush, in model units, above 0.
    value : float
        Size in model units for 'set' and 'at-most', the factor for 'multiply'; above 0.
    hardness : float
        Share of the radius with full effect, 0 to 1; beyond, the effect falls off smoothly to nothing at the radius.
    mask : (float, float), optional
        Only nodes whose size before the stroke lies in this range change.

    Raises
    ------
    InputError
        If a number is out of its range.
    """

    mode: BrushMode = "set"
    radius: float = 0.05
    value: float = 0.01
    hardness: float = 0.5
    mask: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        for name, number in (("radius", self.radius), ("value", self.value)):
            if not (math.isfinite(number) and number > 0):
                raise InputError(f"brush {name} is {number}; it must be a number above 0")
        if not 0.0 <= self.hardness <= 1.0:
            raise InputError(f"brush hardness is {self.hardness}; give 0 (soft) to 1 (hard)")
        if self.mask is not None and not self.mask[0] <= self.mask[1]:
            raise InputError(f"brush mask {self.mask}: its lower end must not be above its upper one")


@dataclass(frozen=True, eq=False)
class Stroke:
    """One stroke: a brush and the path it took.

    Parameters
    ----------
    brush : Brush
        What it does.
    path : (K, 2) float64
        Points in the order they were visited, at least one; the brush covers all between them.
    shape : {'freehand', 'line', 'polygon'}
        Whether the path is the stroke itself, or the outline of what it fills.
    """

    brush: Brush
    path: NDArray[np.float64]
    shape: StrokeShape = "freehand"

    def __post_init__(self) -> None:
        object.__setattr__(self, "path", as_points(self.path, "stroke"))
        if not len(self.path):
            raise InputError("stroke: the path is empty; give at least one point")
        if self.shape not in get_args(StrokeShape):
            raise InputError(
                f"stroke: shape {self.shape!r} is unknown; choose one of {', '.join(get_args(StrokeShape))}"
            )


def painted(field: SizeField, stroke: Stroke, original: SizeField | None = None) -> SizeField:
    """Return a size field after a stroke.

    Parameters
    ----------
    field : SizeField
        The field before.
    stroke : Stroke
        What is painted.
    original : SizeField, optional
        What 'erase' brings back, on the same background; ``field`` itself by default.

    Returns
    -------
    SizeField
        On the same background; nodes out of the brush's reach keep their sizes bit by bit.
    """
    weights = stroke_weights(field.background, stroke)
    nodes = np.flatnonzero(weights)
    goal = stroke_goal(field, stroke.brush, original)
    sizes = field.sizes.copy()
    sizes[nodes] = blended(field.sizes[nodes], goal[nodes], weights[nodes], stroke.brush)
    return field.with_sizes(read_only(sizes))


def stroke_weights(background: BackgroundMesh, stroke: Stroke) -> NDArray[np.float64]:
    """Return how strongly a stroke acts on each background node, ``(V,)`` in [0, 1].

    It depends on the distance to the path only, so neither the number of points nor their spacing matters.
    """
    weights = np.zeros(len(background.points))
    path = stroke.path
    if stroke.shape == "polygon" and len(path) >= 3:
        weights[inside_polygon(background.points, path)] = 1.0
        path = np.vstack([path, path[:1]])
    for start, end in itertools.pairwise(path):
        raise_weights(weights, background, stroke.brush, start, end)
    if len(path) == 1:
        raise_weights(weights, background, stroke.brush, path[0], path[0])
    return weights


def raise_weights(
    weights: NDArray[np.float64],
    background: BackgroundMesh,
    brush: Brush,
    start: NDArray[np.float64],
    end: NDArray[np.float64],
) -> NDArray[np.intp]:
    """Raise the weights, in place, to what one straight piece of a path gives them.

    Returns
    -------
    (K,) int
        The nodes within the brush's reach.
    """
    low, high = np.minimum(start, end) - brush.radius, np.maximum(start, end) + brush.radius
    nodes = nodes_in_box(background, low, high)
    distance = distance_to_segment(background.points[nodes], start, end)
    weights[nodes] = np.maximum(weights[nodes], falloff(distance / brush.radius, brush.hardness))
    return nodes


def falloff(distance: NDArray[np.float64], hardness: float) -> NDArray[np.float64]:
    """Return the effect at a distance from the path in radii: 1 up to the hardness, then a smooth step to 0 at 1."""
    soft = max(1.0 - hardness, 1e-12)
    t = np.clip((1.0 - distance) / soft, 0.0, 1.0)
    effect = t * t * (3.0 - 2.0 * t)
    return np.where(distance <= 1.0, np.where(distance <= hardness, 1.0, effect), 0.0)


def stroke_goal(field: SizeField, brush: Brush, original: SizeField | None = None) -> NDArray[np.float64]:
    """Return the sizes that the full effect of a brush leads to, ``(V,)``."""
    sizes = field.sizes
    if brush.mode == "set":
        return np.full(len(sizes), brush.value)
    if brush.mode == "multiply":
        return sizes * brush.value
    if brush.mode == "at-most":
        return np.minimum(sizes, brush.value)
    if brush.mode == "erase":
        return sizes if original is None else original.sizes
    return np.exp(_evened(field.background, np.log(sizes)))


def blended(
    before: NDArray[np.float64], goal: NDArray[np.float64], weights: NDArray[np.float64], brush: Brush
) -> NDArray[np.float64]:
    """Return sizes part of the way to the goal: even steps of the weight are even factors of the size."""
    mixed = before * (goal / before) ** weights
    mixed = np.where(weights >= 1.0, goal, np.where(weights <= 0.0, before, mixed))
    if brush.mask is not None:
        low, high = brush.mask
        mixed = np.where((before >= low) & (before <= high), mixed, before)
    return mixed


def nodes_in_box(background: BackgroundMesh, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the background nodes in a closed box, by arithmetic where they form a grid."""
    grid = background.grid
    if grid is None:
        inside = ((background.points >= low) & (background.points <= high)).all(axis=1)
        return np.flatnonzero(inside)
    j0, j1 = _span(low[0], high[0], grid.x0, grid.dx, grid.nx)
    i0, i1 = _span(low[1], high[1], grid.y0, grid.dy, grid.ny)
    rows, columns = np.arange(i0, i1, dtype=np.intp), np.arange(j0, j1, dtype=np.intp)
    return (rows[:, None] * grid.nx + columns).ravel()


def distance_to_segment(
    points: NDArray[np.float64], start: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the distance of each point to a straight piece, ``(N,)``."""
    along = end - start
    length2 = float(along @ along)
    away = points - start
    share = np.clip(away @ along / length2, 0.0, 1.0) if length2 > 0 else np.zeros(len(points))
    return np.hypot(*(away - share[:, None] * along).T)


def inside_polygon(points: NDArray[np.float64], outline: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which points a closed outline holds, by the even-odd rule, ``(N,)``."""
    inside = np.zeros(len(points), dtype=bool)
    x, y = points.T
    for (x0, y0), (x1, y1) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        crosses = (y0 > y) != (y1 > y)
        inside ^= crosses & (x < x0 + (y - y0) * ((x1 - x0) / (y1 - y0)))
    return inside


def _span(low: float, high: float, origin: float, step: float, count: int) -> tuple[int, int]:
    first = min(max(math.ceil((low - origin) / step - 1e-9), 0), count)
    last = min(max(math.floor((high - origin) / step + 1e-9) + 1, first), count)
    return first, last


def _evened(background: BackgroundMesh, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return nodal values after some rounds of averaging over the neighbours."""
    if background.grid is not None:
        from scipy.ndimage import uniform_filter

        square = values.reshape(background.grid.ny, background.grid.nx)
        for _ in range(SMOOTHING_ROUNDS // 3):
            square = uniform_filter(square, 5, mode="nearest")
        return square.ravel()
    edges = background.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    one, two = np.vstack([edges, edges[:, ::-1]]).T
    degree = np.maximum(np.bincount(one, minlength=len(values)), 1)
    for _ in range(SMOOTHING_ROUNDS):
        values = 0.5 * values + 0.5 * np.bincount(one, values[two], len(values)) / degree
    return values
