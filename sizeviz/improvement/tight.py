"""The tight field: finer than h* only where h* has no slack against the field that the mesh is judged by.

An element of size h* may reach over a crest of h* into sizes smaller than its own. The smallest size that the user asks
for within a few elements bounds what the element may be: h' = min(h*, c min of h within r h*).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.improvement import _tight_kernels
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sizing import PreserveOptions, SizeField, minimum, preserved
from sizeviz.sizing.analytic import AnalyticSize, SizeFunction

if TYPE_CHECKING:
    from numpy.typing import NDArray

STEEP = 0.15
"""Mean slope of the target, weighted by elements, above which its valleys count as steep."""
SECOND_SCALE = 0.75
SECOND_SHARE = 0.9
"""Where the field is no grid, h* of this alpha and share of the factor stands for the minimum within a radius."""
PLATEAU = 0.3
"""Share of the elements that lie on the floor of the field from which a plateau rules."""
FLAT = 0.01
"""Slope below which sizes change by less than this share from one element to the next: a plateau."""
LEVEL = 0.917
"""Largest factor on a plateau: where no edge may be longer than the others, none can be shortened by moves."""


@dataclass(frozen=True, kw_only=True)
class TightOptions:
    """How the tight field is made; by default both values are chosen from the field.

    Parameters
    ----------
    radius : float, optional
        Distance within which smaller sizes count, in elements, above 0; at most the alpha of size preserving
        (beyond it the field collapses to its floor). Used where both fields share a grid.
    factor : float, optional
        Share of the smallest size found, 0 to 1.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    radius: float | None = None
    factor: float | None = None

    def __post_init__(self) -> None:
        if self.radius is not None and not (math.isfinite(self.radius) and self.radius > 0):
            raise InputError(f"radius is {self.radius}; it must be a number of elements above 0, such as 1.5")
        if self.factor is not None and not 0 < self.factor <= 1:
            raise InputError(f"factor is {self.factor}; it must lie above 0 and at most at 1, such as 0.96")


def tightened(
    reference: SizeFunction,
    target: SizeField,
    options: TightOptions | None = None,
    monitor: Monitor = SILENT,
) -> SizeField:
    """Return the field that a mesh is made for when every element must satisfy R <= 1.

    Parameters
    ----------
    reference : SizeFunction
        The user's field, which R is judged against.
    target : SizeField
        The size-preserving field h*.
    options : TightOptions, optional
        Radius and factor.
    monitor : Monitor
        Told of progress.

    Raises
    ------
    Cancelled
        If the monitor says so.
    """
    options = options or TightOptions()
    radius, factor = chosen(reference, target)
    radius = options.radius if options.radius is not None else radius
    share = np.minimum(factor, np.where(_level(target), LEVEL, 1.0))
    if options.factor is not None:
        share = np.full(len(target.sizes), options.factor)
    field = reference.field if isinstance(reference, AnalyticSize) else reference
    if not isinstance(field, SizeField):
        raise InputError(f"{field.label}: only a size field or a formula can be guaranteed; sample it on a grid first")
    monitor.step(0.0, "tightening the field")
    if field.background.grid is not None and field.background.grid == target.background.grid:
        least = _grid_minima(field, radius * target.sizes)
        return target.with_sizes(np.minimum(target.sizes, share * least), f"{target.label}, tight")
    closer = preserved(
        field, PreserveOptions(alpha=SECOND_SCALE, beta=SECOND_SHARE * float(share.max())), monitor=monitor
    )
    lower = target.with_sizes(share * target.sizes)
    return replace(minimum([lower, closer]), label=f"{target.label}, tight")


def _grid_minima(field: SizeField, reach: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the least size of the grid's nodes within ``reach`` of each of them."""
    grid = field.background.grid
    assert grid is not None
    shape = (grid.ny, grid.nx)
    minima, least = field.sizes.reshape(shape).copy(), field.sizes.reshape(shape).copy()
    cells = (reach / max(grid.dx, grid.dy)).reshape(shape)
    width = 1
    while width <= cells.max():
        _tight_kernels.ball_minima(width, minima, cells, least)
        _tight_kernels.double_windows(minima, width)
        width *= 2
    return least.ravel()


def chosen(reference: SizeFunction, target: SizeField) -> tuple[float, float]:
    """Return the radius and factor that suit a field: its slopes, and how much of it lies on its floor."""
    slopes, weights, lowest = _slopes(target)
    on_floor = float(weights[lowest <= 1.02 * target.sizes.min()].sum() / weights.sum())
    if on_floor > PLATEAU:
        return 0.75, 0.917
    if float((slopes * weights).sum() / weights.sum()) > STEEP:
        return 2.0, 0.96
    return 1.5, 0.98


def _level(field: SizeField) -> NDArray[np.bool_]:
    """Return the background nodes whose triangles are all flat."""
    level = np.ones(len(field.sizes), dtype=bool)
    level[field.background.triangles[_slopes(field)[0] > FLAT]] = False
    return level


def _slopes(field: SizeField) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return each background triangle's slope, number of elements asked for, and mean size."""
    corner = field.background.points[field.background.triangles]
    size = field.sizes[field.background.triangles]
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    twice = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    da, db = size[:, 1] - size[:, 0], size[:, 2] - size[:, 0]
    gradient = np.hypot(da * b[:, 1] - db * a[:, 1], db * a[:, 0] - da * b[:, 0]) / twice
    mean = size.mean(axis=1)
    return gradient, 0.5 * twice / mean**2, mean
