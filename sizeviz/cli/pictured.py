"""What a mesh file alone lets a picture show, and what it shows beside a source."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.cli.options import FieldOptions, loaded
from sizeviz.conformity import element_sizes, judged
from sizeviz.errors import InputError
from sizeviz.scene import Subject
from sizeviz.scene.subject import StoredSubject

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from sizeviz.conformity import Measure
    from sizeviz.files import MeshFile
    from sizeviz.scene.view import Quantity

MEASURES: tuple[Measure, ...] = ("mean-edge", "sqrt-area", "max-edge")
"""The measures of an element's size."""


def stored(content: MeshFile, file: Path, quantity: Quantity, measure: Measure) -> tuple[Subject, Measure]:
    """Return a mesh with what its file says of it, and the measure that its R was formed with.

    Raises
    ------
    InputError
        If the quantity needs what the file does not hold.
    """
    mesh = content.mesh
    detail = f"{mesh.n_quads:,} elements"
    if quantity == "error":
        raise InputError(f"{file}: the interpolation error needs the image; name it with --source")
    if quantity != "ratio":
        return Subject(title=file.stem, detail=detail, mesh=mesh), measure
    ratio = content.cell_data.get("ratio")
    if ratio is None:
        raise InputError(f"{file}: holds no array 'ratio'; name the field with --source to judge the mesh")
    subject = StoredSubject(title=file.stem, detail=detail, mesh=mesh, ratio=ratio)
    return subject, _measure_of(mesh_sizes(content), content.cell_data, measure)


def judged_anew(content: MeshFile, file: Path, source: str, domain: Path | None, beta: float) -> Subject:
    """Return a mesh judged against a source.

    Raises
    ------
    InputError
        If the source or its domain cannot be used.
    """
    found = loaded(source, FieldOptions(domain=domain))
    return Subject(
        title=file.stem,
        detail=f"{content.mesh.n_quads:,} elements against {found.label}",
        mesh=content.mesh,
        report=judged(content.mesh, found.reference, beta=beta),
        prescribed=found.field,
        domain=found.domain,
        image=found.image,
    )


def mesh_sizes(content: MeshFile) -> dict[Measure, NDArray[np.float64]]:
    """Return the sizes of a file's elements by every measure."""
    return {measure: element_sizes(content.mesh, measure) for measure in MEASURES}


def _measure_of(
    sizes: Mapping[Measure, NDArray[np.float64]], cell_data: Mapping[str, NDArray[np.float64]], default: Measure
) -> Measure:
    """Tell the measure from the stored sizes, which were written beside R."""
    written = cell_data.get("size")
    if written is None:
        return default
    return next((name for name, value in sizes.items() if np.allclose(value, written, rtol=1e-6)), default)
