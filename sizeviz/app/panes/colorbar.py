"""The colour bar under a pane, and the small editor that opens from it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from qtpy.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from qtpy.QtGui import QColor, QFontMetricsF, QImage, QPen
from qtpy.QtWidgets import QCheckBox, QComboBox, QDoubleSpinBox, QFormLayout, QFrame, QLabel, QSpinBox, QWidget

from sizeviz.app.qt import painting
from sizeviz.scene.colormaps import MAPS, RATIO_MAP
from sizeviz.scene.compose import DEFAULT_MAPS, LOG_QUANTITIES

if TYPE_CHECKING:
    from qtpy.QtGui import QKeyEvent, QMouseEvent, QPainter, QPaintEvent

    from sizeviz.scene.scale import ColorScale
    from sizeviz.scene.view import ViewState

BAR_HEIGHT = 11
MARGIN = 14


class ColorBar(QWidget):
    """A horizontal bar with ticks; a click, Enter or Space opens its editor."""

    edit_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._scale: ColorScale | None = None
        self._strip: QImage | None = None
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.setAccessibleName("Colour bar")
        self.setToolTip("Colour bar: click to choose map, range and classes")

    @property
    def scale(self) -> ColorScale | None:
        """What the bar shows."""
        return self._scale

    def set_scale(self, scale: ColorScale | None) -> None:
        """Show another scale, or nothing."""
        if scale == self._scale:
            return
        self._scale = scale
        if scale is not None:
            colors = np.ascontiguousarray(scale.bar(512)[None])
            self._strip = QImage(colors.tobytes(), 512, 1, 3 * 512, QImage.Format.Format_RGB888).copy()
            ends = f"{scale.value_at(0.0):.3g} to {scale.value_at(1.0):.3g}"
            self.setAccessibleDescription(f"{scale.title}, {ends}, {scale.norm}")
        self.update()

    def sizeHint(self) -> QSize:
        """Return room for the strip and one line of ticks."""
        return QSize(200, BAR_HEIGHT + 10 + math.ceil(QFontMetricsF(self.font()).height()))

    def changeEvent(self, event: QEvent) -> None:
        """Make room for larger type."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self.updateGeometry()

    def minimumSizeHint(self) -> QSize:
        """Return the same height at any width."""
        return QSize(80, self.sizeHint().height())

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw strip and ticks; labels that would touch are left out, but never 1 and 1.1 of R's bar."""
        if self._scale is None or self._strip is None:
            return
        with painting(self) as painter:
            self._paint(painter, self._scale, self._strip)

    def _paint(self, painter: QPainter, scale: ColorScale, strip: QImage) -> None:
        box = QRectF(MARGIN, 4, self.width() - 2 * MARGIN, BAR_HEIGHT)
        painter.drawImage(box, strip)
        ink = self.palette().color(self.foregroundRole())
        metrics = QFontMetricsF(self.font())
        taken: list[QRectF] = []
        for at, label in _by_weight(scale):
            x = box.left() + at * box.width()
            width = metrics.horizontalAdvance(label)
            left = min(max(x - 0.5 * width, 0.0), self.width() - width)
            room = QRectF(left - 4, box.bottom() + 3, width + 8, metrics.height())
            if any(room.intersects(other) for other in taken):
                continue
            taken.append(room)
            painter.setPen(QPen(ink, 1.0))
            painter.drawLine(QPointF(x, box.bottom()), QPointF(x, box.bottom() + 4))
            painter.drawText(QPointF(left, box.bottom() + 5 + metrics.ascent()), label)
        if self.hasFocus():
            painter.setPen(QPen(QColor(self.palette().highlight().color()), 1.4))
            painter.drawRect(box.adjusted(-2, -2, 2, 2))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Open the editor."""
        self.edit_requested.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Open the editor by keyboard."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Space):
            self.edit_requested.emit()


def _by_weight(scale: ColorScale) -> list[tuple[float, str]]:
    ticks = scale.ticks()
    if scale.norm != "ratio":
        ends_first = [ticks[0], ticks[-1], *ticks[1:-1]] if len(ticks) > 2 else ticks
        return ends_first
    return sorted(ticks, key=lambda tick: (tick[1] not in ("1", "1.1"), tick[1]))


class ColorBarEditor(QFrame):
    """Map, range and classes of one pane's bar; every change is shown at once."""

    view_changed = Signal(object)

    def __init__(self, view: ViewState, scale: ColorScale | None, parent: QWidget | None = None) -> None:
        super().__init__(parent, Qt.WindowType.Popup)
        self.setObjectName("popup")
        self.setAccessibleName("Colour bar editor")
        self._view = view
        low, high = (scale.low, scale.high) if scale is not None else (0.0, 1.0)
        self.map = QComboBox()
        broken = view.color_by == "ratio"
        self.map.addItems([name for name in MAPS if broken or name != RATIO_MAP.name])
        self.map.addItems([f"{name}_r" for name in MAPS if name != RATIO_MAP.name])
        self.map.setCurrentText(view.cmap or DEFAULT_MAPS[view.color_by])
        self.mode = QComboBox()
        for words, mode in (("Automatic", "auto"), ("Percentiles", "percentile"), ("Fixed", "fixed")):
            self.mode.addItem(words, mode)
        self.mode.setCurrentIndex(max(self.mode.findData(view.range_mode), 0))
        self.low, self.high = _number(low), _number(high)
        self.percentile = _number(view.percentile, 0.0, 49.0, 2)
        self.percentile.setSuffix(" %")
        self.log = QCheckBox("Logarithmic")
        self.log.setChecked(view.color_by in LOG_QUANTITIES if view.log is None else view.log)
        self.log.setEnabled(not broken)
        self.classes = QSpinBox()
        self.classes.setRange(0, 64)
        self.classes.setSpecialValueText("continuous")
        self.classes.setValue(view.classes)
        self.remedy = QLabel()
        self.remedy.setProperty("role", "bad")
        self.remedy.setWordWrap(True)
        self.remedy.hide()
        self._lay_out()
        self._connect()
        self._enable()

    def _lay_out(self) -> None:
        form = QFormLayout(self)
        form.setContentsMargins(14, 12, 14, 14)
        form.setSpacing(8)
        rows = (
            ("Map", self.map, "Colours from low to high; _r turns a map round"),
            ("Range", self.mode, "All values, all but a share at each end, or the two numbers below"),
            ("From", self.low, "Lower end of a fixed range"),
            ("to", self.high, "Upper end of a fixed range"),
            ("Cut off", self.percentile, "Share of the values left out at each end, for percentiles"),
            ("", self.log, "Equal factors get equal lengths of the bar; R always has it so"),
            ("Classes", self.classes, "Steps of colour; 0 is continuous"),
        )
        for words, control, tip in rows:
            control.setAccessibleName(words or "Logarithmic")
            control.setToolTip(tip)
            form.addRow(words, control)
        form.addRow(self.remedy)

    def _connect(self) -> None:
        self.map.currentTextChanged.connect(self._tell)
        self.mode.currentIndexChanged.connect(self._tell)
        self.log.toggled.connect(self._tell)
        for spin in (self.low, self.high, self.percentile, self.classes):
            spin.valueChanged.connect(self._tell)

    def _enable(self) -> None:
        mode = self.mode.currentData()
        for control in (self.low, self.high):
            control.setEnabled(mode == "fixed")
        self.percentile.setEnabled(mode == "percentile")

    def _tell(self, *_: object) -> None:
        self._enable()
        low, high = self.low.value(), self.high.value()
        fixed = self.mode.currentData() == "fixed"
        logarithmic = self.log.isChecked() or self._view.color_by == "ratio"
        wrong = fixed and (not low < high or (logarithmic and low <= 0))
        for control in (self.low, self.high):
            control.setProperty("invalid", wrong)
            control.style().polish(control)
        self.remedy.setText("From must lie below to" if not low < high else "A logarithmic range begins above 0")
        self.remedy.setVisible(wrong)
        self.adjustSize()
        if wrong:
            return
        self._view = self._view.with_changes(
            cmap=self.map.currentText(),
            range_mode=self.mode.currentData(),
            low=low if fixed else None,
            high=high if fixed else None,
            percentile=self.percentile.value(),
            log=None if self._view.color_by == "ratio" else self.log.isChecked(),
            classes=self.classes.value(),
        )
        self.view_changed.emit(self._view)


def _number(value: float, low: float = -1e9, high: float = 1e9, decimals: int = 6) -> QDoubleSpinBox:
    spin = QDoubleSpinBox()
    spin.setDecimals(decimals)
    spin.setRange(low, high)
    spin.setStepType(QDoubleSpinBox.StepType.AdaptiveDecimalStepType)
    spin.setKeyboardTracking(False)
    spin.setValue(value)
    return spin
