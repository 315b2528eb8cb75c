"""A small source that meshes in a moment."""

from __future__ import annotations

import numpy as np

from sizeviz.geometry import Domain
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sources.source import Source


def valley_source(n: int = 65, low: float = 0.015, high: float = 0.08) -> Source:
    """Return a slanted valley on the unit square."""
    background = BackgroundMesh.unit_square_grid(n, n)
    x, y = background.points.T
    field = SizeField(background, np.clip(np.abs(x - 0.4 - 0.2 * y), low, high), label="valley")
    return Source(name="valley", label="a slanted valley", domain=Domain.unit_square(), field=field, reference=field)
