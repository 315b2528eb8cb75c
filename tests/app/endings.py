"""Open the window as ``sizeviz gui`` does, end it in one of the ways there are, and hand its exit code on.

    python tests/app/endings.py button|key|terminate|interrupt|run|painted|error|first

``first`` prints how long after ``SIZEVIZ_STARTED`` (a time of ``time.time``) the first page was on the screen.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))


def main(way: str) -> int:
    from sizeviz.app.launch import application, launch

    app = application()
    from qtpy.QtCore import QTimer

    def main_window():
        return next((widget for widget in app.topLevelWidgets() if hasattr(widget, "controller")), None)

    def act() -> None:
        window = main_window()
        if window is None or not window.isVisible() or not window.windowHandle().isExposed():
            QTimer.singleShot(5, act)
        else:
            WAYS[way](window)

    QTimer.singleShot(0, act)
    return launch("ring" if way in ("run", "painted") else None, None)


def by_button(window) -> None:
    window.windowHandle().close()  # what the window manager's button leads to


def by_key(window) -> None:
    from qtpy.QtCore import Qt
    from qtpy.QtTest import QTest

    window.activateWindow()
    QTest.qWait(200)
    QTest.keyClick(window, Qt.Key.Key_Q, Qt.KeyboardModifier.ControlModifier)


def by_signal(number: int) -> Callable[[object], None]:
    return lambda window: os.kill(os.getpid(), number)


def during_a_run(window) -> None:
    _when(lambda: window.controller.is_running and window.progress.bar.value() > 100, window.close)


def with_unsaved_paint(window) -> None:
    from sizeviz.sources.painting import Brush

    controller = window.controller

    def paint() -> None:
        controller.painting.begin(Brush(mode="set", radius=0.1, value=0.02), "freehand", 0.5, 0.5)
        controller.painting.end()
        window.close()

    _when(lambda: controller.study is not None, paint)


def after_an_error(window) -> None:
    from qtpy.QtCore import QTimer

    def fail() -> None:
        raise RuntimeError("as a slot may")

    QTimer.singleShot(0, fail)
    _when(window.toast.isVisible, window.close)


def once_seen(window) -> None:
    print(f"{time.time() - float(os.environ['SIZEVIZ_STARTED']):.3f}", flush=True)
    window.close()


def _when(ready: Callable[[], bool], then: Callable[[], object]) -> None:
    from qtpy.QtCore import QTimer

    def look() -> None:
        if ready():
            then()
        else:
            QTimer.singleShot(10, look)

    look()


WAYS: dict[str, Callable[..., None]] = {
    "button": by_button,
    "key": by_key,
    "terminate": by_signal(signal.SIGTERM),
    "interrupt": by_signal(signal.SIGINT),
    "run": during_a_run,
    "painted": with_unsaved_paint,
    "error": after_an_error,
    "first": once_seen,
}

if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1]))
