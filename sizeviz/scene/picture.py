"""One picture of one mesh or field: pixels for the screen, true vectors for print."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from sizeviz.errors import InputError
from sizeviz.scene.camera import Camera2D
from sizeviz.scene.canvas import Canvas
from sizeviz.scene.compose import compose
from sizeviz.scene.stage import Stage
from sizeviz.scene.subject import as_subject
from sizeviz.scene.vector import VECTOR_SUFFIXES, save_vector
from sizeviz.scene.view import ViewState

if TYPE_CHECKING:
    from sizeviz.conformity import Measure
    from sizeviz.geometry import QuadMesh
    from sizeviz.scene.spec import Bounds, SceneSpec
    from sizeviz.scene.subject import Subject
    from sizeviz.scene.view import Quantity
    from sizeviz.study import Study

EDGES_BELOW = 12_000
"""Element edges are drawn in a picture with fewer elements than this; beyond, they would blacken it."""


def save_picture(
    subject: Study | Subject | QuadMesh,
    path: str | Path,
    *,
    color_by: Quantity = "ratio",
    method: str = "size-preserving",
    measure: Measure = "mean-edge",
    width: int = 1400,
    edges: bool | None = None,
    dark: bool = False,
    view: ViewState | None = None,
    bounds: Bounds | None = None,
) -> Path:
    """Write one picture with its verdict and colour bar.

    Parameters
    ----------
    subject : Study, Subject or QuadMesh
        What to show.
    path : path-like
        Where to; .png, .jpg, .tif and .webp hold pixels, .svg and .pdf vectors.
    color_by : {'ratio', 'quality', 'size', 'prescribed', 'target', 'error'}
        What the colours mean.
    method : str
        Which run of a study.
    measure : {'mean-edge', 'sqrt-area', 'max-edge'}
        Size of an element.
    width : int
        Pixels across; of a vector figure, its width at 200 dots per inch.
    edges : bool, optional
        Whether element edges are drawn; by default below 12,000 elements.
    dark : bool
        Dark ground.
    view : ViewState, optional
        A whole pane's choices, colour bar included; method, quantity and measure are then taken from it.
    bounds : (4,) floats, optional
        ``xmin, ymin, xmax, ymax`` of what is shown, in model units; by default all there is.

    Returns
    -------
    Path
        Where it was written.

    Raises
    ------
    InputError
        If there is nothing of that kind to show, or the place cannot be written.
    """
    path = Path(path)
    view = view or ViewState(method=method, color_by=color_by, measure=measure)
    shown = as_subject(subject, view.method)
    count = 0 if shown.mesh is None else shown.mesh.n_quads
    spec = compose(shown, view.with_changes(edges=count < EDGES_BELOW if edges is None else edges, dark=dark))
    if spec.scale is None:
        raise InputError(f"cannot colour by {view.color_by}: {spec.verdict}")
    if bounds is not None:
        spec = replace(spec, bounds=bounds)
    if path.suffix.lower() in VECTOR_SUFFIXES:
        return save_vector(spec, path, width=width / 200.0)
    _sheet(spec, width).save(path)
    return path


def _sheet(spec: SceneSpec, width: int) -> Canvas:
    x0, y0, x1, y1 = spec.bounds
    size, margin = width // 60, width // 40
    pane = width - 2 * margin
    height = round(pane / min(max((x1 - x0) / (y1 - y0), 0.4), 4.0))
    top = margin + round(size * 2.4)
    canvas = Canvas(width, top + height + round(size * 7.4), spec.ground, spec.ink)
    with Stage(oversampling=2) as stage:
        pixels = stage.shoot(spec, Camera2D.fitted(spec.bounds, pane / height, 1.01), pane, height)
    canvas.picture(pixels, (margin, top, margin + pane, top + height), frame=False)
    canvas.text(margin, margin + size, spec.title, round(size * 1.3), bold=True, anchor="ls")
    canvas.text(width - margin, margin + size, spec.detail, size, anchor="rs", color=canvas.faint)
    foot = top + height
    canvas.text(margin, foot + size * 1.1, spec.verdict, size, anchor="lm")
    if spec.scale is not None:
        bar = (margin, foot + round(size * 4.2), margin + pane // 2, foot + round(size * 5.0))
        canvas.bar(spec.scale, bar, size)
    return canvas
