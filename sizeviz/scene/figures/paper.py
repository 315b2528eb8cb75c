"""Every figure of the paper into one folder."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from sizeviz.monitor import SILENT, Monitor
from sizeviz.scene.figures.line import save_line_figures
from sizeviz.scene.figures.meshes import (
    error_norms,
    image_scales,
    save_adaptation,
    save_image_and_size,
    save_image_run,
)
from sizeviz.study import COMPARED

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from sizeviz.study.paper import Adaptation, ImageRun, LineExample
    from sizeviz.study.paper.summary import Norms

    Job = Callable[[], None]


def save_figures(
    line: LineExample,
    ring: Sequence[Adaptation],
    images: Mapping[str, Sequence[ImageRun]],
    folder: Path,
    monitor: Monitor = SILENT,
) -> Norms:
    """Write Figures 1 to 8 as PNG and SVG, and return the interpolation errors that two of them show.

    Figures 4, 5, 7 and 8 exist once for each mesher: the first one's bear the paper's numbers alone, the others' the
    mesher's name too. The first image's figures bear the paper's numbers, those of others their source's name too.

    Raises
    ------
    Cancelled
        If the monitor says so; figures that are finished stay.
    """
    norms: Norms = {}
    jobs: list[Job] = [partial(save_line_figures, line, folder), *_adaptation_jobs(ring, folder)]
    for k, (source, found) in enumerate(images.items()):
        jobs += _image_jobs(found, folder, "" if k == 0 else f"-{source}")
        norms |= {
            (source, one.mesher, name): error_norms(one.source, run) for one in found for name, run in one.runs.items()
        }
    for done, job in enumerate(jobs):
        monitor.step(done / len(jobs), "drawing figures")
        job()
    monitor.step(1.0)
    return norms


def _adaptation_jobs(ring: Sequence[Adaptation], folder: Path) -> list[Job]:
    jobs: list[Job] = []
    for number, method in enumerate(COMPARED, 4):
        chosen = [one for one in ring if one.method == method]
        for one in chosen:
            ordered = [one, *(other for other in chosen if other is not one)]
            name = f"figure-{number}" + ("" if one is chosen[0] else f"-{one.mesher}")
            jobs.append(partial(save_adaptation, ordered, method, folder, name))
    return jobs


def _image_jobs(found: Sequence[ImageRun], folder: Path, ending: str) -> list[Job]:
    jobs: list[Job] = [partial(save_image_and_size, found[0].source, folder, f"figure-6{ending}")]
    scales = image_scales(found, COMPARED)
    for one in found:
        for number, method in enumerate(COMPARED, 7):
            name = f"figure-{number}{ending}" + ("" if one is found[0] else f"-{one.mesher}")
            jobs.append(partial(save_image_run, one, method, scales, folder, name))
    return jobs
