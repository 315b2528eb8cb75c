"""``show`` and ``screenshot``: a study, meshes or sizes as a page, a picture or a figure."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from sizeviz.conformity import judged
from sizeviz.errors import InputError
from sizeviz.geometry import QuadMesh
from sizeviz.notebook import Shown, picture_page
from sizeviz.sources import Source
from sizeviz.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sizeviz.conformity import Measure
    from sizeviz.scene import Subject, ViewState
    from sizeviz.scene.view import Quantity

MOST_ON_A_PAGE = 400_000
"""Elements that ``show`` puts on an interactive page; more are shown as a picture."""


def show(
    source: Study | Source | QuadMesh,
    meshes: QuadMesh | Mapping[str, QuadMesh] | None = None,
    *,
    color_by: Quantity | None = None,
    measure: Measure = "mean-edge",
    dark: bool = False,
) -> Shown:
    """Show a study, meshes judged against a source, or a source's sizes; in a notebook, to zoom into and point at.

    Parameters
    ----------
    source : Study, Source or QuadMesh
        What is shown.
    meshes : QuadMesh or mapping of str to QuadMesh, optional
        Of a source: the meshes, by the words over them.
    color_by : {'ratio', 'quality', 'size', 'prescribed', 'target', 'error'}, optional
        What the colours mean at first; R by default, the sizes of a source without a mesh, else quality.
    measure : {'mean-edge', 'sqrt-area', 'max-edge'}
        Size of an element.
    dark : bool
        Dark ground.

    Returns
    -------
    Shown
        A notebook displays it; ``.open()`` shows it in a browser, ``.save(path)`` writes it.

    Raises
    ------
    InputError
        If there is nothing of that kind to show.
    MissingDependencyError
        If a picture is needed, for there is no mesh or too large a one, and OpenGL is missing.
    """
    from sizeviz.scene.page import page

    subjects, title = _subjects(source, meshes)
    count = sum(subject.mesh.n_quads for subject in subjects if subject.mesh is not None)
    if 0 < count <= MOST_ON_A_PAGE:
        return Shown(title, page(subjects, panes=_panes(color_by), measure=measure, title=title, dark=dark))
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "picture.png"
        _shoot(subjects, picture, color_by, measure, 1200, dark)
        return Shown(title, picture_page(title, picture.read_bytes()))


def screenshot(
    path: str | Path,
    source: Study | Source | QuadMesh,
    meshes: QuadMesh | Mapping[str, QuadMesh] | None = None,
    *,
    color_by: Quantity | None = None,
    measure: Measure = "mean-edge",
    width: int = 1400,
    dark: bool = False,
) -> Path:
    """Write a picture (.png .jpg .tif .webp), a vector figure (.svg .pdf) or an interactive page (.html).

    Of several meshes, a picture is the comparison of all, coloured by R and by quality; a vector figure shows one.

    Parameters
    ----------
    path : path-like
        Where to; the suffix says what.
    source, meshes, color_by, measure, dark
        As for ``show``.
    width : int
        Pixels across; a vector figure has 200 an inch.

    Returns
    -------
    Path
        Where it was written.

    Raises
    ------
    InputError
        If there is nothing of that kind to show, or the place cannot be written.
    MissingDependencyError
        If OpenGL is needed and missing.
    """
    from sizeviz.scene.page import PAGE_SUFFIXES, save_page

    path = Path(path)
    subjects, title = _subjects(source, meshes)
    if path.suffix.lower() not in PAGE_SUFFIXES:
        return _shoot(subjects, path, color_by, measure, width, dark)
    return save_page(subjects, path, panes=_panes(color_by), measure=measure, title=title, dark=dark)


def _panes(color_by: Quantity | None) -> list[ViewState] | None:
    """Return what both panes of a page show at first, None where the page is to choose."""
    from sizeviz.scene import ViewState

    return None if color_by is None else [ViewState(method=str(k), color_by=color_by) for k in (0, 1)]


def _subjects(
    source: Study | Source | QuadMesh, meshes: QuadMesh | Mapping[str, QuadMesh] | None
) -> tuple[list[Subject], str]:
    """Return what is to be shown, judged, and a heading."""
    from sizeviz.scene import Subject
    from sizeviz.scene.subject import subjects_of

    if isinstance(source, Study | QuadMesh):
        if meshes is not None:
            raise InputError(
                "a study has meshes of its own; leave meshes out, or give the study's source"
                if isinstance(source, Study)
                else "meshes are judged against a source; give that first"
            )
        subjects, heading = subjects_of(source)
        if subjects or isinstance(source, QuadMesh):
            return list(subjects.values()), heading
        source = source.source
    if not isinstance(source, Source):
        raise InputError(f"a {type(source).__name__} cannot be shown; give a study, a source or a mesh")
    bare = Subject(title=source.label, prescribed=source.field, domain=source.domain, image=source.image)
    named = {"Mesh": meshes} if isinstance(meshes, QuadMesh) else dict(meshes or {})
    shown = [
        replace(bare, title=words, detail=f"{m.n_quads:,} elements", mesh=m, report=judged(m, source.reference))
        for words, m in named.items()
    ]
    return shown or [bare], source.label


def _shoot(
    subjects: Sequence[Subject], path: Path, color_by: Quantity | None, measure: Measure, width: int, dark: bool
) -> Path:
    from sizeviz.scene import save_comparison, save_picture
    from sizeviz.scene.opengl import require_gl
    from sizeviz.scene.vector import VECTOR_SUFFIXES

    if not 64 <= width <= 20_000:
        raise InputError(f"width is {width}; give 64 to 20000 pixels")
    vector = path.suffix.lower() in VECTOR_SUFFIXES
    if not vector:
        require_gl()
    if len(subjects) > 1 and color_by is None and not vector:
        return save_comparison(subjects, path, measure=measure, width=width, dark=dark)
    if len(subjects) > 1:
        raise InputError(f"{path}: shows one mesh; name one, or leave out color_by for a .png of all, or write .html")
    subject = subjects[0]
    usual: Quantity = "prescribed" if subject.mesh is None else "quality" if subject.report is None else "ratio"
    return save_picture(subject, path, color_by=color_by or usual, measure=measure, width=width, dark=dark)
