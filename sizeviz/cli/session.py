"""What ``run`` and ``compare`` share: load, prepare, run, write, picture, table."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from sizeviz.cli.options import loaded, study_options
from sizeviz.cli.tables import print_report
from sizeviz.cli.terminal import notice, on_terminal, progress, warn_about_beta
from sizeviz.compiled import are_compiled
from sizeviz.compiled import prepared as compiled_first
from sizeviz.errors import MissingDependencyError
from sizeviz.files import output_folder, replacing, write_mesh
from sizeviz.study import Study, run
from sizeviz.study.report import mesh_arrays, report_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from sizeviz.cli.options import PipelineOptions
    from sizeviz.monitor import Monitor


def carried_out(
    source: str, out: Path, options: PipelineOptions, methods: Sequence[str], *, comparison: bool
) -> dict[str, Any]:
    """Run some methods on a source and write everything that came of it.

    Parameters
    ----------
    source : str
        As typed.
    out : Path
        Folder for the results.
    options : PipelineOptions
        As typed.
    methods : sequence of str
        Which to run.
    comparison : bool
        Whether the methods are to be shown on one sheet, each with a file of its own.

    Returns
    -------
    dict
        The report, as written.

    Raises
    ------
    InputError, MeshingError, MissingDependencyError
        Before anything was written that is not whole.
    """
    from sizeviz.scene.opengl import probe

    asked = study_options(options, comparable=comparison)
    with output_folder(out) as folder, ThreadPoolExecutor(1) as aside:
        study = Study(loaded(source, options), asked)
        warn_about_beta(options.beta)
        drawable = aside.submit(probe)
        with progress() as monitor:
            study = run(study, methods, prepared(monitor))
            monitor.step(1.0, "writing")
            for method in methods:
                name = f"mesh-{method}.vtu" if comparison else "mesh.vtu"
                write_mesh(folder / name, *mesh_arrays(study, method, options.measure))
            report = report_of(study, methods, options.measure)
            with replacing(folder / "report.json") as part:
                part.write_text(json.dumps(report, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
            problem = drawable.result()
            if problem is None:
                _picture(study, folder, methods, options, comparison)
    print_report(report)
    if problem is not None:
        raise MissingDependencyError(f"meshes and report are written, but not the picture: {problem}")
    return report


def prepared(monitor: Monitor) -> Monitor:
    """Compile the kernels if this machine has not yet, and say so; return what is left of the monitor."""
    if not are_compiled() and not on_terminal():
        notice("compiling the kernels, once on this machine; this takes up to a minute")
    return compiled_first(monitor)


def _picture(study: Study, folder: Path, methods: Sequence[str], options: PipelineOptions, comparison: bool) -> None:
    from sizeviz.scene import save_comparison, save_picture

    if comparison:
        save_comparison(study, folder / "compare.png", methods=methods, measure=options.measure)
    else:
        save_picture(study, folder / "picture.png", method=methods[0], measure=options.measure)
