"""Size fields on background meshes, gradient limiting and size preserving."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from sizeviz.sizing.background import BackgroundMesh, Grid
from sizeviz.sizing.field import SizeField
from sizeviz.sizing.options import LimitOptions, PreserveOptions

if TYPE_CHECKING:
    from sizeviz.sizing.analytic import AnalyticSize, SizeFunction
    from sizeviz.sizing.combine import minimum
    from sizeviz.sizing.count import ideal_count
    from sizeviz.sizing.envelopes import limited, preserved

_LAZY = {
    "AnalyticSize": "analytic",
    "SizeFunction": "analytic",
    "ideal_count": "count",
    "limited": "envelopes",
    "minimum": "combine",
    "preserved": "envelopes",
}

__all__ = [
    "AnalyticSize",
    "BackgroundMesh",
    "Grid",
    "LimitOptions",
    "PreserveOptions",
    "SizeField",
    "SizeFunction",
    "ideal_count",
    "limited",
    "minimum",
    "preserved",
]


def __getattr__(name: str) -> object:
    """Load what needs numba, scipy or shapely on first use."""
    if name not in _LAZY:
        raise AttributeError(f"module 'sizeviz.sizing' has no attribute {name!r}")
    return getattr(import_module(f"sizeviz.sizing.{_LAZY[name]}"), name)
