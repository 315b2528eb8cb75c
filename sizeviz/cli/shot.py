"""``sizeviz shot``: a picture, vector figure or interactive page of a study or a mesh file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from sizeviz.cli.options import FileArgument, MeasureName
from sizeviz.cli.values import Place, Whole

if TYPE_CHECKING:
    from sizeviz.conformity import Measure
    from sizeviz.scene import Subject

QuantityName = Literal["ratio", "quality", "size", "error", "prescribed", "target"]
"""What the colours mean: R(e), shape quality, element size, interpolation error of the image; h and h* of a study."""

RunName = Literal["none", "gradient-limiting", "size-preserving", "guaranteed"]
"""A run of a study."""


def shot(
    file: Annotated[Place, Parameter(help="A study (.sizeviz), or a mesh of quadrilaterals such as mesh.vtu.")],
    /,
    *,
    output: FileArgument,
    color_by: Annotated[QuantityName, Parameter(help="What the colours mean.")] = "ratio",
    method: Annotated[RunName | None, Parameter(help="Which run of a study; a page holds all.")] = None,
    source: Annotated[str | None, Parameter(help="Judge a mesh anew against this source.")] = None,
    domain: Annotated[Place | None, Parameter(help="Outline of the domain of that source.")] = None,
    beta: Annotated[float, Parameter(help="Scale of the size asked for, in that judgement.")] = 1.0,
    measure: Annotated[MeasureName, Parameter(help="Size of an element.")] = "mean-edge",
    width: Annotated[Whole, Parameter(help="Pixels across; a vector figure has 200 an inch.")] = 1400,
    edges: Annotated[bool | None, Parameter(help="Draw element edges; by default below 12,000 elements.")] = None,
    dark: Annotated[bool, Parameter(negative="", help="Dark ground.")] = False,
) -> None:
    """Draw a study or a mesh, coloured by R, quality, size or the source image's interpolation error.

    The suffix of the output says what it is: pixels (.png .jpg .tif .webp), vectors (.svg .pdf), or a page (.html) to
    zoom and point in, in any browser. R of a mesh comes from its own ratio array unless a source is named to judge it.
    """
    from sizeviz.errors import InputError
    from sizeviz.files import require_writable_file
    from sizeviz.scene import ViewState, save_page, save_picture
    from sizeviz.scene.opengl import require_gl
    from sizeviz.scene.page import PAGE_SUFFIXES
    from sizeviz.scene.vector import VECTOR_SUFFIXES
    from sizeviz.study.storage import SUFFIX

    is_page = output.suffix.lower() in PAGE_SUFFIXES
    if not 64 <= width <= 20_000:
        raise InputError(f"width is {width}; give 64 to 20000 pixels")
    require_writable_file(output)
    if file.suffix.lower() == SUFFIX:
        if source is not None:
            raise InputError(f"--source judges a mesh; {file} is a study, which has a source of its own: leave it out")
        subjects, chosen, title = _runs(file, method)
    else:
        if method is not None:
            raise InputError(f"--method chooses a run of a study; {file} is a mesh: leave it out")
        subject, measure = _mesh(file, color_by, measure, source, domain, beta, judgement=is_page)
        subjects, chosen, title = [subject], 0, file.name
    if is_page:
        panes = None if color_by == "ratio" else [ViewState(method=str(k), color_by=color_by) for k in (0, 1)]
        save_page(subjects, output, panes=panes, measure=measure, title=title, dark=dark)
        print(f"{output}: {', '.join(subject.title for subject in subjects)} of {file}; open it in a browser")
        return
    if output.suffix.lower() not in VECTOR_SUFFIXES:
        require_gl()
    shown = subjects[chosen]
    save_picture(shown, output, color_by=color_by, measure=measure, width=width, edges=edges, dark=dark)
    print(f"{output}: {shown.title}, {shown.detail} of {file}, coloured by {color_by}")


def _runs(file: Path, method: str | None) -> tuple[list[Subject], int, str]:
    """Return a study's runs that have a mesh, which of them a picture shows, and what the study is of.

    Raises
    ------
    InputError
        If there is none, or not the one asked for.
    """
    from sizeviz.errors import InputError
    from sizeviz.scene.subject import subjects_of
    from sizeviz.study.storage import read_study

    subjects, heading = subjects_of(read_study(file).study)
    names = list(subjects)
    if not names:
        raise InputError(f"{file}: the study holds no mesh yet; open it with sizeviz gui, run it and save it again")
    wanted = method or ("size-preserving" if "size-preserving" in names else names[0])
    if wanted not in names:
        raise InputError(f"{file}: holds no mesh of {wanted}; it has {', '.join(names)}")
    return list(subjects.values()), names.index(wanted), heading


def _mesh(
    file: Path,
    color_by: QuantityName,
    measure: Measure,
    source: str | None,
    domain: Path | None,
    beta: float,
    *,
    judgement: bool,
) -> tuple[Subject, Measure]:
    """Return a mesh as its file knows it or as a source judges it, and the measure its R was formed with.

    With ``judgement``, R comes along wherever the file holds it, whatever the colours mean at first.

    Raises
    ------
    InputError
        If the quantity needs what neither holds.
    """
    from sizeviz.cli.pictured import judged_anew, stored
    from sizeviz.errors import InputError
    from sizeviz.files import read_mesh

    content = read_mesh(file)
    if source is not None:
        return judged_anew(content, file, source, domain, beta), measure
    if color_by in ("prescribed", "target"):
        raise InputError(f"{file}: a mesh alone has no size field; give a study, or name the field with --source")
    return stored(content, file, "ratio" if judgement and "ratio" in content.cell_data else color_by, measure)
