"""The picture that settles it: a row a method, R beside quality, a close-up where it is worst, words below."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.scene.camera import Camera2D
from sizeviz.scene.canvas import Box, Canvas, text_width
from sizeviz.scene.compose import compose, scale_for, subject_bounds, values_of
from sizeviz.scene.spec import CellLayer
from sizeviz.scene.stage import Stage
from sizeviz.scene.subject import subjects_of
from sizeviz.scene.view import ViewState

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sizeviz.conformity import Measure
    from sizeviz.scene.scale import ColorScale
    from sizeviz.scene.spec import Color, SceneSpec
    from sizeviz.scene.subject import Subject
    from sizeviz.study import Study

GOOD: Color = (31, 119, 80)
"""Green of a verdict that is good news; always beside words, never colour alone."""

BAD: Color = (184, 67, 10)
"""Orange of a verdict that is not."""

CLOSE_UP_ELEMENTS = 26.0
"""How many elements, as large as the worst one, fit across a close-up."""


@dataclass(frozen=True)
class Layout:
    """Where things go on the sheet, in pixels; the panes take the shape of the domain.

    Parameters
    ----------
    width : int
        Width of the sheet.
    aspect : float
        Width to height of the domain.
    """

    width: int = 2000
    aspect: float = 1.0

    @property
    def margin(self) -> int:
        """Space around everything, and between the columns."""
        return self.width // 50

    @property
    def type_size(self) -> int:
        """Height of ordinary text."""
        return self.width // 80

    @property
    def pane(self) -> tuple[int, int]:
        """Width and height of a pane; the close-up column is as wide as half a pane is high."""
        free = self.width - 4 * self.margin
        height = round((free + self.gap / 2) / (2.0 * self.shape + 0.5))
        return round(height * self.shape), height

    @property
    def shape(self) -> float:
        """Width to height of a pane: the domain's, within reason."""
        return min(max(self.aspect, 0.5), 2.2)

    @property
    def gap(self) -> int:
        """Between the two close-ups of a row."""
        return self.margin // 2

    @property
    def head(self) -> int:
        """Height of the words over a row."""
        return round(self.type_size * 2.4)

    @property
    def foot(self) -> int:
        """Height of the words under a row."""
        return round(self.type_size * 2.9)

    @property
    def top(self) -> int:
        """Where the first row begins."""
        return round(self.type_size * 3.4) + self.margin

    def height(self, rows: int) -> int:
        """Height of a sheet with so many rows, the colour bars below them included."""
        return self.top + rows * (self.head + self.pane[1] + self.foot) + round(self.type_size * 5.2)

    def pane_box(self, row: int, column: int) -> Box:
        """Box of a pane."""
        width, height = self.pane
        left = self.margin + column * (width + self.margin)
        top = self.top + row * (self.head + height + self.foot) + self.head
        return left, top, left + width, top + height

    def close_up_box(self, row: int, place: int) -> Box:
        """Box of a close-up: place 0 is R, place 1 is quality."""
        _, top, right, bottom = self.pane_box(row, 1)
        side = (bottom - top - self.gap) // 2
        left, above = right + self.margin, top + place * (side + self.gap)
        return left, above, left + side, above + side


def save_comparison(
    study: Study | Sequence[Subject],
    path: str | Path,
    *,
    methods: Sequence[str] | None = None,
    measure: Measure = "mean-edge",
    title: str | None = None,
    width: int = 2000,
    dark: bool = False,
) -> Path:
    """Write the comparison of a study's methods as one picture.

    Parameters
    ----------
    study : Study or sequence of Subject
        What is compared; every subject must have a mesh and a report.
    path : path-like
        Where to; the suffix chooses the format (PNG by custom).
    methods : sequence of str, optional
        Which runs, from top to bottom; by default all there are.
    measure : {'mean-edge', 'sqrt-area', 'max-edge'}
        Size of an element that R is formed with.
    title : str, optional
        Heading; the source's name by default.
    width : int
        Pixels across.
    dark : bool
        Dark ground.

    Returns
    -------
    Path
        Where it was written.

    Raises
    ------
    InputError
        If nothing was run yet, or the place cannot be written.
    """
    subjects, heading = subjects_of(study, methods)
    rows = list(subjects.values())
    if not rows or any(subject.report is None for subject in rows):
        raise InputError("the comparison needs a judged mesh of every method; run the study first")
    view = ViewState(measure=measure, dark=dark)
    sheet = _Sheet(rows, view, width)
    with Stage() as stage:
        sheet.fill(stage)
    sheet.words(title or heading)
    sheet.canvas.save(Path(path))
    return Path(path)


class _Sheet:
    """One comparison being drawn."""

    def __init__(self, rows: Sequence[Subject], view: ViewState, width: int) -> None:
        x0, y0, x1, y1 = subject_bounds(rows[0])
        self.rows = rows
        self.layout = Layout(width, (x1 - x0) / (y1 - y0))
        self.views = (view, view.with_changes(color_by="quality"))
        self.scales = [_shared_scale(rows, column) for column in self.views]
        self.specs = [
            [compose(subject, column, scale=scale) for column, scale in zip(self.views, self.scales, strict=True)]
            for subject in rows
        ]
        spec = self.specs[0][0]
        self.canvas = Canvas(width, self.layout.height(len(rows)), spec.ground, spec.ink)
        self.close = _close_up(rows, view)

    def fill(self, stage: Stage) -> None:
        """Draw the panes and the close-ups; each mesh is handed to the stage once."""
        width, height = self.layout.pane
        whole = Camera2D.fitted(self.specs[0][0].bounds, width / height, 1.01)
        for row, specs in enumerate(self.specs):
            for column, spec in enumerate(specs):
                box = self.layout.pane_box(row, column)
                self.canvas.picture(stage.shoot(spec, whole, width, height), box, frame=False)
                self._mark(box, whole)
                box = self.layout.close_up_box(row, column)
                near = _with_edges(spec)
                self.canvas.picture(stage.shoot(near, self.close, box[2] - box[0], box[3] - box[1]), box)

    def words(self, title: str) -> None:
        """Write headings, verdicts and colour bars."""
        layout, canvas = self.layout, self.canvas
        size = layout.type_size
        canvas.text(layout.margin, layout.margin, title, round(size * 1.7), bold=True)
        for row, specs in enumerate(self.specs):
            self._row_words(row, specs)
        bottom = layout.height(len(self.rows)) - round(size * 3.0)
        for column, scale in enumerate(self.scales):
            left, _, right, _ = layout.pane_box(0, column)
            canvas.bar(scale, (left, bottom, right, bottom + round(size * 0.8)), size)

    def _row_words(self, row: int, specs: Sequence[SceneSpec]) -> None:
        layout, canvas, size = self.layout, self.canvas, self.layout.type_size
        left, top, _, _ = layout.pane_box(row, 0)
        base = top - round(size * 0.75)
        large = round(size * 1.25)
        canvas.text(left, base, specs[0].title, large, bold=True, anchor="ls")
        after = left + text_width(specs[0].title, large, bold=True) + size
        canvas.text(after, base, specs[0].detail, size, anchor="ls", color=canvas.faint)
        for column, spec in enumerate(specs):
            left, _, _, bottom = layout.pane_box(row, column)
            color = canvas.ink if spec.passed is None else GOOD if spec.passed else BAD
            dot = size * 0.36
            middle = bottom + round(size * 1.15)
            canvas.dot(left + dot, middle, dot, color if spec.passed is not None else canvas.faint)
            indent = size * 1.15
            lines, small = wrapped(spec.verdict, layout.pane[0] - indent, size)
            for k, line in enumerate(lines):
                canvas.text(left + indent, middle + 1.2 * small * k, line, small, anchor="lm")
        box = layout.close_up_box(row, 0)
        bottom = layout.pane_box(row, 0)[3]
        where = f"close-up at ({self.close.x:.3g}, {self.close.y:.3g})"
        canvas.text(box[0], bottom + round(size * 1.15), where, round(size * 0.9), anchor="lm", color=canvas.faint)

    def _mark(self, box: Box, camera: Camera2D) -> None:
        """Show on a pane where the close-up looks, as a small frame that is never too small to find."""
        width, height = box[2] - box[0], box[3] - box[1]
        x, y = camera.to_pixel(self.close.x, self.close.y, width, height)
        half = max(0.5 * self.close.height * height / camera.height, self.layout.type_size * 0.45)
        left, top = round(box[0] + x - half), round(box[1] + y - half)
        right, bottom = round(box[0] + x + half), round(box[1] + y + half)
        self.canvas.rectangle((left - 2, top - 2, right + 2, bottom + 2), self.canvas.ground, 2)
        self.canvas.rectangle((left, top, right, bottom), self.canvas.ink, 2)


def wrapped(words: str, width: float, size: int) -> tuple[list[str], int]:
    """Return words on at most two lines, broken after commas, in type that is as large as the width permits."""
    parts = words.split(", ")
    for small in range(size, 1, -1):
        whole = [words, *(", ".join(parts[:k]) + ",\n" + ", ".join(parts[k:]) for k in range(len(parts) - 1, 0, -1))]
        for candidate in whole:
            lines = candidate.split("\n")
            if all(text_width(line, small) <= width for line in lines):
                return lines, small
    return [words], 1


def _shared_scale(rows: Sequence[Subject], view: ViewState) -> ColorScale:
    values = [array for array in (values_of(subject, view) for subject in rows) if array is not None]
    scale = scale_for(values, view)
    if scale is None:
        raise InputError("the comparison has no element to show; mesh the study first")
    return scale


def _close_up(rows: Sequence[Subject], view: ViewState) -> Camera2D:
    """Return the camera at the worst R of all rows, so that every row shows the same place."""
    best: tuple[float, Camera2D] | None = None
    for subject in rows:
        ratios = values_of(subject, view)
        if ratios is None or subject.mesh is None:
            continue
        worst = int(np.argmax(ratios))
        corners = subject.mesh.points[subject.mesh.quads[worst]]
        reach = float(np.sqrt(abs(subject.mesh.areas[worst]))) * CLOSE_UP_ELEMENTS
        x, y = corners.mean(axis=0)
        if best is None or ratios[worst] > best[0]:
            best = float(ratios[worst]), Camera2D(float(x), float(y), reach)
    assert best is not None
    return _kept_inside(best[1], subject_bounds(rows[0]))


def _kept_inside(camera: Camera2D, bounds: tuple[float, float, float, float]) -> Camera2D:
    """Move a square view so that it shows as little as possible of what lies outside the domain."""
    x0, y0, x1, y1 = bounds
    height = min(camera.height, x1 - x0, y1 - y0)
    half = 0.5 * height
    x = min(max(camera.x, x0 + half), x1 - half)
    y = min(max(camera.y, y0 + half), y1 - half)
    return Camera2D(x, y, height)


def _with_edges(spec: SceneSpec) -> SceneSpec:
    layers = tuple(replace(layer, edges=spec.ink) if isinstance(layer, CellLayer) else layer for layer in spec.layers)
    return replace(spec, layers=layers)
