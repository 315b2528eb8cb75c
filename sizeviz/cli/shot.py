"""``sizeviz shot``: a picture or vector figure of a mesh file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from sizeviz.cli.options import FileArgument, MeasureName

QuantityName = Literal["ratio", "quality", "size", "error"]
"""What the colours mean: R(e), shape quality, element size, interpolation error of the source's image."""


def shot(
    file: Annotated[Path, Parameter(help="A mesh of quadrilaterals, such as mesh.vtu.")],
    /,
    *,
    output: FileArgument,
    color_by: Annotated[QuantityName, Parameter(help="What the colours mean.")] = "ratio",
    source: Annotated[str | None, Parameter(help="Judge the mesh anew against this source.")] = None,
    domain: Annotated[Path | None, Parameter(help="Outline of the domain of that source.")] = None,
    beta: Annotated[float, Parameter(help="Scale of the size asked for, in that judgement.")] = 1.0,
    measure: Annotated[MeasureName, Parameter(help="Size of an element.")] = "mean-edge",
    width: Annotated[int, Parameter(help="Pixels across; a vector figure has 200 an inch.")] = 1400,
    edges: Annotated[bool | None, Parameter(help="Draw element edges; by default below 12,000 elements.")] = None,
    dark: Annotated[bool, Parameter(negative="", help="Dark ground.")] = False,
) -> None:
    """Draw a mesh, coloured by R, quality, size or the source image's interpolation error.

    R comes from the file's own ratio array unless a source is named to judge the mesh against.
    """
    from sizeviz.cli.pictured import judged_anew, stored
    from sizeviz.errors import InputError
    from sizeviz.files import read_mesh, replacing, require_writable_file
    from sizeviz.scene import save_picture
    from sizeviz.scene.opengl import require_gl
    from sizeviz.scene.vector import VECTOR_SUFFIXES

    if not 64 <= width <= 20_000:
        raise InputError(f"width is {width}; give 64 to 20000 pixels")
    require_writable_file(output)
    content = read_mesh(file)
    if source is None:
        subject, measure = stored(content, file, color_by, measure)
    else:
        subject = judged_anew(content, file, source, domain, beta)
    if output.suffix.lower() not in VECTOR_SUFFIXES:
        require_gl()
    with replacing(output) as part:
        save_picture(subject, part, color_by=color_by, measure=measure, width=width, edges=edges, dark=dark)
    print(f"{output}: {content.mesh.n_quads:,} elements of {file}, coloured by {color_by}")
