"""Size fields on background meshes, gradient limiting and size preserving."""

from sizeviz.sizing.background import BackgroundMesh, Grid
from sizeviz.sizing.field import SizeField
from sizeviz.sizing.options import LimitOptions, PreserveOptions

__all__ = ["BackgroundMesh", "Grid", "LimitOptions", "PreserveOptions", "SizeField"]
