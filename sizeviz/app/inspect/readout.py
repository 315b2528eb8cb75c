"""What is under the cursor, in words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sizeviz.app.inspect.locate import ElementLocator
    from sizeviz.conformity import Measure
    from sizeviz.scene.subject import Subject
    from sizeviz.sizing import SizeField


@dataclass(frozen=True)
class Reading:
    """Everything known at a point; None where there is nothing.

    Parameters
    ----------
    x, y : float
        Where, in model units.
    prescribed, target : float, optional
        h and h* there.
    element : int, optional
        The element that holds the point.
    ratio, quality, size : float, optional
        Its R, shape quality and size.
    """

    x: float
    y: float
    prescribed: float | None = None
    target: float | None = None
    element: int | None = None
    ratio: float | None = None
    quality: float | None = None
    size: float | None = None

    def words(self) -> str:
        """Return the reading as one line."""
        parts = [f"x {self.x:.5g}   y {self.y:.5g}"]
        for name, value, form in (
            ("h", self.prescribed, ".4g"),
            ("h*", self.target, ".4g"),
            ("R", self.ratio, ".3f"),
            ("quality", self.quality, ".3f"),
        ):
            if value is not None:
                parts.append(f"{name} {value:{form}}")
        if self.element is not None:
            parts.append(f"element {self.element}")
        return "    ".join(parts)


def reading(subject: Subject, locator: ElementLocator | None, measure: Measure, x: float, y: float) -> Reading:
    """Return what a subject has at a point."""
    element = None if locator is None else locator.element_at(x, y)
    ratio = quality = size = None
    if element is not None:
        ratio, quality, size = (_of(subject, name, measure, element) for name in ("ratio", "quality", "size"))
    return Reading(
        x, y, value_at(subject.prescribed, x, y), value_at(subject.target, x, y), element, ratio, quality, size
    )


def value_at(field: SizeField | None, x: float, y: float) -> float | None:
    """Return a field's size at a point, None outside its background.

    On a grid this is plain arithmetic, so that hovering never waits for a kernel to be compiled.
    """
    if field is None:
        return None
    grid = field.background.grid
    if grid is None:
        low, high = field.background.points.min(axis=0), field.background.points.max(axis=0)
        inside = low[0] <= x <= high[0] and low[1] <= y <= high[1]
        return float(field.at(np.array([[x, y]]))[0]) if inside else None
    u, v = (x - grid.x0) / grid.dx, (y - grid.y0) / grid.dy
    if not (0.0 <= u <= grid.nx - 1 and 0.0 <= v <= grid.ny - 1):
        return None
    j, i = min(math.floor(u), grid.nx - 2), min(math.floor(v), grid.ny - 2)
    s, t = u - j, v - i
    at = i * grid.nx + j
    low_left, right, above, across = (field.sizes[at + k] for k in (0, 1, grid.nx, grid.nx + 1))
    if s >= t:  # the triangle below the diagonal
        return float(low_left + s * (right - low_left) + t * (across - right))
    return float(low_left + t * (above - low_left) + s * (across - above))


def _of(subject: Subject, quantity: str, measure: Measure, element: int) -> float | None:
    if subject.report is None:
        return None
    values = {"ratio": subject.report.ratios[measure], "quality": subject.report.quality}.get(
        quantity, subject.report.sizes[measure]
    )
    return float(values[element])
