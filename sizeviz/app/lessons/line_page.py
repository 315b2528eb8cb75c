"""The page of the lesson on a line: plots at the left, words and controls at the right."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import QObject, Qt, Signal
from qtpy.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from sizeviz.app.lessons.ball import term_rows
from sizeviz.app.lessons.chapters import TITLES, chapter_of, verdict_rows
from sizeviz.app.lessons.line import LineLesson, LineShown, resolved
from sizeviz.app.lessons.line_plots import LinePlots
from sizeviz.app.lessons.page import LessonPage, TermTable, quiet, rich, spaced
from sizeviz.app.lessons.transport import Transport
from sizeviz.app.panels.controls import LogNumber

if TYPE_CHECKING:
    from collections.abc import Callable

    from sizeviz.app.lessons.chapters import Chapter
    from sizeviz.app.theme import Theme

CONTROLS: dict[str, tuple[str, str, float, float]] = {
    "alpha": ("α", "radius: how many elements' room is kept around small sizes", 0.25, 4.0),
    "beta": ("β", "scale: which share of the size asked for is used", 0.25, 1.0),
    "epsilon": ("ε", "slope: how fast sizes may grow", 0.1, 3.0),
}
"""Symbol, plain words, and range of each control."""


class LineController(QObject):
    """Holds the lesson, takes intents, resolves, tells. It knows no widget.

    Signals
    -------
    changed(LineShown)
        Everything that follows from the lesson now.
    """

    changed = Signal(object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.shown: LineShown = resolved(LineLesson())

    @property
    def lesson(self) -> LineLesson:
        """What was chosen."""
        return self.shown.lesson

    def move_knot(self, index: int, x: float, size: float) -> None:
        """Drag a handle."""
        self._set(self.lesson.with_knot(index, x, size))

    def add_knot(self, x: float, size: float) -> None:
        """Add a handle."""
        self._set(self.lesson.with_new_knot(x, size))

    def remove_knot(self, index: int) -> None:
        """Remove a handle."""
        self._set(self.lesson.without_knot(index))

    def set_parameter(self, name: str, value: float) -> None:
        """Turn alpha, beta or epsilon."""
        self._set(self.lesson.with_changes(**{name: value}))

    def choose_place(self, x: float) -> None:
        """Ask for h* at another place."""
        self._set(self.lesson.with_changes(place=x))

    def show_step(self, step: int) -> None:
        """Show the ball at another step."""
        self._set(self.lesson.with_changes(step=min(max(step, 0), self.shown.ball.count - 1)))

    def show_chapter(self, chapter: int) -> None:
        """Tell another chapter."""
        self._set(self.lesson.with_changes(chapter=min(max(chapter, 0), len(TITLES) - 1)))

    def start_over(self) -> None:
        """Return to eq. (1) and the first chapter."""
        self._set(LineLesson())

    def _set(self, lesson: LineLesson) -> None:
        if lesson != self.lesson:
            self.shown = resolved(lesson)
            self.changed.emit(self.shown)


class LinePage(LessonPage):
    """The lesson as a person sees it.

    Parameters
    ----------
    controller : LineController
        Where intents go, and what tells what to show.
    parent : QWidget, optional
        Owner.
    """

    def __init__(self, controller: LineController, parent: QWidget | None = None) -> None:
        super().__init__("Sizes on a line", parent)
        self.controller = controller
        self.plots = LinePlots()
        self.count, self.heading = quiet(), QLabel()
        self.heading.setProperty("role", "title")
        self.heading.setWordWrap(True)
        self.words, self.equation, self.task = rich(), rich(), rich()
        self.words.setProperty("role", "lesson")
        self.equation.setObjectName("equation")
        self.task.setObjectName("task")
        self.verdict = rich()
        self.terms = TermTable()
        self.transport = Transport("Ball step")
        self.controls = {name: _Control(name) for name in CONTROLS}
        self.back, self.next = QPushButton("Back"), QPushButton("Next")
        self.next.setProperty("primary", True)
        self.restart = self.add_action("Start over", "Back to the paper's own field and the first step")
        self._lay_out()
        self._connect()
        self.show_lesson(controller.shown)

    def show_lesson(self, shown: LineShown) -> None:
        """Show a lesson."""
        chapter = chapter_of(shown)
        self.plots.show_lesson(shown, chapter)
        self.count.setText(f"Step {chapter.number + 1} of {len(TITLES)}")
        self.heading.setText(chapter.title)
        self.words.setText(spaced(chapter.words))
        self.equation.setText(chapter.equation)
        self.task.setText(f"<b>Try it.</b> {chapter.task}")
        self._show_verdict(shown, chapter)
        for name, control in self.controls.items():
            control.setVisible(name in chapter.controls)
            control.number.set_value(getattr(shown.lesson, name))
        for widget in (self.transport, self.terms):
            widget.setVisible(chapter.shows_ball)
        if chapter.shows_ball:
            moment = shown.ball.at(shown.lesson.step)
            self.terms.show_rows(term_rows(shown.ball, moment))
            self.transport.show_step(moment.number, shown.ball.count)
        else:
            self.transport.stop()
        self.back.setEnabled(chapter.number > 0)
        self.next.setEnabled(chapter.number < len(TITLES) - 1)

    def take_focus(self) -> None:
        """Put the keyboard on the way on."""
        self.next.setFocus()

    def set_theme(self, theme: Theme, type_scale: float) -> None:
        """Take colours and type."""
        super().set_theme(theme, type_scale)
        self.plots.set_theme(theme, type_scale)
        self.body.setStretch(0, 17 if type_scale == 1.0 else 12)
        self.show_lesson(self.controller.shown)

    # -- inside ----------------------------------------------------------------------------------------------------

    def _show_verdict(self, shown: LineShown, chapter: Chapter) -> None:
        rows = verdict_rows(shown, chapter)
        self.verdict.setVisible(bool(rows))
        good, bad = (self.theme.good, self.theme.bad) if self.theme is not None else ("", "")
        told = ""
        for name, words, passed in rows:
            color, sign = (good, "✓") if passed else (bad, "✗")
            told += f'<p style="margin:0 0 6px 0"><b style="color:{color}">{sign} {name}</b>: {words}</p>'
        self.verdict.setText(told)

    def _lay_out(self) -> None:
        told = QWidget()
        told.setObjectName("told")
        column = QVBoxLayout(told)
        column.setContentsMargins(18, 14, 18, 8)
        column.setSpacing(10)
        for widget in (self.count, self.heading, self.transport, self.words, self.equation):
            column.addWidget(widget)
        for control in self.controls.values():
            column.addWidget(control)
        for widget in (self.terms, self.verdict, self.task):
            column.addWidget(widget)
        column.addStretch(1)
        scroll = QScrollArea()
        scroll.setWidget(told)
        scroll.setWidgetResizable(True)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        steps = QHBoxLayout()
        steps.setContentsMargins(18, 6, 18, 14)
        steps.addWidget(self.back)
        steps.addStretch(1)
        steps.addWidget(self.next)
        side = QVBoxLayout()
        side.setSpacing(0)
        side.addWidget(scroll, 1)
        side.addLayout(steps)
        aside = QFrame()
        aside.setObjectName("card")
        aside.setLayout(side)
        self.body.addWidget(self.plots, 17)
        self.body.addWidget(aside, 10)

    def _connect(self) -> None:
        controller, sizes = self.controller, self.plots.sizes
        controller.changed.connect(self.show_lesson)
        sizes.knot_moved.connect(controller.move_knot)
        sizes.knot_added.connect(controller.add_knot)
        sizes.knot_removed.connect(controller.remove_knot)
        sizes.place_chosen.connect(controller.choose_place)
        self.transport.moved.connect(controller.show_step)
        for name, control in self.controls.items():
            control.number.changed.connect(self._turned(name))
        self.back.clicked.connect(lambda: controller.show_chapter(controller.lesson.chapter - 1))
        self.next.clicked.connect(lambda: controller.show_chapter(controller.lesson.chapter + 1))
        self.restart.clicked.connect(controller.start_over)

    def _turned(self, name: str) -> Callable[[float], None]:
        return lambda value: self.controller.set_parameter(name, value)


class _Control(QWidget):
    """A parameter: symbol and plain words above, a slider and its number below."""

    def __init__(self, name: str) -> None:
        super().__init__()
        symbol, words, low, high = CONTROLS[name]
        self.number = LogNumber(low, high, 1.0)
        self.number.setAccessibleName(f"{symbol}, {words}")
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(3)
        label = QLabel(f"<b>{symbol}</b> &nbsp;{words}")
        label.setWordWrap(True)
        label.setBuddy(self.number)
        column.addWidget(label)
        column.addWidget(self.number)
