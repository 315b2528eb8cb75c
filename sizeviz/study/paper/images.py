"""Section 5.2: sizes from the curvature of an image, by both methods and every mesher."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sources import load
from sizeviz.sources.pictures import size_from_curvature
from sizeviz.study.paper.together import together
from sizeviz.study.pipeline import COMPARED, processed, run
from sizeviz.study.study import MethodRun, Study

if TYPE_CHECKING:
    from sizeviz.sources import Source
    from sizeviz.study.options import StudyOptions
    from sizeviz.study.paper.options import PaperOptions

EQUAL_COUNT = "gradient-limiting, equal count"
"""Gradient limiting once more, at the mesh scale that gives it as many elements as size preserving has."""

MRI_TOLERANCE = 1e-3
"""Share of the range of intensities that a linear element may miss in the MRI slice. The gallery's example allows an
eighth of it, and its sizes are the finest there are nearly everywhere; the paper's vary over the whole image."""


def image_source(name: str) -> Source:
    """Return an example that has an image; the MRI slice with sizes that vary as the paper's do.

    Raises
    ------
    InputError
        If there is no such example.
    """
    source = load(name)
    if name != "mri" or source.image is None:
        return source
    field = size_from_curvature(source.image, finest=1 / 1000, tolerance=MRI_TOLERANCE, nodes_a_pixel=2)
    label = f"MRI slice, sizes from its curvature at a tolerance of {MRI_TOLERANCE:g}"
    return replace(source, label=label, field=field, reference=field)


@dataclass(frozen=True, eq=False)
class ImageRun:
    """One image meshed by one mesher.

    Parameters
    ----------
    source : Source
        The image and its sizes.
    mesher : str
        What made the meshes.
    runs : dict of str to MethodRun
        By method; and gradient limiting at equal count under ``EQUAL_COUNT``. One mesher has the guarantee too.
    field_seconds : dict of str to float
        By method, how long its field takes where nothing else runs beside it: the best of three.
    """

    source: Source
    mesher: str
    runs: dict[str, MethodRun]
    field_seconds: dict[str, float]


def image_runs(name: str, options: PaperOptions, monitor: Monitor = SILENT) -> list[ImageRun]:
    """Mesh an example that has an image.

    Raises
    ------
    InputError
        If there is no such example.
    Cancelled
        If the monitor says so.
    """
    source = image_source(name)
    study = Study(source, options.study(options.meshers[0]))
    seconds = {method: _field_seconds(study, method) for method in COMPARED}
    jobs = [partial(_by_mesher, source, mesher, options, seconds) for mesher in options.meshers]
    return together(jobs, monitor)


def _field_seconds(study: Study, method: str) -> float:
    best = math.inf
    for _ in range(3):
        began = time.perf_counter()
        processed(study, method)
        best = min(best, time.perf_counter() - began)
    return best


def _by_mesher(
    source: Source, mesher: str, options: PaperOptions, seconds: dict[str, float], monitor: Monitor = SILENT
) -> ImageRun:
    methods, asked = options.methods(mesher), options.study(mesher)
    study = run(Study(source, asked), methods, SubMonitor(monitor, 0.0, 0.7))
    runs = {method: study.runs[method] for method in methods}
    runs[EQUAL_COUNT] = _equal_count(source, asked, runs, SubMonitor(monitor, 0.7, 1.0))
    return ImageRun(source, mesher, runs, seconds)


def _equal_count(source: Source, asked: StudyOptions, runs: dict[str, MethodRun], monitor: Monitor) -> MethodRun:
    limiting, preserving = runs["gradient-limiting"].report, runs["size-preserving"].report
    assert limiting is not None and preserving is not None
    scale = asked.mesh.scale * (limiting.n_quads / preserving.n_quads) ** 0.5
    finer = replace(asked, mesh=replace(asked.mesh, scale=scale))
    method = "gradient-limiting"
    begun = MethodRun(target=runs[method].target)
    return run(Study(source, finer, {method: begun}), (method,), monitor).runs[method]
