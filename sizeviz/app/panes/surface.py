"""A canvas under a sheet of glass: the glass takes the mouse and draws cursor, hover and pin; the canvas only draws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from qtpy.QtCore import QPointF, Qt, Signal
from qtpy.QtGui import QColor, QFontMetrics, QPainter, QPen, QPolygonF
from qtpy.QtWidgets import QWidget

from sizeviz.app.qt import painting
from sizeviz.scene.camera import Camera2D

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray
    from qtpy.QtGui import QFocusEvent, QKeyEvent, QMouseEvent, QPaintEvent, QResizeEvent, QWheelEvent

    from sizeviz.app.panes.canvas import Canvas
    from sizeviz.scene.spec import Bounds

WHEEL_STEP = 1.2
"""Zoom of one notch of the wheel."""

ARROW_SHARE = 0.1
"""Which part of a pane's height an arrow key pans by."""

CLICK_SLOP = 4.0
"""A press that moves less than this, in pixels, is a click."""


@dataclass(frozen=True)
class Ring:
    """The brush's cursor: where it is and how far it reaches, in model units, and what is written beside it."""

    x: float
    y: float
    radius: float
    label: str


@dataclass(frozen=True, eq=False)
class Mark:
    """An outlined element: corners ``(4, 2)`` in model units, a label, and whether it is pinned."""

    corners: NDArray[np.float64]
    label: str = ""
    pinned: bool = False


class Overlay(Protocol):
    """Something drawn over a pane that is neither cursor nor mark, such as a lesson's ball."""

    def paint(self, glass: Glass, painter: QPainter) -> None:
        """Draw, with the glass to turn model units into pixels and to write labels."""


class Glass(QWidget):
    """Takes the mouse, draws what moves with it."""

    def __init__(self, surface: Surface) -> None:
        super().__init__(surface)
        self._surface = surface
        self.setMouseTracking(True)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self.setAttribute(Qt.WidgetAttribute.WA_TranslucentBackground)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName("Picture")
        self.ring: Ring | None = None
        self.marks: dict[str, Mark] = {}
        self.path: list[tuple[float, float]] = []
        self.overlay: Overlay | None = None
        self._pressed: QPointF | None = None
        self._last = QPointF()
        self._cursor: QPointF | None = None
        self._panning = False
        self._drawing = False

    # -- the mouse -------------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a pan, a stroke or a click."""
        self._pressed = self._last = _position(event)
        self._surface.activated.emit()
        if event.button() == Qt.MouseButton.MiddleButton or not self._surface.tool_active:
            self._panning = event.button() in (Qt.MouseButton.MiddleButton, Qt.MouseButton.LeftButton)
        elif event.button() == Qt.MouseButton.LeftButton:
            self._drawing = True
            self._surface.stroke_began.emit(*self._model(self._last))
        elif event.button() == Qt.MouseButton.RightButton:
            self._surface.stroke_closed.emit()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Pan, draw or hover."""
        self._cursor = at = _position(event)
        if self._panning and self._pressed is not None:
            delta, self._last = at - self._last, at
            if _length(at - self._pressed) > CLICK_SLOP:
                self.setCursor(Qt.CursorShape.ClosedHandCursor)
            self._surface.move_camera(self._surface.camera.panned(delta.x(), delta.y(), self.height()))
            return  # which has told of the place under the cursor
        if self._drawing:
            self._surface.stroke_moved.emit(*self._model(at))
        self.hover_again()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End what the press began; a press that did not move is a click."""
        at = _position(event)
        clicked = self._pressed is not None and _length(at - self._pressed) <= CLICK_SLOP
        if self._drawing and event.button() == Qt.MouseButton.LeftButton:
            self._drawing = False
            self._surface.stroke_ended.emit(*self._model(at))
        elif self._panning and clicked and event.button() == Qt.MouseButton.LeftButton:
            self._surface.clicked.emit(*self._model(at))
        elif clicked and event.button() == Qt.MouseButton.RightButton and not self._surface.tool_active:
            self._surface.menu_requested.emit(*self._model(at))
        self._panning = False
        self._pressed = None
        self.unsetCursor()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Fit, or close a polygon."""
        if self._surface.tool_active:
            self._surface.stroke_closed.emit()
        else:
            self._surface.fit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom at the cursor; with Shift or Ctrl and a tool, change the brush's radius."""
        turn = event.angleDelta()
        notches = (turn.y() or turn.x()) / 120.0
        if self._surface.tool_active and event.modifiers() & (
            Qt.KeyboardModifier.ShiftModifier | Qt.KeyboardModifier.ControlModifier
        ):
            self._surface.radius_stepped.emit(notches)
        else:
            x, y = self._model(QPointF(event.position()))
            self._surface.move_camera(self._surface.camera.zoomed(WHEEL_STEP**notches, x, y))
        event.accept()

    def hover_again(self) -> None:
        """Tell what is under the cursor now: the picture may have moved while the mouse rested."""
        if self._cursor is not None:
            self._surface.hovered.emit(*self._model(self._cursor))

    # -- the keyboard ----------------------------------------------------------------------------------------------

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Make the pane the active one when the keyboard comes to it."""
        super().focusInEvent(event)
        if event.reason() in (Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason):
            self._surface.activated.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Pan with the arrow keys."""
        arrows = {Qt.Key.Key_Left: (1, 0), Qt.Key.Key_Right: (-1, 0), Qt.Key.Key_Up: (0, 1), Qt.Key.Key_Down: (0, -1)}
        if event.key() not in arrows:
            super().keyPressEvent(event)
            return
        across, down = arrows[event.key()]
        step = ARROW_SHARE * self.height()
        self._surface.move_camera(self._surface.camera.panned(across * step, down * step, self.height()))

    def leaveEvent(self, event: object) -> None:
        """Forget the hover."""
        self._cursor = None
        self._surface.left.emit()

    # -- drawing ---------------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw marks, the path of a line or polygon, and the ring."""
        if not (self.marks or self.path or self.ring or self.overlay):
            return
        with painting(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            if self.overlay is not None:
                self.overlay.paint(self, painter)
            for mark in self.marks.values():
                self._draw_mark(painter, mark)
            if self.path:
                self._draw_path(painter)
            if self.ring is not None:
                self._draw_ring(painter, self.ring)

    def _draw_mark(self, painter: QPainter, mark: Mark) -> None:
        shape = QPolygonF([self.pixel(x, y) for x, y in mark.corners])
        self.twice(painter, lambda: painter.drawPolygon(shape), 2.4 if mark.pinned else 1.6)
        box = shape.boundingRect()
        if mark.pinned and max(box.width(), box.height()) < 14:
            self.twice(painter, lambda: painter.drawEllipse(box.center(), 11.0, 11.0), 2.0)
        if mark.label:
            width = QFontMetrics(self.font()).horizontalAdvance(mark.label) + 12.0
            below = max(0.5 * box.height(), 11.0) + 9.0
            self.draw_label(painter, box.center() + QPointF(-0.5 * width, below), mark.label)

    def _draw_path(self, painter: QPainter) -> None:
        line = QPolygonF([self.pixel(x, y) for x, y in self.path])
        self.twice(painter, lambda: painter.drawPolyline(line), 1.6)

    def _draw_ring(self, painter: QPainter, ring: Ring) -> None:
        centre = self.pixel(ring.x, ring.y)
        reach = max(ring.radius * self.height() / self._surface.camera.height, 2.0)
        self.twice(painter, lambda: painter.drawEllipse(centre, reach, reach), 1.6)
        if ring.label:
            self.draw_label(painter, centre + QPointF(min(reach, 0.4 * self.width()) * 0.72 + 8.0, 16.0), ring.label)

    def draw_label(self, painter: QPainter, at: QPointF, words: str) -> None:
        """Write words on a dark plate whose upper left corner is at a pixel, wholly within the pane."""
        metrics = QFontMetrics(self.font())
        width, height = metrics.horizontalAdvance(words) + 12.0, metrics.height() + 6.0
        x = min(max(at.x(), 2.0), self.width() - width - 2.0)
        y = min(max(at.y(), 2.0), self.height() - height - 2.0)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(24, 27, 32, 215))
        painter.drawRoundedRect(int(x), int(y), int(width), int(height), 4, 4)
        painter.setPen(QColor(245, 247, 250))
        painter.drawText(QPointF(x + 6.0, y + 3.0 + metrics.ascent()), words)

    @staticmethod
    def twice(painter: QPainter, draw: Callable[[], object], width: float) -> None:
        """Draw a line that shows on any ground: white upon black."""
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(10, 12, 15, 190), width + 2.0))
        draw()
        painter.setPen(QPen(QColor(255, 255, 255), width))
        draw()

    def _model(self, at: QPointF) -> tuple[float, float]:
        return self._surface.camera.to_model(at.x(), at.y(), self.width(), self.height())

    def pixel(self, x: float, y: float) -> QPointF:
        """Return the pixel over a model point."""
        return QPointF(*self._surface.camera.to_pixel(x, y, self.width(), self.height()))


class Surface(QWidget):
    """A canvas with two-dimensional navigation.

    Parameters
    ----------
    make_canvas : callable
        Takes the parent, returns the canvas to draw on.
    parent : QWidget, optional
        Owner.
    """

    camera_changed = Signal(object)
    hovered = Signal(float, float)
    left = Signal()
    clicked = Signal(float, float)
    menu_requested = Signal(float, float)
    activated = Signal()
    stroke_began = Signal(float, float)
    stroke_moved = Signal(float, float)
    stroke_ended = Signal(float, float)
    stroke_closed = Signal()
    radius_stepped = Signal(float)

    def __init__(self, make_canvas: Callable[[QWidget], Canvas], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.canvas = make_canvas(self)
        self.glass = Glass(self)
        self.glass.raise_()
        self.camera = Camera2D(0.5, 0.5, 1.1)
        self.tool_active = False
        self._bounds: Bounds = (0.0, 0.0, 1.0, 1.0)
        self._fitted = True
        self.setMinimumSize(150, 66)
        policy = self.sizePolicy()
        policy.setRetainSizeWhenHidden(True)
        self.setSizePolicy(policy)

    def set_bounds(self, bounds: Bounds) -> None:
        """Say what 'fit' shows; a change of it fits at once."""
        if bounds != self._bounds:
            self._bounds = bounds
            self.fit()

    def look_like(self, other: Surface) -> None:
        """Look where another surface does, without telling."""
        self._bounds = other._bounds
        self.set_camera(other.camera, other.shows_all)

    def fit(self) -> None:
        """Show everything, and go on doing so at any size until somebody looks elsewhere."""
        self.set_camera(self.fitted, shows_all=True)
        self.camera_changed.emit(self.camera)

    @property
    def fitted(self) -> Camera2D:
        """The camera that shows everything."""
        return Camera2D.fitted(self._bounds, self.aspect)

    @property
    def shows_all(self) -> bool:
        """Whether nobody has looked elsewhere since everything was shown."""
        return self._fitted

    @property
    def aspect(self) -> float:
        """Width to height."""
        return self.width() / max(self.height(), 1)

    def move_camera(self, camera: Camera2D) -> None:
        """Look elsewhere and tell."""
        self.set_camera(camera)
        self.camera_changed.emit(camera)

    def set_camera(self, camera: Camera2D, shows_all: bool = False) -> None:
        """Look elsewhere without telling, as when another pane leads; say whether that is everything."""
        self._fitted = shows_all
        self.camera = camera
        self.canvas.look(camera)
        self.glass.hover_again()
        self.glass.update()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep canvas and glass as large as the surface; a fitted view stays fitted."""
        self.canvas.widget().setGeometry(self.rect())
        self.glass.setGeometry(self.rect())
        if self._fitted:
            self.fit()


def _position(event: QMouseEvent) -> QPointF:
    """Return where a mouse event is; Qt 5 and Qt 6 name it differently."""
    return QPointF(event.position() if hasattr(event, "position") else event.localPos())


def _length(vector: QPointF) -> float:
    return float((vector.x() ** 2 + vector.y() ** 2) ** 0.5)
