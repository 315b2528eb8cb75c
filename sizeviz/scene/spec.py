"""A picture as plain data: layers of coloured geometry, a colour bar, and the words beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sizeviz.scene.scale import ColorScale

Color = tuple[int, int, int]
"""sRGB, 0 to 255."""

Bounds = tuple[float, float, float, float]
"""Smallest x, smallest y, largest x, largest y, in model units."""


@dataclass(frozen=True, eq=False)
class CellLayer:
    """Quadrilaterals of one flat colour each.

    Parameters
    ----------
    name : str
        Identity of the layer from one scene to the next.
    points : (N, 2) float64
        Nodes.
    quads : (Q, 4) int32
        Corners.
    colors : (Q, 3) uint8
        Colour of each element.
    edges : Color, optional
        Colour of the element edges, none by default.
    """

    name: str
    points: NDArray[np.float64]
    quads: NDArray[np.int32]
    colors: NDArray[np.uint8]
    edges: Color | None = None


@dataclass(frozen=True, eq=False)
class TriangleLayer:
    """Triangles coloured at their corners and blended between.

    Parameters
    ----------
    name : str
        Identity of the layer.
    points : (V, 2) float64
        Nodes.
    triangles : (T, 3) int32
        Corners.
    colors : (V, 3) uint8
        Colour at each node.
    """

    name: str
    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    colors: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class ImageLayer:
    """A regular grid of coloured nodes, drawn as one picture.

    Parameters
    ----------
    name : str
        Identity of the layer.
    colors : (ny, nx, 3) uint8
        Colour at each node, row 0 at the smallest y.
    bounds : Bounds
        Where the outermost nodes lie.
    """

    name: str
    colors: NDArray[np.uint8]
    bounds: Bounds


@dataclass(frozen=True, eq=False)
class LineLayer:
    """Line segments.

    Parameters
    ----------
    name : str
        Identity of the layer.
    points : (N, 2) float64
        Vertices.
    segments : (S, 2) int32
        Ends of each segment.
    color : Color
        Colour of every segment that has none of its own.
    width : float
        Thickness in pixels.
    colors : (S, 3) uint8, optional
        A colour for each segment.
    near : bool
        Whether the lines are drawn only where element edges are: near enough to tell one element from the next.
    """

    name: str
    points: NDArray[np.float64]
    segments: NDArray[np.int32]
    color: Color
    width: float = 1.0
    colors: NDArray[np.uint8] | None = None
    near: bool = False


Layer = CellLayer | TriangleLayer | ImageLayer | LineLayer


@dataclass(frozen=True, eq=False)
class SceneSpec:
    """All that one pane shows.

    Parameters
    ----------
    layers : tuple of Layer
        Back to front.
    bounds : Bounds
        What 'fit' shows.
    scale : ColorScale, optional
        The colour bar, where anything is coloured.
    title : str
        The method or file shown.
    detail : str
        Its parameters and counts in a few words.
    verdict : str
        The judgement in words, or what is missing.
    passed : bool, optional
        Whether the verdict is good; None where there is nothing to judge.
    ground, ink : Color
        Colour behind the layers, and of lines and words upon it.
    """

    layers: tuple[Layer, ...]
    bounds: Bounds
    scale: ColorScale | None = None
    title: str = ""
    detail: str = ""
    verdict: str = ""
    passed: bool | None = None
    ground: Color = (255, 255, 255)
    ink: Color = (30, 34, 40)
