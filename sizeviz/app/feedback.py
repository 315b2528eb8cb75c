"""How the window talks: progress in the status bar, messages that ask for no answer, the log, About."""

from __future__ import annotations

import logging
import platform
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

from qtpy.QtCore import QObject, Qt, QTimer, Signal
from qtpy.QtWidgets import (
    QApplication,
    QDialog,
    QFrame,
    QHBoxLayout,
    QLabel,
    QPlainTextEdit,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

if TYPE_CHECKING:
    from sizeviz.app.news import Notice

TOAST_MS = 6000
"""How long a message that is no error stays."""

FOOT = 124
"""Pixels that a message keeps from the lower side: colour bars and verdicts stay in sight."""

LOG_LINES = 2000


class Progress(QWidget):
    """Words, a bar, the time left and Cancel; invisible while nothing runs."""

    cancel_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.words = QLabel()
        self.bar = QProgressBar()
        self.bar.setRange(0, 1000)
        self.bar.setTextVisible(False)
        self.bar.setFixedWidth(180)
        self.bar.setAccessibleName("Progress")
        self.left = QLabel()
        self.left.setProperty("role", "muted")
        self.left.setMinimumWidth(70)
        self.button = QPushButton("Cancel")
        self.button.setAccessibleName("Cancel the run")
        self.button.clicked.connect(self.cancel_requested)
        row = QHBoxLayout(self)
        row.setContentsMargins(8, 3, 8, 3)
        row.setSpacing(10)
        for widget in (self.words, self.bar, self.left, self.button):
            row.addWidget(widget)
        self.show_busy(False)

    def show_busy(self, busy: bool) -> None:
        """Appear empty, or vanish."""
        self.bar.setValue(0)
        self.words.setText("Starting…" if busy else "")
        self.left.setText("")
        for widget in (self.words, self.bar, self.left, self.button):
            widget.setVisible(busy)

    def show_progress(self, fraction: float, words: str, left: float) -> None:
        """Show how far the work is."""
        self.bar.setValue(round(1000 * fraction))
        self.words.setText(words[:1].upper() + words[1:])
        self.left.setText(time_left(left))


def time_left(seconds: float) -> str:
    """Return the time left in words, nothing while it is not known."""
    if seconds < 0:
        return ""
    if seconds < 1.5:
        return "almost done"
    return f"{seconds:.0f} s left" if seconds < 90 else f"{seconds / 60:.0f} min left"


class Toast(QFrame):
    """A message in the corner of the panes. Errors stay until they are closed; details can be copied."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("toast")
        self.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Maximum)
        self.text = QLabel()
        self.text.setWordWrap(True)
        self.text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.copy_button = QPushButton("Copy details")
        self.close_button = QToolButton()
        self.close_button.setText("✕")
        self.close_button.setAccessibleName("Close the message")
        row = QHBoxLayout(self)
        row.setContentsMargins(14, 10, 8, 10)
        row.addWidget(self.text, 1)
        row.addWidget(self.copy_button)
        row.addWidget(self.close_button)
        self._details = ""
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self.hide)
        self.close_button.clicked.connect(self.hide)
        self.copy_button.clicked.connect(self._copy)
        self.hide()

    def tell(self, notice: Notice) -> None:
        """Show a message."""
        self._details = notice.details or notice.text
        self.text.setText(notice.text)
        self.setProperty("level", notice.level)
        self.style().polish(self)
        self.copy_button.setVisible(notice.level == "error")
        self.setAccessibleName(f"{notice.level}: {notice.text}")
        self.show()
        self.place()
        self.raise_()
        self._timer.stop()
        if notice.level == "info":
            self._timer.start(TOAST_MS)

    def forget_error(self) -> None:
        """Take an error away once what it was about has worked."""
        if self.property("level") == "error":
            self.hide()

    def place(self) -> None:
        """Stay in the lower middle of the parent."""
        parent = self.parentWidget()
        width = min(parent.width() - 60, 640)
        self.setFixedWidth(max(width, 200))
        self.layout().activate()  # the words' height follows from the width that the buttons leave them
        self.resize(self.width(), self.layout().totalHeightForWidth(self.width()))
        self.move((parent.width() - self.width()) // 2, parent.height() - self.height() - FOOT)

    def _copy(self) -> None:
        QApplication.clipboard().setText(self._details)


class _Relay(QObject):
    """Carries log records from any thread into the window's."""

    line = Signal(str)


class LogPanel(QPlainTextEdit):
    """What sizeviz logged, newest last."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setReadOnly(True)
        self.setMaximumBlockCount(LOG_LINES)
        self.setAccessibleName("Log")
        self.setLineWrapMode(QPlainTextEdit.LineWrapMode.NoWrap)
        self._relay = _Relay()
        self._relay.line.connect(self.appendPlainText, Qt.ConnectionType.QueuedConnection)
        self._handler = _Handler(self._relay)
        self._handler.setFormatter(logging.Formatter("%(asctime)s  %(levelname)-7s %(message)s", "%H:%M:%S"))
        logging.getLogger("sizeviz").addHandler(self._handler)
        logging.getLogger("sizeviz").setLevel(logging.INFO)

    def detach(self) -> None:
        """Stop listening."""
        logging.getLogger("sizeviz").removeHandler(self._handler)


class _Handler(logging.Handler):
    def __init__(self, relay: _Relay) -> None:
        super().__init__()
        self._relay = relay

    def emit(self, record: logging.LogRecord) -> None:
        """Hand a record over; a window that is gone is no reason to fail."""
        try:
            self._relay.line.emit(self.format(record))
        except RuntimeError:
            logging.getLogger("sizeviz").removeHandler(self)


class About(QDialog):
    """Name, licence, versions, the paper."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle("About sizeviz")
        self.setMinimumWidth(520)
        title = QLabel("sizeviz")
        title.setProperty("role", "title")
        words = QLabel(
            "See, limit, preserve and honour mesh size fields.<br><br>After E. Ruiz-Gironés, X. Roca, J. Sarrate, "
            "<i>Combining Size-Preserving and Smoothing Procedures for Adaptive Quadrilateral Mesh Generation</i>, "
            "Proceedings of the 22nd International Meshing Roundtable (2013), "
            '<a href="https://doi.org/10.1007/978-3-319-02335-9">doi 10.1007/978-3-319-02335-9</a>.<br><br>'
            "BSD-3-Clause. Qt is used through PyQt, which is GPL-3."
        )
        words.setWordWrap(True)
        words.setOpenExternalLinks(True)
        self.versions = QPlainTextEdit(versions())
        self.versions.setReadOnly(True)
        self.versions.setAccessibleName("Versions")
        copy, close = QPushButton("Copy versions"), QPushButton("Close")
        copy.clicked.connect(lambda: QApplication.clipboard().setText(self.versions.toPlainText()))
        close.clicked.connect(self.accept)
        row = QHBoxLayout()
        row.addWidget(copy)
        row.addStretch(1)
        row.addWidget(close)
        column = QVBoxLayout(self)
        column.setContentsMargins(24, 20, 24, 18)
        column.setSpacing(12)
        for widget in (title, words, self.versions):
            column.addWidget(widget)
        column.addLayout(row)


def versions() -> str:
    """Return the versions of everything that matters, a line each."""
    lines = [f"Python {platform.python_version()} on {platform.platform()}"]
    for name in ("sizeviz", "numpy", "scipy", "numba", "pyvista", "pyvistaqt", "vtk", "QtPy", "PyQt5", "PyQt6"):
        try:
            lines.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            continue
    return "\n".join(lines)
