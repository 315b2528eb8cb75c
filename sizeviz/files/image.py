"""Images: intensities on a regular grid of pixels, and how large a pixel is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import read_only

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Image:
    """A grey image, upright: row 0 is at the smallest y.

    Parameters
    ----------
    values : (ny, nx) float64
        Intensity at each pixel's centre, as the file gives it (8-bit pictures run from 0 to 255), finite.
    spacing : tuple of float
        Distance between pixels along x and y, in model units (millimetres for medical images), above 0.
    origin : tuple of float
        Centre of pixel (0, 0).
    label : str
        What to call the image in messages.

    Raises
    ------
    InputError
        If the values are not a 2-D array of at least 2 x 2 finite numbers, or the spacing is not above 0.
    """

    values: NDArray[np.float64]
    spacing: tuple[float, float] = (1.0, 1.0)
    origin: tuple[float, float] = (0.0, 0.0)
    label: str = "image"

    def __post_init__(self) -> None:
        values = np.asarray(self.values)
        if values.ndim != 2 or min(values.shape) < 2 or values.dtype.kind not in "bfiu":
            found = f"{values.dtype} of shape {values.shape}"
            raise InputError(f"{self.label}: expected a grey image of at least 2 x 2 pixels, got {found}")
        values = values.astype(np.float64, copy=False)
        if not np.isfinite(values).all():
            raise InputError(
                f"{self.label}: {int((~np.isfinite(values)).sum())} pixels are not finite; repair the image"
            )
        if not all(math.isfinite(step) and step > 0 for step in self.spacing):
            raise InputError(f"{self.label}: pixel spacing is {self.spacing}; both must be finite and above 0")
        if not all(map(math.isfinite, self.origin)):
            raise InputError(f"{self.label}: the image's origin {self.origin} is not finite")
        object.__setattr__(self, "values", read_only(values))

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and columns."""
        return self.values.shape[0], self.values.shape[1]
