"""Colour tables: small lists of anchors, perceptually ordered and safe for the colour-blind."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import read_only

if TYPE_CHECKING:
    from numpy.typing import NDArray

STEPS = 512
"""Rows of a colour table; more than a screen's colour bar is long."""

_ANCHORS: dict[str, tuple[str, ...]] = {
    # viridis, magma, cividis: after S. van der Walt, N. Smith, E. Firing and J. R. Nunez et al. (CC0)
    "viridis": ("440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"),
    "magma": ("000004", "1d1147", "51127c", "832681", "b73779", "e75263", "fc8961", "fec488", "fcfdbf"),
    "cividis": ("00224e", "123570", "3b496c", "575d6d", "707173", "8a8678", "a59c74", "c3b369", "fee838"),
    "ice": ("f4fbf7", "d3ecdf", "a5d8cb", "72bfbc", "459fae", "34799b", "325481", "2b315a", "171a2e"),
    "grey": ("1b1b1b", "6e6e6e", "b4b4b4", "f2f2f2"),
}

_CORRECT = ("08306b", "1f5fa8", "4a8fc7", "86b9de", "c9dff0")
_FAILING = ("fdae4d", "f98a25", "e0620d", "b8430a", "6e2407")


@dataclass(frozen=True)
class ColorMap:
    """A colour table with an optional hard break in its middle.

    Parameters
    ----------
    name : str
        What the table is called in menus and files.
    broken : bool
        Whether the lower and the upper half meet in a jump rather than smoothly.
    """

    name: str
    broken: bool = False

    @property
    def table(self) -> NDArray[np.uint8]:
        """The ``(512, 3)`` sRGB colours, first the lowest value's."""
        return _table(self.name)


RATIO_MAP = ColorMap("blue | orange", broken=True)
"""R(e): blue up to 1, orange above; blue and orange are told apart in every common colour blindness."""

MAPS: dict[str, ColorMap] = {name: ColorMap(name) for name in _ANCHORS} | {RATIO_MAP.name: RATIO_MAP}
"""Every colour map by name."""


def color_map(name: str) -> ColorMap:
    """Return the colour map called ``name``; a trailing ``_r`` turns a smooth one around.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    if name in MAPS:
        return MAPS[name]
    if name.endswith("_r") and name[:-2] in _ANCHORS:
        return ColorMap(name)
    raise InputError(f"colour map {name!r} is unknown; choose one of {', '.join(MAPS)}")


@cache
def _table(name: str) -> NDArray[np.uint8]:
    if name == RATIO_MAP.name:
        half = STEPS // 2
        return read_only(np.vstack([_ramp(_CORRECT, half), _ramp(_FAILING, half)]))
    if name.endswith("_r"):
        return read_only(_table(name[:-2])[::-1].copy())
    return read_only(_ramp(_ANCHORS[name], STEPS))


def _ramp(anchors: tuple[str, ...], steps: int) -> NDArray[np.uint8]:
    rgb = np.array([[int(color[k : k + 2], 16) for k in (0, 2, 4)] for color in anchors], dtype=np.float64)
    at = np.linspace(0.0, len(anchors) - 1.0, steps)
    channels = [np.interp(at, np.arange(len(anchors)), rgb[:, k]) for k in range(3)]
    return np.rint(np.column_stack(channels)).astype(np.uint8)
