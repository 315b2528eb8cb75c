"""Section 5.2: sizes from the curvature of an image, by both methods and every mesher."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sources import load
from sizeviz.study.paper.together import together
from sizeviz.study.pipeline import COMPARED, processed, run
from sizeviz.study.study import MethodRun, Study

if TYPE_CHECKING:
    from sizeviz.sources import Source
    from sizeviz.study.options import StudyOptions
    from sizeviz.study.paper.options import PaperOptions

EQUAL_COUNT = "gradient-limiting, equal count"
"""Gradient limiting once more, at the mesh scale that gives it as many elements as size preserving has."""


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
        By method; and gradient limiting at equal count under ``EQUAL_COUNT``.
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
    source = load(name)
    alone = replace(options.study(options.meshers[0]), threads=options.threads)
    seconds = {method: _field_seconds(Study(source, alone), method) for method in COMPARED}
    jobs = [partial(_by_mesher, source, mesher, options.study(mesher), seconds) for mesher in options.meshers]
    return together(jobs, monitor)


def _field_seconds(study: Study, method: str) -> float:
    best = math.inf
    for _ in range(3):
        began = time.perf_counter()
        processed(study, method)
        best = min(best, time.perf_counter() - began)
    return best


def _by_mesher(
    source: Source, mesher: str, asked: StudyOptions, seconds: dict[str, float], monitor: Monitor = SILENT
) -> ImageRun:
    study = run(Study(source, asked), COMPARED, SubMonitor(monitor, 0.0, 0.6))
    runs = {method: study.runs[method] for method in COMPARED}
    runs[EQUAL_COUNT] = _equal_count(source, asked, runs, SubMonitor(monitor, 0.6, 1.0))
    return ImageRun(source, mesher, runs, seconds)


def _equal_count(source: Source, asked: StudyOptions, runs: dict[str, MethodRun], monitor: Monitor) -> MethodRun:
    limiting, preserving = runs["gradient-limiting"].report, runs["size-preserving"].report
    assert limiting is not None and preserving is not None
    scale = asked.mesh.scale * (limiting.n_quads / preserving.n_quads) ** 0.5
    finer = replace(asked, mesh=replace(asked.mesh, scale=scale))
    method = "gradient-limiting"
    begun = MethodRun(target=runs[method].target)
    return run(Study(source, finer, {method: begun}), (method,), monitor).runs[method]
