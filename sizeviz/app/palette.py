"""Type a few letters, press Enter: the command palette; and the overlay that lists all shortcuts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import QEvent, QObject, QPoint, QSize, Qt
from qtpy.QtGui import QKeySequence, QPalette
from qtpy.QtWidgets import (
    QApplication,
    QFrame,
    QGridLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QScrollArea,
    QStyledItemDelegate,
    QVBoxLayout,
    QWidget,
)

if TYPE_CHECKING:
    from qtpy.QtCore import QModelIndex
    from qtpy.QtGui import QKeyEvent, QPainter
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
            rank = match(words, f"{command.group} {command.title} {command.words}")
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
    """Return how well what was typed fits some words (smaller is better), None where it does not.

    Best is what is written there; then typed words in any order; then an abbreviation, such as "gtwq".
    """
    query, words = query.lower(), words.lower()
    where = words.replace(" ", "").find(query.replace(" ", ""))
    if where >= 0:
        return 0, where
    if all(word in words for word in query.split()):
        return 1, words.find(query.split()[0])
    return (2, 0) if _abbreviates(query.replace(" ", ""), words) else None


def _abbreviates(query: str, words: str, at: int = 0) -> bool:
    """Return whether every letter continues the one before or begins a word, in order."""
    if not query:
        return True
    starts = [k for k in range(at, len(words)) if k == at or words[k - 1] == " "]
    return any(words[k] == query[0] and _abbreviates(query[1:], words, k + 1) for k in starts)


class ShortcutOverlay(QFrame):
    """All shortcuts at a glance; any key or click closes it."""

    def __init__(self, actions: Actions, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("popup")
        self.setAccessibleName("Keyboard shortcuts")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self._before: QWidget | None = None
        self.sheet = QWidget()
        self.sheet.setObjectName("told")
        grid = QGridLayout(self.sheet)
        grid.setContentsMargins(22, 16, 22, 18)
        grid.setHorizontalSpacing(26)
        grid.setVerticalSpacing(5)
        title = QLabel("Keyboard shortcuts")
        title.setProperty("role", "title")
        grid.addWidget(title, 0, 0, 1, 4)
        _fill(grid, _rows(actions))
        self.scroll = QScrollArea()
        self.scroll.setFrameShape(QFrame.Shape.NoFrame)
        self.scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.scroll.setWidgetResizable(True)
        self.scroll.setWidget(self.sheet)
        self.scroll.viewport().installEventFilter(self)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.scroll)
        self.hide()

    def open(self) -> None:
        """Show the overlay in the middle of its window, as much of it as there is room for; the rest is scrolled to."""
        parent, wish = self.parentWidget(), self.sheet.sizeHint() + QSize(14, 14)
        room = parent.size() - QSize(16, 16)
        scrolls = wish.height() > room.height()
        wish += QSize(self.scroll.verticalScrollBar().sizeHint().width() if scrolls else 0, 0)
        self.resize(wish.boundedTo(room))
        self.move((parent.width() - self.width()) // 2, (parent.height() - self.height()) // 2)
        self._before = QApplication.focusWidget()
        self.show()
        self.raise_()
        self.setFocus()

    def put_away(self) -> None:
        """Vanish, and give the keyboard back to whoever had it."""
        before, self._before = self._before, None
        self.hide()
        if before is not None and before.isVisible():
            before.setFocus()

    def event(self, event: QEvent) -> bool:
        """Take keys that are somebody's shortcut too: while the overlay is up, they close it and do nothing else."""
        if event.type() == QEvent.Type.ShortcutOverride:
            event.accept()
            return True
        return bool(super().event(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Scroll, or close."""
        bar = self.scroll.verticalScrollBar()
        steps = {
            Qt.Key.Key_Up: -3 * bar.singleStep(),
            Qt.Key.Key_Down: 3 * bar.singleStep(),
            Qt.Key.Key_PageUp: -bar.pageStep(),
            Qt.Key.Key_PageDown: bar.pageStep(),
        }
        if event.key() in steps and bar.maximum() > 0:
            bar.setValue(bar.value() + steps[event.key()])
        else:
            self.put_away()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Close at a click anywhere on the sheet."""
        if event.type() == QEvent.Type.MouseButtonPress:
            self.put_away()
        return bool(super().eventFilter(watched, event))

    def mousePressEvent(self, event: object) -> None:
        """Close."""
        self.put_away()

    def focusOutEvent(self, event: object) -> None:
        """Close when something else is turned to."""
        self._before = None
        self.hide()


def _fill(grid: QGridLayout, rows: list[tuple[str, str, bool]]) -> None:
    """Write the rows under each other in two columns of keys and words."""
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


_MOUSE = (
    ("Drag", "Pan; while painting, with the middle button", False),
    ("Arrow keys", "Pan the picture that has the keyboard", False),
    ("Wheel", "Zoom at the cursor", False),
    ("Double-click", "Fit to pane", False),
    ("Click", "Pin an element; on a verdict: go to the worst", False),
    ("Right-click", "Why is h* this here?", False),
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
