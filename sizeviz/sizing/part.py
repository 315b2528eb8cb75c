"""The part of a size field in a box, for work there that should not cost what the whole field costs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.sizing.background import BackgroundMesh
from sizeviz.sizing.field import SizeField

if TYPE_CHECKING:
    from numpy.typing import NDArray


def part_of(field: SizeField, low: NDArray[np.float64], high: NDArray[np.float64]) -> SizeField:
    """Return the field on the triangles that a box may meet: the same sizes within it, where the field has any.

    Parameters
    ----------
    field : SizeField
        Sizes.
    low, high : (2,) float64
        Corners of the box, in model units. Where it lies beyond the background, the whole field is returned.
    """
    corner = field.background.points[field.background.triangles]
    meets = ((corner.min(axis=1) <= high) & (corner.max(axis=1) >= low)).all(axis=1)
    cells = field.background.triangles[meets]
    if not len(cells):
        return field
    nodes = np.unique(cells)
    background = BackgroundMesh(field.background.points[nodes], np.searchsorted(nodes, cells).astype(np.int32))
    return SizeField(background, field.sizes[nodes], field.label)
