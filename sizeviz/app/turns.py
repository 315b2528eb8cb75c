"""Long work of the window in pieces, one a turn of the event loop: the mouse never waits for all of it."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Protocol

from qtpy.QtCore import QCoreApplication, QObject, QTimer

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Mapping


class Member(Protocol):
    """Somebody with work in pieces."""

    def step(self) -> bool:
        """Do one piece; return whether there is another."""


class Turnstile(QObject):
    """Lets one piece of work through in each turn of the event loop, whoever's it is, and everybody in order.

    There is one for the application: two that each let something through would make a turn twice as long.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._queue: deque[Member] = deque()
        self._timer = QTimer(self)
        self._timer.setInterval(0)
        self._timer.timeout.connect(self._next)

    def join(self, member: Member) -> None:
        """Wait for a turn, if not waiting already."""
        if member not in self._queue:
            self._queue.append(member)
        self._timer.start()

    def leave(self, member: Member) -> None:
        """Wait no longer."""
        if member in self._queue:
            self._queue.remove(member)

    def _next(self) -> None:
        if self._queue:
            member = self._queue.popleft()
            if member.step():
                self.join(member)
        if not self._queue:
            self._timer.stop()


def turnstile() -> Turnstile:
    """Return the application's turnstile."""
    application = QCoreApplication.instance()
    return application.findChild(Turnstile) or Turnstile(application)


class Turns(QObject):
    """Calls named functions one after another, each in a turn of its own.

    A new one takes the place of one of its name that was not yet called, so that however often something is asked for,
    everybody gets a turn.

    Parameters
    ----------
    parent : QObject, optional
        Owner.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._waiting: dict[Hashable, Callable[[], object]] = {}

    @property
    def is_busy(self) -> bool:
        """Whether anything is still to be called."""
        return bool(self._waiting)

    def take(self, pieces: Mapping[Hashable, Callable[[], object]]) -> None:
        """Call these, from the next turn on."""
        self._waiting.update(pieces)
        if self._waiting:
            turnstile().join(self)

    def drop(self) -> None:
        """Call nothing any more."""
        self._waiting.clear()

    def finish(self) -> None:
        """Call all that is waiting now."""
        while self.step():
            pass

    def step(self) -> bool:
        """Call what has waited longest; return whether anything is left."""
        if self._waiting:
            self._waiting.pop(next(iter(self._waiting)))()
        return self.is_busy
