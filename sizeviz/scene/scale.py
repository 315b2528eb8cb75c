"""From a value to its colour and back to a place on the colour bar: one definition for pane, bar and figure."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from sizeviz.errors import InputError
from sizeviz.scene.colormaps import RATIO_MAP, STEPS, ColorMap

if TYPE_CHECKING:
    from numpy.typing import NDArray

Norm = Literal["linear", "log", "ratio"]
"""How values spread over the bar; 'ratio' is logarithmic on either side of 1, which sits in the middle."""

CORRECT = 1.0 + 1e-9
"""R up to here counts as correct, so that an element exactly as large as asked for is not failed by rounding."""

UNDEFINED = (150, 150, 150)
"""Colour of a value that is not finite."""


@dataclass(frozen=True)
class ColorScale:
    """A colour map laid over a range of values.

    Parameters
    ----------
    cmap : ColorMap
        The colours.
    low, high : float
        Values at the two ends of the bar; anything beyond takes the end's colour.
    norm : {'linear', 'log', 'ratio'}
        How values spread between them; 'ratio' needs ``low < 1 < high``, 'log' needs ``low > 0``.
    classes : int
        Number of flat steps, 0 for a continuous bar. A broken map keeps its break between two classes.
    title : str
        What the bar is headed with.

    Raises
    ------
    InputError
        If the range is empty, not finite, or does not suit the norm.
    """

    cmap: ColorMap
    low: float
    high: float
    norm: Norm = "linear"
    classes: int = 0
    title: str = ""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise InputError(f"colour range {self.low} to {self.high}: the upper end must be above the lower one")
        if self.norm != "linear" and self.low <= 0:
            raise InputError(f"colour range from {self.low}: a logarithmic bar must start above 0")
        if self.norm == "ratio" and not self.low < 1.0 < self.high:
            raise InputError(f"colour range {self.low} to {self.high}: a bar for R must have 1 inside")
        if self.classes < 0 or self.classes > STEPS:
            raise InputError(f"{self.classes} colour classes: give 0 (continuous) to {STEPS}")

    def fractions(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where on the bar each value lies, ``(N,)`` in [0, 1]; NaN stays NaN."""
        inside = np.clip(np.asarray(values, dtype=np.float64), self.low, self.high)
        if self.norm == "linear":
            return (inside - self.low) / (self.high - self.low)
        if self.norm == "log":
            return np.log(inside / self.low) / math.log(self.high / self.low)
        below = 0.5 * np.log(inside / self.low) / -math.log(self.low)
        above = 0.5 + 0.5 * np.log(np.maximum(inside, 1.0)) / math.log(self.high)
        return np.where(inside <= CORRECT, np.minimum(below, 0.5), above)

    def value_at(self, fraction: float) -> float:
        """Return the value at a place on the bar, 0 its lower and 1 its upper end."""
        if self.norm == "linear":
            return self.low + fraction * (self.high - self.low)
        if self.norm == "log":
            return self.low * (self.high / self.low) ** fraction
        if fraction <= 0.5:
            return self.low ** (1.0 - 2.0 * fraction)
        return self.high ** (2.0 * fraction - 1.0)

    def colors(self, values: NDArray[np.float64]) -> NDArray[np.uint8]:
        """Return the sRGB colour of each value, ``(N, 3)``; a value equal to a break takes the lower colour."""
        fractions = self.fractions(values)
        undefined = np.isnan(fractions)
        if not undefined.any():
            return self.cmap.table.take(self._rows(fractions), axis=0)
        colors = self.cmap.table.take(self._rows(np.where(undefined, 0.0, fractions)), axis=0)
        colors[undefined] = UNDEFINED
        return colors

    def bar(self, steps: int = STEPS) -> NDArray[np.uint8]:
        """Return the colours along the bar from low to high, ``(steps, 3)``."""
        return self.cmap.table[self._rows((np.arange(steps) + 0.5) / steps)]

    def ticks(self) -> list[tuple[float, str]]:
        """Return the bar's labelled marks: place on the bar in [0, 1] and text, from low to high."""
        values = _tick_values(self)
        where = self.fractions(np.array(values))
        return [(float(at), tick_label(value)) for at, value in zip(where, values, strict=True)]

    def with_range(self, low: float, high: float) -> ColorScale:
        """Return the same scale over another range."""
        return replace(self, low=low, high=high)

    def _rows(self, fractions: NDArray[np.float64]) -> NDArray[np.intp]:
        if self.cmap.broken:
            upper = fractions > 0.5
            inner = np.where(upper, 2.0 * fractions - 1.0, 2.0 * fractions)
            half = STEPS // 2
            return upper * half + _cells(inner, half, max(self.classes // 2, 1) if self.classes else 0)
        return _cells(fractions, STEPS, self.classes)


def ratio_scale(low: float, high: float, *, title: str = "R", classes: int = 0) -> ColorScale:
    """Return the scale of R(e): blue up to 1, orange above, the break exactly at 1."""
    return ColorScale(RATIO_MAP, min(low, 0.8), max(high, 1.2), "ratio", classes, title)


def tick_label(value: float) -> str:
    """Return a number as a bar shows it: short, no trailing zeros, powers of ten where it is tiny or huge."""
    if value == 0.0:
        return "0"
    if 1e-3 <= abs(value) < 1e5:
        return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
    mantissa, exponent = f"{value:.1e}".split("e")
    mantissa = mantissa.removesuffix(".0")
    power = "10" + str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return power if mantissa == "1" else f"{mantissa}·{power}"


def _cells(fractions: NDArray[np.float64], rows: int, classes: int) -> NDArray[np.intp]:
    """Return table rows; with classes, the middle row of each class, spread so that both ends are reached."""
    if not classes:
        return np.minimum((fractions * rows).astype(np.intp), rows - 1)
    step = np.minimum((fractions * classes).astype(np.intp), classes - 1)
    if classes == 1:
        return np.full(fractions.shape, rows // 2, dtype=np.intp)
    return np.rint(step * ((rows - 1) / (classes - 1))).astype(np.intp)


def _tick_values(scale: ColorScale) -> list[float]:
    if scale.norm == "linear":
        return _linear_ticks(scale.low, scale.high)
    if scale.norm == "log":
        return _log_ticks(scale.low, scale.high)
    wanted = (0.1, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0, 100.0)
    inside = [value for value in wanted if scale.low * 0.999 <= value <= scale.high * 1.001]
    return _spaced(scale, inside, keep=(1.0, 1.1))


def _spaced(scale: ColorScale, values: list[float], keep: tuple[float, ...], gap: float = 0.07) -> list[float]:
    """Drop ticks that would print over another one; those in ``keep`` always stay."""
    chosen = [value for value in keep if scale.low <= value <= scale.high]
    for value in sorted(values, key=lambda v: -abs(math.log(v))):
        places = scale.fractions(np.array([*chosen, value]))
        if value not in chosen and np.all(np.abs(places[:-1] - places[-1]) >= gap):
            chosen.append(value)
    return sorted(chosen)


def _linear_ticks(low: float, high: float) -> list[float]:
    rough = (high - low) / 5.0
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if power * factor >= rough * 0.999)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(k * step, 12) for k in range(first, last + 1)]


def _log_ticks(low: float, high: float) -> list[float]:
    decades = math.log10(high / low)
    factors = (1.0,) if decades > 4 else (1.0, 3.0) if decades > 1.6 else (1.0, 2.0, 3.0, 5.0, 7.0)
    exponents = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1)
    ticks = [factor * 10.0**power for power in exponents for factor in factors]
    inside = [tick for tick in ticks if low * 0.999 <= tick <= high * 1.001]
    return inside if len(inside) >= 2 else [low, high]
