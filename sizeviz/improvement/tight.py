"""The tight field: h* with what a mesh needs to hold it everywhere, not only on average.

Longest edges are longer than the mean, and an element of size h* may reach over a crest of h* into sizes smaller than
its own: h' = c min(h*, min of h within r h*). The second minimum counts where r is above the alpha of h*.

Where the user's field has plateaus that hold much of the mesh, a crest is not the trouble: the elements of a plateau
form a lattice, whose edge cannot follow the plateau's, and the irregular elements along it need room. There h' = c h*,
and the plateau's size is kept a little beyond its edge, so that these elements lie where larger ones would do.
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
PLATEAU = 0.3
"""Share of the elements that lie on plateaus of the user's field from which plateaus rule."""
SECOND_SCALE = 0.75
SECOND_SHARE = 0.94
"""Where the field is no grid, h* of this alpha and share of the factor keeps room in narrow valleys."""
LEVEL = 0.01
"""Share of the elements from which a size that the field keeps to is a plateau of its own."""
SPREADS = (1.5, 1.25, 1.1)
"""How far beyond a plateau its size may be kept: up to where h* is this much larger; the first that is cheap enough."""
FLAT = 0.01
"""Slope below which sizes change by less than this share from one element to the next."""
ON_FLAT = 0.93
"""Largest factor on flat ground that does not rule: where no edge may be longer than the others, none can give way."""
ON_PLATEAUS = 0.96
"""The factor there."""
DEAREST = 0.04
"""Share of elements that this may add."""
RADII = (2.0, 1.5, 1.25, 1.1, 1.0)
"""Radii that are tried, from the one that suits the slope downwards: from alpha on the field may fall to its floor."""
DEAR = 0.45
"""Share of elements that a radius may add; the last is taken whatever it adds."""


@dataclass(frozen=True, kw_only=True)
class TightOptions:
    """How the tight field is made; by default all values are chosen from the field.

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
    InputError
        If the reference is neither a size field nor a formula with one.
    Cancelled
        If the monitor says so.
    """
    options = options or TightOptions()
    field = reference.field if isinstance(reference, AnalyticSize) else reference
    if not isinstance(field, SizeField):
        raise InputError(f"{field.label}: only a size field or a formula can be guaranteed; sample it on a grid first")
    monitor.step(0.0, "tightening the field")
    asked = _asked(target)
    radius, factor = chosen(target, asked)
    radius = options.radius if options.radius is not None else radius
    levels = plateaus(field, asked) if options.radius is None and _alike(field, target) else np.empty(0)
    if len(levels):
        sizes = (options.factor if options.factor is not None else ON_PLATEAUS) * _spread(target, levels, asked.sum())
        return target.with_sizes(sizes, f"{target.label}, tight")
    share = _shares(field, target, factor) if options.factor is None else np.full(len(target.sizes), options.factor)
    if field.background.grid is not None and _alike(field, target):
        radii = [radius, *(r for r in RADII if r < radius and options.radius is None)]
        return _affordable(field, target, share, radii, (1.0 + DEAR) * float(asked.sum()))
    # h* itself bounds the minimum within alpha h* from below; a second scale stands for the floors of narrow valleys
    lower = target.with_sizes(share * target.sizes)
    second = PreserveOptions(alpha=SECOND_SCALE, beta=SECOND_SHARE * float(share.max()))
    both = minimum([lower, preserved(field, second, monitor=monitor)])
    return replace(both, label=f"{target.label}, tight")


def _affordable(
    field: SizeField, target: SizeField, share: NDArray[np.float64], radii: list[float], most: float
) -> SizeField:
    """Return the tight field of the largest radius that asks for no more than ``most`` elements, or the last one's."""
    for radius in radii:
        sizes = np.minimum(share * target.sizes, share * _grid_minima(field, radius * target.sizes))
        tight = target.with_sizes(sizes, f"{target.label}, tight")
        if _asked(tight).sum() <= most:
            break
    return tight


def _shares(field: SizeField, target: SizeField, factor: float) -> NDArray[np.float64]:
    """Return the factor at each node: smaller where both fields are flat, since moves shorten no edge there."""
    share = np.full(len(target.sizes), factor)
    if _alike(field, target):
        level = np.ones(len(share), dtype=bool)
        for one in (field, target):
            level[one.background.triangles[_slopes(one) > FLAT]] = False
        share[level] = min(factor, ON_FLAT)
    return share


def _alike(field: SizeField, target: SizeField) -> bool:
    """Say whether both fields live on the same triangles."""
    return field.background is target.background or (
        field.background.grid is not None and field.background.grid == target.background.grid
    )


def plateaus(field: SizeField, asked: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the sizes of the user's plateaus, ascending, where they hold so much of the mesh that they rule it.

    ``asked`` is the number of elements that each background triangle asks for.
    """
    triangles, sizes = field.background.triangles, field.sizes
    first = sizes[triangles[:, 0]]
    flat = (first == sizes[triangles[:, 1]]) & (first == sizes[triangles[:, 2]])
    levels, which = np.unique(first[flat], return_inverse=True)
    share = np.bincount(which, asked[flat], len(levels)) / asked.sum()
    return levels[share > LEVEL] if share.sum() > PLATEAU else np.empty(0)


def _spread(target: SizeField, levels: NDArray[np.float64], before: float) -> NDArray[np.float64]:
    """Return the nodal sizes with each plateau's kept as far beyond it as is cheap for ``before`` elements."""
    for reach in SPREADS:
        below = np.searchsorted(levels, target.sizes * (1.0 + 1e-9), side="right") - 1
        level = levels[np.maximum(below, 0)]
        near = (below >= 0) & (target.sizes < reach * level)
        wider = target.with_sizes(np.where(near, np.minimum(level, target.sizes), target.sizes))
        if _asked(wider).sum() <= (1.0 + DEAREST) * before:
            return wider.sizes
    return target.sizes


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


def chosen(target: SizeField, asked: NDArray[np.float64]) -> tuple[float, float]:
    """Return the radius and factor that suit a field without ruling plateaus, by its mean slope over its elements."""
    return (2.0, 0.958) if float((_slopes(target) * asked).sum() / asked.sum()) > STEEP else (1.5, 0.96)


def _slopes(field: SizeField) -> NDArray[np.float64]:
    """Return the slope of each background triangle."""
    slopes = np.empty(len(field.background.triangles))
    _tight_kernels.slopes(field.background.points, field.background.triangles, field.sizes, slopes)
    return slopes


def _asked(field: SizeField) -> NDArray[np.float64]:
    """Return about how many elements each background triangle asks for."""
    asked = np.empty(len(field.background.triangles))
    _tight_kernels.asked(field.background.points, field.background.triangles, field.sizes, asked)
    return asked
