"""The adaptive process behind its player: run on the window's worker, meshes read from disk one at a time.

The worker writes each iteration to a folder. While it is at work, it also reads the meshes that the player asks for,
between two steps of its own work: there is one worker, and the window never waits for a file.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Protocol

from qtpy.QtCore import QObject, QTimer, Signal

from sizeviz.app.jobs import Failure, Job
from sizeviz.app.news import Notice
from sizeviz.errors import SizevizError

if TYPE_CHECKING:
    from collections.abc import Callable

    from sizeviz.app.controller import Controller
    from sizeviz.app.engine import Engine
    from sizeviz.monitor import Monitor
    from sizeviz.scene.subject import StoredSubject
    from sizeviz.sources import Source
    from sizeviz.study import StudyOptions
    from sizeviz.study.evolution import Evolution

KEPT_MESHES = 4
"""How many iterations' meshes stay in memory."""

POLL_MS = 150
"""How often news of a running process is looked for."""

EXAMPLE = "ring"
"""What is meshed where nothing is open: the paper's example."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What a person asks of the process.

    Parameters
    ----------
    method : str
        What is done to the sizes on each background.
    cells : int
        Elements along the longer side of the first mesh.
    limit : float
        Converged when no R against the given field is above this.
    iterations : int
        Give up after this many meshes.
    """

    method: str = "size-preserving"
    cells: int = 40
    limit: float = 1.1
    iterations: int = 12


@dataclass(frozen=True, eq=False)
class ProcessShown:
    """What the player shows.

    Parameters
    ----------
    evolution : Evolution, optional
        The iterations so far.
    number : int
        Which of them is on show, from 0.
    subject : StoredSubject, optional
        Its mesh with R, once it is read.
    running : bool
        Whether the process is at work.
    folder : Path, optional
        Where the iterations are kept.
    """

    evolution: Evolution | None = None
    number: int = 0
    subject: StoredSubject | None = None
    running: bool = False
    folder: Path | None = None

    @property
    def count(self) -> int:
        """How many iterations there are, the first mesh included."""
        return 0 if self.evolution is None else len(self.evolution.iterations)


class Desk:
    """Where player and worker leave each other requests and meshes; every method may be called from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._wanted: Callable[[], tuple[int, StoredSubject]] | None = None
        self._ready: list[tuple[int, StoredSubject]] = []

    def want(self, read: Callable[[], tuple[int, StoredSubject]] | None) -> None:
        """Ask for a mesh; only the latest request counts."""
        with self._lock:
            self._wanted = read

    def serve(self) -> None:
        """Read what is wanted, if anything is; for the worker."""
        with self._lock:
            read, self._wanted = self._wanted, None
        if read is not None:
            found = read()
            with self._lock:
                self._ready.append(found)

    def take(self) -> list[tuple[int, StoredSubject]]:
        """Return the meshes read since the last call."""
        with self._lock:
            ready, self._ready = self._ready, []
        return ready


class ServingMonitor:
    """A monitor that serves a desk between two steps."""

    def __init__(self, monitor: Monitor, desk: Desk) -> None:
        self._monitor, self._desk = monitor, desk

    def step(self, fraction: float, message: str = "") -> None:
        """Pass the step on, then read what the player waits for."""
        self._monitor.step(fraction, message)
        self._desk.serve()


class Runner(Protocol):
    """What runs a process on the worker."""

    def __call__(
        self, engine: Engine, source: Source | None, options: StudyOptions, asked: Asked, folder: Path, monitor: Monitor
    ) -> None:
        """Run it into a folder."""


def run_process(
    engine: Engine, source: Source | None, options: StudyOptions, asked: Asked, folder: Path, monitor: Monitor
) -> None:
    """Run Algorithm 3 as ``sizeviz adapt`` does, in plain mode; without a source on the paper's ring."""
    source = source or engine.load(EXAMPLE, monitor)
    from sizeviz.compiled import prepared

    rest = prepared(monitor)
    from sizeviz.study.adaptive import AdaptOptions, adapted

    wanted = AdaptOptions(
        method=asked.method, study=options, cells=asked.cells, limit=asked.limit, iterations=asked.iterations
    )
    adapted(source, wanted, folder, rest)


def read_iteration(folder: Path, evolution: Evolution, number: int) -> tuple[int, StoredSubject]:
    """Return an iteration's mesh with the R that was stored beside it.

    Raises
    ------
    InputError
        If the file is gone or holds no R.
    """
    from sizeviz.errors import InputError
    from sizeviz.files import read_mesh
    from sizeviz.scene.subject import StoredSubject

    row = evolution.iterations[number]
    content = read_mesh(folder / row.mesh)
    if "ratio" not in content.cell_data:
        raise InputError(f"{folder / row.mesh}: holds no array 'ratio'; choose a folder that sizeviz adapt wrote")
    title = "Uniform mesh" if number == 0 else f"Iteration {number}"
    detail = f"{content.mesh.n_quads:,} elements"
    return number, StoredSubject(title=title, detail=detail, mesh=content.mesh, ratio=content.cell_data["ratio"])


class ProcessController(QObject):
    """Runs, opens and plays adaptive processes. It knows no widget.

    Parameters
    ----------
    controller : Controller
        Whose worker and study are used.
    run : callable
        What runs a process; tests bring their own.
    parent : QObject, optional
        Owner.

    Signals
    -------
    changed(ProcessShown)
        What there is to show now.
    """

    changed = Signal(object)

    def __init__(self, controller: Controller, run: Runner = run_process, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._controller, self._run = controller, run
        self.shown = ProcessShown()
        self._desk = Desk()
        self._job: Job | None = None
        self._following = True
        self._kept: OrderedDict[int, StoredSubject] = OrderedDict()
        self._temporary: TemporaryDirectory[str] | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(POLL_MS)
        self._timer.timeout.connect(self._look)
        controller.jobs.completed.connect(lambda job: self._ended(job))
        controller.jobs.cancelled.connect(lambda job: self._ended(job))
        controller.jobs.failed.connect(self._failed)

    # -- intents ---------------------------------------------------------------------------------------------------

    def start(self, asked: Asked, folder: Path | None = None) -> None:
        """Run the process, into a folder or, without one, a temporary one; the same process there is continued."""
        controller = self._controller
        if controller.jobs.is_busy:
            controller.noticed.emit(Notice("info", "A run is under way; wait for it or cancel it first"))
            return
        study = controller.study
        source = None if study is None else study.source
        options = controller.engine.default_options() if study is None else study.options
        into = folder or self._fresh_folder()
        self._desk, self._following = Desk(), True
        self._kept.clear()
        desk, engine, run = self._desk, controller.engine, self._run

        def work(monitor: Monitor) -> None:
            run(engine, source, options, asked, into, ServingMonitor(monitor, desk))

        self._job = Job("adaptive process", work, lambda nothing: None)
        self._tell(ProcessShown(running=True, folder=into))
        self._timer.start()
        controller.jobs.submit(self._job)

    def cancel(self) -> None:
        """Stop the process; finished iterations stay."""
        if self.shown.running:
            self._controller.jobs.cancel()

    def open(self, folder: Path) -> bool:
        """Open what ``sizeviz adapt`` wrote; return whether there was such a thing."""
        evolution = self._record(folder)
        if evolution is None or not evolution.iterations:
            return False
        self._kept.clear()
        self._following = False
        self._tell(ProcessShown(evolution, 0, None, False, folder))
        self.show_iteration(len(evolution.iterations) - 1)
        return True

    def show_iteration(self, number: int) -> None:
        """Show another iteration; its mesh follows when it is read."""
        shown = self.shown
        if shown.evolution is None or not shown.count:
            return
        number = min(max(number, 0), shown.count - 1)
        self._following = number == shown.count - 1
        subject = self._kept.get(number)
        self._tell(replace(shown, number=number, subject=subject or shown.subject))
        if subject is None:
            self._read(number)

    def close(self) -> None:
        """Remove what was only kept for the time being."""
        self._timer.stop()
        if self._temporary is not None:
            self._temporary.cleanup()

    # -- inside ----------------------------------------------------------------------------------------------------

    def _read(self, number: int) -> None:
        shown = self.shown
        assert shown.evolution is not None and shown.folder is not None
        evolution, folder = shown.evolution, shown.folder

        def read() -> tuple[int, StoredSubject]:
            return read_iteration(folder, evolution, number)

        def arrived(found: tuple[int, StoredSubject]) -> None:
            if self.shown.folder == folder:
                self._keep(*found)

        if shown.running:
            self._desk.want(read)
        else:
            self._controller.jobs.submit(Job(f"reading iteration {number}", lambda monitor: read(), arrived))

    def _keep(self, number: int, subject: StoredSubject) -> None:
        self._kept[number] = subject
        self._kept.move_to_end(number)
        while len(self._kept) > KEPT_MESHES:
            self._kept.popitem(last=False)
        if number == self.shown.number:
            self._tell(replace(self.shown, subject=subject))

    def _look(self) -> None:
        """Look for iterations that were finished, and meshes that were read."""
        for number, subject in self._desk.take():
            self._keep(number, subject)
        folder = self.shown.folder
        evolution = None if folder is None else self._record(folder)
        if evolution is not None and len(evolution.iterations) > self.shown.count:
            self._tell(replace(self.shown, evolution=evolution))
            if self._following:
                self.show_iteration(len(evolution.iterations) - 1)

    def _ended(self, job: Job) -> None:
        if job is not self._job:
            return
        self._job = None
        self._timer.stop()
        self._desk.want(None)
        self._look()
        self._tell(replace(self.shown, running=False))
        if self.shown.count and self.shown.number not in self._kept:
            self._read(self.shown.number)

    def _failed(self, job: Job, failure: Failure) -> None:
        self._ended(job)

    def _record(self, folder: Path) -> Evolution | None:
        from sizeviz.study.evolution import read_evolution

        try:
            return read_evolution(folder)
        except SizevizError as error:
            self._controller.noticed.emit(Notice("error", str(error)))
            return None

    def _fresh_folder(self) -> Path:
        if self._temporary is not None:
            self._temporary.cleanup()
        self._temporary = TemporaryDirectory(prefix="sizeviz-")
        return Path(self._temporary.name)

    def _tell(self, shown: ProcessShown) -> None:
        self.shown = shown
        self.changed.emit(shown)
