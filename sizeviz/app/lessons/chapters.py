"""The words of the lesson on a line, chapter by chapter, with the numbers of what is shown now."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.app.lessons.ball import headline, story_words
from sizeviz.app.lessons.line import METHODS, NAMES

if TYPE_CHECKING:
    from sizeviz.app.lessons.line import LineShown

TITLES: tuple[str, ...] = (
    "A wish for every place",
    "A mesh that misses it",
    "Limit the slope",
    "Keep room for small sizes",
    "Why is h* this here?",
    "Now you",
)
"""The chapters."""

BALL = 4
"""The chapter of the shrinking ball."""


@dataclass(frozen=True)
class Chapter:
    """One chapter as it is told now.

    Parameters
    ----------
    number : int
        From 0.
    title : str
        Its heading.
    words : str
        What it says, as rich text.
    equation : str
        The equation that it is about, as rich text.
    task : str
        What to try.
    methods : tuple of str
        Whose sizes, nodes and R are on show.
    controls : tuple of str
        Which of 'alpha', 'beta', 'epsilon' can be turned.
    """

    number: int
    title: str
    words: str
    equation: str
    task: str
    methods: tuple[str, ...]
    controls: tuple[str, ...] = ()

    @property
    def shows_ball(self) -> bool:
        """Whether the ball is on show."""
        return self.number == BALL


def chapter_of(shown: LineShown) -> Chapter:
    """Return the chapter that a lesson is at, told with its numbers."""
    tell = (_wish, _miss, _limit, _preserve, _ball, _free)[shown.lesson.chapter]
    return tell(shown)


def verdict_rows(shown: LineShown, chapter: Chapter) -> tuple[tuple[str, str, bool], ...]:
    """Return for each method on show its name, its judgement in words, and whether it passes."""
    if chapter.number == 0 or chapter.shows_ball:
        return ()
    return tuple((NAMES[name], shown.fronts[name].verdict, shown.fronts[name].passed) for name in chapter.methods)


def _wish(shown: LineShown) -> Chapter:
    low = int(shown.curves["none"].argmin())
    least, greatest = float(shown.curves["none"][low]), float(shown.curves["none"].max())
    return Chapter(
        0,
        TITLES[0],
        "A <b>size field</b> h(x) says how long an element of the mesh may be at each place x. Small sizes stand where "
        "something must be resolved, large ones where elements would be wasted.<br><br>"
        f"Here elements may be {greatest:.3g} long in most places, but only {least:.3g} at x = {shown.x[low]:.3g}. "
        "The question of this lesson: <b>which mesh keeps to that everywhere?</b>",
        "h(x)",
        "Drag the round handles to change h. Double-click the curve to add a handle, right-click one to remove it.",
        ("none",),
    )


def _miss(shown: LineShown) -> Chapter:
    front = shown.fronts["none"]
    first, second = front.nodes[:2]
    worst = int(front.ratios.argmax())
    least = float(shown.lesson.field.min_over(front.nodes[worst], front.nodes[worst + 1])[0])
    length = float(np.diff(front.nodes)[worst])
    return Chapter(
        1,
        TITLES[1],
        f"An advancing front starts at x = 0. The size there is {shown.curves['none'][0]:.3g}, so the next node comes "
        f"at "
        f"{first:.3g} + {second - first:.3g} = {second:.3g}. There it asks again, and so on. It looks only where it "
        f"stands: "
        "what comes within the next step it cannot know.<br><br>"
        "An element e is judged by <b>R(e)</b>: its length over the <i>smallest</i> size anywhere within it. "
        f"The element from {front.nodes[worst]:.3g} to {front.nodes[worst + 1]:.3g} is {length:.3g} long, but h falls "
        f"to "
        f"{least:.3g} in it, so R = {front.ratios[worst]:.2f}.",
        "R(e) = μ(e) / (β · min<sub>e</sub> h) ≤ 1 &nbsp;&nbsp;(3), (4)",
        "Below the curve: the elements, blue where R ≤ 1 and orange where they are too long. Make the valley wider "
        "until "
        "the front sees it.",
        ("none",),
    )


def _limit(shown: LineShown) -> Chapter:
    front = shown.fronts["gradient-limiting"]
    outcome = (
        "Every element is correct now, but it took luck: move the valley and look again."
        if front.passed
        else "The mesh follows the curve better. But the front still looks only at its own place: an element that "
        "leads "
        "downhill is as long as the size at its upper end."
    )
    return Chapter(
        2,
        TITLES[2],
        "A steep field cannot be followed. <b>Gradient limiting</b> lowers h until it nowhere rises faster than ε: "
        "near a "
        f"small size, sizes may grow by at most {shown.lesson.epsilon:g} for each unit of distance.<br><br>{outcome}",
        "h<sub>g</sub>(x) = min<sub>y</sub> ( h(y) + ε·|x − y| )",
        "Turn ε down. How gentle must the slope be until all elements are correct, and how many elements does that "
        "take?",
        ("none", "gradient-limiting"),
        ("epsilon",),
    )


def _preserve(shown: LineShown) -> Chapter:
    lesson = shown.lesson
    front, other = shown.fronts["size-preserving"], shown.fronts["gradient-limiting"]
    slope = lesson.beta / lesson.alpha
    if lesson.alpha >= lesson.beta:
        outcome = "so every element is correct, whatever h is. No luck is needed." if front.passed else ""
        outcome = f"An element as long as h* at its end lies within that distance, {outcome}"
    else:
        outcome = f"With α below {lesson.beta:g} an element reaches further than was looked, so it may be too long."
    return Chapter(
        3,
        TITLES[3],
        "<b>Size preserving</b> looks before it steps: h*(x) is the largest size such that nothing smaller is asked "
        "for "
        f"within α = {lesson.alpha:g} elements of that size. {outcome}<br><br>"
        f"Each valley gets a floor wide enough to hold an element, and the slope never exceeds β/α = {slope:.3g}. "
        f"It takes {len(front.ratios)} elements; gradient limiting with ε = {lesson.epsilon:g} takes "
        f"{len(other.ratios)}.",
        "h*(x) = β · min { h(y) : |x − y| ≤ α·h*(x)/β } &nbsp;&nbsp;(5), (6)",
        "Turn α. Below 1 elements fail; above 1 the floor of the valley grows wider than one element needs.",
        METHODS,
        ("alpha",),
    )


def _ball(shown: LineShown) -> Chapter:
    story = shown.ball
    moment = story.at(shown.lesson.step)
    return Chapter(
        BALL,
        TITLES[BALL],
        f"<b>{headline(story, moment)}</b><br><br>{story_words(story, moment)}",
        "r = α · min { h(y) : |x − y| ≤ r }, &nbsp; h* = β·r/α &nbsp;&nbsp;(6)",
        "The box is as wide as the ball and as high as the size it stands for: it must fit under h. "
        "Its corners slide along the dotted lines, |x − y|/α. Click the curve to ask at another place.",
        ("none", "size-preserving"),
        ("alpha",),
    )


def _free(shown: LineShown) -> Chapter:
    counts = ", ".join(f"{NAMES[name].lower()} {len(shown.fronts[name].ratios)}" for name in METHODS)
    return Chapter(
        5,
        TITLES[5],
        f"Elements: {counts}. Size preserving asks for at most twice as many elements as gradient limiting with "
        "ε = 1/α, and keeps every size asked for as long as α ≥ β.<br><br>"
        "In the plane nothing changes but the ball, which becomes round, and the mesh, which is made of "
        "quadrilaterals: "
        "open an example, right-click a place and ask the same question there.",
        "α ≥ β &nbsp;⟹&nbsp; R(e) ≤ 1",
        "Draw a field of your own and find one that gradient limiting gets right and one that it misses.",
        METHODS,
        ("alpha", "beta", "epsilon"),
    )
