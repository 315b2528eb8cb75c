"""Type a few letters, press Enter: the command palette; and the overlay that lists all shortcuts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import QEvent, QObject, QPoint, Qt
from qtpy.QtGui import QKeySequence, QPalette
from qtpy.QtWidgets import (
    QFrame,
    QGridLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QStyledItemDelegate,
    QVBoxLayout,
    QWidget,
)

if TYPE_CHECKING:
    from qtpy.QtCore import QModelIndex
    from qtpy.QtGui import QPainter
    from qtpy.QtWidgets import QStyleOptionViewItem

    from sizeviz.app.actions import Actions


KEYS = Qt.ItemDataRole.UserRole + 1
"""Role of a command's shortcut in the list."""


class _KeysAtTheRight(QStyledItemDelegate):
    """Writes each command's shortcut at the right end of its line, quietly."""

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: QModelIndex) -> None:
        """Draw the line, then the keys."""
        super().paint(painter, option, index)
        muted = option.palette.color(QPalette.ColorRole.Text)
        muted.setAlphaF(0.6)
        painter.save()
        painter.setPen(muted)
        edge = Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignRight
        painter.drawText(option.rect.adjusted(0, 0, -10, 0), edge, index.data(KEYS) or "")
        painter.restore()


class CommandPalette(QFrame):
    """All commands that are possible now, filtered by what is typed."""

    def __init__(self, actions: Actions, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Popup)
        self.setObjectName("popup")
        self.setAccessibleName("Command palette")
        self._actions = actions
        self.query = QLineEdit()
        self.query.setPlaceholderText("Type a command")
        self.query.setAccessibleName("Command")
        self.list = QListWidget()
        self.list.setAccessibleName("Matching commands")
        self.list.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.list.setItemDelegate(_KeysAtTheRight(self.list))
        column = QVBoxLayout(self)
        column.setContentsMargins(10, 10, 10, 10)
        column.addWidget(self.query)
        column.addWidget(self.list)
        self.query.textChanged.connect(self.filter)
        self.query.returnPressed.connect(self.run)
        self.list.itemClicked.connect(lambda item: self.run())
        self.query.installEventFilter(self)

    def open(self) -> None:
        """Show the palette in the upper middle of its window."""
        window = self.parentWidget().window()
        self.resize(460, 380)
        corner = window.mapToGlobal(QPoint((window.width() - self.width()) // 2, 64))
        self.move(corner)
        self.query.clear()
        self.filter("")
        self.show()
        self.query.setFocus()

    def filter(self, words: str) -> None:
        """List the commands that match, best first."""
        self.list.clear()
        scored = []
        for command, action in self._actions:
            rank = match(words, f"{command.group} {command.title}")
            if rank is not None and action.isEnabled() and command.name != "palette":
                scored.append((rank, command.title, command.name, command.group, action))
        for _, title, name, group, action in sorted(scored, key=lambda entry: entry[0]):
            keys = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
            item = QListWidgetItem(f"{group}:  {title}")
            item.setData(Qt.ItemDataRole.UserRole, name)
            item.setData(KEYS, keys)
            item.setData(Qt.ItemDataRole.AccessibleDescriptionRole, keys)
            self.list.addItem(item)
        self.list.setCurrentRow(0)

    def run(self) -> None:
        """Do what is marked."""
        item = self.list.currentItem()
        self.hide()
        if item is not None:
            self._actions[item.data(Qt.ItemDataRole.UserRole)].trigger()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Move through the list with the arrow keys while the cursor stays in the field."""
        if event.type() == QEvent.Type.KeyPress:
            step = {Qt.Key.Key_Down: 1, Qt.Key.Key_Up: -1}.get(event.key())
            if step:
                row = (self.list.currentRow() + step) % max(self.list.count(), 1)
                self.list.setCurrentRow(row)
                return True
        return bool(super().eventFilter(watched, event))


def match(query: str, words: str) -> tuple[int, int] | None:
    """Return how well letters typed in order fit some words (smaller is better), None where they do not."""
    query, words = query.lower().replace(" ", ""), words.lower()
    where = words.replace(" ", "").find(query)
    if where >= 0:
        return 0, where
    at = gaps = 0
    for letter in query:
        found = words.find(letter, at)
        if found < 0:
            return None
        gaps += found - at
        at = found + 1
    return 1, gaps


class ShortcutOverlay(QFrame):
    """All shortcuts at a glance; any key or click closes it."""

    def __init__(self, actions: Actions, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("popup")
        self.setAccessibleName("Keyboard shortcuts")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        grid = QGridLayout(self)
        grid.setContentsMargins(28, 22, 28, 24)
        grid.setHorizontalSpacing(26)
        grid.setVerticalSpacing(5)
        title = QLabel("Keyboard shortcuts")
        title.setProperty("role", "title")
        grid.addWidget(title, 0, 0, 1, 4)
        rows = _rows(actions)
        half = -(-len(rows) // 2)
        for k, (keys, words, heading) in enumerate(rows):
            row, column = 1 + k % half, 2 * (k // half)
            if heading:
                head = QLabel(words)
                head.setProperty("role", "heading")
                grid.addWidget(head, row, column, 1, 2)
                continue
            shown = QLabel(keys)
            shown.setProperty("role", "muted")
            grid.addWidget(shown, row, column)
            grid.addWidget(QLabel(words), row, column + 1)
        self.hide()

    def open(self) -> None:
        """Show the overlay in the middle of its window."""
        self.adjustSize()
        parent = self.parentWidget()
        self.move((parent.width() - self.width()) // 2, max((parent.height() - self.height()) // 2, 8))
        self.show()
        self.raise_()
        self.setFocus()

    def event(self, event: QEvent) -> bool:
        """Take keys that are somebody's shortcut too: while the overlay is up, they close it and do nothing else."""
        if event.type() == QEvent.Type.ShortcutOverride:
            event.accept()
            return True
        return bool(super().event(event))

    def keyPressEvent(self, event: object) -> None:
        """Close."""
        self.hide()

    def mousePressEvent(self, event: object) -> None:
        """Close."""
        self.hide()

    def focusOutEvent(self, event: object) -> None:
        """Close when something else is turned to."""
        self.hide()


_MOUSE = (
    ("Drag", "Pan", False),
    ("Wheel", "Zoom at the cursor", False),
    ("Double-click", "Fit to pane", False),
    ("Click", "Pin an element", False),
    ("Shift + wheel", "Brush radius", False),
    ("Esc", "Drop the stroke", False),
    ("Enter", "Finish a line or polygon", False),
)


def _rows(actions: Actions) -> list[tuple[str, str, bool]]:
    rows: list[tuple[str, str, bool]] = []
    group = ""
    for command, action in actions:
        if not command.shortcut:
            continue
        if command.group != group:
            group = command.group
            rows.append(("", group, True))
        keys = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
        rows.append((keys, command.title, False))
    return [*rows, ("", "Mouse", True), *_MOUSE]
