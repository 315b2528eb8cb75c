"""Films that leave the window: what they show is asked for once, and the command line makes them beside it."""

from __future__ import annotations

import os
import queue
import shutil
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from qtpy.QtWidgets import QDialog, QDialogButtonBox, QSpinBox, QVBoxLayout, QWidget

from sizeviz.app.jobs import Job
from sizeviz.app.news import Notice
from sizeviz.app.panels.controls import Form, choice, hint, number
from sizeviz.app.places import ask_place
from sizeviz.errors import InputError
from sizeviz.progress_lines import ENVIRONMENT, parsed_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from sizeviz.app.controller import Controller
    from sizeviz.monitor import Monitor
    from sizeviz.study.storage import StudyFile

PATIENCE = 1.0
"""Seconds that a film's process has to end by itself once it is cancelled."""

POLL = 0.05
"""Seconds between two looks at whether it is."""


@dataclass(frozen=True, kw_only=True)
class Turn:
    """What a film of a turning α shows.

    Parameters
    ----------
    first, last : float
        The α that it begins and ends with.
    takes : int
        How many there are.
    width : int
        Pixels across.
    """

    first: float = 1.0
    last: float = 6.0
    takes: int = 24
    width: int = 1280

    def as_typed(self) -> list[str]:
        """Return this as the command line takes it."""
        named = {"--first": self.first, "--last": self.last, "--takes": self.takes, "--width": self.width}
        return [word for name, value in named.items() for word in (name, f"{value:g}")]


class FilmDialog(QDialog):
    """Asks what a film of a turning α shows; nothing waits for the answer.

    Parameters
    ----------
    turn : Turn
        What it shows first.
    parent : QWidget, optional
        Owner.
    """

    def __init__(self, turn: Turn, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle("Film of a turning α")
        self.setMinimumWidth(380)
        self.first, self.last = number(turn.first, 0.1, 50.0, 2), number(turn.last, 0.1, 50.0, 2)
        self.takes = QSpinBox()
        self.takes.setRange(2, 200)
        self.takes.setValue(turn.takes)
        self.width_ = choice([(f"{width} pixels", width) for width in (640, 960, 1280, 1920)])
        self.width_.setCurrentIndex(max(self.width_.findData(turn.width), 0))
        form = Form()
        form.grid.setContentsMargins(0, 0, 0, 0)
        form.add("From α", self.first, "Elements over which no smaller size may lie, in the first take")
        form.add("To α", self.last, "The same in the last take")
        form.add("Takes", self.takes, "Each is a run of the whole pipeline")
        form.add("Width", self.width_, "Of the film; its height follows from the domain")
        self.words = hint()
        form.add_wide(self.words)
        buttons = QDialogButtonBox()
        buttons.addButton("Cancel", QDialogButtonBox.ButtonRole.RejectRole)
        save = buttons.addButton("Save…", QDialogButtonBox.ButtonRole.AcceptRole)
        save.setProperty("primary", True)
        save.setDefault(True)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setContentsMargins(22, 18, 22, 16)
        column.setSpacing(14)
        column.addWidget(form)
        column.addWidget(buttons)
        self.takes.valueChanged.connect(self._describe)
        self._describe()

    @property
    def turn(self) -> Turn:
        """What is asked for now."""
        return Turn(
            first=self.first.value(), last=self.last.value(), takes=self.takes.value(), width=self.width_.currentData()
        )

    def _describe(self) -> None:
        takes = self.takes.value()
        self.words.setText(
            f"{takes} runs of the pipeline, with ε = 1/α, and {takes / 4:g} s of film: R by gradient limiting beside "
            "size preserving, over the share of correct elements."
        )


def ask_film_place(parent: QWidget, title: str, stem: str) -> str:
    """Return where a film is to be saved, empty if nowhere; MP4 is offered first where it can be written."""
    mp4 = find_spec("imageio_ffmpeg") is not None
    kinds = "Films (*.mp4 *.gif)" if mp4 else "Films (*.gif)"
    return ask_place(parent, title, f"{stem}.{'mp4' if mp4 else 'gif'}", kinds)


def film_study(controller: Controller, content: StudyFile, path: Path, typed: list[str]) -> None:
    """Have a film made of the study's methods while α turns.

    Parameters
    ----------
    controller : Controller
        Whose worker does it, with progress and Cancel, and who tells how it went.
    content : StudyFile
        The study as it is.
    path : Path
        Where the film goes.
    typed : list of str
        Options of ``sizeviz film``.
    """

    def work(monitor: Monitor) -> None:
        from sizeviz.study.storage import StudyFile, write_study
        from sizeviz.study.study import Study

        bare = Study(content.study.source, content.study.options)  # every α is run anew
        with tempfile.TemporaryDirectory() as folder:
            study = write_study(Path(folder) / "study.sizeviz", StudyFile(bare))
            _filmed([str(study), *typed], path, monitor)

    _submit(controller, path, work)


def film_process(controller: Controller, folder: Path, path: Path, typed: list[str]) -> None:
    """Have a film made of an adaptive process, iteration by iteration; arguments as for ``film_study``."""
    _submit(controller, path, lambda monitor: _filmed([str(folder), *typed], path, monitor))


def _submit(controller: Controller, path: Path, work: Callable[[Monitor], None]) -> None:
    def done(_: object) -> None:
        controller.noticed.emit(Notice("info", f"Saved {path.name}"))

    controller.jobs.submit(Job(f"saving {path.name}", work, done))


def _filmed(arguments: list[str], path: Path, monitor: Monitor) -> None:
    """Let the command line make the film in a process of its own, for VTK belongs to the window's thread in this one.

    Raises
    ------
    InputError
        With the line that the command line said.
    Cancelled
        If the monitor says so; nothing is left.
    """
    from sizeviz.files import replacing, require_writable_file

    monitor.step(0.0, "filming")
    require_writable_file(path)
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / path.name
        command = [sys.executable, "-m", "sizeviz", "film", *arguments, "-o", str(made)]
        said = _carried_out(command, monitor)
        if said is not None:
            raise InputError(said.replace(str(made), str(path)) or f"{path}: the film could not be made")
        with replacing(path) as part:
            shutil.copyfile(made, part)


def _carried_out(command: list[str], monitor: Monitor) -> str | None:
    """Run a command of sizeviz, handing on its progress; return what it said if it failed, None if it did not."""
    environment = {**os.environ, ENVIRONMENT: "1"}
    lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
    said, state = "", (0.0, "filming")
    with subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, env=environment
    ) as child:
        threading.Thread(target=_listen, args=(child, lines), daemon=True).start()
        try:
            while True:
                monitor.step(*state)
                try:
                    line = lines.get(timeout=POLL)
                except queue.Empty:
                    continue
                if line is None:
                    break
                step = parsed_line(line)
                state = step or state
                if step is None and line.strip():
                    said = line.strip().removeprefix("sizeviz: ")
        except BaseException:
            _end(child)
            raise
    return said if child.returncode else None


def _listen(child: subprocess.Popen[str], lines: queue.SimpleQueue[str | None]) -> None:
    """Hand on what a process says, line by line, and None at its end: reading would hold up who asks for Cancel."""
    assert child.stderr is not None
    for line in child.stderr:
        lines.put(line)
    lines.put(None)


def _end(child: subprocess.Popen[str]) -> None:
    child.terminate()
    try:
        child.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        child.kill()
