"""Planar domains: an outer loop, holes, and lines and points that the mesh must keep."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import as_points, read_only

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

CORNER_ANGLE = np.deg2rad(30.0)
"""A loop vertex that turns by more than this (radians) is a corner unless the caller says otherwise."""


SMALLEST, LARGEST = 1e-60, 1e60
"""Extents between which products of four lengths, which the predicates take, are numbers that can be held."""

FARTHEST = 1e13
"""Distance from the origin over the extent beyond which rounding leaves too few different places."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A polyline that boundary nodes slide along: a loop between two corners, a whole loop, or an inner line.

    Parameters
    ----------
    points : (K, 2) float64
        Vertices in order. A closed curve does not repeat its first vertex.
    closed : bool
        Whether the last vertex joins the first.
    inner : bool
        Whether the curve lies inside the domain (a constraint line) rather than on its boundary.
    """

    points: NDArray[np.float64]
    closed: bool = False
    inner: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", as_points(self.points, "curve"))

    @cached_property
    def stations(self) -> NDArray[np.float64]:
        """Arc length at each vertex, ``(K,)``, or ``(K + 1,)`` where the curve is closed."""
        points = np.vstack([self.points, self.points[:1]]) if self.closed else self.points
        return read_only(np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))]))

    @property
    def length(self) -> float:
        """Arc length."""
        return float(self.stations[-1])


@dataclass(frozen=True, eq=False)
class Domain:
    """A region of the plane bounded by loops of straight segments (curves come sampled).

    Parameters
    ----------
    outer : (K, 2) float64
        The outer loop; turned counter-clockwise when built; the first vertex is not repeated at the end.
    holes : sequence of (K, 2) float64
        Loops cut out; turned clockwise when built.
    corners : sequence of (K,) bool, optional
        For each loop, outer first, which vertices no node may slide past. By default those that turn by more
        than 30 degrees.
    lines : sequence of (K, 2) float64
        Inner polylines that element edges must follow.
    fixed_points : (M, 2) float64
        Inner points at which a node must lie.
    label : str
        What to call the domain in messages.
    notes : tuple of str
        What was mended when it was read, in plain words; empty where nothing was.

    Raises
    ------
    InputError
        If a loop has fewer than three distinct vertices or no area, or if the domain is too small, too large or too far
        from the origin for numbers to hold it.
    """

    outer: NDArray[np.float64]
    holes: tuple[NDArray[np.float64], ...] = ()
    corners: tuple[NDArray[np.bool_], ...] = ()
    lines: tuple[NDArray[np.float64], ...] = ()
    fixed_points: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
    label: str = "domain"
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _require_extent(self.outer, self.label)
        loops = [_clean_loop(self.outer, f"{self.label}: outer loop")]
        loops += [_clean_loop(hole, f"{self.label}: hole {k}") for k, hole in enumerate(self.holes)]
        marks: list[NDArray[np.bool_] | None] = [*self.corners] or [None] * len(loops)
        if len(marks) != len(loops):
            raise InputError(f"{self.label}: corners are given for {len(marks)} loops, but there are {len(loops)}")
        turned, turned_marks = [], []
        for k, (loop, mark) in enumerate(zip(loops, marks, strict=True)):
            flags = np.abs(turning_angles(loop)) > CORNER_ANGLE if mark is None else np.asarray(mark, dtype=bool)
            if flags.shape != (len(loop),):
                raise InputError(f"{self.label}: corner marks of loop {k} do not match its {len(loop)} vertices")
            wrong_way = (signed_area(loop) < 0) == (k == 0)
            turned.append(read_only(loop[::-1] if wrong_way else loop))
            turned_marks.append(read_only(flags[::-1] if wrong_way else flags))
        object.__setattr__(self, "outer", turned[0])
        object.__setattr__(self, "holes", tuple(turned[1:]))
        object.__setattr__(self, "corners", tuple(turned_marks))
        lines = tuple(as_points(line, f"{self.label}: inner line {k}") for k, line in enumerate(self.lines))
        object.__setattr__(self, "lines", lines)
        points = np.reshape(np.asarray(self.fixed_points, dtype=np.float64), (-1, 2))
        object.__setattr__(self, "fixed_points", as_points(points, f"{self.label}: fixed points"))

    @classmethod
    def rectangle(cls, x0: float, y0: float, x1: float, y1: float, label: str = "rectangle") -> Domain:
        """Return the axis-parallel rectangle between two opposite corners."""
        return cls(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), label=label)

    @classmethod
    def unit_square(cls) -> Domain:
        """Return [0, 1] x [0, 1], the domain of the paper's examples."""
        return cls.rectangle(0.0, 0.0, 1.0, 1.0, label="unit square")

    @property
    def loops(self) -> tuple[NDArray[np.float64], ...]:
        """The outer loop and the holes, each ``(K, 2)``; the domain lies on the left of every one."""
        return (self.outer, *self.holes)

    @property
    def area(self) -> float:
        """Enclosed area, in square model units."""
        return float(sum(signed_area(loop) for loop in self.loops))

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Smallest x, smallest y, largest x, largest y."""
        low, high = self.outer.min(axis=0), self.outer.max(axis=0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @cached_property
    def curves(self) -> tuple[Curve, ...]:
        """The curves that nodes slide along: every loop split at its corners, in order, then the inner lines.

        The domain lies on the left of each boundary curve. ``QuadMesh.curve`` counts these.
        """
        curves: list[Curve] = []
        for loop, marks in zip(self.loops, self.corners, strict=True):
            at = np.flatnonzero(marks)
            if not len(at):
                curves.append(Curve(loop, closed=True))
                continue
            rolled = np.roll(loop, -at[0], axis=0)
            stops = np.append(at - at[0], len(loop))
            ring = np.vstack([rolled, rolled[:1]])
            curves += [Curve(ring[a : b + 1]) for a, b in itertools.pairwise(stops)]
        curves += [Curve(line, inner=True) for line in self.lines]
        return tuple(curves)


def signed_area(loop: ArrayLike) -> float:
    """Return the area enclosed by a closed polygon, positive where it runs counter-clockwise."""
    points = np.asarray(loop, dtype=np.float64)
    x, y = (points - points[0]).T
    return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def turning_angles(loop: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the signed change of direction at each vertex of a closed polygon, in radians, -pi to pi."""
    before = loop - np.roll(loop, 1, axis=0)
    after = np.roll(loop, -1, axis=0) - loop
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.arctan2(cross, (before * after).sum(axis=1))


def _require_extent(outer: ArrayLike, label: str) -> None:
    points = as_points(outer, f"{label}: outer loop")
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    if extent > 0.0 and not SMALLEST <= extent <= LARGEST:
        raise InputError(
            f"{label}: it is {extent:.3g} wide; scale it, and its sizes, to between {SMALLEST:g} and {LARGEST:g}"
        )
    if extent > 0.0 and float(np.abs(points).max()) > FARTHEST * extent:
        raise InputError(
            f"{label}: it is {extent:.3g} wide, but lies {np.abs(points).max():.3g} from the origin, where coordinates "
            "cannot tell its nodes apart; move it nearer"
        )


def _clean_loop(value: ArrayLike, name: str) -> NDArray[np.float64]:
    loop = as_points(value, name)
    if len(loop) > 1 and np.array_equal(loop[0], loop[-1]):
        loop = loop[:-1]
    if len(np.unique(loop, axis=0)) < 3:
        raise InputError(f"{name}: a loop needs at least three distinct vertices, got {len(loop)}")
    if signed_area(loop) == 0.0:
        raise InputError(f"{name}: the loop encloses no area, or crosses itself; list its vertices in order")
    return loop
