"""A stroke while it is drawn: only the nodes that the newest piece of the path reaches are touched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry.arrays import read_only
from sizeviz.sources.painting import (
    Brush,
    Stroke,
    StrokeShape,
    blended,
    inside_polygon,
    raise_weights,
    stroke_goal,
    stroke_weights,
)

if TYPE_CHECKING:
    from sizeviz.sizing import SizeField


@dataclass(frozen=True, eq=False)
class Painted:
    """How a field came about by painting: the field before the first stroke, and the strokes in order."""

    original: SizeField
    strokes: tuple[Stroke, ...] = ()

    def with_stroke(self, stroke: Stroke) -> Painted:
        """Return the painting with one more stroke."""
        return Painted(self.original, (*self.strokes, stroke))


class LiveStroke:
    """Accumulates a path; at every moment ``field`` equals ``painted(base, stroke)``.

    Parameters
    ----------
    base : SizeField
        The field before the stroke.
    brush : Brush
        What the stroke does.
    shape : {'freehand', 'line', 'polygon'}
        Freehand strokes grow with every point; the others are given whole by ``replace_path``.
    original : SizeField, optional
        What erasing brings back.
    """

    def __init__(
        self, base: SizeField, brush: Brush, shape: StrokeShape = "freehand", original: SizeField | None = None
    ) -> None:
        self.base, self.brush, self.shape = base, brush, shape
        self.path: list[tuple[float, float]] = []
        self._goal = stroke_goal(base, brush, original)
        self._weights = np.zeros(len(base.sizes))
        self._sizes = base.sizes.copy()

    @property
    def stroke(self) -> Stroke:
        """The stroke so far."""
        return Stroke(self.brush, np.array(self.path), self.shape)

    @property
    def field(self) -> SizeField:
        """The field as painted so far; a copy, so that a worker may read it while the stroke goes on."""
        return self.base.with_sizes(read_only(self._sizes.copy()))

    def extend(self, x: float, y: float) -> None:
        """Go on to a point; everything between it and the last one is covered."""
        end = np.array([x, y])
        start = np.array(self.path[-1]) if self.path else end
        self.path.append((x, y))
        nodes = raise_weights(self._weights, self.base.background, self.brush, start, end)
        self._sizes[nodes] = blended(self.base.sizes[nodes], self._goal[nodes], self._weights[nodes], self.brush)

    def replace_path(self, path: list[tuple[float, float]]) -> None:
        """Take another path in place of the old one, as while the last corner of a line is moved."""
        self.path = list(path)
        self._weights = stroke_weights(self.base.background, self.stroke)
        nodes = np.flatnonzero(self._weights)
        self._sizes = self.base.sizes.copy()
        self._sizes[nodes] = blended(self.base.sizes[nodes], self._goal[nodes], self._weights[nodes], self.brush)


def covers_nothing(stroke: Stroke, field: SizeField) -> bool:
    """Return whether a stroke reaches no node at all, such as one beside the domain."""
    if stroke.shape == "polygon" and inside_polygon(field.background.points, stroke.path).any():
        return False
    return not stroke_weights(field.background, stroke).any()


def stroke_words(brush: Brush) -> str:
    """Return a stroke in words, for the history."""
    return {
        "set": f"set {brush.value:.3g}",
        "multiply": f"× {brush.value:.3g}",
        "at-most": f"at most {brush.value:.3g}",
        "smooth": "smooth",
        "erase": "erase",
    }[brush.mode]
