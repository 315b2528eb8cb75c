"""The paper's figures drawn again with matplotlib: sheets of panels, and what the panels share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.files import replacing

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from sizeviz.geometry import QuadMesh
    from sizeviz.scene.scale import ColorScale
    from sizeviz.study.evolution import Evolution

INK, FAINT = "#222222", "#8a8a8a"
"""Colours of lines and text, and of what stands back."""

COLORS: dict[str, str] = {
    "none": "#222222",
    "gradient-limiting": "#b8430a",
    "size-preserving": "#1f5fa8",
}
"""Colours of the methods, told apart in every common colour blindness."""

WORDS: dict[str, str] = {
    "none": "original",
    "gradient-limiting": "gradient limiting",
    "size-preserving": "size preserving",
}
"""The methods in the paper's words."""

DASHES: tuple[str, ...] = ("-", "--", ":", "-.")
"""Line styles, one for each mesher or curve in turn."""

MOST_VECTORS = 30_000
"""Panels of more elements are drawn as pixels within the vector figure: nobody can see them, or open the file."""

DOTS = 200
"""Pixels an inch of the PNG files and of panels drawn as pixels."""


def sheet(panels: tuple[int, int], panel: tuple[float, float] = (3.4, 3.2)) -> tuple[Any, Any]:
    """Return a figure of ``(rows, columns)`` panels of ``(width, height)`` inches, and the panels, row by row."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows, columns = panels
    figure = Figure(figsize=(columns * panel[0], rows * panel[1]), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False)
    return figure, axes.ravel()


def save(figure: Any, folder: Path, name: str) -> None:
    """Write a figure as PNG and as SVG, text as text."""
    from matplotlib import rc_context

    for suffix in (".png", ".svg"):
        with replacing(folder / f"{name}{suffix}") as part, rc_context({"svg.fonttype": "none", "svg.hashsalt": name}):
            figure.savefig(part, dpi=DOTS, metadata={"Date": None} if suffix == ".svg" else None)


def title(axes: Any, text: str) -> None:
    """Head a panel."""
    axes.set_title(text, fontsize=9, loc="left", color=INK)
    axes.tick_params(labelsize=8)


def bare(axes: Any, bounds: tuple[float, float, float, float]) -> None:
    """Show a box of the plane, x and y alike, without axes."""
    x0, y0, x1, y1 = bounds
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", xticks=[], yticks=[])
    for side in axes.spines.values():
        side.set(color=FAINT, linewidth=0.6)


def inside(mesh: QuadMesh, bounds: tuple[float, float, float, float]) -> NDArray[np.bool_]:
    """Return which elements touch a box, ``(Q,)``."""
    corner = mesh.points[mesh.quads]
    low, high = corner.min(axis=1), corner.max(axis=1)
    x0, y0, x1, y1 = bounds
    return (high[:, 0] >= x0) & (low[:, 0] <= x1) & (high[:, 1] >= y0) & (low[:, 1] <= y1)


def draw_edges(axes: Any, mesh: QuadMesh, bounds: tuple[float, float, float, float], width: float = 0.25) -> None:
    """Draw the edges of the elements that touch a box, each once."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Line

    quads = mesh.quads[inside(mesh, bounds)]
    one, other = quads.astype(np.int64).ravel(), np.roll(quads, -1, axis=1).astype(np.int64).ravel()
    keys = np.unique(np.minimum(one, other) * mesh.n_points + np.maximum(one, other))
    segments = mesh.points[np.column_stack([keys // mesh.n_points, keys % mesh.n_points])]
    codes = np.tile(np.array([Line.MOVETO, Line.LINETO], dtype=np.uint8), len(segments))
    path = Line(segments.reshape(-1, 2), codes)
    lines = PathPatch(path, fill=False, edgecolor=INK, linewidth=width, rasterized=len(quads) > MOST_VECTORS)
    lines.set_in_layout(False)  # the panel's frame is the extent; measuring a hundred thousand lines takes longer
    axes.add_artist(lines)  # add_patch would go through every line to find the extent
    bare(axes, bounds)


def draw_cells(
    figure: Any,
    axes: Any,
    mesh: QuadMesh,
    values: NDArray[np.float64],
    scale: ColorScale,
    bounds: tuple[float, float, float, float],
) -> None:
    """Fill the elements that touch a box with their values' colours, and draw the bar that says what they mean."""
    from matplotlib.collections import PolyCollection

    rows = np.flatnonzero(inside(mesh, bounds))
    corners, colors = mesh.points[mesh.quads[rows]], scale.colors(values[rows])
    if len(rows) > MOST_VECTORS:
        x0, y0, x1, y1 = bounds
        axes.imshow(painted_cells(corners, colors, bounds), extent=(x0, x1, y0, y1))
    else:
        faces = PolyCollection(list(corners), facecolors=colors / 255.0, edgecolors=colors / 255.0, linewidth=0.1)
        faces.set_in_layout(False)
        axes.add_collection(faces)
    bare(axes, bounds)
    draw_bar(figure, axes, scale)


def painted_cells(
    corners: NDArray[np.float64],
    colors: NDArray[np.uint8],
    bounds: tuple[float, float, float, float],
    pixels: int = 1400,
) -> NDArray[np.uint8]:
    """Return elements painted as pixels, a hundred times sooner than as vectors.

    Parameters
    ----------
    corners : (N, 4, 2) float64
        Of each element.
    colors : (N, 3) uint8
        Red, green and blue of each.
    bounds : tuple
        The box that the picture shows, which is as wide as high.
    pixels : int
        Along a side; each is the mean of four.

    Returns
    -------
    (pixels, pixels, 3) uint8
        The highest y first.
    """
    from PIL import Image, ImageDraw

    x0, y0, x1, y1 = bounds
    fine = 2 * pixels
    where = (corners - (x0, y1)) * (fine / (x1 - x0), fine / (y0 - y1)) - 0.5
    picture = Image.new("RGB", (fine, fine), "white")
    pen = ImageDraw.Draw(picture)
    for outline, color in zip(where.reshape(-1, 8).tolist(), map(tuple, colors.tolist()), strict=True):
        pen.polygon(outline, fill=color)
    return np.asarray(picture.reduce(2))


def draw_bar(figure: Any, axes: Any, scale: ColorScale) -> None:
    """Draw a colour bar below a panel, headed with its scale's title."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap

    mappable = ScalarMappable(cmap=ListedColormap(scale.bar(256) / 255.0))
    mappable.set_clim(0.0, 1.0)
    bar = figure.colorbar(mappable, ax=axes, orientation="horizontal", fraction=0.05, pad=0.03, aspect=30)
    ticks = scale.ticks()
    bar.set_ticks([at for at, _ in ticks], labels=[label for _, label in ticks], fontsize=7)
    bar.set_label(scale.title, fontsize=8, color=INK)
    bar.outline.set_linewidth(0.4)


@dataclass(frozen=True)
class Published:
    """A largest R of the paper's: at one iteration, or a bound for all where ``iteration`` is None."""

    words: str
    ratio: float
    iteration: int | None = None


def draw_evolution(
    axes: Any, curves: Mapping[str, Evolution], against: str, color: str, published: Published | None = None
) -> None:
    """Draw the largest R of each iteration.

    Parameters
    ----------
    axes : Axes
        The panel.
    curves : mapping of str to Evolution
        Processes by what the legend calls them.
    against : {'background', 'analytic'}
        What R is measured against.
    color : str
        Of every curve; line styles tell them apart.
    published : Published, optional
        A number of the paper's.
    """
    least, most = 1.0, 1.0
    for style, (label, evolution) in zip(DASHES, curves.items(), strict=False):
        rows = evolution.iterations[1:]  # the first mesh was made from no background
        ratio = [row.background_ratio if against == "background" else row.analytic_ratio for row in rows]
        marker = "o" if len(rows) < 12 else ""
        axes.plot([row.number for row in rows], ratio, style, marker=marker, ms=3.5, lw=1.2, color=color, label=label)
        least, most = min([least, *ratio]), max([most, *ratio])
    limits = {evolution.limit for evolution in curves.values()}
    axes.axhline(1.0, color=FAINT, lw=0.8)
    for limit in limits:
        axes.axhline(limit, color=FAINT, lw=0.8, ls=":")
        axes.annotate(
            f"{limit:g}", (1.0, limit), xycoords=("axes fraction", "data"), xytext=(2, 0), textcoords="offset points",
            va="center", fontsize=7, color=FAINT,
        )  # fmt: skip
    if published:
        _draw_published(axes, published)
        least, most = min(least, published.ratio), max(most, published.ratio)
    axes.set_yscale("log")
    low, high = least / 1.1, most * 1.15
    ticks = [value for value in (0.8, 0.9, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0) if low <= value <= high]
    axes.set_yticks(ticks, [f"{value:g}" for value in ticks])
    axes.minorticks_off()
    axes.set_ylim(low, high)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel("iteration", fontsize=8)
    axes.set_ylabel("largest R(e)", fontsize=8)
    if len(curves) > 1 or published:
        axes.legend(fontsize=7, frameon=False)


def _draw_published(axes: Any, published: Published) -> None:
    if published.iteration is None:
        axes.axhline(published.ratio, color=INK, lw=0.9, ls=(0, (1, 2)), label=published.words)
    else:
        axes.plot(
            [published.iteration], [published.ratio], "D", ms=5, mfc="white", mec=INK, zorder=3, label=published.words
        )


def save_evolution(evolution: Evolution, folder: Path, name: str = "evolution") -> None:
    """Write the R-evolution plot of one adaptive process as PNG and SVG."""
    figure, panels = sheet((1, 2))
    color = COLORS.get(str(evolution.options.get("method")), INK)
    for axes, against, words in (
        (panels[0], "background", "against the background of each iteration"),
        (panels[1], "analytic", "against the given field"),
    ):
        title(axes, words)
        draw_evolution(axes, {"": evolution}, against, color)
    save(figure, folder, name)
