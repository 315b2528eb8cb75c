"""Strokes on their way to the study: shown while they are drawn, one undo step each when the brush is lifted."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from qtpy.QtCore import QObject, QTimer, Signal

from sizeviz.app.brush.live import LiveStroke, Painted, covers_nothing, stroke_words
from sizeviz.app.engine import LIMITED, PRESERVED, Engine, Preview, Processed, with_field
from sizeviz.app.jobs import Job

if TYPE_CHECKING:
    from sizeviz.app.jobs import JobRunner
    from sizeviz.app.store import StudyStore
    from sizeviz.sizing import SizeField
    from sizeviz.sources import Source
    from sizeviz.sources.painting import Brush, StrokeShape
    from sizeviz.study import Study

PREVIEW = "preview"
"""Title of the jobs that process a field while the brush moves."""


class Painting(QObject):
    """Turns the brush's movements into studies.

    Parameters
    ----------
    engine : Engine
        Limits and preserves the field under the brush.
    store : StudyStore
        Holds the study that is painted on.
    jobs : JobRunner
        The worker.
    parent : QObject, optional
        Owner.

    Signals
    -------
    changed()
        The brush shows something else, or nothing any more.
    lifted()
        A stroke has become a study.
    """

    changed = Signal()
    lifted = Signal()

    def __init__(self, engine: Engine, store: StudyStore, jobs: JobRunner, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._engine, self._store, self._jobs = engine, store, jobs
        self.stroke: LiveStroke | None = None
        self.preview: Preview | None = None
        self._painted: WeakKeyDictionary[Source, Painted] = WeakKeyDictionary()
        self._preview_due = False
        self._processed: Processed | None = None
        self._carried: Preview | None = None

    def painted(self, source: Source) -> Painted:
        """Return how a source was painted, so far as it was."""
        return self._painted.get(source) or Painted(source.field)

    def remember(self, source: Source, painted: Painted) -> None:
        """Take over how a source was painted, as from a file."""
        self._painted[source] = painted

    def processed(self, study: Study) -> dict[str, SizeField]:
        """Return the limited and preserved fields of a study, by method, so far as the brush has had them made."""
        known = self._processed
        if known is None or known.field is not study.source.field or known.options != study.options:
            return {}
        return dict(known.targets)

    def carried(self, study: Study) -> dict[str, SizeField]:
        """Return what the last stroke's preview showed of the field that it became: a few stamps behind it at most."""
        return self._carried.targets if self._carried and self._carried.field is study.source.field else {}

    def process(self) -> None:
        """Have the processed fields of the study itself made: they must not fall back when the brush is lifted."""
        study = self._store.study
        if study is not None and self.stroke is None and Preview(study.source.field, {}).is_live:
            self._ask(study.source.field, study)

    def begin(self, brush: Brush, shape: StrokeShape, x: float, y: float) -> None:
        """Put the brush down."""
        study = self._store.study
        if study is None:
            return
        source = study.source
        self.stroke = LiveStroke(source.field, brush, shape, self.painted(source).original)
        self.extend(x, y)

    def extend(self, x: float, y: float) -> None:
        """Move the brush."""
        if self.stroke is not None:
            self.stroke.extend(x, y)
            self._show_stroke()

    def reshape(self, path: list[tuple[float, float]]) -> None:
        """Give a line or polygon under way another path."""
        if self.stroke is not None and path:
            self.stroke.replace_path(path)
            self._show_stroke()

    def end(self) -> None:
        """Lift the brush: the stroke becomes one undo step, and the mesh follows."""
        study, live, self.stroke = self._store.study, self.stroke, None
        if study is None or live is None:
            return
        targets = {} if self.preview is None else self.preview.targets
        self.preview = None
        if covers_nothing(live.stroke, live.base):
            self.changed.emit()
            return
        painted = self.painted(study.source).with_stroke(live.stroke)
        source = with_field(study.source, live.field, len(painted.strokes))
        self._painted[source] = painted
        self._carried = Preview(source.field, targets)
        self._preview_due = False
        self._store.commit(study.with_source(source), f"Paint: {stroke_words(live.brush)}")
        self.changed.emit()
        self.lifted.emit()

    def abort(self) -> None:
        """Drop the stroke under way; nothing was changed."""
        if self.stroke is not None or self.preview is not None:
            self.stroke = self.preview = None
            self.changed.emit()

    # -- inside ----------------------------------------------------------------------------------------------------

    def _show_stroke(self) -> None:
        assert self.stroke is not None
        targets = self.preview.targets if self.preview is not None else {}
        self.preview = Preview(self.stroke.field, targets)
        self.changed.emit()
        if self.preview.is_live:
            self._request_preview()

    def _request_preview(self) -> None:
        """Ask for the processed fields of the stroke; while one answer is awaited, only the next is remembered."""
        running = self._jobs.running
        if running is not None and running.title == PREVIEW:
            self._preview_due = True
            return
        self._preview_due = False
        preview, study = self.preview, self._store.study
        if preview is None or study is None:
            return
        self._ask(preview.field, study)

    def _ask(self, field: SizeField, study: Study) -> None:
        options, since = study.options, self._since(study)

        def show(targets: dict[str, SizeField]) -> None:
            self._processed = Processed(field, options, targets)
            if self.stroke is not None and self.preview is not None:
                self.preview = Preview(self.preview.field, targets)
                if self._preview_due:
                    QTimer.singleShot(0, self._request_preview)
            self.changed.emit()

        work = partial(self._engine.targets, field, options, since)
        self._jobs.submit(Job(PREVIEW, work, show, is_patient=False))

    def _since(self, study: Study) -> Processed | None:
        """Return the newest fields that the next preview can start from: the last preview's, or the study's own."""
        known = self._processed
        if known is not None and known.field.background is study.source.field.background:
            return known
        targets = {name: run.target for name, run in study.runs.items() if run.target is not None}
        if LIMITED in targets and PRESERVED in targets:
            return Processed(study.source.field, study.options, {name: targets[name] for name in (LIMITED, PRESERVED)})
        return None
