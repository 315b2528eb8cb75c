"""The shrinking ball of Algorithm 1 told step by step: on a line and in the plane, as plain values and words.

Ruiz-Gironés, Roca, Sarrate, 22nd International Meshing Roundtable, 2013, DOI 10.1007/978-3-319-02335-9, section 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.sizing.ball import BallStep, BallTrace
    from sizeviz.sizing.options import PreserveOptions

MOST_MOMENTS = 200
"""Steps that are told one by one; of more, those that change the ball and some between."""

RULES: dict[str, str] = {
    "i": "Its own ball is smaller and still reaches this node: the ball shrinks to it, <b>r = r′</b>.",
    "ii": "Its own ball is smaller but no longer reaches this node: the ball shrinks until the node lies on its rim, "
    "<b>r = d</b>.",
    "iii": "The node lies outside the ball by now: nothing to do.",
    "iv": "It asks for no smaller ball: <b>r stays</b>, and its neighbours are looked at next.",
    "v": "The node lies outside the ball by now: nothing to do.",
}
"""What Algorithm 1 does in each of its five cases."""


@dataclass(frozen=True, eq=False)
class Moment:
    """The ball at one step.

    Parameters
    ----------
    number, last : int
        Which step of how many, from 0.
    step : BallStep
        The node looked at.
    place : (D,) float64
        Where it lies, in model units.
    size : float
        What it asks for, h(y).
    radius : float
        r after the step.
    skipped : int
        How many nodes were looked at since the moment told before.
    candidate : float
        beta r / alpha: h* if the ball stopped here.
    blocking : (D,) float64
        The node that made the ball as small as it is.
    """

    number: int
    last: int
    step: BallStep
    place: NDArray[np.float64]
    size: float
    radius: float
    skipped: int
    candidate: float
    blocking: NDArray[np.float64]

    @property
    def is_start(self) -> bool:
        """Whether only the ball's own node was looked at."""
        return self.number == 0

    @property
    def is_end(self) -> bool:
        """Whether the ball stops here."""
        return self.number == self.last

    @property
    def shrank(self) -> bool:
        """Whether this step made the ball smaller."""
        return self.step.after < self.step.before


@dataclass(frozen=True, eq=False)
class BallStory:
    """A trace of Algorithm 1 with the nodes it speaks of.

    Parameters
    ----------
    trace : BallTrace
        The steps.
    places : (V, D) float64
        Where the background's nodes lie, in model units.
    sizes : (V,) float64
        Size prescribed at each.
    options : PreserveOptions
        alpha and beta.
    """

    trace: BallTrace
    places: NDArray[np.float64]
    sizes: NDArray[np.float64]
    options: PreserveOptions

    @cached_property
    def told(self) -> tuple[int, ...]:
        """Which steps are told: all of a short trace; of a long one the first, the last, every change, some between."""
        steps = self.trace.steps
        if len(steps) <= MOST_MOMENTS:
            return tuple(range(len(steps)))
        changes = [k for k, step in enumerate(steps) if step.after < step.before]
        thinned = changes[:: max(1, -(-len(changes) // (MOST_MOMENTS // 2)))]
        between = np.linspace(0, len(steps) - 1, MOST_MOMENTS // 2).astype(int).tolist()
        return tuple(sorted({0, len(steps) - 1, *thinned, *changes[-1:], *between}))

    @property
    def count(self) -> int:
        """How many moments there are."""
        return len(self.told)

    def at(self, number: int) -> Moment:
        """Return a moment; beyond the last there is only the last."""
        number = min(max(number, 0), self.count - 1)
        row = self.told[number]
        step = self.trace.steps[row]
        skipped = row - self.told[number - 1] - 1 if number else 0
        return Moment(
            number=number,
            last=self.count - 1,
            step=step,
            place=self.places[step.node],
            size=float(self.sizes[step.node]),
            radius=step.after,
            skipped=skipped,
            candidate=self.options.beta * step.after / self.options.alpha,
            blocking=self.places[self._blocking[row]],
        )

    def looked_at(self, number: int) -> NDArray[np.intp]:
        """Return the nodes looked at up to a moment, ``(K,)``, in order."""
        row = self.told[min(max(number, 0), self.count - 1)]
        return np.array([step.node for step in self.trace.steps[: row + 1]], dtype=np.intp)

    @cached_property
    def _blocking(self) -> NDArray[np.intp]:
        """Which node the ball's size comes from, after each step."""
        found, node = [], self.trace.steps[0].node
        for step in self.trace.steps:
            node = step.node if step.after < step.before else node
            found.append(node)
        return np.array(found, dtype=np.intp)


def place_words(place: NDArray[np.float64]) -> str:
    """Return a place as text, ``x = 0.55`` or ``(0.55, 0.2)``."""
    if len(place) == 1:
        return f"x = {place[0]:.3g}"
    return f"({place[0]:.3g}, {place[1]:.3g})"


def headline(story: BallStory, moment: Moment) -> str:
    """Return what happens at a moment, in one sentence."""
    if moment.is_end:
        return f"The ball stops: r = {moment.radius:.4g}, so h* = {moment.candidate:.4g}."
    if moment.is_start:
        return f"The place itself asks for {moment.size:.4g}. The largest ball it allows is tried first."
    if moment.shrank:
        shrinks = f"from {moment.step.before:.4g} to {moment.radius:.4g}"
        return f"A smaller size lies within reach: the ball shrinks {shrinks}."
    return "This node asks for nothing smaller. The ball keeps its size."


def story_words(story: BallStory, moment: Moment) -> str:
    """Return what happens at a moment and why, as rich text."""
    alpha, trace = story.options.alpha, story.trace
    here = place_words(trace.centre)
    if moment.is_start:
        text = (
            f"How large may an element at {here} be? Suppose as large as the size there, h = {moment.size:.4g}. "
            f"Then no smaller size may lie within r = α·h = {alpha:g} × {moment.size:.4g} = "
            f"<b>{moment.radius:.4g}</b>. "
            "Now look at the nodes around, the nearest first."
        )
        return text if story.count > 1 else text + " " + end_words(story)
    later = f"{moment.skipped:,} nodes later: node" if moment.skipped else "Node"
    text = (
        f"{later} at {place_words(moment.place)}, d = {moment.step.distance:.4g} away. It asks for h = "
        f"{moment.size:.4g}, "
        f"which allows a ball of r′ = α·h = {moment.step.allowed:.4g}. {RULES[moment.step.case]}"
    )
    return text + ("<br><br>" + end_words(story) if moment.is_end else "")


def end_words(story: BallStory) -> str:
    """Return the result, what blocks the ball, and how the exact answer differs, as rich text."""
    trace, beta, alpha = story.trace, story.options.beta, story.options.alpha
    last = story.at(story.count - 1)
    if trace.radius >= trace.start * (1 - 1e-12):
        why = "No smaller size lies within reach, so the size asked for is kept"
        why += "." if beta == 1.0 else f", times β = {beta:g}."
    else:
        apart = float(np.linalg.norm(last.blocking - trace.centre))
        asks = float(story.sizes[np.linalg.norm(story.places - last.blocking, axis=1).argmin()])
        why = f"What stops it is the node at {place_words(last.blocking)}, {apart:.3g} away, which asks for {asks:.4g}."
    text = f"<b>h* = β·r/α = {beta:g} × {trace.radius:.4g} / {alpha:g} = {trace.size:.4g}.</b> {why}"
    if abs(trace.exact_size - trace.size) > 1e-3 * trace.size:
        how = "between nodes" if len(trace.centre) == 1 else "between nodes, and along straight lines instead of edges"
        text += f" Looking also {how}, the exact answer is {trace.exact_size:.4g}, "
        text += f"blocked at {place_words(trace.blocking)}."
    return text


def term_rows(story: BallStory, moment: Moment) -> tuple[tuple[str, str, str], ...]:
    """Return the terms of eq. (6) now: symbol, plain words, number."""
    step, alpha = moment.step, story.options.alpha
    least = moment.radius / alpha
    return (
        ("d", "distance of this node", f"{step.distance:.4g}"),
        ("h(y)", "size it asks for", f"{moment.size:.4g}"),
        ("r′ = α·h(y)", "ball it allows", f"{step.allowed:.4g}"),
        ("r", "the ball now", f"{moment.radius:.4g}"),
        ("r/α", "least size the ball may hold", f"{least:.4g}"),
        ("β·r/α", "h* so far" if not moment.is_end else "h*", f"{moment.candidate:.4g}"),
    )
