"""From a study and a view to plain data: pure, so that window, still picture and test all see the same scene."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry.arrays import read_only
from sizeviz.scene.colormaps import color_map
from sizeviz.scene.scale import CORRECT, ColorScale, ratio_scale
from sizeviz.scene.spec import Bounds, CellLayer, Color, ImageLayer, Layer, LineLayer, SceneSpec, TriangleLayer
from sizeviz.scene.subject import MEASURE_TITLES, Subject, as_subject
from sizeviz.scene.verdict import verdict
from sizeviz.scene.view import FIELD_QUANTITIES, QUANTITIES, Quantity, ViewState

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from sizeviz.geometry import QuadMesh
    from sizeviz.sizing import SizeField
    from sizeviz.study import Study

LIGHT: tuple[Color, Color] = ((255, 255, 255), (38, 43, 51))
"""Ground and ink of the light theme."""

DARK: tuple[Color, Color] = ((24, 27, 32), (222, 226, 232))
"""Ground and ink of the dark theme."""

FAILING_LINE: dict[bool, Color] = {False: (120, 32, 10), True: (255, 178, 92)}
"""Colour of the outline of elements with R > 1, on a light (False) and on a dark ground."""

SELECTED_LINE: Color = (214, 22, 133)
"""Colour of the outline of selected elements: neither a blue nor an orange of the R map."""

DEFAULT_MAPS: dict[Quantity, str] = {
    "ratio": "blue | orange",
    "quality": "viridis",
    "size": "ice_r",
    "prescribed": "ice_r",
    "target": "ice_r",
    "error": "magma",
}
"""The colour map of each quantity unless the view names one."""

LOG_QUANTITIES: tuple[Quantity, ...] = ("ratio", "size", "prescribed", "target", "error")
"""Quantities whose bar is logarithmic by default."""


def compose(
    subject: Study | Subject | QuadMesh,
    view: ViewState,
    *,
    scale: ColorScale | None = None,
    selected: NDArray[np.intp] | None = None,
) -> SceneSpec:
    """Return the scene that shows a study, or one mesh, as the view asks.

    Parameters
    ----------
    subject : Study, Subject or QuadMesh
        What to show; of a study, the run that ``view.method`` names.
    view : ViewState
        How to show it.
    scale : ColorScale, optional
        Colour bar to use in place of the view's own, such as one shared by several panes.
    selected : (K,) int, optional
        Elements to outline as selected.

    Returns
    -------
    SceneSpec
        Without coloured layers, and with the reason as verdict, where there is nothing to show yet.
    """
    shown = as_subject(subject, view.method)
    if view.color_by in FIELD_QUANTITIES:
        layers, scale = _field_layers(shown, view, scale)
    else:
        layers, scale = _mesh_layers(shown, view, scale, selected)
    words, passed = verdict(shown, view)
    ground, ink = DARK if view.dark else LIGHT
    layers = [*layers, *_outline(shown, ink)]
    return SceneSpec(tuple(layers), subject_bounds(shown), scale, shown.title, shown.detail, words, passed, ground, ink)


def values_of(subject: Subject, view: ViewState) -> NDArray[np.float64] | None:
    """Return the values that the view colours by: one an element or one a node; None where there are none yet."""
    if view.color_by in FIELD_QUANTITIES:
        field = subject.field(view.color_by)
        return None if field is None else field.sizes
    return subject.element_values(view.color_by, view.measure)


def scale_for(values: Iterable[NDArray[np.float64]], view: ViewState) -> ColorScale | None:
    """Return the colour bar over one or several sets of values (a shared range), None without any value."""
    samples = [array if np.isfinite(array).all() else array[np.isfinite(array)] for array in values]
    samples = [array for array in samples if len(array)]
    if not samples:
        return None
    log = view.color_by in LOG_QUANTITIES if view.log is None else view.log
    low, high = _ends(samples, view, log)
    cmap = color_map(view.cmap or DEFAULT_MAPS[view.color_by])
    title = scale_title(view)
    if view.color_by == "ratio":
        broken = ratio_scale(low, high, title=title, classes=view.classes)
        return broken if cmap.broken else ColorScale(cmap, broken.low, broken.high, "ratio", view.classes, title)
    if log and low <= 0:
        log = False
    return ColorScale(cmap, low, high, "log" if log else "linear", view.classes, title)


def scale_title(view: ViewState) -> str:
    """Return the words over a colour bar, with the measure wherever one is meant."""
    words = QUANTITIES[view.color_by]
    return f"{words} ({MEASURE_TITLES[view.measure]})" if view.color_by in ("ratio", "size") else words


def subject_bounds(subject: Subject) -> Bounds:
    """Return the box around all that the subject could show; the unit square where it is empty."""
    if subject.domain is not None:
        return subject.domain.bounds
    points = None
    if subject.mesh is not None:
        points = subject.mesh.points
    elif subject.prescribed is not None:
        points = subject.prescribed.background.points
    if points is None or not len(points):
        return 0.0, 0.0, 1.0, 1.0
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    return float(x0), float(y0), float(x1), float(y1)


def outline_segments(quads: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the four sides of each element as segments, ``(4 Q, 2)``."""
    return np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)


def _ends(samples: list[NDArray[np.float64]], view: ViewState, log: bool) -> tuple[float, float]:
    if view.range_mode == "fixed" and view.low is not None and view.high is not None:
        return view.low, view.high
    if view.range_mode == "percentile":
        joined = np.concatenate(samples)
        low, high = np.percentile(joined, (view.percentile, 100.0 - view.percentile))
    else:
        low, high = min(a.min() for a in samples), max(a.max() for a in samples)
    low, high = float(low), float(high)
    if view.color_by == "ratio":
        return max(low, 0.1), min(high, 10.0)
    if view.color_by == "quality" and view.range_mode == "auto":
        return min(0.5, float(np.floor(low * 10.0)) / 10.0), 1.0
    if view.color_by == "error" and log:
        low = max(low, high * 1e-4)
    return (low, high) if high > low else _around(low)


def _around(value: float) -> tuple[float, float]:
    return (value * 0.9, value * 1.1) if value > 0 else (value - 0.5, value + 0.5)


def _field_layers(subject: Subject, view: ViewState, scale: ColorScale | None) -> tuple[list[Layer], ColorScale | None]:
    field = subject.field(view.color_by)
    if field is None:
        return [], scale
    scale = scale or scale_for([field.sizes], view)
    assert scale is not None
    return [field_layer(field, scale)], scale


def field_layer(field: SizeField, scale: ColorScale) -> Layer:
    """Return the layer that shows a size field: one picture where it lives on a grid, triangles elsewhere."""
    colors = _field_colors(field, scale)
    grid = field.background.grid
    if grid is None:
        return TriangleLayer("field", field.background.points, field.background.triangles, colors)
    x1, y1 = grid.x0 + (grid.nx - 1) * grid.dx, grid.y0 + (grid.ny - 1) * grid.dy
    return ImageLayer("field", colors.reshape(grid.ny, grid.nx, 3), (grid.x0, grid.y0, x1, y1))


_RECENT: list[tuple[SizeField, ColorScale, NDArray[np.uint8]]] = []
"""The last fields coloured: while one field is painted, the others beside it are not coloured anew."""


def _field_colors(field: SizeField, scale: ColorScale) -> NDArray[np.uint8]:
    for known, known_scale, colors in _RECENT:
        if known is field and known_scale == scale:
            return colors
    colors = read_only(_changed_colors(field, scale))
    _RECENT.insert(0, (field, scale, colors))
    del _RECENT[4:]
    return colors


def _changed_colors(field: SizeField, scale: ColorScale) -> NDArray[np.uint8]:
    """Return a field's colours; those of nodes that have not changed are taken from the last one, as under a brush."""
    for known, known_scale, old in _RECENT:
        if known.background is field.background and known_scale == scale:
            changed = np.flatnonzero(known.sizes != field.sizes)
            if 2 * len(changed) < len(field.sizes):
                colors = old.copy()
                colors[changed] = scale.colors(field.sizes[changed])
                return colors
    return scale.colors(field.sizes)


def _mesh_layers(
    subject: Subject, view: ViewState, scale: ColorScale | None, selected: NDArray[np.intp] | None
) -> tuple[list[Layer], ColorScale | None]:
    values = subject.element_values(view.color_by, view.measure)
    if subject.mesh is None or values is None:
        return [], scale
    mesh = subject.mesh
    scale = scale or scale_for([values], view)
    assert scale is not None
    ink = (DARK if view.dark else LIGHT)[1]
    layers: list[Layer] = [
        CellLayer("elements", mesh.points, mesh.quads, scale.colors(values), ink if view.edges else None)
    ]
    failing = _failing(subject, view)
    if len(failing):
        layers += _failing_lines(mesh, failing, scale.colors(values[failing]), view.dark)
    chosen = np.empty(0, dtype=np.intp) if selected is None else selected[selected < mesh.n_quads]
    if len(chosen):  # a selection can outlive the mesh it was made in
        layers.append(LineLayer("selected", mesh.points, outline_segments(mesh.quads[chosen]), SELECTED_LINE, 2.0))
    return layers, scale


def _failing_lines(mesh: QuadMesh, failing: NDArray[np.intp], colors: NDArray[np.uint8], dark: bool) -> list[Layer]:
    """Return the outlines of failing elements.

    From afar they have the elements' own colours and are a pixel wide, so that no element is too small to be seen and
    none looks worse than it is; near by they have a colour that stands out.
    """
    lines = outline_segments(mesh.quads[failing])
    own = np.repeat(colors, 4, axis=0)
    return [
        LineLayer("failing", mesh.points, lines, FAILING_LINE[dark], 1.0, own),
        LineLayer("failing-near", mesh.points, lines, FAILING_LINE[dark], 1.6, near=True),
    ]


def _failing(subject: Subject, view: ViewState) -> NDArray[np.intp]:
    if not view.outline_failing or view.color_by not in ("ratio", "size") or subject.report is None:
        return np.empty(0, dtype=np.intp)
    ratios = subject.element_values("ratio", view.measure)
    return np.flatnonzero(ratios > CORRECT) if ratios is not None else np.empty(0, dtype=np.intp)


def _outline(subject: Subject, ink: Color) -> list[Layer]:
    if subject.domain is None:
        return []
    loops, lines = subject.domain.loops, subject.domain.lines
    starts = np.cumsum([0, *(len(path) for path in (*loops, *lines))])
    paths = [np.arange(a, b) for a, b in itertools.pairwise(starts)]
    closed = [np.column_stack([ring, np.roll(ring, -1)]) for ring in paths[: len(loops)]]
    open_ = [np.column_stack([path[:-1], path[1:]]) for path in paths[len(loops) :]]
    segments = np.vstack([*closed, *open_]).astype(np.int32)
    return [LineLayer("outline", np.vstack([*loops, *lines]), segments, ink, 1.2)]
