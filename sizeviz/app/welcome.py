"""The first page: what sizeviz is for, the gallery, and what was open lately."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from qtpy.QtCore import QSize, Qt, Signal
from qtpy.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QPushButton, QToolButton, QVBoxLayout, QWidget

from sizeviz.app.files import age_words
from sizeviz.app.panels.source import thumbnail

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sizeviz.app.engine import Example
    from sizeviz.study.storage.autosave import Leftover

CARD = QSize(124, 124)


class Welcome(QWidget):
    """Shown until something is open."""

    open_requested = Signal(str)
    file_requested = Signal()
    canvas_requested = Signal()
    recover_requested = Signal(object)
    lesson_requested = Signal()

    def __init__(
        self,
        examples: Sequence[Example],
        recent: Sequence[str],
        unsaved: Sequence[Leftover] = (),
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        title = QLabel("See whether a mesh honours its size field")
        title.setProperty("role", "title")
        words = QLabel("Open an example, drop a file anywhere, or paint sizes on a blank canvas.")
        words.setProperty("role", "muted")
        column = QVBoxLayout(self)
        column.setContentsMargins(48, 30, 48, 30)
        column.setSpacing(14)
        column.addStretch(1)
        for widget in (title, words):
            column.addWidget(widget, 0, Qt.AlignmentFlag.AlignHCenter)
        column.addSpacing(10)
        column.addWidget(self._gallery(examples), 0, Qt.AlignmentFlag.AlignHCenter)
        column.addLayout(self._buttons())
        if recent:
            column.addWidget(self._recent(recent), 0, Qt.AlignmentFlag.AlignHCenter)
        if unsaved:
            column.addWidget(self._unsaved(unsaved), 0, Qt.AlignmentFlag.AlignHCenter)
        column.addStretch(2)

    def _gallery(self, examples: Sequence[Example]) -> QWidget:
        frame = QFrame()
        grid = QGridLayout(frame)
        grid.setSpacing(12)
        columns = len(examples) if len(examples) <= 5 else -(-len(examples) // 2)
        for k, example in enumerate(examples):
            card = QToolButton()
            card.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
            card.setIcon(thumbnail(example.name))
            card.setIconSize(CARD)
            card.setText(example.title)
            card.setToolTip(f"<b>{example.title}</b><br>{example.words}")
            card.setAccessibleName(f"Open the example {example.title}")
            card.clicked.connect(lambda checked=False, name=example.name: self.open_requested.emit(name))
            grid.addWidget(card, k // columns, k % columns)
        return frame

    def _buttons(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setSpacing(10)
        row.addStretch(1)
        file, canvas, lesson = QPushButton("Open file…"), QPushButton("Blank canvas"), QPushButton("New here? A lesson")
        lesson.setToolTip("What a size field is, and why meshes miss it: six short steps on a line")
        lesson.clicked.connect(self.lesson_requested)
        file.setProperty("primary", True)
        file.clicked.connect(self.file_requested)
        canvas.clicked.connect(self.canvas_requested)
        row.addWidget(file)
        row.addWidget(canvas)
        row.addWidget(lesson)
        row.addStretch(1)
        return row

    def _unsaved(self, unsaved: Sequence[Leftover]) -> QWidget:
        frame = QWidget()
        row = QHBoxLayout(frame)
        label = QLabel("Not saved:")
        label.setProperty("role", "muted")
        row.addWidget(label)
        for leftover in unsaved[:3]:
            button = QToolButton()
            button.setText(f"Recover the study of {age_words(leftover.modified)}")
            button.setToolTip("It was open when the window was closed or sizeviz was ended")
            button.clicked.connect(lambda checked=False, leftover=leftover: self.recover_requested.emit(leftover))
            row.addWidget(button)
        return frame

    def _recent(self, recent: Sequence[str]) -> QWidget:
        frame = QWidget()
        row = QHBoxLayout(frame)
        label = QLabel("Recent:")
        label.setProperty("role", "muted")
        row.addWidget(label)
        for spec in recent[:5]:
            button = QToolButton()
            button.setText(spec if spec.startswith("expr:") else Path(spec).name)
            button.setToolTip(spec)
            button.clicked.connect(lambda checked=False, spec=spec: self.open_requested.emit(spec))
            row.addWidget(button)
        return frame
