"""What a reader is told beside the file, where the file leaves a choice."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from sizeviz.errors import InputError

Axis = Literal["x", "y", "z"]


@dataclass(frozen=True, kw_only=True)
class ReadOptions:
    """Choices that a file may leave open; every default is the usual one, and each format ignores what is not its own.

    Parameters
    ----------
    array : str, optional
        Name of the array that holds sizes or intensities. By default ``size`` or another usual name, or the only one.
    axis : {'x', 'y', 'z'}
        Across which axis a volume is sliced. Default z.
    slice : int, optional
        Which slice of a volume, or frame of a sequence, counted from 0. By default the middle slice, the first frame.
    frame : int
        Which volume of a series in time, counted from 0. Default 0.
    tolerance : float, optional
        How far a sampled curve may lie from the true one, in model units, above 0. By default 1/10000 of the
        drawing's diagonal.
    part : int, optional
        Which one of several separate regions, counted from 1, largest first. By default there may be only one.
    extent : tuple of float, optional
        x0, y0, x1, y1 that a grid without coordinates spans. By default the unit square.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    array: str | None = None
    axis: Axis = "z"
    slice: int | None = None
    frame: int = 0
    tolerance: float | None = None
    part: int | None = None
    extent: tuple[float, float, float, float] | None = None

    def __post_init__(self) -> None:
        if self.axis not in ("x", "y", "z"):
            raise InputError(f"axis is {self.axis!r}; choose x, y or z")
        for name, value, least in (("slice", self.slice, 0), ("frame", self.frame, 0), ("part", self.part, 1)):
            if value is not None and value < least:
                raise InputError(f"{name} is {value}; it must be {least} or more")
        if self.tolerance is not None and not (math.isfinite(self.tolerance) and self.tolerance > 0):
            raise InputError(f"tolerance is {self.tolerance}; it must be a number above 0, in model units")
        if self.extent is not None:
            x0, y0, x1, y1 = self.extent
            if not (all(map(math.isfinite, self.extent)) and x1 > x0 and y1 > y0):
                raise InputError(f"extent is {self.extent}; give x0, y0, x1, y1 with x1 > x0 and y1 > y0")
