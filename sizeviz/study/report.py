"""What a study leaves behind: the numbers of ``report.json``, and the arrays of a mesh file."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

from sizeviz import __version__
from sizeviz.errors import InputError
from sizeviz.threads import default_threads

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from sizeviz.conformity import Measure
    from sizeviz.geometry import QuadMesh
    from sizeviz.study.options import StudyOptions
    from sizeviz.study.study import MethodRun, Study

PACKAGES: tuple[str, ...] = ("numpy", "scipy", "numba", "pyvista", "vtk")
"""Packages whose versions a report names, because its numbers or pictures may depend on them."""


def report_of(study: Study, methods: Sequence[str], measure: Measure = "mean-edge") -> dict[str, Any]:
    """Return a study's numbers as plain data, ready for JSON.

    Parameters
    ----------
    study : Study
        With complete runs of the methods.
    methods : sequence of str
        Which runs.
    measure : {'mean-edge', 'sqrt-area', 'max-edge'}
        Size of an element in the mesh files' arrays; noted among the options.

    Raises
    ------
    InputError
        If a method has not been run to the end.
    """
    source = study.source
    return {
        "source": {"name": source.name, "label": source.label, **_plain(source.provenance)},
        "options": {**options_as_typed(study.options), "measure": measure},
        "methods": {method: _method_numbers(complete_run(study, method)) for method in methods},
        "versions": versions(),
    }


def mesh_arrays(
    study: Study, method: str, measure: Measure = "mean-edge"
) -> tuple[QuadMesh, dict[str, NDArray[np.float64]], dict[str, NDArray[np.float64]]]:
    """Return a method's mesh, its cell arrays and its point arrays, as a mesh file holds them.

    Cells carry ``ratio`` (R against the field the user gave), ``quality`` and ``size``; points carry
    ``size_prescribed`` (the user's field) and ``size_target`` (the processed one).

    Raises
    ------
    InputError
        If the method has not been run to the end.
    """
    run = complete_run(study, method)
    mesh, report, target = run.mesh, run.report, run.target
    assert mesh is not None and report is not None and target is not None
    cells = {"ratio": report.ratios[measure], "quality": report.quality, "size": report.sizes[measure]}
    points = {"size_prescribed": study.source.reference.at(mesh.points), "size_target": target.at(mesh.points)}
    return mesh, cells, points


def complete_run(study: Study, method: str) -> MethodRun:
    """Return a method's run; raise InputError unless every stage has a result."""
    found = study.runs.get(method)
    if found is None or not found.is_complete:
        raise InputError(f"{method} has not been run to the end on {study.source.label}; run it first")
    return found


def options_as_typed(options: StudyOptions) -> dict[str, Any]:
    """Return the options by the names they have on the command line."""
    return {
        "epsilon": options.limit.epsilon,
        "alpha": options.preserve.alpha,
        "beta": options.preserve.beta,
        "distance": options.preserve.distance,
        "mesher": options.mesh.mesher,
        "mesh_scale": options.mesh.scale,
        "preset": options.mesh.preset,
        "smooth": options.smoothing,
        "seed": options.mesh.seed,
        "threads": options.threads or default_threads(),
        "max_elements": options.mesh.max_elements,
    }


def versions() -> dict[str, str]:
    """Return the versions of sizeviz, Python and the packages that results depend on, and the platform."""
    found = {"sizeviz": __version__, "python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "absent"
    return {**found, "platform": platform.platform()}


def _method_numbers(run: MethodRun) -> dict[str, Any]:
    report = run.report
    assert report is not None
    seconds = {**run.seconds, "total": run.total_seconds}
    promise = {} if run.guarantee is None else {"guarantee": run.guarantee.verdict}
    return {**report.summary(), **promise, "seconds": {stage: round(taken, 4) for stage, taken in seconds.items()}}


def _plain(value: Any) -> Any:
    """Return provenance as JSON can hold it."""
    if isinstance(value, dict) or hasattr(value, "items"):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    return value.item() if hasattr(value, "item") else str(value)
