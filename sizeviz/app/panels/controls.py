"""The few controls that all panels are made of."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from qtpy.QtCore import QEvent, QRect, QSignalBlocker, QSize, Qt, Signal
from qtpy.QtGui import QFontMetrics
from qtpy.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QSizePolicy,
    QSlider,
    QStyle,
    QStyleOptionComboBox,
    QStylePainter,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from sizeviz.app.qt import painting

if TYPE_CHECKING:
    from collections.abc import Sequence

    from qtpy.QtGui import QMouseEvent, QPaintEvent, QResizeEvent

SLIDER_STEPS = 400


class Section(QFrame):
    """A part of the sidebar that folds away under its heading."""

    def __init__(self, title: str, body: QWidget, parent: QWidget | None = None, open_: bool = True) -> None:
        super().__init__(parent)
        self.setObjectName("section")
        self.body = body
        self.head = QToolButton()
        self.head.setObjectName("sectionHead")
        self.head.setText(title)
        self.head.setCheckable(True)
        self.head.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.head.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.head.setAccessibleName(f"{title}: show or hide")
        self.head.toggled.connect(self._fold)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.head)
        column.addWidget(body)
        self.head.setChecked(open_)
        self._fold(open_)

    def _fold(self, open_: bool) -> None:
        self.head.setArrowType(Qt.ArrowType.DownArrow if open_ else Qt.ArrowType.RightArrow)
        self.body.setVisible(open_)


class Form(QWidget):
    """Rows of a label and a control, with a tooltip each."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.grid = QGridLayout(self)
        self.grid.setContentsMargins(14, 2, 14, 14)
        self.grid.setHorizontalSpacing(10)
        self.grid.setVerticalSpacing(7)
        self.grid.setColumnStretch(1, 1)

    def add(self, label: str, control: QWidget, tip: str) -> None:
        """Add a row; the control is named for screen readers by its label."""
        row = self.grid.rowCount()
        words = QLabel(label)
        words.setBuddy(control)
        for widget in (words, control):
            widget.setToolTip(tip)
        if not control.accessibleName():
            control.setAccessibleName(label)
        self.grid.addWidget(words, row, 0)
        self.grid.addWidget(control, row, 1)

    def add_wide(self, widget: QWidget) -> None:
        """Add a row of one widget."""
        self.grid.addWidget(widget, self.grid.rowCount(), 0, 1, 2)


class LogNumber(QWidget):
    """A positive number: a field to type in, and a slider whose even steps are even factors."""

    changed = Signal(float)

    def __init__(self, low: float, high: float, value: float, decimals: int = 3, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._low, self._high = low, high
        self.spin = number(value, low * 1e-3, high * 1e3, decimals)
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setRange(0, SLIDER_STEPS)
        self.slider.setPageStep(SLIDER_STEPS // 20)
        self.spin.setFixedWidth(88)
        self.slider.setMinimumWidth(50)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(9)
        row.addWidget(self.slider, 1)
        row.addWidget(self.spin)
        self.setFocusProxy(self.spin)
        self.spin.valueChanged.connect(self._typed)
        self.slider.valueChanged.connect(self._slid)
        self.set_value(value)

    def value(self) -> float:
        """Return the number."""
        return float(self.spin.value())

    def set_value(self, value: float) -> None:
        """Show a number without telling."""
        with QSignalBlocker(self.spin), QSignalBlocker(self.slider):
            self.spin.setValue(value)
            self.slider.setValue(self._place(value))

    def setAccessibleName(self, name: str) -> None:
        """Name both parts for screen readers."""
        super().setAccessibleName(name)
        self.spin.setAccessibleName(name)
        self.slider.setAccessibleName(f"{name}, slider")

    def _place(self, value: float) -> int:
        share = math.log(max(value, 1e-300) / self._low) / math.log(self._high / self._low)
        return round(SLIDER_STEPS * min(max(share, 0.0), 1.0))

    def _typed(self, value: float) -> None:
        with QSignalBlocker(self.slider):
            self.slider.setValue(self._place(value))
        self.changed.emit(value)

    def _slid(self, step: int) -> None:
        value = self._low * (self._high / self._low) ** (step / SLIDER_STEPS)
        digits = 2 - math.floor(math.log10(value))
        value = round(value, digits)
        with QSignalBlocker(self.spin):
            self.spin.setValue(value)
        self.changed.emit(value)


class ElidedLabel(QLabel):
    """A line of words that ends in an ellipsis where there is no room for all of it; ``text`` is still the whole."""

    def __init__(self, words: str = "", parent: QWidget | None = None) -> None:
        super().__init__(words, parent)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)

    @property
    def shown(self) -> str:
        """The words as they are drawn."""
        room = self.contentsRect().width()
        return str(self.fontMetrics().elidedText(self.text(), Qt.TextElideMode.ElideRight, room))

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw what fits, in the style's colour."""
        middle = Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft
        with painting(self) as painter:
            painter.setPen(self.palette().color(self.foregroundRole()))
            painter.drawText(self.contentsRect(), middle, self.shown)


class VerdictLabel(QLabel):
    """Words that are always seen whole: on two lines where one is too short for the longest verdict.

    Whether there are two depends on the width alone, so that panes of one width stay aligned whatever they say.
    """

    clicked = Signal()

    LONGEST = "✗  99.9990 % correct, worst R = 1.0001 at element 1000000"

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("", parent)
        self.setObjectName("verdict")
        self.setWordWrap(True)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.setAlignment(Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Tell of a click."""
        if event.button() == Qt.MouseButton.LeftButton and self.rect().contains(event.pos()):
            self.clicked.emit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Take as many lines as the width asks for."""
        super().resizeEvent(event)
        self._suit()

    def changeEvent(self, event: QEvent) -> None:
        """Follow the font."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.FontChange:
            self._suit()

    def _suit(self) -> None:
        font = self.font()
        font.setBold(True)
        metrics = QFontMetrics(font)
        lines = min(-(-metrics.horizontalAdvance(self.LONGEST) // max(self.width(), 1)), 4)
        self.setFixedHeight(lines * metrics.lineSpacing() + 3)


class Menu(QComboBox):
    """A menu that is wide enough for its longest entry where there is room, and shrinks where there is not."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        self.setMinimumWidth(60)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)

    def sizeHint(self) -> QSize:
        """Return room for the longest entry, the arrow, and the space that the style sheet puts around them."""
        widest = max((self.fontMetrics().horizontalAdvance(self.itemText(k)) for k in range(self.count())), default=0)
        option = QStyleOptionComboBox()
        self.initStyleOption(option)
        option.rect = QRect(0, 0, 400, 40)
        field = QStyle.SubControl.SC_ComboBoxEditField
        inner = self.style().subControlRect(QStyle.ComplexControl.CC_ComboBox, option, field, self).width()
        return QSize(widest + 400 - inner + 4, super().sizeHint().height())

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the menu, its words ending in an ellipsis where there is no room for all of them."""
        option = QStyleOptionComboBox()
        self.initStyleOption(option)
        field = QStyle.SubControl.SC_ComboBoxEditField
        room = self.style().subControlRect(QStyle.ComplexControl.CC_ComboBox, option, field, self).width()
        option.currentText = self.fontMetrics().elidedText(option.currentText, Qt.TextElideMode.ElideRight, room - 2)
        with painting(self, QStylePainter) as painter:
            painter.drawComplexControl(QStyle.ComplexControl.CC_ComboBox, option)
            painter.drawControl(QStyle.ControlElement.CE_ComboBoxLabel, option)


def number(value: float, low: float, high: float, decimals: int = 3) -> QDoubleSpinBox:
    """Return a field for a number; it tells when the number is finished, not at every key."""
    spin = QDoubleSpinBox()
    spin.setDecimals(decimals)
    spin.setRange(low, high)
    spin.setStepType(QDoubleSpinBox.StepType.AdaptiveDecimalStepType)
    spin.setKeyboardTracking(False)
    spin.setMinimumWidth(60)  # not as wide as the largest number it could hold
    spin.setValue(value)
    return spin


def choice(entries: Sequence[tuple[str, object]]) -> QComboBox:
    """Return a menu of words, each with the value it stands for."""
    box = QComboBox()
    for words, value in entries:
        box.addItem(words, value)
    box.setMinimumWidth(60)
    return box


def choose(box: QComboBox, value: object) -> None:
    """Show the entry that stands for a value, without telling."""
    with QSignalBlocker(box):
        box.setCurrentIndex(max(box.findData(value), 0))


def hint(words: str = "") -> QLabel:
    """Return a line of quiet explanation."""
    label = QLabel(words)
    label.setProperty("role", "muted")
    label.setWordWrap(True)
    return label
