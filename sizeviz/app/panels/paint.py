"""The brush: what it does, how far it reaches, what it leaves alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from qtpy.QtCore import QSignalBlocker, Qt, Signal
from qtpy.QtWidgets import QButtonGroup, QCheckBox, QGridLayout, QPushButton, QSlider, QWidget

from sizeviz.app.panels.controls import Form, LogNumber, choice, hint
from sizeviz.sources.painting import Brush, BrushMode, StrokeShape

if TYPE_CHECKING:
    from sizeviz.sizing import SizeField

MODES: tuple[tuple[str, BrushMode, str], ...] = (
    ("Set", "set", "Set the size to the value"),
    ("× factor", "multiply", "Multiply the size by the factor"),
    ("At most", "at-most", "Lower sizes above the value, leave the others"),
    ("Smooth", "smooth", "Even the sizes out"),
    ("Erase", "erase", "Bring the original sizes back"),
)
"""What the brush can do: words, mode, explanation."""

RADIUS_STEP = 1.15
"""Factor of one press of [ or ], or of one notch of the wheel."""


DAB = 25.0
"""Elements across half a dab of the brush at first: fine, but a long stroke asks for thousands and not for millions."""


class PaintPanel(Form):
    """Settings of the brush, and the switch that takes it up."""

    toggled = Signal(bool)
    brush_changed = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.switch = QPushButton("Paint on the field")
        self.switch.setCheckable(True)
        self.switch.setToolTip("Take the brush up or put it down (B)")
        self.switch.toggled.connect(self.toggled)
        self.modes: dict[BrushMode, QPushButton] = {}
        self.radius = LogNumber(1e-3, 0.5, 0.06, 4)
        self.value = LogNumber(1e-4, 0.5, 0.01, 5)
        self.factor = LogNumber(0.1, 10.0, 0.5, 3)
        self.hardness = QSlider(Qt.Orientation.Horizontal)
        self.hardness.setRange(0, 100)
        self.hardness.setValue(50)
        self.shape = choice([("freehand", "freehand"), ("line", "line"), ("polygon, filled", "polygon")])
        self.mask = QCheckBox("Only sizes between")
        self.mask_low, self.mask_high = LogNumber(1e-4, 1.0, 1e-4, 5), LogNumber(1e-4, 1.0, 1.0, 5)
        self.add_wide(self.switch)
        self.add_wide(self._mode_buttons())
        self.add("Shape", self.shape, "Lines and polygons: click the corners, double-click or Enter to finish")
        self.add("Radius", self.radius, "Reach in model units: [ and ], or Shift + wheel")
        self.add("Size", self.value, "Size to set, in model units")
        self.add("Factor", self.factor, "Factor to multiply by; below 1 refines")
        self.add("Hardness", self.hardness, "Share of the radius with full effect; the rest falls off smoothly")
        self.add_wide(self.mask)
        self.mask.setToolTip("Leave nodes alone whose size lies outside this range")
        self.add("from", self.mask_low, "Lower end of the sizes that change")
        self.add("to", self.mask_high, "Upper end of the sizes that change")
        self.note = hint("Esc drops a stroke · one undo step a stroke")
        self.add_wide(self.note)
        self._connect()
        self._enable()

    def brush(self) -> Brush:
        """Return the brush as set."""
        mode = self.mode()
        mask = None
        if self.mask.isChecked():
            low, high = sorted((self.mask_low.value(), self.mask_high.value()))
            mask = (low, high)
        return Brush(
            mode=mode,
            radius=self.radius.value(),
            value=self.factor.value() if mode == "multiply" else self.value.value(),
            hardness=self.hardness.value() / 100.0,
            mask=mask,
        )

    def mode(self) -> BrushMode:
        """Return what the brush does."""
        return next(mode for mode, button in self.modes.items() if button.isChecked())

    def stroke_shape(self) -> StrokeShape:
        """Return how a stroke is drawn."""
        shape: StrokeShape = self.shape.currentData()
        return shape

    def set_mode(self, mode: BrushMode) -> None:
        """Choose what the brush does."""
        self.modes[mode].setChecked(True)

    def step_radius(self, steps: float) -> None:
        """Make the brush larger or smaller by steps."""
        self.radius.set_value(self.radius.value() * RADIUS_STEP**steps)
        self._tell()

    def suit(self, field: SizeField, extent: float) -> None:
        """Choose a radius and a size that suit a field of the given extent, in model units."""
        self.radius.set_value(0.06 * extent)
        low, high = float(field.sizes.min()), float(field.sizes.max())
        self.value.set_value(max(low if low < 0.5 * high else 0.2 * high, 0.06 * extent / DAB))
        self.mask_low.set_value(low)
        self.mask_high.set_value(high)

    def show_active(self, active: bool) -> None:
        """Show whether the brush is up, without telling."""
        with QSignalBlocker(self.switch):
            self.switch.setChecked(active)
        self.switch.setText("Stop painting" if active else "Paint on the field")

    def _mode_buttons(self) -> QWidget:
        box = QWidget()
        grid = QGridLayout(box)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setSpacing(5)
        group = QButtonGroup(self)
        for k, (words, mode, tip) in enumerate(MODES):
            button = QPushButton(words)
            button.setCheckable(True)
            button.setToolTip(tip)
            button.setAccessibleName(f"Brush: {words}")
            group.addButton(button)
            self.modes[mode] = button
            grid.addWidget(button, k // 3, k % 3)
        self.modes["set"].setChecked(True)
        return box

    def _connect(self) -> None:
        for button in self.modes.values():
            button.toggled.connect(self._tell)
        for control in (self.radius, self.value, self.factor, self.mask_low, self.mask_high):
            control.changed.connect(self._tell)
        self.hardness.valueChanged.connect(self._tell)
        self.mask.toggled.connect(self._tell)
        self.shape.currentIndexChanged.connect(self._tell)

    def _enable(self) -> None:
        mode = self.mode() if any(button.isChecked() for button in self.modes.values()) else "set"
        self.value.setEnabled(mode in ("set", "at-most"))
        self.factor.setEnabled(mode == "multiply")
        for control in (self.mask_low, self.mask_high):
            control.setEnabled(self.mask.isChecked())

    def _tell(self, *_: Any) -> None:
        if not any(button.isChecked() for button in self.modes.values()):
            return  # between two modes
        self._enable()
        self.brush_changed.emit(self.brush())
