"""Ending when the system asks: a signal closes the window as its close button would."""

from __future__ import annotations

import signal
import socket
from typing import TYPE_CHECKING

from qtpy.QtCore import QObject, QSocketNotifier

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

NAMES = ("SIGTERM", "SIGINT", "SIGHUP")
"""Signals that ask a program to end; not every platform has each of them."""


class EndRequests(QObject):
    """Calls a function when the process is asked to end, from the event loop and not from within the signal.

    Python runs its handlers only between its own instructions, and Qt's loop may not come back to them for hours, so
    the signal also writes a byte to a socket that Qt listens to.

    Parameters
    ----------
    close : callable
        What to do.
    parent : QObject, optional
        Owner.
    """

    def __init__(self, close: Callable[[], object], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._close = close
        self._asked = False
        self._ours, self._theirs = socket.socketpair()
        for end in (self._ours, self._theirs):
            end.setblocking(False)
        self._notifier = QSocketNotifier(self._ours.fileno(), QSocketNotifier.Type.Read, self)
        self._notifier.activated.connect(self._on_byte)
        self._before_fd = signal.set_wakeup_fd(self._theirs.fileno())
        numbers = [getattr(signal, name) for name in NAMES if hasattr(signal, name)]
        self._before = {number: signal.signal(number, self._note) for number in numbers}

    def stop(self) -> None:
        """Give the signals back to whoever had them."""
        self._notifier.setEnabled(False)
        signal.set_wakeup_fd(self._before_fd)
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._ours.close()
        self._theirs.close()

    def _note(self, number: int, frame: FrameType | None) -> None:
        self._asked = True

    def _on_byte(self) -> None:
        try:
            self._ours.recv(64)
        except BlockingIOError:
            return
        if self._asked:
            self._asked = False
            self._close()
