"""The one-dimensional lesson of section 2: sizes on an interval, an advancing front, and the ratio R(e).

Ruiz-Gironés, Roca, Sarrate, 22nd International Meshing Roundtable, 2013, DOI 10.1007/978-3-319-02335-9, Figures 1 to 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import as_sizes, read_only

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

MOST_NODES = 100_000
"""Nodes after which an advancing front is given up."""


class LineSizes(Protocol):
    """Anything that prescribes a size along a line."""

    def at(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the size at positions."""


@dataclass(frozen=True, eq=False)
class LineField:
    """Sizes on an interval, linear between nodes.

    Parameters
    ----------
    x : (N,) float64
        Positions, ascending, at least two, in model units.
    sizes : (N,) float64
        Size at each, above 0.

    Raises
    ------
    InputError
        If positions do not ascend or a size is not above 0.
    """

    x: NDArray[np.float64]
    sizes: NDArray[np.float64]

    def __post_init__(self) -> None:
        x = np.asarray(self.x, dtype=np.float64)
        if x.ndim != 1 or len(x) < 2 or not np.isfinite(x).all() or (np.diff(x) <= 0).any():
            raise InputError("line: give at least two positions, each greater than the last")
        object.__setattr__(self, "x", read_only(x))
        object.__setattr__(self, "sizes", as_sizes(self.sizes, len(x), "line"))

    def at(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the size at positions; beyond the ends that of the nearer end."""
        return np.interp(np.asarray(x, dtype=np.float64), self.x, self.sizes)

    def min_over(self, start: ArrayLike, stop: ArrayLike) -> NDArray[np.float64]:
        """Return the least size over intervals, exact: at an end or at a node between."""
        low, high = np.atleast_1d(np.asarray(start, float)), np.atleast_1d(np.asarray(stop, float))
        between = (self.x >= low[:, None]) & (self.x <= high[:, None])
        inner = np.where(between, self.sizes, np.inf).min(axis=1)
        return np.minimum(inner, np.minimum(self.at(low), self.at(high)))


def paper_valley() -> LineField:
    """Return eq. (1), h(x) = min(0.5, 0.1 + 3 |x - 0.75|) on [0, 1]."""
    bend = 0.4 / 3.0
    return LineField(np.array([0.0, 0.75 - bend, 0.75, 0.75 + bend, 1.0]), np.array([0.5, 0.5, 0.1, 0.5, 0.5]))


def limited_on_line(field: LineField, epsilon: float, x: ArrayLike) -> NDArray[np.float64]:
    """Return min over y of h(y) + epsilon |x - y| at positions, exact: y is a node or x itself."""
    where = np.atleast_1d(np.asarray(x, dtype=np.float64))
    through_nodes = field.sizes + epsilon * np.abs(where[:, None] - field.x)
    return np.minimum(through_nodes.min(axis=1), field.at(where))


def preserved_on_line(field: LineField, alpha: float, beta: float, x: ArrayLike) -> NDArray[np.float64]:
    """Return beta min over y of max(h(y), |x - y| / alpha) at positions, exact.

    On each segment the size is linear and the distance has two branches: the minimum lies at a node, at x, or where
    size and distance / alpha are equal, which is a linear equation.
    """
    where = np.atleast_1d(np.asarray(x, dtype=np.float64))[:, None]
    best = np.minimum(np.maximum(field.sizes, np.abs(where - field.x) / alpha).min(axis=1), field.at(where[:, 0]))
    left, right, size = field.x[:-1], field.x[1:], field.sizes[:-1]
    slope = np.diff(field.sizes) / (right - left)
    for side in (-1.0, 1.0):  # y = x + side * distance, and distance = alpha h(y)
        steep = 1.0 - side * alpha * slope
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = alpha * (size + slope * (where - left)) / steep
        y = where + side * distance
        valid = (distance >= 0.0) & (y >= left) & (y <= right)
        best = np.minimum(best, np.where(valid, distance / alpha, np.inf).min(axis=1))
    return beta * best


@dataclass(frozen=True, eq=False)
class LimitedLine:
    """The limited sizes of a line, exact wherever they are asked for.

    Parameters
    ----------
    field : LineField
        The sizes given.
    epsilon : float
        Largest slope.
    """

    field: LineField
    epsilon: float

    def at(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the limited size at positions."""
        return limited_on_line(self.field, self.epsilon, x)


@dataclass(frozen=True, eq=False)
class PreservedLine:
    """The preserved sizes of a line, exact wherever they are asked for.

    Parameters
    ----------
    field : LineField
        The sizes given.
    alpha, beta : float
        Radius of the ball in elements, and scale of the size.
    """

    field: LineField
    alpha: float
    beta: float = 1.0

    def at(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the preserved size at positions."""
        return preserved_on_line(self.field, self.alpha, self.beta, x)


def advanced(field: LineSizes, start: float, stop: float, *, stretch_last: bool = True) -> NDArray[np.float64]:
    """Return the nodes of an advancing front: each lies one size, as prescribed at the one before, beyond that.

    Parameters
    ----------
    field : LineSizes
        Sizes, in model units.
    start, stop : float
        First and last node.
    stretch_last : bool
        Whether a rest of less than half an element before ``stop`` is given to the element before it. Otherwise it
        remains an element of its own: shorter than asked for, never longer.

    Raises
    ------
    InputError
        If the interval is empty or holds more than 100,000 nodes.
    """
    if not stop > start:
        raise InputError(f"line from {start} to {stop}: it must end after it begins")
    nodes = [float(start)]
    while True:
        size = float(field.at([nodes[-1]])[0])
        if nodes[-1] + size >= stop:
            break
        nodes.append(nodes[-1] + size)
        if len(nodes) > MOST_NODES:
            raise InputError(f"line: more than {MOST_NODES:,} nodes; ask for larger sizes")
    if stretch_last and len(nodes) > 1 and stop - nodes[-1] < 0.5 * float(field.at([nodes[-1]])[0]):
        nodes.pop()
    return read_only(np.array([*nodes, float(stop)]))


def ratios_on_line(field: LineField, nodes: ArrayLike, beta: float = 1.0) -> NDArray[np.float64]:
    """Return R(e) of each interval between neighbouring nodes, eq. (3), ``(N - 1,)``."""
    where = np.asarray(nodes, dtype=np.float64)
    return np.diff(where) / (beta * field.min_over(where[:-1], where[1:]))
