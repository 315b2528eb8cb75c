"""What a pane can show of one method: its mesh, its judgement and its fields, whichever of them exist."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry import QuadMesh
from sizeviz.scene.imaging import interpolation_errors

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.conformity import Measure, MeshReport
    from sizeviz.files.image import Image
    from sizeviz.geometry import Domain
    from sizeviz.scene.view import Quantity
    from sizeviz.sizing import SizeField
    from sizeviz.study import Study

METHOD_TITLES: dict[str, str] = {
    "none": "Field as given",
    "gradient-limiting": "Gradient limiting",
    "size-preserving": "Size preserving",
    "guaranteed": "Guaranteed",
}
"""The methods in the order of the paper, in words."""

MEASURE_TITLES: dict[str, str] = {
    "mean-edge": "mean edge",
    "sqrt-area": "√area",
    "max-edge": "longest edge",
}
"""The measures of an element's size, in words."""


@dataclass(frozen=True, eq=False)
class Subject:
    """One method's results, as far as they exist.

    Parameters
    ----------
    title, detail : str
        Words over the pane.
    mesh : QuadMesh, optional
        The elements.
    report : MeshReport, optional
        Their judgement against the user's field.
    prescribed, target : SizeField, optional
        The user's field, and what the method made of it.
    domain : Domain, optional
        Its outline is drawn.
    image : Image, optional
        What the interpolation error is measured on.
    promise : {'mean-edge', 'sqrt-area', 'max-edge'}, optional
        The measure by which the method promises every element to be correct, if it promises anything.
    """

    title: str = ""
    detail: str = ""
    mesh: QuadMesh | None = None
    report: MeshReport | None = None
    prescribed: SizeField | None = None
    target: SizeField | None = None
    domain: Domain | None = None
    image: Image | None = None
    promise: Measure | None = None

    def field(self, quantity: Quantity) -> SizeField | None:
        """Return the field behind a field quantity, None where it does not exist yet."""
        return self.prescribed if quantity == "prescribed" else self.target

    def element_values(self, quantity: Quantity, measure: Measure) -> NDArray[np.float64] | None:
        """Return one value an element, ``(Q,)``, or None where the mesh or its report does not exist yet."""
        if self.mesh is None:
            return None
        if quantity == "error":
            if self.image is None or self.domain is None:
                return None
            return interpolation_errors(self.mesh, self.image, self.domain.bounds)
        if self.report is not None:
            return {"quality": self.report.quality, "size": self.report.sizes[measure]}.get(
                quantity, self.report.ratios[measure]
            )
        return None if quantity == "ratio" else _measured(self.mesh, quantity, measure)


@dataclass(frozen=True, eq=False)
class StoredSubject(Subject):
    """A mesh whose R was judged when its file was written.

    Parameters
    ----------
    ratio : (Q,) float64
        R of each element, as stored.
    """

    ratio: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))

    def element_values(self, quantity: Quantity, measure: Measure) -> NDArray[np.float64] | None:
        """Return the stored R, or what follows from the mesh."""
        return self.ratio if quantity == "ratio" else super().element_values(quantity, measure)


def subject_of(study: Study, method: str) -> Subject:
    """Return what a study has of one method; the prescribed field is there even before anything was run."""
    run = study.runs.get(method)
    return Subject(
        title=METHOD_TITLES.get(method, method),
        detail=_detail(study, method),
        mesh=None if run is None else run.mesh,
        report=None if run is None else run.report,
        prescribed=study.source.field,
        target=None if run is None else run.target,
        domain=study.source.domain,
        image=study.source.image,
        promise="max-edge" if method == "guaranteed" else None,
    )


def as_subject(shown: Study | Subject | QuadMesh, method: str = "") -> Subject:
    """Return the subject to show: a run of a study, a bare mesh, or the subject handed in.

    Raises
    ------
    InputError
        If it is none of these.
    """
    if isinstance(shown, Subject):
        return shown
    if isinstance(shown, QuadMesh):
        return Subject(title="Mesh", detail=f"{shown.n_quads:,} elements", mesh=shown)
    if not hasattr(shown, "runs"):
        raise InputError(f"a {type(shown).__name__} cannot be shown here; give a study, a mesh or a subject")
    return subject_of(shown, method)


def subjects_of(
    shown: Study | Subject | QuadMesh | Sequence[Subject], methods: Sequence[str] | None = None
) -> tuple[dict[str, Subject], str]:
    """Return what is to be shown side by side, by name, and a heading.

    Parameters
    ----------
    shown : Study, Subject, QuadMesh or sequence of Subject
        A study's runs are named by their methods, in the order of the paper; others are numbered.
    methods : sequence of str, optional
        Which runs of a study, in this order; by default all that have a mesh.

    Raises
    ------
    InputError
        If a method asked for was not run.
    """
    from sizeviz.study import Study

    if not isinstance(shown, Study):
        several = [*shown] if isinstance(shown, Sequence) else [as_subject(shown)]
        return {str(k): subject for k, subject in enumerate(several)}, " beside ".join(s.title for s in several)
    runs = shown.runs
    names = [name for name in METHOD_TITLES if name in runs and runs[name].mesh is not None]
    missing = [name for name in methods or () if name not in runs]
    if missing:
        raise InputError(f"no run of {', '.join(missing)} in this study; it has {', '.join(runs) or 'none'}")
    return {name: subject_of(shown, name) for name in (names if methods is None else methods)}, shown.source.label


def _detail(study: Study, method: str) -> str:
    options = study.options
    words = {
        "gradient-limiting": f"ε = {options.limit.epsilon:g}",
        "size-preserving": f"α = {options.preserve.alpha:g}, β = {options.preserve.beta:g}",
        "guaranteed": f"α = {options.preserve.alpha:g}, β = {options.preserve.beta:g}",
    }.get(method, "")
    run = study.runs.get(method)
    if run is None or run.mesh is None:
        return words
    return " · ".join(part for part in (words, f"{run.mesh.n_quads:,} elements") if part)


def _measured(mesh: QuadMesh, quantity: Quantity, measure: Measure) -> NDArray[np.float64]:
    """Return the size or quality of a mesh that nobody has judged."""
    from sizeviz.conformity import element_sizes, shape_quality  # compiles kernels: only where it is needed

    return shape_quality(mesh) if quantity == "quality" else element_sizes(mesh, measure)
