"""Long work of the window in pieces, one a turn of the event loop: the mouse never waits for all of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import QObject, QTimer

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


class Turns(QObject):
    """Calls functions one after another, each in a turn of its own; new ones take the place of those not yet called.

    Parameters
    ----------
    parent : QObject, optional
        Owner.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._waiting: list[Callable[[], object]] = []
        self._timer = QTimer(self)
        self._timer.setInterval(0)
        self._timer.timeout.connect(self._next)

    @property
    def is_busy(self) -> bool:
        """Whether anything is still to be called."""
        return bool(self._waiting)

    def take(self, pieces: Sequence[Callable[[], object]]) -> None:
        """Call these, from the next turn on."""
        self._waiting = list(pieces)
        self._timer.start()

    def drop(self) -> None:
        """Call nothing any more."""
        self._waiting.clear()
        self._timer.stop()

    def finish(self) -> None:
        """Call all that is waiting now."""
        while self._waiting:
            self._waiting.pop(0)()
        self._timer.stop()

    def _next(self) -> None:
        if self._waiting:
            self._waiting.pop(0)()
        if not self._waiting:
            self._timer.stop()
