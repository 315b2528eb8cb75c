"""The lesson on a line as plain values: what a person chose, and all that follows from it. No Qt, no pixels.

Ruiz-Gironés, Roca, Sarrate, 22nd International Meshing Roundtable, 2013, DOI 10.1007/978-3-319-02335-9, section 2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.app.lessons.ball import BallStory
from sizeviz.sizing.ball import ball_on_line
from sizeviz.sizing.line import (
    LimitedLine,
    LineField,
    LineSizes,
    PreservedLine,
    advanced,
    paper_valley,
    ratios_on_line,
)
from sizeviz.sizing.options import PreserveOptions

if TYPE_CHECKING:
    from numpy.typing import NDArray

METHODS: tuple[str, ...] = ("none", "gradient-limiting", "size-preserving")
"""What is done with the sizes before the front asks for them."""

NAMES: dict[str, str] = {
    "none": "Sizes as given",
    "gradient-limiting": "Gradient limiting",
    "size-preserving": "Size preserving",
}
"""The methods in words."""

SMALLEST, LARGEST = 0.03, 0.6
"""Least and greatest size that a control point can be dragged to."""

APART = 0.01
"""Least distance between neighbouring control points."""

MOST_KNOTS = 16
"""Control points after which no more are added."""

SAMPLES = 801
"""Places that curves are drawn through."""

BACKGROUND = 41
"""Nodes of the background that the ball of Algorithm 1 looks at, beside the control points."""

CORRECT = 1.0 + 1e-9
"""Largest R that counts as 1: rounding is no error of a mesh."""

Knot = tuple[float, float]
"""A control point: x and the size there."""


def paper_knots() -> tuple[Knot, ...]:
    """Return the control points of eq. (1)."""
    field = paper_valley()
    return tuple(zip(field.x.tolist(), field.sizes.tolist(), strict=True))


@dataclass(frozen=True, kw_only=True)
class LineLesson:
    """What a person has chosen.

    Parameters
    ----------
    knots : tuple of (float, float)
        Control points of h(x) on [0, 1], ascending in x.
    alpha, beta, epsilon : float
        Radius of the ball in elements, scale of the size, largest slope.
    chapter : int
        Which step of the lesson is told.
    place : float
        Where the ball is, 0 to 1.
    step : int
        How far it has shrunk: nodes looked at after its own.
    """

    knots: tuple[Knot, ...] = paper_knots()
    alpha: float = 1.0
    beta: float = 1.0
    epsilon: float = 1.0
    chapter: int = 0
    place: float = 0.55
    step: int = 0

    @property
    def field(self) -> LineField:
        """The sizes given."""
        x, sizes = np.array(self.knots).T
        return LineField(x, sizes)

    def with_knot(self, index: int, x: float, size: float) -> LineLesson:
        """Return the lesson with a control point moved as far as its neighbours and the limits let it."""
        last = len(self.knots) - 1
        low = self.knots[index - 1][0] + APART if index else 0.0
        high = self.knots[index + 1][0] - APART if index < last else 1.0
        x = {0: 0.0, last: 1.0}.get(index, min(max(x, low), high))
        moved = (x, min(max(size, SMALLEST), LARGEST))
        return self._with_knots((*self.knots[:index], moved, *self.knots[index + 1 :]))

    def with_new_knot(self, x: float, size: float) -> LineLesson:
        """Return the lesson with another control point; unchanged where there is no room for one."""
        if len(self.knots) >= MOST_KNOTS or not 0 < x < 1 or min(abs(x - knot[0]) for knot in self.knots) < APART:
            return self
        added = (x, min(max(size, SMALLEST), LARGEST))
        return self._with_knots(tuple(sorted((*self.knots, added))))

    def without_knot(self, index: int) -> LineLesson:
        """Return the lesson with a control point less; the two ends stay."""
        if not 0 < index < len(self.knots) - 1:
            return self
        return self._with_knots((*self.knots[:index], *self.knots[index + 1 :]))

    def with_changes(self, **changes: Any) -> LineLesson:
        """Return the lesson with other parameters; the ball starts anew where it would be another ball."""
        lesson = self if set(changes) <= {"step", "epsilon", "chapter"} else replace(self, step=0)
        return replace(lesson, **changes)

    def _with_knots(self, knots: tuple[Knot, ...]) -> LineLesson:
        return replace(self, knots=knots, step=0)


@dataclass(frozen=True, eq=False)
class Front:
    """The nodes that an advancing front leaves, and R of the elements between them.

    Parameters
    ----------
    method : str
        Whose sizes the front asked for.
    nodes : (N,) float64
        From 0 to 1.
    ratios : (N - 1,) float64
        R of each element against the sizes given.
    """

    method: str
    nodes: NDArray[np.float64]
    ratios: NDArray[np.float64]

    @property
    def passed(self) -> bool:
        """Whether every element is correct."""
        return bool((self.ratios <= CORRECT).all())

    @property
    def verdict(self) -> str:
        """The judgement in words."""
        count, good = len(self.ratios), int((self.ratios <= CORRECT).sum())
        if good == count:
            return f"{count} elements, all of them correct."
        worst = int(self.ratios.argmax())
        share = "none of them" if good == 0 else f"{good} of them"
        return (
            f"{count} elements, {share} correct. The one from {self.nodes[worst]:.3g} to {self.nodes[worst + 1]:.3g} "
            f"is {self.ratios[worst]:.2f} times as long as its smallest size allows."
        )


@dataclass(frozen=True, eq=False)
class LineShown:
    """All that follows from a lesson.

    Parameters
    ----------
    lesson : LineLesson
        What it follows from.
    x : (S,) float64
        Places that curves are drawn through.
    curves : dict of str to (S,) float64
        Sizes by method, 'none' for the sizes given.
    fronts : dict of str to Front
        Nodes and ratios by method.
    ball : BallStory
        The ball at the lesson's place.
    """

    lesson: LineLesson
    x: NDArray[np.float64]
    curves: dict[str, NDArray[np.float64]]
    fronts: dict[str, Front]
    ball: BallStory


def resolved(lesson: LineLesson) -> LineShown:
    """Return all that follows from a lesson; pure, and quick enough to be asked at every move of the mouse."""
    given = lesson.field
    asked = LineField(given.x, lesson.beta * given.sizes)  # what R = 1 means, eq. (3)
    sizes: dict[str, LineSizes] = {
        "none": asked,
        "gradient-limiting": LimitedLine(asked, lesson.epsilon),
        "size-preserving": PreservedLine(given, lesson.alpha, lesson.beta),
    }
    x = np.union1d(np.linspace(0.0, 1.0, SAMPLES), given.x)
    fronts = {}
    for method, asked_for in sizes.items():
        nodes = advanced(asked_for, 0.0, 1.0, stretch_last=False)
        fronts[method] = Front(method, nodes, ratios_on_line(given, nodes, lesson.beta))
    curves = {"none": given.at(x), **{method: sizes[method].at(x) for method in METHODS[1:]}}
    return LineShown(lesson, x, curves, fronts, ball_story(lesson))


def ball_story(lesson: LineLesson) -> BallStory:
    """Return how the ball shrinks at the lesson's place, on a background that has a node there."""
    given = lesson.field
    x = np.union1d(np.union1d(np.linspace(0.0, 1.0, BACKGROUND), given.x), [lesson.place])
    apart = np.concatenate([[True], np.diff(x) > 1e-9])  # two nodes at one place would be no line
    x = x[apart]
    background = LineField(x, given.at(x))
    node = int(np.abs(x - lesson.place).argmin())
    options = PreserveOptions(alpha=lesson.alpha, beta=lesson.beta)
    return BallStory(ball_on_line(background, node, options), background.x[:, None], background.sizes, options)
