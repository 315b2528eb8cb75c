"""One HTML file of the panes: it opens in any browser, without a server or a network, to zoom and point in."""

from __future__ import annotations

import base64
import json
import zlib
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz import __version__
from sizeviz.errors import InputError
from sizeviz.files import replacing
from sizeviz.scene.compose import scale_for, subject_bounds, values_of
from sizeviz.scene.scale import CORRECT
from sizeviz.scene.subject import MEASURE_TITLES, subjects_of
from sizeviz.scene.verdict import percent, verdict
from sizeviz.scene.view import QUANTITIES, Quantity, ViewState

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from sizeviz.conformity import Measure
    from sizeviz.geometry import QuadMesh
    from sizeviz.scene.scale import ColorScale
    from sizeviz.scene.spec import Bounds
    from sizeviz.scene.subject import Subject
    from sizeviz.study import Study

PAGE_SUFFIXES = (".html", ".htm")
"""File suffixes that mean a page."""

ASSETS = Path(__file__).with_name("page_assets")
"""The page's own HTML, CSS and JavaScript, which every page carries."""

MOST_ELEMENTS = 2_000_000
"""Beyond so many elements in all, a page would be too large for a browser."""

PLACES: dict[Quantity, str] = {"prescribed": ", at element centres", "target": ", at element centres"}
"""Where the values of a field are taken."""


def save_page(
    study: Study | Subject | QuadMesh | Sequence[Subject],
    path: str | Path,
    *,
    methods: Sequence[str] | None = None,
    panes: Sequence[ViewState] | None = None,
    measure: Measure = "mean-edge",
    title: str | None = None,
    dark: bool = False,
) -> Path:
    """Write the panes as one HTML file: zoom, pan, linked cameras, every element's values under the pointer.

    Parameters
    ----------
    study : Study, Subject, QuadMesh or sequence of Subject
        What is shown.
    path : path-like
        Where to; .html by custom.
    methods : sequence of str, optional
        Which runs of a study can be chosen; by default all that have a mesh.
    panes : sequence of ViewState, optional
        What the panes show at first, from left to right; by default the first two methods coloured by R, or the one
        mesh by R and by quality.
    measure : {'mean-edge', 'sqrt-area', 'max-edge'}
        Size of an element that R is formed with.
    title : str, optional
        Heading; the source's name by default.
    dark : bool
        Dark ground at first.

    Returns
    -------
    Path
        Where it was written.

    Raises
    ------
    InputError
        If there is no mesh to show, or too large a one, or the place cannot be written.
    """
    path = Path(path)
    content = page(study, methods=methods, panes=panes, measure=measure, title=title, dark=dark)
    with replacing(path) as part:
        part.write_text(content, encoding="utf-8")
    return path


def page(
    study: Study | Subject | QuadMesh | Sequence[Subject],
    *,
    methods: Sequence[str] | None = None,
    panes: Sequence[ViewState] | None = None,
    measure: Measure = "mean-edge",
    title: str | None = None,
    dark: bool = False,
) -> str:
    """Return the text of the file that ``save_page`` writes; parameters and errors are the same."""
    chosen, heading = _chosen(study, methods)
    packer = _Packer()
    box = _joined([subject_bounds(subject) for _, subject in chosen])
    kinds = _quantities(chosen, measure)
    scales = {kind: _shared_scale(chosen, kind, measure) for kind in kinds}
    data = {
        "subjects": [packer.subject(subject, kinds, scales, measure, box) for _, subject in chosen],
        "panes": _panes([name for name, _ in chosen], kinds, panes),
        "table": table_of([subject for _, subject in chosen], measure),
        "box": box,
        "dark": dark,
        "arrays": packer.arrays,
    }
    return _filled(title or heading, data, dark)


def table_of(subjects: Sequence[Subject], measure: Measure) -> dict[str, list[Any]]:
    """Return counts, conformity and quality as ``header`` and ``rows`` of words, a column for each subject."""
    words = MEASURE_TITLES[measure]
    names = ("Elements", f"Correct, {words}", f"Largest R, {words}", "Quality, smallest", "Quality, mean")
    columns = [_column(subject, measure) for subject in subjects]
    rows = [[name, *(column[k] for column in columns)] for k, name in enumerate(names)]
    return {"header": ["", *(subject.title for subject in subjects)], "rows": rows}


def _column(subject: Subject, measure: Measure) -> tuple[str, ...]:
    assert subject.mesh is not None
    ratios = subject.element_values("ratio", measure)
    quality = subject.element_values("quality", measure)
    assert quality is not None
    judged = ("", "")
    if ratios is not None:
        judged = percent(int((ratios <= CORRECT).sum()), len(ratios)), f"{ratios.max():.3f}"
    return f"{subject.mesh.n_quads:,}", *judged, f"{quality.min():.3f}", f"{quality.mean():.3f}"


def _chosen(
    study: Study | Subject | QuadMesh | Sequence[Subject], methods: Sequence[str] | None
) -> tuple[list[tuple[str, Subject]], str]:
    """Return the subjects with a mesh by name, and a heading."""
    subjects, heading = subjects_of(study, methods)
    found = [(name, subject) for name, subject in subjects.items() if subject.mesh is not None]
    count = sum(subject.mesh.n_quads for _, subject in found if subject.mesh is not None)
    if not count:
        raise InputError("there is no mesh to show on a page; run a method first")
    if count > MOST_ELEMENTS:
        raise InputError(f"a page shows at most {MOST_ELEMENTS:,} elements, these are {count:,}; choose fewer methods")
    return found, heading


def _quantities(chosen: Sequence[tuple[str, Subject]], measure: Measure) -> list[Quantity]:
    """Return what any of the subjects can be coloured by."""
    return [kind for kind in QUANTITIES if any(_values(subject, kind, measure) is not None for _, subject in chosen)]


def _values(subject: Subject, kind: Quantity, measure: Measure) -> NDArray[np.float64] | None:
    """Return one value an element, ``(Q,)``; of a field, that at the element's centre."""
    if kind not in PLACES:
        return values_of(subject, ViewState(color_by=kind, measure=measure))
    field = subject.field(kind)
    if field is None or subject.mesh is None:
        return None
    return field.at(subject.mesh.points[subject.mesh.quads].mean(axis=1))


def _shared_scale(chosen: Sequence[tuple[str, Subject]], kind: Quantity, measure: Measure) -> ColorScale:
    values = [_values(subject, kind, measure) for _, subject in chosen]
    scale = scale_for([array for array in values if array is not None], ViewState(color_by=kind, measure=measure))
    assert scale is not None
    return scale


def _panes(names: Sequence[str], kinds: Sequence[Quantity], asked: Sequence[ViewState] | None) -> list[dict[str, Any]]:
    if asked:
        shown = [view for view in asked if view.method in names]
        if shown:
            return [{"subject": names.index(view.method), "quantity": view.color_by} for view in shown]
    if len(names) == 1:
        return [{"subject": 0, "quantity": kind} for kind in kinds[:2]]
    return [{"subject": k, "quantity": kinds[0]} for k in (0, 1)]


def _joined(boxes: Sequence[Bounds]) -> Bounds:
    x0, y0 = min(box[0] for box in boxes), min(box[1] for box in boxes)
    return x0, y0, max(box[2] for box in boxes), max(box[3] for box in boxes)


class _Packer:
    """Collects the arrays of a page, deflated and in base64, and what refers to them."""

    def __init__(self) -> None:
        self.arrays: list[dict[str, str]] = []

    def subject(
        self,
        subject: Subject,
        kinds: Sequence[Quantity],
        scales: Mapping[Quantity, ColorScale],
        measure: Measure,
        box: Bounds,
    ) -> dict[str, Any]:
        """Return one mesh with its values; coordinates are relative to the middle of ``box``, in float32."""
        mesh = subject.mesh
        assert mesh is not None
        origin = np.array([0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3])])
        ratios = subject.element_values("ratio", measure)
        quality = subject.element_values("quality", measure)
        assert quality is not None
        quantities = {}
        for kind in kinds:
            values = _values(subject, kind, measure)
            if values is not None:
                quantities[kind] = self._quantity(subject, kind, measure, values, scales[kind])
        failing = np.empty(0) if ratios is None else np.flatnonzero(ratios > CORRECT)
        loops = [] if subject.domain is None else subject.domain.loops
        return {
            "title": subject.title,
            "detail": subject.detail,
            "origin": origin.tolist(),
            "box": box,
            "points": self._packed(mesh.points - origin, "f4"),
            "quads": self._packed(mesh.quads, "u4"),
            "outline": [self._packed(loop - origin, "f4") for loop in loops],
            "failing": self._packed(failing, "u4"),
            "worst": {
                "ratio": None if ratios is None else int(np.argmax(ratios)),
                "quality": int(np.argmin(quality)),
            },
            "quantities": quantities,
        }

    def _quantity(
        self, subject: Subject, kind: Quantity, measure: Measure, values: NDArray[np.float64], scale: ColorScale
    ) -> dict[str, Any]:
        words, passed = verdict(subject, ViewState(color_by=kind, measure=measure))
        palette, which = np.unique(scale.colors(values), axis=0, return_inverse=True)
        return {
            "words": QUANTITIES[kind],
            "title": scale.title + PLACES.get(kind, ""),
            "verdict": words,
            "passed": passed,
            "alarmed": kind in ("ratio", "size"),
            "values": self._packed(values, "f4"),
            "colors": self._packed(which.ravel(), "u2"),
            "palette": self._packed(palette, "u1"),
            "bar": self._packed(scale.bar(512), "u1"),
            "ticks": scale.ticks(),
        }

    def _packed(self, array: NDArray[Any], kind: str) -> int:
        """Keep an array, little-endian, and return its number."""
        data = zlib.compress(np.ascontiguousarray(array, dtype=f"<{kind}").tobytes(), 6)
        self.arrays.append({"type": kind, "data": base64.b64encode(data).decode("ascii")})
        return len(self.arrays) - 1


def _filled(title: str, data: Mapping[str, Any], dark: bool) -> str:
    """Return the page; text from files cannot end its script or become part of it."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    parts = {
        "title": escape(title),
        "version": escape(__version__),
        "theme": "dark" if dark else "light",
        "style": (ASSETS / "page.css").read_text(encoding="utf-8"),
        "script": (ASSETS / "page.js").read_text(encoding="utf-8"),
        "data": text,
    }
    pieces = (ASSETS / "page.html").read_text(encoding="utf-8").split("{{")
    return pieces[0] + "".join(parts[name] + rest for name, rest in (piece.split("}}", 1) for piece in pieces[1:]))
