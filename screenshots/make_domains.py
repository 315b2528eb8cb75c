"""Make the pictures of meshes on difficult domains and of two details: ``python screenshots/make_domains.py``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.scene import Camera2D, Subject, ViewState, compose
from sizeviz.scene.canvas import Canvas
from sizeviz.scene.stage import Stage
from sizeviz.sizing import BackgroundMesh, Grid, SizeField
from sizeviz.sources import Source, load
from sizeviz.sources.shapes import shape
from sizeviz.study import Study, run

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sizeviz.geometry import Domain

HERE = Path(__file__).parent
PANE, GAP, TEXT = 620, 28, 19
METHOD = "guaranteed"


def main() -> None:
    """Make both sheets."""
    domains = [_meshed(name, words, sizes) for name, words, sizes in CASES]
    _sheet("domains.png", domains, [subject.domain.bounds for subject in domains if subject.domain is not None])
    details, boxes = [], []
    for name, words, box in DETAILS:
        study = run(Study(load(name)), [METHOD])
        made = study.runs[METHOD]
        count = "" if made.mesh is None else f"of {made.mesh.n_quads:,} quadrilaterals"
        details.append(Subject(words, count, made.mesh, made.report, domain=study.source.domain))
        boxes.append(box)
    _sheet("details.png", details, boxes)


def _meshed(name: str, words: str, sizes: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Subject:
    """Return a guaranteed mesh of a shape of the catalogue."""
    domain = shape(name)
    background = BackgroundMesh.regular(_grid(domain))
    field = SizeField(background, sizes(background.points), name)
    made = run(Study(Source(name=name, label=words, domain=domain, field=field, reference=field)), [METHOD]).runs[
        METHOD
    ]
    assert made.mesh is not None and made.report is not None and made.guarantee is not None
    quality = made.report.quality
    print(f"{name}: {made.guarantee.verdict}; quality {quality.min():.3f} / {quality.mean():.3f}")
    return Subject(words, f"{made.mesh.n_quads:,} quadrilaterals", made.mesh, made.report, domain=domain)


def _grid(domain: Domain) -> Grid:
    x0, y0, x1, y1 = domain.bounds
    return Grid(x0, y0, (x1 - x0) / 200, (y1 - y0) / 200, 201, 201)


def _sheet(name: str, subjects: list[Subject], boxes: list[tuple[float, float, float, float]]) -> None:
    """Draw R above and quality below, a column a subject, and the two colour bars."""
    width = GAP + len(subjects) * (PANE + GAP)
    top = GAP + 3 * TEXT
    canvas = Canvas(width, top + 2 * (PANE + GAP) + 6 * TEXT, (255, 255, 255), (33, 37, 41))
    with Stage(oversampling=2) as stage:
        for column, (subject, box) in enumerate(zip(subjects, boxes, strict=True)):
            left = GAP + column * (PANE + GAP)
            canvas.text(left, GAP + TEXT, subject.title, round(1.2 * TEXT), bold=True, anchor="ls")
            canvas.text(left, GAP + 2.3 * TEXT, subject.detail, TEXT, color=canvas.faint, anchor="ls")
            for row, quantity in enumerate(("ratio", "quality")):
                view = ViewState(
                    method=METHOD, color_by=quantity, measure="max-edge", edges=True, range_mode="fixed",
                    low=0.3 if quantity == "ratio" else 0.0, high=1.1 if quantity == "ratio" else 1.0,
                )  # fmt: skip
                spec = compose(subject, view)
                pixels = stage.shoot(spec, Camera2D.fitted(box, 1.0, 1.02), PANE, PANE)
                at = top + row * (PANE + GAP)
                canvas.picture(pixels, (left, at, left + PANE, at + PANE))
                if column < 1 and spec.scale is not None:
                    foot, begin = top + 2 * (PANE + GAP) + 2 * TEXT, GAP + row * (PANE + GAP)
                    canvas.bar(spec.scale, (begin, foot, begin + PANE, foot + round(0.8 * TEXT)), TEXT)
    canvas.save(HERE / name)
    print(name)


def _near(points: NDArray[np.float64], x: float, y: float) -> NDArray[np.float64]:
    return np.hypot(points[:, 0] - x, points[:, 1] - y)


CASES = (
    ("coastline", "Coastline with four islands", lambda p: np.minimum(0.04, 0.008 + 0.4 * np.abs(p[:, 0] - 0.45))),
    ("eccentric", "A gap far narrower than the sizes", lambda p: np.full(len(p), 0.06)),
    ("star", "Corners of 36 degrees", lambda p: np.minimum(0.05, 0.006 + 0.3 * _near(p, 0.5, 0.5))),
    ("regions", "Five regions that share edges", lambda p: np.minimum(0.05, 0.006 + 0.5 * _near(p, 0.5, 0.25))),
)
"""Shape, title and sizes."""

DETAILS = (
    ("ring", "The ring's crest", (0.7515, 0.494, 0.7635, 0.506)),
    ("mri", "A detail of the MRI slice", (0.675, 0.095, 0.715, 0.135)),
)
"""Example, title and the box shown."""


if __name__ == "__main__":
    main()
