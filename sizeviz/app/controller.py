"""Where intents go: the one place that changes the study, starts work and decides what is stale.

Widgets emit intents and show what they are told; this class holds no widget and needs no OpenGL.
"""

from __future__ import annotations

import logging
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from qtpy.QtCore import QObject, Signal

from sizeviz.app.brush.live import Painted
from sizeviz.app.brush.painting import PREVIEW, Painting
from sizeviz.app.engine import LIMITED, PRESERVED
from sizeviz.app.inspect.locate import ElementLocator
from sizeviz.app.jobs import Failure, Job, JobRunner
from sizeviz.app.news import Displayed, Notice
from sizeviz.app.pace import Pace
from sizeviz.app.store import StudyStore
from sizeviz.errors import SizevizError
from sizeviz.scene.subject import METHOD_TITLES, Subject, subject_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sizeviz.app.engine import Engine
    from sizeviz.geometry import QuadMesh
    from sizeviz.sizing import SizeField
    from sizeviz.sources import Source
    from sizeviz.sources.painting import Stroke
    from sizeviz.study import Study, StudyOptions

AUTO_SECONDS = 3.0
"""Studies whose next run should take no longer than this are run again by themselves after every change."""

MERGE_SECONDS = 1.5
"""Changes of one control that follow each other faster than this are one undo step."""

LOG = logging.getLogger(__name__)


class Controller(QObject):
    """Turns intents into studies.

    Parameters
    ----------
    engine : Engine
        The pipeline.
    parent : QObject, optional
        Owner.

    Signals
    -------
    study_changed(Study or None, Study)
        The study was replaced; old and new.
    progressed(float, str, float)
        Overall fraction, words, seconds left (negative while unknown).
    busy_changed(bool)
        Work began or ended.
    noticed(Notice)
        Something to tell.
    refused()
        A value cannot be; whoever shows it shows the study's again.
    opened(str)
        A source was opened, by what name it can be opened again.
    study_file_requested(str)
        A whole study is to be opened, not a source.
    settled()
        Every wanted method of the current study is complete.
    """

    study_changed = Signal(object, object)
    progressed = Signal(float, str, float)
    busy_changed = Signal(bool)
    noticed = Signal(object)
    refused = Signal()
    opened = Signal(str)
    study_file_requested = Signal(str)
    settled = Signal()

    def __init__(self, engine: Engine, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.engine = engine
        self.store = StudyStore(self)
        self.jobs = JobRunner(self)
        self.wanted: tuple[str, ...] = ("gradient-limiting", "size-preserving")
        self.automatic = True
        self.painting = Painting(engine, self.store, self.jobs, self)
        self.painting.lifted.connect(self._after_stroke)
        self._last_good: dict[str, Subject] = {}
        self._locators: WeakKeyDictionary[QuadMesh, ElementLocator] = WeakKeyDictionary()
        self._last_edit = ("", 0.0, 0)
        self._pace = Pace()
        self._batch = 0
        self.store.changed.connect(self._on_changed)
        self.jobs.started.connect(lambda job: self.busy_changed.emit(self.is_running))
        self.jobs.idle.connect(lambda: self.busy_changed.emit(False))
        self.jobs.failed.connect(self._on_failed)
        self.jobs.progressed.connect(self._on_progress)

    # -- what there is ---------------------------------------------------------------------------------------------

    @property
    def study(self) -> Study | None:
        """The current study."""
        return self.store.study

    @property
    def is_running(self) -> bool:
        """Whether work is under way that a person waits for; the brush's previews are not."""
        job = self.jobs.running
        return job is not None and job.title != PREVIEW

    def displayed(self, method: str) -> Displayed:
        """Return what to show of a method now, the brush's preview included."""
        study = self.study
        if study is None:
            return Displayed(Subject(), stale=False)
        subject = subject_of(study, method)
        last = self._last_good.get(method)
        stale, older = False, None
        if subject.report is None and last is not None and last.domain is subject.domain:
            stale, older = True, self.painting.carried(study).get(method, last.target)
            subject = replace(subject, mesh=last.mesh, report=last.report, detail=last.detail)
        preview = self.painting.preview
        if preview is None:
            target = subject.target or self.painting.processed(study).get(method)
            return Displayed(replace(subject, target=target or older), stale, target is None and older is not None)
        follows = method in preview.targets or (preview.is_live and method in (LIMITED, PRESERVED))
        target = preview.targets.get(method, subject.target or older)
        subject = replace(subject, prescribed=preview.field, target=target)
        return Displayed(subject, subject.mesh is not None, target is not None and not follows)

    def missing(self) -> tuple[str, ...]:
        """Return the wanted methods that the current study has no complete run of."""
        study = self.study
        if study is None:
            return ()
        done = {name for name, run in study.runs.items() if run.is_complete}
        return tuple(name for name in self.wanted if name not in done)

    def locator(self, mesh: QuadMesh) -> ElementLocator:
        """Return what finds a mesh's element at a point; the worker has usually built it already."""
        if mesh not in self._locators:
            self._locators[mesh] = ElementLocator(mesh)
        return self._locators[mesh]

    def know(self, locators: Sequence[tuple[QuadMesh, ElementLocator]]) -> None:
        """Take locators that a worker has built."""
        self._locators.update(locators)

    def is_cheap(self) -> bool:
        """Return whether a change may start a run by itself."""
        study = self.study
        return self.automatic and (study is None or self._pace.seconds_for(study) <= AUTO_SECONDS)

    # -- intents: sources and options ------------------------------------------------------------------------------

    def open_source(self, spec: str) -> None:
        """Open an example, a file or a formula, then run it; or a study file."""
        if spec.lower().endswith(".sizeviz"):
            self.study_file_requested.emit(spec)
            return

        def opened(source: Source) -> None:
            self.set_source(source, f"Open {source.label}")
            self.opened.emit(spec)

        self.jobs.submit(Job(f"opening {spec}", lambda monitor: self.engine.load(spec, monitor), opened))

    def open_canvas(self, nodes: int, size: float) -> None:
        """Start from a blank canvas."""
        self._guarded(lambda: self.set_source(self.engine.canvas(nodes, size), "Blank canvas"))

    def set_source(self, source: Source, words: str) -> None:
        """Study another source with the same options; it is run at once."""
        from sizeviz.study import Study

        study = self.study
        self._pace = Pace()
        options = self.engine.default_options() if study is None else study.options
        self.store.commit(Study(source, options), words)
        self.apply()

    def set_study(self, study: Study, strokes: Sequence[Stroke], original: SizeField | None, words: str) -> None:
        """Show a whole study, with what was painted and what it results in; only what it lacks is run."""
        self.painting.remember(study.source, Painted(original or study.source.field, tuple(strokes)))
        self._pace = Pace()
        for name, run in study.runs.items():
            if run.is_complete:
                self._pace.note(study, name)
        self.store.commit(study, words)
        self.apply()
        if not self.missing():
            self.settled.emit()

    def set_options(self, options: StudyOptions, words: str, key: str = "") -> None:
        """Ask for something else of the pipeline; results that it changes become stale."""
        study = self.study
        if study is None or options == study.options:
            return
        self.store.commit(study.with_options(options), words, self._merge_key(key))
        self._after_edit()

    def change(self, make: Callable[[StudyOptions], StudyOptions], words: str, key: str = "") -> None:
        """Change the options by a function; values that cannot be are answered by a notice."""
        study = self.study
        if study is not None:
            current = study.options
            self._guarded(lambda: self.set_options(make(current), words, key))

    def set_wanted(self, methods: tuple[str, ...]) -> None:
        """Say which methods the panes need; one that is asked for by name is run, however long that takes."""
        if methods == self.wanted:
            return
        before = self.missing()
        self.wanted = methods
        if self.automatic and not before and self.missing():
            self.apply()
        else:
            self._after_edit()

    def apply(self) -> None:
        """Run whatever is missing, however long it takes."""
        missing = self.missing()
        self._batch = len(missing)
        if missing:
            self._run_next(missing[0])

    def cancel(self) -> None:
        """Stop the work under way; what was there stays."""
        self.jobs.cancel()

    def undo(self) -> None:
        """Go one step back."""
        self.painting.abort()
        self.store.stack.undo()
        self._after_edit()

    def redo(self) -> None:
        """Go one step forward again."""
        self.painting.abort()
        self.store.stack.redo()
        self._after_edit()

    # -- inside ----------------------------------------------------------------------------------------------------

    def _run_next(self, method: str) -> None:
        study = self.study
        assert study is not None

        def work(monitor: Any) -> tuple[Study, ElementLocator | None]:
            result = self.engine.run(study, method, monitor)
            mesh = result.runs[method].mesh
            return result, None if mesh is None else ElementLocator(mesh)

        def then(answer: tuple[Study, ElementLocator | None]) -> None:
            result, locator = answer
            if self.study is not study:
                return  # its inputs are no longer the study's
            run = result.runs[method]
            if run.mesh is not None and locator is not None:
                self._locators[run.mesh] = locator
            self._pace.note(result, method)
            self.store.amend(result)
            missing = self.missing()
            if missing:
                self._run_next(missing[0])
            else:
                self.settled.emit()

        self.jobs.submit(Job(METHOD_TITLES.get(method, method), work, then))

    def _after_edit(self) -> None:
        """Run what a change made stale if that is cheap; otherwise stop work on what nobody wants any more."""
        if not self.missing():
            self.jobs.cancel()
            return
        if self.is_cheap():
            self.apply()
        else:
            self.jobs.cancel()

    def _after_stroke(self) -> None:
        """Where no run follows a stroke by itself, its processed fields do all the same."""
        self._after_edit()
        if self.missing() and not self.is_cheap():
            self.painting.process()

    def _merge_key(self, key: str) -> str:
        if not key:
            return ""
        last, when, gesture = self._last_edit
        now = time.monotonic()
        if key != last or now - when > MERGE_SECONDS:
            gesture += 1
        self._last_edit = (key, now, gesture)
        return f"{key}#{gesture}"

    def _guarded(self, call: Callable[[], object]) -> None:
        try:
            call()
        except SizevizError as error:
            self.noticed.emit(Notice("error", str(error)))
            self.refused.emit()

    def _on_changed(self, old: Study | None, new: Study) -> None:
        domain = new.source.domain
        self._last_good = {method: last for method, last in self._last_good.items() if last.domain is domain}
        for method, run in new.runs.items():
            if run.is_complete:
                self._last_good[method] = subject_of(new, method)
        self.study_changed.emit(old, new)

    def _on_failed(self, job: Job, failure: Failure) -> None:
        self.noticed.emit(Notice("error", failure.message, f"{job.title}\n\n{failure.details}"))

    def _on_progress(self, fraction: float, message: str, left: float) -> None:
        if not self.is_running:
            return
        waiting = len(self.missing())
        if left >= 0 and waiting > 1:
            left += (waiting - 1) * (self._pace.seconds or left / max(1.0 - fraction, 0.1))
        done = max(self._batch - waiting, 0)
        overall = (done + fraction) / (done + waiting) if waiting else fraction
        self.progressed.emit(overall, message, left)
