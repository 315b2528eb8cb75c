"""The three plots of the lesson on a line: sizes with handles to drag, the elements, and R of each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pyqtgraph
from qtpy.QtCore import QPointF, Qt, Signal
from qtpy.QtGui import QFont
from qtpy.QtWidgets import QVBoxLayout, QWidget

from sizeviz.app.lessons.line import CORRECT, NAMES, SMALLEST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from qtpy.QtGui import QKeyEvent, QMouseEvent

    from sizeviz.app.lessons.chapters import Chapter
    from sizeviz.app.lessons.line import LineShown
    from sizeviz.app.theme import Theme

GRAB_PIXELS = 14.0
"""How near to a handle a press must be to take it."""

NUDGE_SIZE, NUDGE_X = 0.01, 0.005
"""How far one press of an arrow key moves a handle."""

CEILING = 0.66
"""Upper end of the axis of sizes."""

DASHES = {
    "none": Qt.PenStyle.SolidLine,
    "gradient-limiting": Qt.PenStyle.DashLine,
    "size-preserving": Qt.PenStyle.DotLine,
}
"""Line styles of R, those of the paper."""

AXIS_WIDTH = 116
"""Room for the words left of the plots, at usual type; the same for all, so that x lines up."""


class LinePlot(pyqtgraph.PlotWidget):
    """A plot over x from 0 to 1 that neither zooms nor pans."""

    def __init__(self, name: str, bottom: str = "") -> None:
        super().__init__(background=None)
        self.setAccessibleName(name)
        self.setMouseEnabled(False, False)
        self.setMenuEnabled(False)
        self.hideButtons()
        self.setXRange(0.0, 1.0, padding=0.015)
        self.getPlotItem().getAxis("bottom").setStyle(tickLength=-5)
        self.getPlotItem().getAxis("left").setStyle(tickLength=-5)
        self.bottom = bottom
        if not bottom:
            self.getPlotItem().getAxis("bottom").setStyle(showValues=False)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)

    def take_theme(self, theme: Theme, type_scale: float, left: str) -> None:
        """Take colours, and type as large as the window's."""
        self.setBackground(theme.raised)
        font = QFont(self.font())
        font.setPointSizeF(9.0 * type_scale)
        for side, words in (("left", left), ("bottom", self.bottom)):
            axis = self.getPlotItem().getAxis(side)
            axis.setPen(theme.border)
            axis.setTextPen(theme.muted)
            axis.setTickFont(font)
            if words:
                axis.setLabel(words, color=theme.text, **{"font-size": f"{10 * type_scale:g}pt"})
            axis.enableAutoSIPrefix(False)
        self.getPlotItem().getAxis("left").setWidth(AXIS_WIDTH * type_scale)


class SizePlot(LinePlot):
    """Sizes over x. Handles are dragged; a click elsewhere asks for that place.

    Signals
    -------
    knot_moved(int, float, float)
        A handle is dragged to x and size.
    knot_added(float, float), knot_removed(int)
        A handle more, or one less.
    place_chosen(float)
        A place was clicked.
    """

    knot_moved = Signal(int, float, float)
    knot_added = Signal(float, float)
    knot_removed = Signal(int)
    place_chosen = Signal(float)

    def __init__(self) -> None:
        super().__init__("Sizes along the line; arrow keys move the chosen handle, Tab and Shift+Tab leave the plot")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setYRange(-0.02, CEILING, padding=0.0)
        # named ticks: left to itself the axis may name 0.5 as 500 thousandths
        self.getPlotItem().getAxis("left").setTicks([[(k / 10, f"{k / 10:g}") for k in range(7)]])
        self.knots: tuple[tuple[float, float], ...] = ()
        self.chosen = 0
        self._dragged: int | None = None
        self._pressed: QPointF | None = None

    def pixel(self, x: float, size: float) -> QPointF:
        """Return the pixel of a place."""
        return QPointF(self.mapFromScene(self.getViewBox().mapViewToScene(QPointF(x, size))))

    def knot_at(self, at: QPointF) -> int | None:
        """Return the handle under a pixel, None where there is none."""
        gaps = [(self.pixel(*knot) - at).manhattanLength() for knot in self.knots]
        nearest = int(np.argmin(gaps))
        return nearest if gaps[nearest] <= 1.4 * GRAB_PIXELS else None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take a handle, or mark where a click may end."""
        at = QPointF(event.pos())
        held = self.knot_at(at)
        if event.button() == Qt.MouseButton.RightButton:
            if held is not None:
                self.knot_removed.emit(held)
        elif event.button() == Qt.MouseButton.LeftButton:
            self._dragged, self._pressed = held, at
            if held is not None:
                self.chosen = held
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag what is held; otherwise show what can be."""
        at = QPointF(event.pos())
        if self._dragged is not None:
            self.knot_moved.emit(self._dragged, *self._model(at))
        else:
            over = self.knot_at(at) is not None
            self.setCursor(Qt.CursorShape.SizeAllCursor if over else Qt.CursorShape.CrossCursor)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go; a press on no handle was a click."""
        if self._pressed is not None and self._dragged is None:
            self.place_chosen.emit(min(max(self._model(self._pressed)[0], 0.0), 1.0))
        self._dragged = self._pressed = None

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Add a handle."""
        at = QPointF(event.pos())
        if event.button() == Qt.MouseButton.LeftButton and self.knot_at(at) is None:
            self.knot_added.emit(*self._model(at))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Choose a handle with Page Up and Page Down, move it with the arrows, remove it with Delete."""
        x, size = self.knots[min(self.chosen, len(self.knots) - 1)]
        moves = {
            Qt.Key.Key_Up: (0.0, NUDGE_SIZE),
            Qt.Key.Key_Down: (0.0, -NUDGE_SIZE),
            Qt.Key.Key_Left: (-NUDGE_X, 0.0),
            Qt.Key.Key_Right: (NUDGE_X, 0.0),
        }
        turn = {Qt.Key.Key_PageUp: -1, Qt.Key.Key_PageDown: 1}.get(event.key())
        if event.key() in moves:
            dx, dy = moves[event.key()]
            self.knot_moved.emit(self.chosen, x + dx, max(size + dy, SMALLEST))
        elif turn is not None:
            self.chosen = (self.chosen + turn) % len(self.knots)
            self.place_chosen.emit(self.knots[self.chosen][0])
        elif event.key() == Qt.Key.Key_Delete:
            self.knot_removed.emit(self.chosen)
        else:
            event.ignore()

    def _model(self, at: QPointF) -> tuple[float, float]:
        place = self.getViewBox().mapSceneToView(self.mapToScene(at.toPoint()))
        return float(place.x()), float(place.y())


class LinePlots(QWidget):
    """The plots of one lesson; they show what was resolved and hold nothing else."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.sizes = SizePlot()
        self.elements = LinePlot("Elements of each mesh, by method")
        self.ratios = LinePlot("R of each element, by method", bottom="x")
        self.elements.hideAxis("bottom")
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        for plot, share in ((self.sizes, 6), (self.elements, 2), (self.ratios, 3)):
            column.addWidget(plot, share)
        self._type_scale = 1.0
        self._theme: Theme | None = None
        self._shown: tuple[LineShown, Chapter] | None = None

    def set_theme(self, theme: Theme, type_scale: float) -> None:
        """Take colours and type."""
        self._theme, self._type_scale = theme, type_scale
        self.sizes.take_theme(theme, type_scale, "size")
        self.elements.take_theme(theme, type_scale, "")
        self.ratios.take_theme(theme, type_scale, "R(e)")
        if self._shown is not None:
            self.show_lesson(*self._shown)

    def show_lesson(self, shown: LineShown, chapter: Chapter) -> None:
        """Draw what a chapter shows."""
        self._shown = (shown, chapter)
        if self._theme is None:
            return
        meshes = () if chapter.number == 0 or chapter.shows_ball else chapter.methods
        self.elements.setVisible(bool(meshes))
        self.ratios.setVisible(bool(meshes))
        self.sizes.getPlotItem().getAxis("bottom").setStyle(showValues=not meshes)
        self._draw_sizes(shown, chapter)
        if meshes:
            self._draw_elements(shown, meshes)
            self._draw_ratios(shown, meshes)

    # -- drawing ---------------------------------------------------------------------------------------------------

    def _draw_sizes(self, shown: LineShown, chapter: Chapter) -> None:
        plot, theme = self.sizes, self._colors
        plot.clear()
        plot.knots = shown.lesson.knots
        plot.chosen = min(plot.chosen, len(plot.knots) - 1)
        if chapter.shows_ball:
            self._draw_ball(shown)
        for method in chapter.methods:
            style = Qt.PenStyle.SolidLine if method != "gradient-limiting" else Qt.PenStyle.DashLine
            plot.plot(shown.x, shown.curves[method], pen=self._pen(method, 2.6, style), antialias=True)
        handles = np.array(plot.knots)
        plot.plot(
            handles[:, 0], handles[:, 1], pen=None, symbol="o", symbolSize=13 * self._type_scale,
            symbolBrush=theme.raised, symbolPen=pyqtgraph.mkPen(theme.text, width=2.0),
        )  # fmt: skip
        self._name_curves(shown, chapter.methods)

    def _name_curves(self, shown: LineShown, methods: Sequence[str]) -> None:
        """Write each curve's name where it has the most room."""
        symbols = {"none": "h", "gradient-limiting": "h<sub>g</sub>", "size-preserving": "h*"}
        places = {
            "none": (0.08, (0.0, 1.12)),
            "gradient-limiting": (0.48, (-0.04, 0.75)),
            "size-preserving": (0.34, (1.04, 0.0)),
        }
        for method in methods:
            at, anchor = places[method]
            words = f"<b>{symbols[method]}</b> {NAMES[method].lower()}"
            label = self._label(words, self._color(method), anchor=anchor)
            label.setPos(at, float(np.interp(at, shown.x, shown.curves[method])))
            self.sizes.addItem(label)

    def _draw_ball(self, shown: LineShown) -> None:
        """Draw the ball as a box: as wide as the ball, as high as the size it stands for."""
        theme, story = self._colors, shown.ball
        moment = story.at(shown.lesson.step)
        place, alpha = float(story.trace.centre[0]), shown.lesson.alpha
        height, tint = moment.radius / alpha, pyqtgraph.mkColor(theme.accent)
        tint.setAlpha(46)
        edge = [place - moment.radius, place + moment.radius]
        self.sizes.plot(edge, [height, height], pen=self._pen("size-preserving", 1.6), fillLevel=0.0, brush=tint)
        cone = np.array([place - 1.0, place, place + 1.0])
        self.sizes.plot(
            cone, np.abs(cone - place) / alpha, pen=self._thin(theme.muted, Qt.PenStyle.DotLine), antialias=True
        )
        for side, at in zip((-1, 1), edge, strict=True):
            self.sizes.plot([at, at], [0.0, height], pen=self._pen("size-preserving", 1.6))
            words = "x − r" if side < 0 else "x + r"
            self._write(words, at, 0.0, theme.accent, (0.5 - 0.6 * side, 1.0))
        seen = story.looked_at(shown.lesson.step)
        self._dots(story.places[seen, 0], story.sizes[seen], 6.0, theme.muted)
        if not (moment.is_start or moment.is_end):
            self._dots(moment.place[:1], [moment.size], 12.0, theme.warn)
            if not moment.shrank:  # what blocks is named below
                self._write("looks here", float(moment.place[0]), moment.size, theme.warn, (0.5, 1.15))
        if moment.radius < story.trace.start:
            blocking = float(moment.blocking[0])
            asks = float(np.interp(blocking, story.places[:, 0], story.sizes))
            self._dots([blocking], [asks], 15.0, theme.bad, "d")
            self._write("<b>blocks</b>", blocking, asks, theme.bad, (-0.2, 0.5))
        self._dots([place], [0.0], 12.0, theme.accent, "t1")
        self._write(f"h* = {moment.candidate:.3g}" + ("" if moment.is_end else " ?"), place, height, theme.accent,
                    (0.5, 1.1))  # fmt: skip

    def _draw_elements(self, shown: LineShown, methods: Sequence[str]) -> None:
        plot, theme = self.elements, self._colors
        plot.clear()
        rows = {method: float(len(methods) - k) for k, method in enumerate(methods)}
        for method, row in rows.items():
            front = shown.fronts[method]
            good = front.ratios <= CORRECT
            for which, color in ((good, theme.accent), (~good, theme.bad)):
                ends = np.column_stack([front.nodes[:-1], front.nodes[1:]])[which].ravel()
                pen = pyqtgraph.mkPen(color, width=7 * self._type_scale, cap=Qt.PenCapStyle.FlatCap)
                plot.plot(ends, np.full(len(ends), row), connect="pairs", pen=pen)
            self._dots(front.nodes, np.full(len(front.nodes), row), 9.0, theme.text, plot=plot)
        names = [(row, f"{NAMES[method]} ") for method, row in rows.items()]
        plot.getPlotItem().getAxis("left").setTicks([names])
        plot.setYRange(0.4, len(methods) + 0.6, padding=0.0)

    def _draw_ratios(self, shown: LineShown, methods: Sequence[str]) -> None:
        plot, theme = self.ratios, self._colors
        plot.clear()
        plot.plot([0.0, 1.0], [1.0, 1.0], pen=self._thin(theme.text))
        label = self._label("R = 1: correct up to here", theme.muted, anchor=(0.0, 1.0))
        label.setPos(0.005, 1.0)
        plot.addItem(label)
        top = 1.0
        for method in methods:
            front = shown.fronts[method]
            x, y = np.repeat(front.nodes, 2)[1:-1], np.repeat(front.ratios, 2)
            plot.plot(x, y, pen=self._pen(method, 2.6, DASHES[method]))
            top = max(top, float(front.ratios.max()))
        plot.setYRange(0.0, max(1.4, 1.1 * top), padding=0.0)

    # -- pens and words --------------------------------------------------------------------------------------------

    @property
    def _colors(self) -> Theme:
        assert self._theme is not None
        return self._theme

    def _color(self, method: str) -> str:
        theme = self._colors
        return {"none": theme.text, "gradient-limiting": theme.bad, "size-preserving": theme.accent}[method]

    def _pen(self, method: str, width: float, style: Any = Qt.PenStyle.SolidLine) -> Any:
        return pyqtgraph.mkPen(self._color(method), width=width * self._type_scale, style=style)

    def _thin(self, color: str, style: Any = Qt.PenStyle.SolidLine) -> Any:
        return pyqtgraph.mkPen(color, width=1.2 * self._type_scale, style=style)

    def _dots(
        self, x: NDArray[np.float64] | list[float], y: NDArray[np.float64] | list[float], size: float, color: str,
        symbol: str = "o", plot: Any = None,
    ) -> None:  # fmt: skip
        (plot or self.sizes).plot(
            x, y, pen=None, symbol=symbol, symbolSize=size * self._type_scale, symbolBrush=color, symbolPen=None
        )

    def _label(self, html: str, color: str, anchor: tuple[float, float]) -> Any:
        size = f"{10 * self._type_scale:g}pt"
        plate = pyqtgraph.mkColor(self._colors.raised)
        plate.setAlpha(170)  # words stay legible over a curve
        words = f'<span style="color:{color};font-size:{size}">{html}</span>'
        return pyqtgraph.TextItem(html=words, anchor=anchor, fill=plate)

    def _write(self, words: str, x: float, y: float, color: str, anchor: tuple[float, float]) -> None:
        label = self._label(words, color, anchor)
        label.setPos(x, y)
        self.sizes.addItem(label)
