"""What is shown now, in words: the equation, and the numbers that stand for its letters. Pure, no Qt.

Ruiz-Gironés, Roca, Sarrate, 22nd International Meshing Roundtable, 2013, DOI 10.1007/978-3-319-02335-9.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal
from weakref import WeakKeyDictionary

import numpy as np

from sizeviz.scene.scale import CORRECT
from sizeviz.scene.subject import MEASURE_TITLES
from sizeviz.scene.verdict import percent, quality_words, ratio_words

if TYPE_CHECKING:
    from sizeviz.conformity import Measure, MeshReport
    from sizeviz.scene.subject import Subject
    from sizeviz.scene.view import Quantity, ViewState
    from sizeviz.sizing import SizeField
    from sizeviz.study import Study

Topic = Literal["source", "sizes", "mesh", "ratio", "quality", "error"]
"""What can be explained."""

TOPICS: dict[Topic, str] = {
    "source": "Source",
    "sizes": "Sizes",
    "mesh": "Mesh",
    "ratio": "R",
    "quality": "Quality",
}
"""The topics to choose from, in the pipeline's order; the image's error comes by what a pane shows."""

OF_QUANTITY: dict[Quantity, Topic] = {
    "prescribed": "source",
    "target": "sizes",
    "size": "mesh",
    "ratio": "ratio",
    "quality": "quality",
    "error": "error",
}
"""The topic of what a pane is coloured by."""

Row = tuple[str, str, str]
"""Symbol, plain words, number."""


@dataclass(frozen=True)
class Explanation:
    """What a person is looking at.

    Parameters
    ----------
    topic : Topic
        What is explained.
    title : str
        Heading.
    words : str
        What it means, as rich text.
    equation : str
        The equation, as rich text; empty where there is none.
    rows : tuple of (str, str, str)
        Symbol, plain words and number of each term now.
    """

    topic: Topic
    title: str
    words: str
    equation: str = ""
    rows: tuple[Row, ...] = ()


NOTHING = Explanation(
    "source", "Nothing is open yet", "Open an example or a file, or paint sizes on a blank canvas. The lesson on a "
    "line "
    "needs nothing: it is under Learn.",
)  # fmt: skip
"""What is said before there is a study."""


def explained(
    study: Study, subject: Subject, view: ViewState, topic: Topic | None = None, pinned: int | None = None
) -> Explanation:
    """Return the explanation of a topic as it stands now.

    Parameters
    ----------
    study : Study
        What is open.
    subject : Subject
        What the active pane shows, for its method.
    view : ViewState
        How it shows it.
    topic : Topic, optional
        By default the one that the pane is coloured by.
    pinned : int, optional
        The element that is pinned in that pane.
    """
    topic = topic or OF_QUANTITY[view.color_by]
    tell = {"source": _source, "sizes": _sizes, "mesh": _mesh, "ratio": _ratio, "quality": _quality, "error": _error}
    return tell[topic](study, subject, view, pinned)


def _source(study: Study, subject: Subject, view: ViewState, pinned: int | None) -> Explanation:
    field, source = subject.prescribed or study.source.field, study.source
    low, high = float(field.sizes.min()), float(field.sizes.max())
    slope, alpha = steepest(field), study.options.preserve.alpha
    judge = "this field" if source.reference is source.field else "the formula itself, not its values at nodes"
    steep = (
        f"Sizes change by up to {slope:.3g} for each unit of distance. A mesh can follow about 1/α = {1 / alpha:.3g}: "
        + ("the steep places are where elements come out too large." if slope > 1 / alpha else "this field is gentle.")
    )
    return Explanation(
        "source", source.label,
        f"The size field h says how large an element may be at each place. {steep}<br><br>R is judged against {judge}.",
        "h(x, y)",
        (
            ("min h", "smallest size asked for", f"{low:.4g}"),
            ("max h", "largest", f"{high:.4g}"),
            ("|∇h|", "steepest change along an edge", f"{slope:.3g}"),
            ("", "nodes that carry a size", f"{len(field.sizes):,}"),
        ),
    )  # fmt: skip


def _sizes(study: Study, subject: Subject, view: ViewState, pinned: int | None) -> Explanation:
    limit, preserve = study.options.limit, study.options.preserve
    alpha, beta, epsilon = preserve.alpha, preserve.beta, limit.epsilon
    field = subject.target
    rows: list[Row] = []
    if view.method == "gradient-limiting":
        title, equation = "Gradient limiting", "h<sub>g</sub>(x) = min<sub>y</sub> ( h(y) + ε·|x − y| )"
        words = (
            f"Sizes are lowered until they nowhere grow faster than ε = {epsilon:g} for each unit of distance. "
            f"Neighbouring "
            "elements then differ little, but an element can still reach into a valley whose sizes it exceeds."
        )
        rows.append(("ε", "largest slope", f"{epsilon:.3g}"))
    elif view.method == "none":
        title, equation = "The field as given", "h(x)"
        words = "Nothing is done to the sizes: the mesher follows them as well as it can, and misses what is steep."
    else:
        title, equation = "Size preserving", "h*(x) = β·r/α, &nbsp; r = α · min { h(y) : |x − y| ≤ r }"
        words = (
            f"h* is the largest size at a place such that nothing smaller is asked for within α = {alpha:g} elements "
            f"of it. "
            f"Small sizes keep room around them, and h* never grows faster than β/α = {beta / alpha:.3g}. Right-click "
            f"a "
            "place and ask <i>why is h* this here?</i> to see the ball shrink."
        )
        if view.method == "guaranteed":
            words += " The guarantee then refines where an element of that size could still reach a smaller one."
        rows += [("α", "room in elements", f"{alpha:.3g}"), ("β", "scale of the size", f"{beta:.3g}"),
                 ("β/α", "largest slope", f"{beta / alpha:.3g}")]  # fmt: skip
    if field is not None:
        low, high = float(field.sizes.min()), float(field.sizes.max())
        rows += [("min", "smallest size now", f"{low:.4g}"), ("max", "largest", f"{high:.4g}")]
        given = study.source.field
        if len(field.sizes) == len(given.sizes):
            lowered = 100.0 * float(np.mean(field.sizes < 0.999 * given.sizes))
            rows.append(("", "of the nodes were lowered", f"{lowered:.1f} %"))
    if subject.report is not None and subject.report.ideal_quads is not None:
        rows.append(("∫dA/h²", "squares that these sizes ask for", f"{subject.report.ideal_quads:,.0f}"))
    return Explanation("sizes", title, words, equation, tuple(rows))


def _mesh(study: Study, subject: Subject, view: ViewState, pinned: int | None) -> Explanation:
    options = study.options.mesh
    how = {
        "frontal": "places nodes by size, smallest first, joins them to triangles and pairs these",
        "decomposition": "splits the outline by chords until every piece is a quadrilateral, as in the paper's "
        "reference 5",
        "gmsh": "is Gmsh, run beside sizeviz",
    }.get(options.mesher, "makes quadrilaterals")
    smoothed = "Nodes are then moved for shape and size." if study.options.smoothing else "Smoothing is off."
    rows: list[Row] = [("", "mesher", options.mesher), ("", "mesh scale", f"{options.scale:g}")]
    mesh, report = subject.mesh, subject.report
    if mesh is not None:
        rows.append(("", "elements", f"{mesh.n_quads:,}"))
    if report is not None:
        size = report.sizes[view.measure]
        rows.append(("μ(e)", f"size by {MEASURE_TITLES[view.measure]}", f"{size.min():.3g} to {size.max():.3g}"))
        if report.efficiency is not None:
            rows.append(("", "elements for each one asked for", f"{report.efficiency:.2f}"))
    return Explanation(
        "mesh", "The mesh", f"The mesher {how}. Every element is a quadrilateral. {smoothed}",
        "μ(e): size of element e", tuple(rows),
    )  # fmt: skip


def _ratio(study: Study, subject: Subject, view: ViewState, pinned: int | None) -> Explanation:
    report, measure = subject.report, subject.promise or view.measure
    words = (
        f"R compares an element's size μ (its {MEASURE_TITLES[measure]}) with the <i>smallest</i> size asked for "
        "anywhere within it. <b>Blue</b> elements have R ≤ 1 and keep to the field; <b>orange</b> ones are too large "
        "for it."
    )
    rows: tuple[Row, ...] = ()
    if report is not None:
        ratios = report.ratios[measure]
        verdict, passed = ratio_words(ratios)
        next_step = "No element is too large." if passed else "Press W to go to the worst."
        words += f"<br><br>{subject.title}: {verdict}. {next_step}"
        if pinned is not None and pinned < report.n_quads:
            told, rows = _pinned(report, measure, pinned)
            words += f"<br><br>{told}"
        else:
            rows = (
                ("max R", "the worst element", f"{report.max_ratio[measure]:.4f}"),
                ("R ≤ 1", "elements that are correct", percent(report.correct_count[measure], report.n_quads)),
            )
            words += "" if passed else " Click an element to see its own numbers."
    equation = "R(e) = μ(e) / (β · min<sub>e</sub> h) ≤ 1 &nbsp;(3), (4)"
    return Explanation("ratio", "Is the mesh as fine as asked?", words, equation, rows)


def _pinned(report: MeshReport, measure: Measure, element: int) -> tuple[str, tuple[Row, ...]]:
    size, least = float(report.sizes[measure][element]), float(report.least[element])
    ratio, beta = float(report.ratios[measure][element]), report.beta
    verdict = "it is correct." if ratio <= CORRECT else f"it is {100 * (ratio - 1):.3g} % too large."
    return f"Element {element}, which you have pinned: {verdict}", (
        ("μ(e)", "its size", f"{size:.4g}"),
        ("min h", "smallest size asked for in it", f"{least:.4g}"),
        ("β", "scale", f"{beta:g}"),
        ("R(e)", f"= {size:.4g} / ({beta:g} × {least:.4g})", f"{ratio:.3f}"),
    )


def _quality(study: Study, subject: Subject, view: ViewState, pinned: int | None) -> Explanation:
    words = (
        "A square has quality 1, a flat or folded element 0. Each corner is compared with a right angle between "
        "equal sides; "
        "the element's quality is the harmonic mean of its four corners (Knupp, 2001)."
    )
    rows: list[Row] = []
    if subject.report is not None:
        quality = subject.report.quality
        words += f"<br><br>{subject.title}: {quality_words(quality)[0]}."
        rows = [("min q", "worst element", f"{quality.min():.3f}"), ("mean q", "average", f"{quality.mean():.3f}")]
        if pinned is not None and pinned < len(quality):
            rows.append(("q(e)", f"element {pinned}", f"{quality[pinned]:.3f}"))
    return Explanation("quality", "Is it well shaped?", words, "q = 4 / Σ ( ‖S‖² / 2σ ) over the corners", tuple(rows))


def _error(study: Study, subject: Subject, view: ViewState, pinned: int | None) -> Explanation:
    words = (
        "The image is known only at the mesh's nodes; between them it is interpolated. What is shown is how far that "
        "is "
        "from the image itself, the error that the sizes were meant to bound (section 5.2)."
    )
    if subject.image is None:
        words += " This source has no image."
    return Explanation("error", "Interpolation error", words, "mean over e of | I − I<sub>h</sub> |")


_STEEPEST: WeakKeyDictionary[SizeField, float] = WeakKeyDictionary()


def steepest(field: SizeField) -> float:
    """Return the largest change of size for each unit of distance, along the edges of a background."""
    if field not in _STEEPEST:
        _STEEPEST[field] = _slope(field)
    return _STEEPEST[field]


def _slope(field: SizeField) -> float:
    grid = field.background.grid
    if grid is not None:
        rows = field.sizes.reshape(grid.ny, grid.nx)
        along = [np.abs(np.diff(rows, axis=axis)).max(initial=0.0) for axis in (0, 1)]
        return float(max(along[0] / grid.dy, along[1] / grid.dx))
    triangles, points = field.background.triangles, field.background.points
    ahead = np.roll(triangles, -1, axis=1)
    length = np.hypot(*np.moveaxis(points[ahead] - points[triangles], 2, 0))
    return float((np.abs(field.sizes[ahead] - field.sizes[triangles]) / length).max(initial=0.0))
