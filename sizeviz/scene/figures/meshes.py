"""Figures 4 to 8: the adaptive process, and the meshes made from an image."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.scene.colormaps import color_map
from sizeviz.scene.figures.sheet import (
    COLORS,
    WORDS,
    Published,
    draw_bar,
    draw_cells,
    draw_edges,
    draw_evolution,
    save,
    sheet,
    title,
)
from sizeviz.scene.imaging import interpolation_errors
from sizeviz.scene.scale import ColorScale, ratio_scale
from sizeviz.study.paper.published import PUBLISHED

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from sizeviz.sources import Source
    from sizeviz.study.paper import Adaptation, ImageRun
    from sizeviz.study.study import MethodRun

DETAIL = (0.7545, 0.497, 0.7605, 0.503)
"""The box around a piece of the ring that panels (b) of Figures 4 and 5 show."""

LOWEST: dict[str, Published] = {"gradient-limiting": Published("the paper: never below 1.28", 1.28)}
"""What Section 5.1 says of R against the background."""

ITERATIONS: dict[str, int] = {"gradient-limiting": 50, "size-preserving": 4}
"""How many iterations the paper's processes had."""


def save_adaptation(found: Sequence[Adaptation], method: str, folder: Path, name: str) -> None:
    """Write Figure 4 or 5: the last mesh, a detail of it, and R against background and analytic function.

    Parameters
    ----------
    found : sequence of Adaptation
        One process of the method for each mesher; the first one's mesh is shown.
    method : str
        Which method.
    folder : Path
        Where to.
    name : str
        Name of the files.
    """
    shown, mesh = found[0], found[0].last_mesh().mesh
    last = shown.evolution.iterations[-1]
    figure, panels = sheet((2, 2))
    title(panels[0], f"(a) {WORDS[method]}, iteration {last.number}: {last.n_quads:,} elements")
    draw_edges(panels[0], mesh, (0.0, 0.0, 1.0, 1.0), width=0.12)
    title(panels[1], f"(b) detail ({shown.mesher}), {DETAIL[2] - DETAIL[0]:.3f} across")
    draw_edges(panels[1], mesh, DETAIL, width=0.5)
    curves = {one.mesher: one.evolution for one in found}
    title(panels[2], "(c) R against the background of the iteration")
    draw_evolution(panels[2], curves, "background", COLORS[method], LOWEST.get(method))
    title(panels[3], "(d) R against the analytic function")
    ratio = PUBLISHED["table-1"][method]["max R(e)"]
    reached = Published(f"the paper's last: {ratio:g}", ratio, ITERATIONS[method])
    draw_evolution(panels[3], curves, "analytic", COLORS[method], reached)
    save(figure, folder, name)


def save_image_and_size(source: Source, folder: Path, name: str) -> None:
    """Write Figure 6: an image, and the sizes from its curvature."""
    assert source.image is not None
    x0, y0, x1, y1 = source.domain.bounds
    figure, panels = sheet((1, 2), (3.5, 4.3))
    title(panels[0], f"(a) {source.image.label}")
    grey = _linear(source.image.values, "grey", "intensity")
    panels[0].imshow(_painted(grey, source.image.values), origin="lower", extent=(x0, x1, y0, y1))
    draw_bar(figure, panels[0], grey)
    title(panels[1], "(b) size prescribed by its curvature")
    field, grid = source.field, source.field.background.grid
    scale = ColorScale(color_map("viridis"), float(field.sizes.min()), float(field.sizes.max()), "log", title="h")
    assert grid is not None
    sizes = field.sizes.reshape(grid.ny, grid.nx)
    panels[1].imshow(_painted(scale, sizes), origin="lower", extent=(x0, x1, y0, y1))
    draw_bar(figure, panels[1], scale)
    for axes in panels:
        axes.set(xticks=[], yticks=[])
    save(figure, folder, name)


def save_image_run(one: ImageRun, method: str, scales: Mapping[str, ColorScale], folder: Path, name: str) -> None:
    """Write Figure 7 or 8: the interpolation error of the image on a method's mesh, and R of its elements."""
    run = one.runs[method]
    assert run.mesh is not None and run.report is not None
    bounds = one.source.domain.bounds
    figure, panels = sheet((1, 2), (3.5, 4.3))
    title(panels[0], f"(a) {WORDS[method]}: {run.mesh.n_quads:,} elements")
    draw_cells(figure, panels[0], run.mesh, image_errors(one.source, run), scales["error"], bounds)
    title(
        panels[1],
        f"(b) R ≤ 1: {_floor(run.report.correct_percent['mean-edge'])} %, largest {_largest(run):.3f} ({one.mesher})",
    )
    draw_cells(figure, panels[1], run.mesh, run.report.ratios["mean-edge"], scales["ratio"], bounds)
    save(figure, folder, name)


def image_scales(found: Sequence[ImageRun], methods: Sequence[str]) -> dict[str, ColorScale]:
    """Return the scales that the figures of all methods and meshers share: ``error`` and ``ratio``."""
    errors = np.concatenate([image_errors(one.source, one.runs[method]) for one in found for method in methods])
    top = max(float(np.quantile(errors, 0.995)), 1e-12)
    largest = max(_largest(one.runs[method]) for one in found for method in methods)
    words = "interpolation error, share of the range of intensities"
    return {
        "error": ColorScale(color_map("magma"), 0.0, top, title=words),
        "ratio": ratio_scale(0.3, largest, title="R(e)"),
    }


def image_errors(source: Source, run: MethodRun) -> NDArray[np.float64]:
    """Return each element's mean absolute interpolation error of the image, as a share of its range, ``(Q,)``."""
    assert source.image is not None and run.mesh is not None
    return interpolation_errors(run.mesh, source.image, source.domain.bounds)


def error_norms(source: Source, run: MethodRun) -> dict[str, float]:
    """Return the mean and the largest elementwise interpolation error over the area, in percent of the range."""
    assert run.mesh is not None
    errors, areas = image_errors(source, run), run.mesh.areas
    mean = float(errors @ areas / areas.sum())
    square = float(np.sqrt(errors**2 @ areas / areas.sum()))
    return {"mean": 100.0 * mean, "rms": 100.0 * square, "max": 100.0 * float(errors.max())}


def _largest(run: MethodRun) -> float:
    assert run.report is not None
    return float(run.report.max_ratio["mean-edge"])


def _floor(percent: float) -> str:
    return "100" if percent >= 100.0 else f"{int(percent * 100) / 100:.2f}"


def _linear(values: NDArray[np.float64], name: str, words: str) -> ColorScale:
    return ColorScale(color_map(name), float(values.min()), float(values.max()), title=words)


def _painted(scale: ColorScale, values: NDArray[np.float64]) -> Any:
    return scale.colors(values.ravel()).reshape(*values.shape, 3)
