"""What leaves the window as a page or a film: written beside the window's thread, without its OpenGL."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from qtpy.QtWidgets import QFileDialog

from sizeviz.app.jobs import Job
from sizeviz.app.news import Notice
from sizeviz.errors import Cancelled, InputError
from sizeviz.progress_lines import ENVIRONMENT, parsed_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from sizeviz.app.window import MainWindow
    from sizeviz.monitor import Monitor
    from sizeviz.study.storage import StudyFile

TAKES = 24
"""How many α a film shows."""


def save_page(window: MainWindow, path: str | None = None) -> None:
    """Save the meshes of the panes as a page that opens in a browser; asks for the place if none is given."""
    from sizeviz.scene.page import save_page as save

    panes = [pane for pane in window.board.visible_panes if pane.subject.mesh is not None]
    if not panes:
        window.controller.noticed.emit(Notice("info", "There is no mesh to save yet"))
        return
    path = path or _ask(window, "Save an interactive page", "compare.html", "Pages (*.html)")
    if not path:
        return
    subjects = {pane.view.method: pane.subject for pane in panes}
    names = list(subjects)
    views = [pane.view.with_changes(method=str(names.index(pane.view.method))) for pane in panes]
    study, dark = window.controller.study, window.theme.dark
    title, measure = study.source.label if study is not None else "sizeviz", window.board.active.view.measure

    def work(monitor: Monitor) -> None:
        monitor.step(0.0, "writing the page")
        save(list(subjects.values()), path, panes=views, measure=measure, title=title, dark=dark)

    _submit(window, Path(path), work)


def save_film(window: MainWindow, path: str | None = None) -> None:
    """Save a film of the study's methods while α turns; asks for the place if none is given."""
    if window.controller.study is None:
        return
    path = path or _ask(window, "Save a film of a turning α", "alpha.mp4", "Films (*.mp4 *.gif)")
    if not path:
        return
    content, dark = window.files.content(), window.theme.dark
    target = Path(path).resolve()
    _submit(window, target, lambda monitor: _filmed(content, target, dark, monitor))


def _submit(window: MainWindow, path: Path, work: Callable[[Monitor], None]) -> None:
    """Hand the work to the window's worker, with its progress and its Cancel."""

    def done(_: object) -> None:
        window.controller.noticed.emit(Notice("info", f"Saved {path.name}"))

    window.controller.jobs.submit(Job(f"saving {path.name}", work, done))


def _filmed(content: StudyFile, path: Path, dark: bool, monitor: Monitor) -> None:
    """Let the command line make the film in a process of its own, for VTK belongs to the window's thread in this one.

    Raises
    ------
    InputError
        With the line that the command line said.
    Cancelled
        If the monitor says so; nothing is left.
    """
    from sizeviz.study.storage import StudyFile, write_study
    from sizeviz.study.study import Study

    monitor.step(0.0, "filming")
    with tempfile.TemporaryDirectory() as folder:
        bare = Study(content.study.source, content.study.options)  # every α is run anew
        study = write_study(Path(folder) / "study.sizeviz", StudyFile(bare))
        command = [sys.executable, "-m", "sizeviz", "film", str(study), "-o", str(path), "--takes", str(TAKES)]
        environment = {**os.environ, ENVIRONMENT: "1"}
        said = ""
        with subprocess.Popen(
            [*command, "--dark"] if dark else command,
            stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, env=environment,
        ) as child:  # fmt: skip
            assert child.stderr is not None
            try:
                for line in child.stderr:
                    step = parsed_line(line)
                    if step is not None:
                        monitor.step(*step)
                    elif line.strip():
                        said = line.strip().removeprefix("sizeviz: ")
            except Cancelled:
                child.terminate()
                raise
        if child.returncode:
            raise InputError(said or f"{path}: the film could not be made")


def _ask(window: MainWindow, title: str, name: str, kinds: str) -> str:
    path, _ = QFileDialog.getSaveFileName(window, title, name, kinds)
    return str(path)
