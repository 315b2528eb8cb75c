"""The adaptive process, Algorithm 3: each mesh is the background that the sizes of the next one live on.

Ruiz-Girones, Roca, Sarrate (2013), Section 5, DOI 10.1007/978-3-319-02335-9. Meshes are kept on disk, one file an
iteration, so that a long process needs no more memory than a short one, and can be taken up again.
"""

from __future__ import annotations

import hashlib
import math
import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.conformity import element_sizes, judged
from sizeviz.conformity.report import TOLERANCE
from sizeviz.errors import InputError
from sizeviz.files import output_folder, read_mesh, write_mesh
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.study.backgrounds import Sampling, background_of, uniform_mesh
from sizeviz.study.evolution import FINGERPRINT, Evolution, Iteration, read_evolution, write_evolution
from sizeviz.study.options import StudyOptions
from sizeviz.study.pipeline import GUARANTEED, METHODS, run
from sizeviz.study.report import mesh_arrays, options_as_typed
from sizeviz.study.study import Study

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sizeviz.conformity import Measure, MeshReport
    from sizeviz.geometry import QuadMesh
    from sizeviz.sources.source import Source

FREE: tuple[str, ...] = ("threads", "max_elements")
"""Options that do not decide the meshes."""

NEARLY = 2.0
"""Largest R of the last mesh against the given field, by the longest edge, up to which the next mesh is guaranteed.
Above it a mesh is made by size preserving alone: its background has missed part of the field, and to find that by
moving and inserting nodes would take far longer than the next background does."""


@dataclass(frozen=True, kw_only=True)
class AdaptOptions:
    """What an adaptive process is asked to do.

    Parameters
    ----------
    method : str
        One of ``METHODS``: what is done to the sizes on each background. Default size preserving.
    study : StudyOptions
        Of every stage of every iteration.
    sampling : {'refined', 'nodes'}
        Where on the previous mesh the given field is asked: at its nodes, as the paper says, or also at the middle of
        every edge and element. With the nodes alone a narrow valley needs more iterations to be found.
    cells : int
        Elements along the longer side of the domain in the uniform mesh to start from. Default 80.
    limit : float
        Converged when no element's R against the given field exceeds this. Default 1.1.
    iterations : int
        Give up after this many meshes. Default 50.
    measure : {'mean-edge', 'sqrt-area', 'max-edge'}
        Size of an element in R; with the guarantee always the longest edge, and no limit above 1.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    method: str = "size-preserving"
    study: StudyOptions = field(default_factory=StudyOptions)
    sampling: Sampling = "refined"
    cells: int = 80
    limit: float = 1.1
    iterations: int = 50
    measure: Measure = "mean-edge"

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise InputError(f"method {self.method!r} is unknown; choose one of {', '.join(METHODS)}")
        if self.cells < 1 or self.iterations < 1:
            raise InputError(f"cells is {self.cells} and iterations {self.iterations}; at least 1 of each is needed")
        if not self.limit > 0:
            raise InputError(f"the limit of R is {self.limit}; it must be above 0, such as 1.1")

    @property
    def criterion(self) -> tuple[Measure, float]:
        """The size of an element and the limit of R that end the process; what it promises where that is guaranteed."""
        return ("max-edge", min(self.limit, 1.0)) if self.method == GUARANTEED else (self.measure, self.limit)

    def as_recorded(self) -> dict[str, object]:
        """Return what decides the meshes."""
        typed = {name: value for name, value in options_as_typed(self.study).items() if name not in FREE}
        return {
            "method": self.method,
            "sampling": self.sampling,
            "cells": self.cells,
            "measure": self.criterion[0],
            **typed,
        }


def adapted(source: Source, options: AdaptOptions, out: str | Path, monitor: Monitor = SILENT) -> Evolution:
    """Run the process until a mesh keeps the limit, or to the last iteration; take it up where it was left.

    Writes ``mesh-000.vtu``, ``mesh-001.vtu``, ... and ``evolution.json`` into the folder after each iteration.

    Parameters
    ----------
    source : Source
        Its domain is meshed; its ``reference`` gives the sizes at the nodes of each mesh, and judges it.
    options : AdaptOptions
        What is asked for.
    out : path-like
        The process's folder; if it holds the record of the same process, that is continued.
    monitor : Monitor
        Told the iteration and its stage.

    Raises
    ------
    InputError
        If the folder cannot be written, or holds another process.
    MeshingError
        If an iteration makes no valid mesh.
    Cancelled
        If the monitor says so; finished iterations stay on disk.
    """
    with output_folder(out) as folder:
        evolution = _taken_up(source, options, folder)
        mesh = _last_mesh(evolution, folder)
        for number in range(len(evolution.iterations), options.iterations + 1):
            if evolution.converged:
                break
            part = SubMonitor(monitor, number / (options.iterations + 1), (number + 1) / (options.iterations + 1))
            missed = number == 0 or evolution.iterations[-1].strict_ratio > NEARLY
            mesh, row = _iterated(number, mesh, source, options, folder, part, missed=missed)
            evolution = replace(evolution, iterations=(*evolution.iterations, row))
            write_evolution(folder, evolution)
        monitor.step(1.0)
        return evolution


def _taken_up(source: Source, options: AdaptOptions, folder: Path) -> Evolution:
    recorded = {**options.as_recorded(), FINGERPRINT: _fingerprint(source)}
    fresh = Evolution(source=source.name, options=recorded, limit=options.criterion[1])
    found = read_evolution(folder)
    if found is None:
        return fresh
    if differences := found.differences(fresh):
        raise InputError(
            f"{folder}: holds another adaptive process ({'; '.join(differences[:3])}); choose another --out, or remove "
            "that folder"
        )
    whole = replace(found, iterations=tuple(_brought_up_to_date(row, folder) for row in found.iterations))
    if any(math.isnan(row.strict_ratio) for row in found.iterations):
        write_evolution(folder, whole)
    return whole


def _fingerprint(source: Source) -> str:
    """Return what tells a source from another of its name: of its sizes and its domain, to single precision."""
    found = hashlib.sha256()
    for array in (*source.domain.loops, *source.domain.lines, source.field.background.points, source.field.sizes):
        found.update(np.ascontiguousarray(array, dtype="<f4").tobytes())
    return found.hexdigest()[:16]


def _brought_up_to_date(row: Iteration, folder: Path) -> Iteration:
    """Return a row with what older versions did not record, from the R and the sizes in its mesh's file."""
    if not math.isnan(row.strict_ratio):
        return row
    content = read_mesh(folder / row.mesh)
    ratio = content.cell_data["ratio"] * element_sizes(content.mesh, "max-edge") / content.cell_data["size"]
    correct = 100.0 * float(np.mean(ratio <= 1.0 + TOLERANCE))
    return replace(row, strict_ratio=float(ratio.max()), strict_correct=correct)


def _last_mesh(evolution: Evolution, folder: Path) -> QuadMesh | None:
    return read_mesh(folder / evolution.iterations[-1].mesh).mesh if evolution.iterations else None


def _iterated(
    number: int,
    mesh: QuadMesh | None,
    source: Source,
    options: AdaptOptions,
    folder: Path,
    monitor: Monitor,
    *,
    missed: bool,
) -> tuple[QuadMesh, Iteration]:
    """Return the next mesh, written to the folder, and its row; ``missed`` says whether the last was far from it."""
    monitor.step(0.0, f"iteration {number}")
    began = time.perf_counter()
    name = f"mesh-{number:03d}.vtu"
    beta, measure = options.study.beta, options.criterion[0]
    if mesh is None:
        made = uniform_mesh(source.domain, options.cells, options.study.mesh, monitor)
        report = judged(made, source.reference, beta=beta)
        write_mesh(folder / name, made, _cells(report, measure))
        return made, _row(number, name, report, report, measure, time.perf_counter() - began)
    background = background_of(mesh, source.reference, options.sampling)
    method = "size-preserving" if missed and options.method == GUARANTEED else options.method
    study = run(Study(replace(source, field=background), options.study), (method,), SubMonitor(monitor, 0, 0.9))
    made, cells, points = mesh_arrays(study, method, measure)
    against = judged(made, background, beta=beta, monitor=SubMonitor(monitor, 0.9, 1.0))
    write_mesh(folder / name, made, cells, points)
    whole = study.runs[method].report
    assert whole is not None
    return made, _row(number, name, against, whole, measure, time.perf_counter() - began)


def _cells(report: MeshReport, measure: Measure) -> dict[str, NDArray[np.float64]]:
    return {"ratio": report.ratios[measure], "quality": report.quality, "size": report.sizes[measure]}


def _row(
    number: int, name: str, background: MeshReport, analytic: MeshReport, measure: Measure, seconds: float
) -> Iteration:
    quality = analytic.quality_summary
    return Iteration(
        number=number,
        mesh=name,
        n_quads=int(analytic.n_quads),
        n_nodes=int(analytic.n_nodes),
        background_ratio=float(background.max_ratio[measure]),
        analytic_ratio=float(analytic.max_ratio[measure]),
        background_correct=float(background.correct_percent[measure]),
        analytic_correct=float(analytic.correct_percent[measure]),
        strict_ratio=float(analytic.max_ratio["max-edge"]),
        strict_correct=float(analytic.correct_percent["max-edge"]),
        quality_min=float(quality["min"]),
        quality_mean=float(quality["mean"]),
        quality_max=float(quality["max"]),
        quality_std=float(quality["std"]),
        irregular=float(analytic.irregular_percent),
        seconds=round(seconds, 3),
    )
