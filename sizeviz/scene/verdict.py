"""The judgement of a mesh in one line of words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.scene.scale import CORRECT
from sizeviz.scene.subject import MEASURE_TITLES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.conformity import Measure
    from sizeviz.scene.subject import Subject
    from sizeviz.scene.view import ViewState


def verdict(subject: Subject, view: ViewState) -> tuple[str, bool | None]:
    """Return the words under a pane, and whether they are good news (None: nothing is judged)."""
    if view.color_by in ("prescribed", "target"):
        return _field_words(subject, view), None
    if subject.mesh is None:
        return "no mesh yet", None
    values = subject.element_values(view.color_by, view.measure)
    if values is None:
        what = "no image to measure against" if view.color_by == "error" else "not judged yet"
        return what, None
    if view.color_by == "ratio":
        if subject.promise is not None and subject.report is not None:
            return ratio_words(subject.report.ratios[subject.promise], subject.promise)
        return ratio_words(values)
    if view.color_by == "quality":
        return quality_words(values)
    return f"{_short(values.min())} to {_short(values.max())}, mean {_short(values.mean())}", None


def ratio_words(ratios: NDArray[np.float64], promise: Measure | None = None) -> tuple[str, bool]:
    """Return such as "99.98 % correct, worst R = 1.03 at element 8123", and whether every element passes.

    Parameters
    ----------
    ratios : (Q,) float64
        R of every element.
    promise : {'mean-edge', 'sqrt-area', 'max-edge'}, optional
        The measure that R was formed with, named where it may be another than the one on show.
    """
    correct = int(np.count_nonzero(ratios <= CORRECT))
    worst = int(np.argmax(ratios))
    by = "" if promise is None else f" by the {MEASURE_TITLES[promise]}"
    words = f"{percent(correct, len(ratios))} correct{by}, worst R = {_ratio(ratios[worst])} at element {worst}"
    return words, correct == len(ratios)


def quality_words(quality: NDArray[np.float64]) -> tuple[str, bool | None]:
    """Return the smallest and mean quality in words; False where an element is inverted or folded."""
    worst = int(np.argmin(quality))
    words = f"mean quality {quality.mean():.3f}, worst {quality[worst]:.3f} at element {worst}"
    if quality[worst] > 0:
        return words, None
    return f"{int((quality <= 0).sum())} inverted, {words}", False


def percent(part: int, whole: int) -> str:
    """Return a share in percent, rounded towards zero, so that only all of them make 100 %."""
    if whole == 0:
        return "0 %"
    if part == whole:
        return "100 %"
    share = 100.0 * part / whole
    digits = 2 if share < 99.99 else 4
    return f"{math.floor(share * 10**digits) / 10**digits:.{digits}f} %"


def _ratio(value: float) -> str:
    """Round R to two digits, or to as many as it takes that a failing element never reads as passing."""
    digits = 2
    while value > CORRECT and round(value, digits) <= 1.0:
        digits += 1
    return f"{value:.{digits}f}"


def _short(value: float) -> str:
    return f"{value:.3g}"


def _field_words(subject: Subject, view: ViewState) -> str:
    field = subject.field(view.color_by)
    if field is None:
        return "not computed yet"
    low, high = float(field.sizes.min()), float(field.sizes.max())
    return f"{_short(low)} to {_short(high)} on {len(field.sizes):,} nodes"
