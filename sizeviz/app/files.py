"""Study files in the window: open, save, autosave, recover. Reading and writing happen beside the window's thread."""

from __future__ import annotations

import logging
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import ref

from qtpy.QtCore import QObject, QTimer, Signal

from sizeviz.app.inspect.locate import ElementLocator
from sizeviz.app.jobs import Failure, Job, JobRunner
from sizeviz.app.news import Notice
from sizeviz.errors import SizevizError

if TYPE_CHECKING:
    from collections.abc import Callable

    from sizeviz.app.controller import Controller
    from sizeviz.geometry import QuadMesh
    from sizeviz.monitor import Monitor
    from sizeviz.sources import Source
    from sizeviz.study import Study, StudyOptions
    from sizeviz.study.storage import StudyFile
    from sizeviz.study.storage.autosave import Autosave, Leftover

AUTOSAVE_MS = 3000
"""How long after a change the study is autosaved; further changes meanwhile do not put it off."""

AUTOSAVING = "autosave"
"""Title of the jobs that autosave."""

LOG = logging.getLogger(__name__)


class StudyFiles(QObject):
    """Keeps the study on disk.

    Parameters
    ----------
    controller : Controller
        Whose study it is.
    folder : Path
        Where autosaves are kept; made when it is first needed.
    view : callable
        Returns how the study is looked at now, as plain values.
    parent : QObject, optional
        Owner.

    Signals
    -------
    view_restored(dict)
        A study was opened that was looked at like this.
    state_changed()
        The file's name, or whether there are unsaved changes, is another.
    """

    view_restored = Signal(object)
    state_changed = Signal()

    def __init__(
        self,
        controller: Controller,
        folder: Path,
        view: Callable[[], dict[str, Any]],
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self.path: Path | None = None
        self._controller, self._folder, self._view = controller, folder, view
        self._base: tuple[Source, StudyOptions] | None = None  # what is on disk, or was opened
        self._kept: Callable[[], Study | None] = lambda: None  # what the autosave holds, while anybody else holds it
        self._autosave: Autosave | None = None
        self._complained = False
        self._stamp: tuple[int, ...] | None = None  # of the file, when it was last read or written here
        self._saving = JobRunner(self)
        self._saving.failed.connect(self._on_failed)
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(AUTOSAVE_MS)
        self._timer.timeout.connect(self.autosave)
        controller.store.changed.connect(self._on_changed)
        controller.opened.connect(self._on_opened)
        controller.study_file_requested.connect(self.open)

    @property
    def is_modified(self) -> bool:
        """Whether there is something to lose."""
        study, base = self._controller.study, self._base
        if study is None:
            return False
        return base is None or study.source is not base[0] or study.options != base[1]

    @property
    def source_path(self) -> Path | None:
        """The study file that holds the sizes as they are now, None where none does."""
        study, base = self._controller.study, self._base
        same = study is not None and base is not None and study.source is base[0]
        return self.path if same else None

    # -- opening ---------------------------------------------------------------------------------------------------

    def open(self, path: str) -> None:
        """Open a study file; the study that was there can be returned to by undo."""
        from sizeviz.study.storage import read_study

        stamp = stamp_of(Path(path))

        def done(content: StudyFile) -> None:
            self._take(content, f"Open {Path(path).name}")
            self.path, self._base, self._stamp = Path(path), _without_results(self._controller.study), stamp
            self._controller.opened.emit(path)

        self._read(f"opening {path}", lambda: read_study(path), done)

    def recover(self, leftover: Leftover) -> None:
        """Open what a program left that did not end well, or ended with unsaved changes."""

        def done(content: StudyFile) -> None:
            self._take(content, "Recover an unsaved study")
            self.path = None if content.origin is None else Path(content.origin)
            self._base = None
            if self._keep(self.content()):  # only then may the old one go
                leftover.remove()
            self.state_changed.emit()

        self._read("recovering a study", leftover.read, done)

    def leftovers(self) -> list[Leftover]:
        """Return the studies that can be recovered, the newest first."""
        if not any(self._folder.glob("*.sizeviz")):
            return []  # the usual case, found out without loading anything
        from sizeviz.study.storage.autosave import leftovers

        try:
            return leftovers(self._folder)
        except SizevizError as error:
            LOG.warning("%s", error)
            return []

    # -- saving ----------------------------------------------------------------------------------------------------

    def content(self) -> StudyFile:
        """Return what a file of the study as it is now holds."""
        from sizeviz.study.storage import StudyFile

        study = self._controller.study
        assert study is not None
        painted = self._controller.painting.painted(study.source)
        original = painted.original if painted.strokes else None
        origin = None if self.path is None else str(self.path)
        return StudyFile(study, painted.strokes, original, self._view(), origin)

    def save(self, path: str | Path) -> None:
        """Save the study; a notice says how it went."""
        from sizeviz.study.storage import SUFFIX, write_study

        if self._controller.study is None:
            return
        path = Path(path)
        if path.suffix.lower() != SUFFIX:
            path = path.with_name(path.name + SUFFIX)
        if path == self.path and self._changed_elsewhere(path):
            words = (
                f"{path.name} was changed by another program since it was opened here: save again to replace it, or "
            )
            self._controller.noticed.emit(Notice("warning", f"{words}save under another name to keep both"))
            return
        content = self.content()

        def done(_: object) -> None:
            self.path, self._base, self._stamp = path, _without_results(content.study), stamp_of(path)
            if not self.is_modified and self._autosave is not None:
                self._autosave.discard()
                self._kept = lambda: None
            self._controller.noticed.emit(Notice("info", f"Saved {path.name}"))
            self.state_changed.emit()

        self._saving.submit(Job(f"saving {path.name}", lambda monitor: write_study(path, content), done))

    def autosave(self) -> None:
        """Keep a copy of what would be lost, beside the window's thread."""
        if not self.is_modified or self._controller.study is self._kept():
            return
        if self._saving.is_busy or self._controller.painting.stroke is not None:
            self._timer.start()
            return
        content = self.content()
        self._saving.submit(Job(AUTOSAVING, lambda monitor: self._write(content), lambda _: self._wrote(content)))

    def close(self) -> None:
        """Leave unsaved changes behind for the next time, and nothing where there are none; never ask."""
        self._timer.stop()
        self._saving.shut_down(60_000)
        if self.is_modified and self._controller.study is not self._kept():
            self._keep(self.content())
        if self._autosave is not None:
            if self.is_modified:
                self._autosave.leave()
            else:
                self._autosave.close()
            self._autosave = None

    # -- inside ----------------------------------------------------------------------------------------------------

    def _read(self, title: str, read: Callable[[], StudyFile], done: Callable[[StudyFile], None]) -> None:
        def work(monitor: Monitor) -> tuple[StudyFile, list[tuple[QuadMesh, ElementLocator]]]:
            monitor.step(0.0, title)
            content = read()
            meshes = [run.mesh for run in content.study.runs.values() if run.mesh is not None]
            return content, [(mesh, ElementLocator(mesh)) for mesh in meshes]

        def then(answer: tuple[StudyFile, list[tuple[QuadMesh, ElementLocator]]]) -> None:
            content, locators = answer
            self._controller.know(locators)
            done(content)

        self._controller.jobs.submit(Job(title, work, then))

    def _changed_elsewhere(self, path: Path) -> bool:
        """Return whether another program wrote the file; the second time it is known, and may be replaced."""
        before, self._stamp = self._stamp, stamp_of(path)
        return before is not None and self._stamp is not None and before != self._stamp

    def _take(self, content: StudyFile, words: str) -> None:
        self._controller.set_study(content.study, content.strokes, content.original, words)
        self.view_restored.emit(dict(content.view))

    def _write(self, content: StudyFile) -> None:
        from sizeviz.study.storage.autosave import Autosave

        if self._autosave is None:
            self._autosave = Autosave(self._folder)
        self._autosave.save(content, content.origin)

    def _wrote(self, content: StudyFile) -> None:
        self._kept, self._complained = ref(content.study), False

    def _keep(self, content: StudyFile) -> bool:
        """Autosave here and now; return whether that worked."""
        try:
            self._write(content)
        except Exception as error:  # a window that closes must close
            LOG.exception("autosave: %s", error)
            return False
        self._wrote(content)
        return True

    def _on_changed(self, old: Study | None, new: Study) -> None:
        if old is None:
            self._base = _without_results(new)
        if self.is_modified and not self._timer.isActive():
            self._timer.start()
        self.state_changed.emit()

    def _on_opened(self, spec: str) -> None:
        """Something was opened: until it is changed there is nothing to lose."""
        self._base = _without_results(self._controller.study)
        if not spec.endswith(".sizeviz"):
            self.path = None
        self.state_changed.emit()

    def _on_failed(self, job: Job, failure: Failure) -> None:
        quiet = job.title == AUTOSAVING and self._complained
        self._complained = self._complained or job.title == AUTOSAVING
        if not quiet:  # a disk stays full for a while: once is enough
            words = f"Autosave: {failure.message}" if job.title == AUTOSAVING else failure.message
            self._controller.noticed.emit(Notice("error", words, f"{job.title}\n\n{failure.details}"))


def _without_results(study: Study | None) -> tuple[Source, StudyOptions] | None:
    """Return what a file of a study is compared by; its meshes need not be held for that."""
    return None if study is None else (study.source, study.options)


def stamp_of(path: Path) -> tuple[int, ...] | None:
    """Return what changes when a file is written, None where there is no file."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


def age_words(modified: float) -> str:
    """Return when something was written, in words: the time of today, else the date."""
    then, now = time.localtime(modified), time.localtime()
    return time.strftime("%H:%M" if then[:3] == now[:3] else "%d %B, %H:%M", then)
