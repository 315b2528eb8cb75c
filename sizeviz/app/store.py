"""The one study of the window, and its past: every change is one undo step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from qtpy.QtCore import QObject, Signal

from sizeviz.app.qt import QUndoCommand, QUndoStack

if TYPE_CHECKING:
    from sizeviz.study import Study

KEPT_RESULTS = 8
"""How many undo steps keep their meshes; older ones are run again when they are returned to."""

UNDO_LIMIT = 100
"""How many steps can be undone."""


class _Step(QUndoCommand):
    """Replace study A by B. Results that arrive later are filed with the study they belong to."""

    def __init__(self, store: StudyStore, before: Study, after: Study, words: str, key: str) -> None:
        super().__init__(words)
        self.store, self.before, self.after, self.key = store, before, after, key
        self._done_once = False

    def redo(self) -> None:
        """Show B; the first call comes from pushing the step."""
        self.store._swap(self.after, announce=True)

    def undo(self) -> None:
        """Show A again."""
        self.store._swap(self.before, announce=True)

    def id(self) -> int:
        """Return the same number for steps of the same key, such as one slider's: those may melt into one."""
        return (hash(self.key) & 0x3FFFFFFF) if self.key else -1

    def mergeWith(self, other: Any) -> bool:
        """Melt a later step of the same key into this one."""
        if not isinstance(other, _Step) or other.key != self.key or not self.store.may_merge:
            return False
        self.after = other.after
        return True


class StudyStore(QObject):
    """Holds the current study; signals ``changed(old, new)`` for whatever replaces it.

    Parameters
    ----------
    parent : QObject, optional
        Owner.
    """

    changed = Signal(object, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.stack: Any = QUndoStack(self)
        self.stack.setUndoLimit(UNDO_LIMIT)
        self.may_merge = False
        self._study: Study | None = None

    @property
    def study(self) -> Study | None:
        """The current study, None before the first one was opened."""
        return self._study

    def commit(self, study: Study, words: str, key: str = "") -> None:
        """Replace the study as one undo step.

        Parameters
        ----------
        study : Study
            The new one.
        words : str
            What the step is called in the history.
        key : str
            Steps of one key that follow each other directly melt into one, as while a slider is dragged.
        """
        if self._study is None:
            self._swap(study, announce=True)
            return
        self.may_merge = bool(key)
        self.stack.push(_Step(self, self._study, study, words, key))
        self.may_merge = False
        self._drop_old_results()

    def amend(self, study: Study) -> None:
        """Replace the study by itself with more results: no undo step, but the history keeps them."""
        old = self._study
        for k in range(self.stack.count()):
            step = self.stack.command(k)
            if step.before is old:
                step.before = study
            if step.after is old:
                step.after = study
        self._swap(study, announce=True)

    def _swap(self, study: Study, announce: bool) -> None:
        old, self._study = self._study, study
        if announce and old is not study:
            self.changed.emit(old, study)

    def _drop_old_results(self) -> None:
        for k in range(self.stack.count() - KEPT_RESULTS):
            step = self.stack.command(k)
            if step.before.runs and step.before is not self._study:
                bare = step.before.with_source(step.before.source)
                if k > 0:
                    self.stack.command(k - 1).after = bare
                step.before = bare
