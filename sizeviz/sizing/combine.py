"""The least of several fields (Remark 1)."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import Delaunay

from sizeviz.errors import InputError
from sizeviz.sizing.background import BackgroundMesh
from sizeviz.sizing.field import SizeField

if TYPE_CHECKING:
    from collections.abc import Sequence


def minimum(fields: Sequence[SizeField]) -> SizeField:
    """Return a field that honours several at once (Remark 1 of the paper).

    On a shared background the nodal sizes are the least of each node's; between nodes the result then lies at or
    below the least of the fields, because a minimum of linear functions is concave. Different backgrounds are
    joined first: every node of any of them becomes a node.

    Raises
    ------
    InputError
        If there is no field.
    """
    if not fields:
        raise InputError("minimum: no field is given; name at least one")
    label = " and ".join(field.label for field in fields)
    first = fields[0].background
    if all(_same_background(first, field.background) for field in fields[1:]):
        return fields[0].with_sizes(reduce(np.minimum, [field.sizes for field in fields]), label)
    points = np.unique(np.vstack([field.background.points for field in fields]), axis=0)
    sizes = reduce(np.minimum, [field.at(points) for field in fields])
    return SizeField(BackgroundMesh(points, Delaunay(points).simplices), sizes, label)


def _same_background(one: BackgroundMesh, other: BackgroundMesh) -> bool:
    return one is other or (
        one.grid == other.grid
        and np.array_equal(one.points, other.points)
        and np.array_equal(one.triangles, other.triangles)
    )
