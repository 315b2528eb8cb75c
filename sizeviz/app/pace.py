"""How long runs took, and how long the next ones should take."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sizeviz.sizing import SizeField
    from sizeviz.study import Study


FEW = 10_000.0
"""Runs of fewer elements than this take no less time than one of so many."""


class Pace:
    """What the last run of each method took, and on which field.

    A field that was painted over may ask for a hundred times as many elements as the one before: what a run took says
    nothing until it is told in seconds an element; small runs all take about the same time.
    """

    def __init__(self) -> None:
        self._last: dict[str, tuple[float, SizeField]] = {}

    @property
    def seconds(self) -> float:
        """What the last runs of all methods took together."""
        return sum(seconds for seconds, _ in self._last.values())

    def note(self, study: Study, method: str) -> None:
        """Remember what a complete run took."""
        self._last[method] = study.runs[method].total_seconds, study.source.field

    def seconds_for(self, study: Study) -> float:
        """Return what runs of a study should take: as the last ones, in proportion to the elements asked for."""
        field = study.source.field
        total, known = 0.0, {id(field): 1.0}
        for seconds, before in self._last.values():
            if id(before) not in known:
                known[id(before)] = squares(field) / max(squares(before), FEW)
            total += seconds * max(1.0, known[id(before)])
        return total


def squares(field: SizeField) -> float:
    """Return about how many square elements a field asks for: 1 / h² at the corners of the background's triangles."""
    triangles, points = field.background.triangles, field.background.points
    a, b, c = (points[triangles[:, k]] for k in range(3))
    areas = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    density = field.sizes**-2.0
    return float(areas @ density[triangles].mean(axis=1))
