"""What all lessons share: a page with a way back, rich words, and a table of terms."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import Qt, Signal
from qtpy.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sizeviz.app.theme import Theme


class LessonPage(QWidget):
    """A page that takes the place of the panes until it is left.

    Parameters
    ----------
    title : str
        Its heading.
    parent : QWidget, optional
        Owner.

    Signals
    -------
    left()
        The person wants to go back.
    """

    left = Signal()

    def __init__(self, title: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.theme: Theme | None = None
        self.leave = QPushButton("‹  Back to the window")
        self.leave.clicked.connect(self.left)
        heading = QLabel(title)
        heading.setProperty("role", "heading")
        self._head = QHBoxLayout()
        self._head.addWidget(self.leave)
        self._head.addSpacing(10)
        self._head.addWidget(heading)
        self._head.addStretch(1)
        self.body = QHBoxLayout()
        self.body.setSpacing(10)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 10, 12, 12)
        column.setSpacing(10)
        column.addLayout(self._head)
        column.addLayout(self.body, 1)

    def add_action(self, words: str, tip: str) -> QPushButton:
        """Put a button into the head of the page."""
        button = QPushButton(words)
        button.setToolTip(tip)
        self._head.addWidget(button)
        return button

    def take_focus(self) -> None:
        """Put the keyboard where the lesson goes on."""
        self.setFocus()

    def set_theme(self, theme: Theme, type_scale: float) -> None:
        """Take colours, and type ``type_scale`` times as large as usual."""
        self.theme = theme


class TermTable(QWidget):
    """Symbols, plain words and numbers, one row each."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 2, 0, 2)
        self._grid.setHorizontalSpacing(12)
        self._grid.setVerticalSpacing(3)
        self._grid.setColumnStretch(1, 1)
        self.rows: tuple[tuple[str, str, str], ...] = ()

    def show_rows(self, rows: Sequence[tuple[str, str, str]]) -> None:
        """Show other rows; labels are kept where they are."""
        for k in range(max(len(rows), len(self.rows))):
            texts = rows[k] if k < len(rows) else ("", "", "")
            for column, text in enumerate(texts):
                item = self._grid.itemAtPosition(k, column)
                label = self._label(k, column) if item is None else item.widget()
                label.setText(text)
        self.rows = tuple(rows)
        self.setAccessibleName("; ".join(f"{words} {number}" for _, words, number in rows))

    def _label(self, row: int, column: int) -> QLabel:
        label = QLabel()
        label.setProperty("role", ("heading", "muted", "heading")[column])
        if column == 2:
            label.setAlignment(Qt.AlignmentFlag.AlignRight)
        self._grid.addWidget(label, row, column)
        return label


def rich(words: str = "") -> QLabel:
    """Return a label for several lines of rich text."""
    label = QLabel(words)
    label.setWordWrap(True)
    label.setTextFormat(Qt.TextFormat.RichText)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label


def spaced(words: str) -> str:
    """Return rich text with room between its lines, for reading."""
    return f'<div style="line-height:125%">{words}</div>'


def quiet(words: str = "") -> QLabel:
    """Return a label that stands back."""
    label = QLabel(words)
    label.setProperty("role", "muted")
    return label
