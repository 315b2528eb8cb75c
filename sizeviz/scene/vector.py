"""True vector figures: every element a polygon, the same colours as on the screen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.files import replacing
from sizeviz.scene.spec import CellLayer, Color, ImageLayer, LineLayer, SceneSpec, TriangleLayer

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sizeviz.scene.scale import ColorScale

VECTOR_SUFFIXES = (".svg", ".pdf")
"""File suffixes that mean vectors."""


def save_vector(spec: SceneSpec, path: Path, *, width: float = 7.0) -> Path:
    """Write a scene as SVG or PDF, text as text and elements as polygons.

    Parameters
    ----------
    spec : SceneSpec
        What to draw.
    path : Path
        Where to; .svg or .pdf.
    width : float
        Width of the figure in inches.

    Returns
    -------
    Path
        Where it was written.

    Raises
    ------
    InputError
        If the place cannot be written.
    """
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    x0, y0, x1, y1 = spec.bounds
    height = width * min(max((y1 - y0) / (x1 - x0), 0.25), 2.5)
    figure = Figure(figsize=(width, height + 1.1), facecolor=_unit(spec.ground))
    FigureCanvasAgg(figure)
    share = height / (height + 1.1)
    axes = figure.add_axes((0.03, 0.94 - 0.94 * share, 0.94, 0.94 * share))
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal")
    axes.set_axis_off()
    near = any(isinstance(layer, CellLayer) and layer.edges is not None for layer in spec.layers)
    for layer in spec.layers:
        if isinstance(layer, LineLayer) and layer.near and not near:
            continue
        _DRAW[type(layer)](axes, layer)
    ink = _unit(spec.ink)
    figure.text(0.03, 0.965, spec.title, color=ink, fontsize=11, fontweight="bold")
    figure.text(0.97, 0.965, spec.detail, color=ink, fontsize=9, ha="right")
    figure.text(0.03, 0.94 - 0.94 * share - 0.02, spec.verdict, color=ink, fontsize=9, va="top")
    if spec.scale is not None:
        _bar(figure, spec.scale, 0.36 / (height + 1.1), ink)
    kind = path.suffix.lower().lstrip(".")
    undated = {"Date": None} if kind == "svg" else {"CreationDate": None}  # equal scenes are equal files
    with replacing(path) as part, rc_context({"svg.fonttype": "none", "svg.hashsalt": "sizeviz", "pdf.fonttype": 42}):
        figure.savefig(part, format=kind, facecolor=figure.get_facecolor(), metadata=undated)
    return path


def _cells(axes: Any, layer: CellLayer) -> None:
    faces = _compound(layer.points[layer.quads], layer.colors)
    if layer.edges is not None:
        faces.set(edgecolor=(*_unit(layer.edges), 0.5))
    axes.add_collection(faces)


def _triangles(axes: Any, layer: TriangleLayer) -> None:
    corner = layer.colors[layer.triangles].astype(np.float64)
    axes.add_collection(_compound(layer.points[layer.triangles], np.rint(corner.mean(axis=1)).astype(np.uint8)))


def _compound(polygons: NDArray[np.float64], colors: NDArray[np.uint8]) -> Any:
    """Return one path for all polygons of a colour: files and drawing times many times smaller than one path each."""
    from matplotlib.collections import PathCollection
    from matplotlib.path import Path as Outline

    unique, which = np.unique(colors, axis=0, return_inverse=True)
    corners = polygons.shape[1]
    closed = np.concatenate([polygons, polygons[:, :1]], axis=1)
    codes = np.array([Outline.MOVETO, *[Outline.LINETO] * (corners - 1), Outline.CLOSEPOLY], dtype=np.uint8)
    groups = np.split(np.argsort(which.ravel(), kind="stable"), np.cumsum(np.bincount(which.ravel()))[:-1])
    paths = [Outline(closed[rows].reshape(-1, 2), np.tile(codes, len(rows))) for rows in groups]
    # A hairline in the element's own colour closes the seams that viewers leave between neighbours.
    return PathCollection(paths, facecolors=unique / 255.0, edgecolors=unique / 255.0, linewidths=0.15)


def _image(axes: Any, layer: ImageLayer) -> None:
    x0, y0, x1, y1 = layer.bounds
    ny, nx = layer.colors.shape[:2]
    half_x, half_y = 0.5 * (x1 - x0) / (nx - 1), 0.5 * (y1 - y0) / (ny - 1)
    extent = (x0 - half_x, x1 + half_x, y0 - half_y, y1 + half_y)
    axes.imshow(layer.colors, origin="lower", extent=extent, interpolation="nearest", aspect="auto")
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal")


def _lines(axes: Any, layer: LineLayer) -> None:
    from matplotlib.collections import LineCollection

    lines = list(layer.points[layer.segments])
    colors: Any = [_unit(layer.color)] if layer.colors is None else layer.colors / 255.0
    axes.add_collection(LineCollection(lines, colors=colors, linewidths=0.5 * layer.width, clip_on=False))


_DRAW: dict[type, Any] = {CellLayer: _cells, TriangleLayer: _triangles, ImageLayer: _image, LineLayer: _lines}


def _bar(figure: Any, scale: ColorScale, bottom: float, ink: tuple[float, float, float]) -> None:
    axes = figure.add_axes((0.03, bottom, 0.55, 0.02))
    colors = scale.bar(128) / 255.0
    for k, color in enumerate(colors):
        axes.axvspan(k / 128.0, (k + 1) / 128.0, facecolor=color, edgecolor=color, linewidth=0.15)
    ticks = scale.ticks()
    axes.set(xlim=(0.0, 1.0), yticks=[])
    axes.set_xticks([at for at, _ in ticks], [label for _, label in ticks], fontsize=8, color=ink)
    axes.tick_params(color=ink, length=3)
    axes.set_title(scale.title, fontsize=8, loc="left", color=ink, pad=3)
    for side in axes.spines.values():
        side.set_visible(False)


def _unit(color: Color) -> tuple[float, float, float]:
    return color[0] / 255.0, color[1] / 255.0, color[2] / 255.0
