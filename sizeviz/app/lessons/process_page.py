"""The player of the adaptive process: a pane, the evolution of R with a cursor, and what each iteration means."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyqtgraph
from qtpy.QtCore import QSignalBlocker, Qt, Signal
from qtpy.QtGui import QFont
from qtpy.QtWidgets import (
    QFileDialog,
    QFrame,
    QLabel,
    QPushButton,
    QScrollArea,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from sizeviz.app.lessons.page import LessonPage, TermTable, rich, spaced
from sizeviz.app.lessons.process import Asked, ProcessController, ProcessShown
from sizeviz.app.lessons.process_words import process_rows, process_title, process_words
from sizeviz.app.lessons.transport import Transport
from sizeviz.app.news import Notice
from sizeviz.app.panels.controls import Form, choice, number
from sizeviz.app.panes.pane import Pane
from sizeviz.scene.scale import ratio_scale
from sizeviz.scene.subject import METHOD_TITLES, Subject
from sizeviz.scene.view import ViewState

if TYPE_CHECKING:
    from collections.abc import Callable

    from qtpy.QtGui import QMouseEvent

    from sizeviz.app.controller import Controller
    from sizeviz.app.panes.canvas import Canvas
    from sizeviz.app.theme import Theme

EDGES_BELOW = 20_000
"""Meshes of fewer elements are shown with their edges."""

TICKS = (0.8, 1.0, 1.1, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0)
"""Values that the axis of R may name."""

FOLDER_TIP = "Open what sizeviz adapt wrote, or choose where to keep a new process"
"""What the button of folders does."""

FILM_TIP = "Save the iterations as a film, .mp4 or .gif"
"""What the button of films does."""

TICK_GAP = 0.07
"""Least distance between named values, in decades."""


class EvolutionPlot(pyqtgraph.PlotWidget):
    """The largest R of each iteration; a click or a drag moves the cursor.

    Signals
    -------
    chosen(int)
        An iteration.
    """

    chosen = Signal(int)

    def __init__(self) -> None:
        super().__init__(background=None)
        self.setAccessibleName("Largest R of each iteration")
        self.setMouseEnabled(False, False)
        self.setMenuEnabled(False)
        self.hideButtons()
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._shown = ProcessShown()
        self._theme: Theme | None = None
        self._scale = 1.0

    def set_theme(self, theme: Theme, type_scale: float) -> None:
        """Take colours and type."""
        self._theme, self._scale = theme, type_scale
        self.setBackground(theme.raised)
        font = QFont(self.font())
        font.setPointSizeF(9.0 * type_scale)
        for side, words in (("left", "largest R"), ("bottom", "iteration")):
            axis = self.getPlotItem().getAxis(side)
            axis.setPen(theme.border)
            axis.setTextPen(theme.muted)
            axis.setTickFont(font)
            axis.setLabel(words, color=theme.text, **{"font-size": f"{10 * type_scale:g}pt"})
            axis.enableAutoSIPrefix(False)
        self.show_process(self._shown)

    def show_process(self, shown: ProcessShown) -> None:
        """Draw the evolution and the cursor."""
        self._shown = shown
        self.clear()
        theme, evolution = self._theme, shown.evolution
        if theme is None or evolution is None or not shown.count:
            return
        rows = evolution.iterations
        x = np.array([row.number for row in rows], dtype=float)
        field = np.log10([row.analytic_ratio for row in rows])
        background = np.log10([row.background_ratio for row in rows])
        for level, style in ((1.0, Qt.PenStyle.SolidLine), (evolution.limit, Qt.PenStyle.DashLine)):
            self.addItem(pyqtgraph.InfiniteLine(np.log10(level), 0, pyqtgraph.mkPen(theme.muted, width=1, style=style)))
        self._line(x, field, theme.bad, "o")
        self._line(x[1:], background[1:], theme.accent, "t1")
        cursor = pyqtgraph.mkPen(theme.text, width=1.6 * self._scale)
        self.addItem(pyqtgraph.InfiniteLine(shown.number, 90, cursor))
        both = np.concatenate([field, background[1:], [0.0, np.log10(evolution.limit)]])
        low, high = float(both.min()) - 0.05, float(both.max()) + 0.12
        self.setYRange(low, high, padding=0.0)
        right = max(len(rows) - 1, 4) + 0.3
        self.setXRange(-0.3, right, padding=0.0)
        named: list[float] = []
        for value in sorted(TICKS, key=lambda tick: tick != 1.0):
            at = float(np.log10(value))
            if low <= at <= high and all(abs(at - other) > TICK_GAP * max(high - low, 0.4) for other in named):
                named.append(at)
        self.getPlotItem().getAxis("left").setTicks([[(at, f"{10**at:.3g}") for at in named]])
        step = max(1, round(right / 12))
        self.getPlotItem().getAxis("bottom").setTicks([[(k, str(k)) for k in range(0, int(right) + 1, step)]])
        self._legend(theme, right, high, evolution.limit)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Put the cursor on the nearest iteration."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._choose(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the cursor."""
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._choose(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Leave the cursor where it is."""
        event.accept()

    def _choose(self, event: QMouseEvent) -> None:
        place = self.getViewBox().mapSceneToView(self.mapToScene(event.pos()))
        if self._shown.count:
            self.chosen.emit(int(min(max(round(place.x()), 0), self._shown.count - 1)))

    def _line(self, x: Any, y: Any, color: str, symbol: str) -> None:
        pen = pyqtgraph.mkPen(color, width=2.2 * self._scale)
        size = 8 * self._scale
        self.plot(x, y, pen=pen, symbol=symbol, symbolSize=size, symbolBrush=color, symbolPen=None, antialias=True)

    def _legend(self, theme: Theme, right: float, high: float, limit: float) -> None:
        size = f"{10 * self._scale:g}pt"
        words = (
            f'<div style="font-size:{size}"><span style="color:{theme.bad}">● against the field</span><br>'
            f'<span style="color:{theme.accent}">▲ against its background</span><br>'
            f'<span style="color:{theme.muted}">– – converged at {limit:g}</span></div>'
        )
        label = pyqtgraph.TextItem(html=words, anchor=(1.0, 0.0))
        label.setPos(right - 0.4, high)  # left of a cursor that stands at the end
        self.addItem(label)


class ProcessPage(LessonPage):
    """The player as a person sees it.

    Signals
    -------
    film_asked(Path)
        A film is wanted of the process in a folder.

    Parameters
    ----------
    process : ProcessController
        Where intents go.
    controller : Controller
        Told what there is to notice.
    make_canvas : callable
        Makes the pane's drawing widget.
    parent : QWidget, optional
        Owner.
    """

    film_asked = Signal(object)

    def __init__(
        self,
        process: ProcessController,
        controller: Controller,
        make_canvas: Callable[[QWidget], Canvas],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__("The adaptive process", parent)
        self.process, self._controller = process, controller
        self.folder: Path | None = None
        self.pane = Pane(ViewState(), make_canvas, self)
        self.pane.setAccessibleName("Mesh of the iteration")
        for box in (self.pane.method, self.pane.quantity):
            box.hide()
        self.pane.set_edge_rule(self._edges_show)
        self.plot = EvolutionPlot()
        self.transport = Transport("Iteration")
        self.heading, self.words, self.terms = QLabel(), rich(), TermTable()
        self.heading.setProperty("role", "title")
        self.words.setProperty("role", "lesson")
        self.form = self._build_form()
        self.start = QPushButton("Start")
        self.start.setProperty("primary", True)
        self.film_button = self.add_action("Film…", FILM_TIP)
        self.open_button = self.add_action("Folder…", FOLDER_TIP)
        self._place = QLabel("")
        self._place.setProperty("role", "muted")
        self._place.setWordWrap(True)
        self._lay_out()
        self._connect()
        self.show_process(process.shown)

    def show_process(self, shown: ProcessShown) -> None:
        """Show an iteration."""
        self.heading.setText(process_title(shown))
        self.words.setText(spaced(process_words(shown)))
        rows = process_rows(shown)
        self.terms.show_rows(rows)
        self.terms.setVisible(bool(rows))
        self.transport.show_step(shown.number, max(shown.count, 1))
        self.plot.show_process(shown)
        self.start.setText("Cancel" if shown.running else "Start")
        self.form.setEnabled(not shown.running)
        self.open_button.setEnabled(not shown.running)
        self.film_button.setEnabled(not shown.running and shown.count > 0)
        worst = 2.0
        if shown.evolution is not None and shown.count:
            worst = max(row.analytic_ratio for row in shown.evolution.iterations)
        self.pane.show_subject(
            shown.subject or Subject(title="No mesh yet"), False, dark=self.theme is not None and self.theme.dark,
            scale=ratio_scale(0.3, min(worst, 10.0), title="Size ratio R (mean edge)"),
        )  # fmt: skip

    def open_folder(self, folder: Path) -> None:
        """Open a process, or remember the folder for the next one."""
        if self.process.open(folder):
            self.folder = folder
            self._place.setText(f"Kept in {folder}")
        elif folder.is_dir():
            self.folder = folder
            self._place.setText(f"The next process is kept in {folder}")
        else:
            self._controller.noticed.emit(Notice("error", f"{folder}: is no folder; choose one"))

    def take_focus(self) -> None:
        """Put the keyboard on what begins the process, or on its iterations."""
        (self.transport.slider if self.process.shown.count else self.start).setFocus()

    def set_theme(self, theme: Theme, type_scale: float) -> None:
        """Take colours and type."""
        super().set_theme(theme, type_scale)
        self.plot.set_theme(theme, type_scale)
        self.show_process(self.process.shown)

    def dispose(self) -> None:
        """Free what VTK holds."""
        self.transport.stop()
        self.pane.surface.canvas.dispose()

    # -- inside ----------------------------------------------------------------------------------------------------

    def _build_form(self) -> Form:
        form = Form()
        form.grid.setContentsMargins(0, 0, 0, 0)
        methods = ("none", "gradient-limiting", "size-preserving")
        self.method = choice([(METHOD_TITLES[name], name) for name in methods])
        with QSignalBlocker(self.method):
            self.method.setCurrentIndex(2)
        self.cells, self.limit, self.iterations = QSpinBox(), number(1.1, 0.5, 10.0, 2), QSpinBox()
        self.cells.setRange(4, 400)
        self.cells.setValue(Asked().cells)
        self.iterations.setRange(1, 50)
        self.iterations.setValue(Asked().iterations)
        form.add("Sizes", self.method, "What is done to the sizes on each background")
        form.add("First mesh", self.cells, "Elements along the longer side of the uniform mesh; the paper has 80")
        form.add("Converged at R", self.limit, "No element's R against the field may be above this; the paper has 1.1")
        form.add("At most", self.iterations, "Give up after so many meshes; the paper has 50")
        return form

    def _lay_out(self) -> None:
        left = QVBoxLayout()
        left.setSpacing(8)
        left.addWidget(self.pane, 2)
        left.addWidget(self.transport)
        left.addWidget(self.plot, 1)
        told = QWidget()
        told.setObjectName("told")
        column = QVBoxLayout(told)
        column.setContentsMargins(18, 14, 18, 14)
        column.setSpacing(10)
        for widget in (self.heading, self.words, self.terms, self.form, self.start, self._place):
            column.addWidget(widget)
        column.addStretch(1)
        scroll = QScrollArea()
        scroll.setWidget(told)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        aside = QFrame()
        aside.setObjectName("card")
        around = QVBoxLayout(aside)
        around.addWidget(scroll)
        self.body.addLayout(left, 17)
        self.body.addWidget(aside, 10)

    def _connect(self) -> None:
        self.process.changed.connect(self.show_process)
        self.transport.moved.connect(self.process.show_iteration)
        self.plot.chosen.connect(self.process.show_iteration)
        self.start.clicked.connect(self._start_or_cancel)
        self.open_button.clicked.connect(self._ask_folder)
        self.film_button.clicked.connect(lambda: self.film_asked.emit(self.process.shown.folder))

    def _start_or_cancel(self) -> None:
        if self.process.shown.running:
            self.process.cancel()
            return
        asked = Asked(
            method=self.method.currentData(), cells=self.cells.value(), limit=self.limit.value(),
            iterations=self.iterations.value(),
        )  # fmt: skip
        self.process.start(asked, self.folder)

    def _ask_folder(self) -> None:
        chosen = QFileDialog.getExistingDirectory(self, "A folder that sizeviz adapt wrote, or an empty one")
        if chosen:
            self.open_folder(Path(chosen))

    def _edges_show(self) -> bool:
        mesh = self.pane.subject.mesh
        return mesh is not None and mesh.n_quads < EDGES_BELOW
