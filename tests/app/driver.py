"""A person at the window: mouse, keys, waiting, looking; and a clock that notices every stall."""

from __future__ import annotations

import itertools
import time
from typing import TYPE_CHECKING

import numpy as np
from qtpy.QtCore import QObject, QPoint, QPointF, Qt, QTimer
from qtpy.QtGui import QImage, QWheelEvent
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from qtpy.QtWidgets import QWidget

    from sizeviz.app.panes.pane import Pane
    from sizeviz.app.window import MainWindow

LEFT = Qt.MouseButton.LeftButton


class Heartbeat(QObject):
    """Ticks as often as the event loop lets it; ``longest`` is the longest time it did not, in seconds."""

    def __init__(self) -> None:
        super().__init__()
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._tick)
        self.reset()
        self._timer.start(2)

    def reset(self) -> None:
        self.gaps: list[float] = []
        self.works: list[float] = []  # processor seconds of this thread in each gap: what it did itself
        self._last, self._worked = time.perf_counter(), time.thread_time()

    @property
    def longest(self) -> float:
        return max(self.gaps, default=0.0)

    def stop(self) -> None:
        self._timer.stop()

    def _tick(self) -> None:
        now, worked = time.perf_counter(), time.thread_time()
        self.gaps.append(now - self._last)
        self.works.append(worked - self._worked)
        self._last, self._worked = now, worked


class Person:
    """Does to a window what a person would do."""

    def __init__(self, window: MainWindow) -> None:
        self.window = window

    def wait(self, until: Callable[[], bool], seconds: float = 60.0) -> None:
        end = time.perf_counter() + seconds
        while not until():
            assert time.perf_counter() < end, f"still waiting for {until} after {seconds} s"
            QTest.qWait(5)

    def rest(self, ms: int = 60) -> None:
        QTest.qWait(ms)

    def wait_settled(self, seconds: float = 300.0) -> None:
        controller = self.window.controller
        self.wait(lambda: not controller.jobs.is_busy and controller.study and not controller.missing(), seconds)
        self.wait(lambda: not self.window.is_settling)
        self.rest(30)

    def spot(self, pane: Pane, x: float, y: float) -> QPoint:
        glass = pane.surface.glass
        px, py = pane.surface.camera.to_pixel(x, y, glass.width(), glass.height())
        return QPoint(round(px), round(py))

    def hover(self, pane: Pane, x: float, y: float) -> None:
        QTest.mouseMove(pane.surface.glass, self.spot(pane, x, y))
        self.rest(5)

    def click(self, pane: Pane, x: float, y: float) -> None:
        QTest.mouseClick(pane.surface.glass, LEFT, pos=self.spot(pane, x, y))

    def drag(self, pane: Pane, path: list[tuple[float, float]], steps: int = 6, lift: bool = True) -> None:
        """Press, move along the path in small steps, release."""
        glass = pane.surface.glass
        spots = [self.spot(pane, x, y) for x, y in path]
        QTest.mousePress(glass, LEFT, pos=spots[0])
        for start, end in itertools.pairwise(spots):
            for k in range(1, steps + 1):
                QTest.mouseMove(glass, start + (end - start) * k / steps)
                QTest.qWait(1)
        if lift:
            QTest.mouseRelease(glass, LEFT, pos=spots[-1])

    def wheel(self, pane: Pane, x: float, y: float, notches: float, keys=Qt.KeyboardModifier.NoModifier) -> None:
        glass = pane.surface.glass
        at = QPointF(self.spot(pane, x, y))
        event = QWheelEvent(
            at, QPointF(glass.mapToGlobal(at.toPoint())), QPoint(0, 0), QPoint(0, round(120 * notches)),
            Qt.MouseButton.NoButton, keys, Qt.ScrollPhase.NoScrollPhase, False,
        )  # fmt: skip
        QApplication.sendEvent(glass, event)

    def key(self, key: Qt.Key, keys=Qt.KeyboardModifier.NoModifier) -> None:
        self.window.activateWindow()
        QTest.qWaitForWindowActive(self.window, 2000)
        QTest.keyClick(self.window, key, keys)

    def type_number(self, spin, value: str) -> None:
        spin.setFocus()
        spin.selectAll()
        QTest.keyClicks(spin.lineEdit(), value)
        QTest.keyClick(spin.lineEdit(), Qt.Key.Key_Return)

    def look(self) -> np.ndarray:
        """Return what is on the screen, VTK's panes included, ``(H, W, 3)``."""
        self.rest(150)
        self.wait(lambda: not self.window.is_settling)
        return pixels(self.window.grab().toImage())

    def look_at(self, pane: Pane) -> np.ndarray:
        """Return what one pane's picture shows."""
        self.rest(150)
        self.wait(lambda: not self.window.is_settling)
        return self.picture_of(pane)

    def picture_of(self, pane: Pane) -> np.ndarray:
        """Return what one pane's picture shows at this moment, waiting for nothing."""
        picture = pane.surface.canvas.widget()
        corner = picture.mapTo(self.window, QPoint(0, 0))
        ratio = self.window.devicePixelRatioF()
        image = pixels(self.window.grab().toImage())
        x, y = round(corner.x() * ratio), round(corner.y() * ratio)
        return image[y : y + round(picture.height() * ratio), x : x + round(picture.width() * ratio)]

    def photograph(self, path: Path) -> None:
        self.rest(250)
        self.wait(lambda: not self.window.is_settling)
        assert self.window.grab().save(str(path))


def glass(window: MainWindow, pane: int = 0) -> QWidget:
    """Return what takes the mouse in a pane."""
    return window.board.panes[pane].surface.glass


def at(window: MainWindow, x: float, y: float, pane: int = 0) -> QPoint:
    """Return the pixel of a pane over a model point."""
    widget = glass(window, pane)
    px, py = window.board.panes[pane].surface.camera.to_pixel(x, y, widget.width(), widget.height())
    return QPoint(round(px), round(py))


def pixels(image: QImage) -> np.ndarray:
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    pointer = image.constBits()
    pointer.setsize(image.sizeInBytes() if hasattr(image, "sizeInBytes") else image.byteCount())
    flat = np.frombuffer(bytes(pointer), np.uint8).reshape(image.height(), image.bytesPerLine())
    return flat[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).copy()


def orange_share(picture: np.ndarray) -> float:
    """Return which share of a picture has a colour of R > 1."""
    red, _, blue = (picture[..., k].astype(int) for k in range(3))
    return float((red > blue + 50).mean())


def blue_share(picture: np.ndarray) -> float:
    """Return which share of a picture has a colour of R <= 1."""
    red, _, blue = (picture[..., k].astype(int) for k in range(3))
    return float((blue > red + 20).mean())
