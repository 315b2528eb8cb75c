"""The panel Explain: what is shown, in words, equation and numbers; or the ball that somebody asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import Qt, Signal
from qtpy.QtWidgets import (
    QButtonGroup,
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QStackedWidget,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from sizeviz.app.lessons.ball import headline, story_words, term_rows
from sizeviz.app.lessons.explain import NOTHING, TOPICS, Explanation
from sizeviz.app.lessons.page import TermTable, quiet, rich, spaced
from sizeviz.app.lessons.transport import Transport

if TYPE_CHECKING:
    from sizeviz.app.lessons.why import Asked


class _Told(QWidget):
    """A column of heading, words, equation and terms that scrolls."""

    def __init__(self) -> None:
        super().__init__()
        self.heading = QLabel()
        self.heading.setProperty("role", "title")
        self.heading.setWordWrap(True)
        self.words, self.equation = rich(), rich()
        self.words.setProperty("role", "lesson")
        self.equation.setObjectName("equation")
        self.terms = TermTable()
        told = QWidget()
        told.setObjectName("told")
        self.column = QVBoxLayout(told)
        self.column.setContentsMargins(16, 12, 16, 12)
        self.column.setSpacing(10)
        for widget in (self.heading, self.words, self.equation, self.terms):
            self.column.addWidget(widget)
        self.column.addStretch(1)
        scroll = QScrollArea()
        scroll.setObjectName("told")
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setWidget(told)
        scroll.setWidgetResizable(True)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        outer = QVBoxLayout(self)
        outer.setContentsMargins(0, 0, 0, 0)
        outer.addWidget(scroll)


class ExplainPanel(QWidget):
    """Shows an explanation, or a ball while one is told.

    Signals
    -------
    topic_chosen(str or None)
        A topic to stay with; None to follow the pane.
    why_requested()
        Somebody wants to ask about a place.
    step_requested(int), closed()
        The ball's step to show; the ball is to be put away.
    """

    topic_chosen = Signal(object)
    why_requested = Signal()
    step_requested = Signal(int)
    closed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("explain")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.explanation = NOTHING
        self.pages = QStackedWidget()
        self.topic, self.ball = _Told(), _Told()
        self._build_topics()
        self._build_ball()
        for page in (self.topic, self.ball):
            self.pages.addWidget(page)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.chips)
        column.addWidget(self.pages, 1)
        self.show_explanation(NOTHING)

    def show_explanation(self, explanation: Explanation) -> None:
        """Show what a topic means now."""
        self.explanation = explanation
        told = self.topic
        told.heading.setText(explanation.title)
        told.words.setText(spaced(explanation.words))
        told.equation.setText(explanation.equation)
        told.equation.setVisible(bool(explanation.equation))
        told.terms.show_rows(explanation.rows)
        button = self.topics.get(explanation.topic)
        if button is not None:
            button.setChecked(True)

    def show_waiting(self, where: str) -> None:
        """Show that a ball was asked for."""
        self.pages.setCurrentWidget(self.ball)
        self.chips.hide()
        self.ball.words.setText(spaced(where))
        for widget in (self.ball.equation, self.ball.terms, self.transport):
            widget.hide()

    def show_ball(self, asked: Asked) -> None:
        """Show a moment of a ball."""
        self.pages.setCurrentWidget(self.ball)
        self.chips.hide()
        story = asked.story
        moment = story.at(asked.step)
        self.ball.words.setText(spaced(f"<b>{headline(story, moment)}</b><br><br>{story_words(story, moment)}"))
        self.ball.terms.show_rows(term_rows(story, moment))
        self.transport.show_step(moment.number, story.count)
        for widget in (self.ball.equation, self.ball.terms, self.transport):
            widget.show()

    def show_no_ball(self) -> None:
        """Return to the explanation."""
        self.transport.stop()
        self.pages.setCurrentWidget(self.topic)
        self.chips.show()

    # -- inside ----------------------------------------------------------------------------------------------------

    def _build_topics(self) -> None:
        self.chips = QWidget()
        row = QHBoxLayout(self.chips)
        row.setContentsMargins(12, 10, 12, 0)
        row.setSpacing(3)
        self.topics: dict[str, QToolButton] = {}
        group = QButtonGroup(self)
        for name, words in TOPICS.items():
            button = QToolButton()
            button.setText(words)
            button.setCheckable(True)
            button.setAccessibleName(f"Explain: {words}")
            button.setToolTip("Choosing what a pane shows changes the topic too")
            button.clicked.connect(lambda checked=False, name=name: self.topic_chosen.emit(name))
            group.addButton(button)
            row.addWidget(button)
            self.topics[name] = button
        row.addStretch(1)
        self.ask = QPushButton("Why is h* this here?…")
        self.ask.setToolTip("Then click a place: the ball of Algorithm 1 shrinks there, step by step (H)")
        self.ask.clicked.connect(self.why_requested)
        self.topic.column.insertWidget(self.topic.column.count() - 1, self.ask)

    def _build_ball(self) -> None:
        self.transport = Transport("Ball step")
        self.transport.moved.connect(self.step_requested)
        self.done = QPushButton("Done")
        self.done.setProperty("primary", True)
        self.done.setToolTip("Put the ball away and show again what was there before (Esc)")
        self.done.clicked.connect(self.closed)
        told = self.ball
        told.heading.setText("Why is h* this here?")
        told.equation.setText("r = α · min { h(y) : |x − y| ≤ r }, &nbsp; h* = β·r/α &nbsp;&nbsp;(6)")
        told.column.insertWidget(1, self.transport)  # above the words, which grow and shrink
        row = QHBoxLayout()
        row.addWidget(quiet("Click another place to ask there."), 1)
        row.addWidget(self.done)
        told.column.insertLayout(told.column.count() - 1, row)
