"""``sizeviz paper``: every figure and table of the paper, made again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from cyclopts import Parameter

from sizeviz.cli.options import OutArgument
from sizeviz.cli.values import Whole

if TYPE_CHECKING:
    from pathlib import Path

    from sizeviz.monitor import Monitor
    from sizeviz.study.paper import PaperOptions

IMAGES: tuple[str, ...] = ("mri", "phantom")
"""Sources of Section 5.2; the first one's figures bear the paper's numbers."""


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Choices:
    """How the paper's examples are run.

    Parameters
    ----------
    mesh_scale
        Element size asked for, relative to the processed field; one for both methods and every mesher.
    iterations
        Most iterations of the adaptive processes; the paper has 50.
    threads
        Worker threads; every core by default. The results do not depend on it.
    """

    mesh_scale: float = 0.83
    iterations: Whole = 50
    threads: Whole | None = None


def paper(*, out: OutArgument, choices: Choices | None = None) -> None:
    """Run the paper's examples, and set our numbers beside the published ones.

    Writes figure-1 to figure-8 as .png and .svg, table-1 and table-2 as .csv and .tex, summary.md, and the adaptive
    processes' meshes, which a second run takes up.
    """
    from sizeviz.cli.session import prepared
    from sizeviz.cli.terminal import progress
    from sizeviz.files import output_folder
    from sizeviz.study.paper import PaperOptions

    choices = choices or Choices()
    options = PaperOptions(scale=choices.mesh_scale, iterations=choices.iterations, threads=choices.threads)
    with output_folder(out) as folder, progress() as monitor:
        _carried_out(options, folder, prepared(monitor))
    print(f"{out / 'summary.md'}: published and ours, side by side")


def _carried_out(options: PaperOptions, folder: Path, monitor: Monitor) -> None:
    from sizeviz.files import replacing
    from sizeviz.monitor import SubMonitor
    from sizeviz.scene.figures.paper import save_figures
    from sizeviz.study.paper import adaptations, image_runs, image_table, line_example, ring_table
    from sizeviz.study.paper.summary import summary

    line = line_example()
    ring = adaptations(options, folder, SubMonitor(monitor, 0.0, 0.6))
    ring_table(ring).write(folder)
    images = {}
    for k, name in enumerate(IMAGES):
        share = SubMonitor(monitor, 0.6 + 0.15 * k, 0.75 + 0.15 * k)
        images[name] = image_runs(name, options, share)
        image_table(images[name], "table-2" if k == 0 else f"table-2-{name}").write(folder)
    norms = save_figures(line, ring, images, folder, SubMonitor(monitor, 0.9, 1.0))
    with replacing(folder / "summary.md") as part:
        part.write_text(summary(options, line, ring, images, norms), encoding="utf-8")
    monitor.step(1.0)
