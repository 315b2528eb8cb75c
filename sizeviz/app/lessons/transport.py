"""Play, step and slide through the steps of something."""

from __future__ import annotations

from qtpy.QtCore import QSignalBlocker, Qt, QTimer, Signal
from qtpy.QtWidgets import QHBoxLayout, QLabel, QSizePolicy, QSlider, QToolButton, QWidget

PLAY_SECONDS = 10.0
"""How long playing from the first step to the last takes, within the limits below."""

SHORTEST_MS, LONGEST_MS = 60, 900
"""Least and greatest time that a step stays while it is played."""


class Transport(QWidget):
    """A slider with buttons to go back, play and go on. It holds no state of what it moves through.

    Parameters
    ----------
    name : str
        What a step is called, such as 'Step'.
    parent : QWidget, optional
        Owner.

    Signals
    -------
    moved(int)
        Somebody asks for a step, from 0.
    """

    moved = Signal(int)

    def __init__(self, name: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.name = name
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setAccessibleName(f"{name}, slider")
        self.slider.setMinimumWidth(60)
        self.label = QLabel()
        self.label.setProperty("role", "muted")
        self.label.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)
        self.back, self.forward = self._button("◀", "Back one"), self._button("▶", "On one")
        self.play = self._button("Play", "Play to the end")
        self.play.setCheckable(True)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        for widget in (self.back, self.play, self.forward):
            row.addWidget(widget)
        row.addWidget(self.slider, 1)
        row.addWidget(self.label)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._tick)
        self.slider.valueChanged.connect(self._slid)
        self.back.clicked.connect(lambda: self._go(self.slider.value() - 1))
        self.forward.clicked.connect(lambda: self._go(self.slider.value() + 1))
        self.play.toggled.connect(self._play)
        self.show_step(0, 1)

    @property
    def is_playing(self) -> bool:
        """Whether steps follow each other by themselves."""
        return bool(self._timer.isActive())

    def show_step(self, number: int, count: int) -> None:
        """Show where things are, without telling; playing ends at the last step."""
        with QSignalBlocker(self.slider):
            self.slider.setRange(0, max(count - 1, 0))
            self.slider.setPageStep(max(count // 10, 1))
            self.slider.setValue(number)
        self.label.setText(f"{number + 1} of {count}")
        self.back.setEnabled(number > 0)
        self.forward.setEnabled(number < count - 1)
        self.play.setEnabled(count > 1)
        self._timer.setInterval(int(min(max(1000 * PLAY_SECONDS / max(count, 1), SHORTEST_MS), LONGEST_MS)))
        if number >= count - 1:
            self.stop()

    def stop(self) -> None:
        """Play no further."""
        self._timer.stop()
        if self.play.isChecked():
            with QSignalBlocker(self.play):
                self.play.setChecked(False)
        self.play.setText("Play")

    def _play(self, on: bool) -> None:
        if not on:
            self.stop()
            return
        if self.slider.value() >= self.slider.maximum():
            self.moved.emit(0)
            with QSignalBlocker(self.play):
                self.play.setChecked(True)
        self.play.setText("Pause")
        self._timer.start()

    def _tick(self) -> None:
        self.moved.emit(min(self.slider.value() + 1, self.slider.maximum()))

    def _slid(self, number: int) -> None:
        self.stop()
        self.moved.emit(number)

    def _go(self, number: int) -> None:
        self.stop()
        self.moved.emit(number)

    def _button(self, words: str, what: str) -> QToolButton:
        button = QToolButton()
        button.setText(words)
        button.setToolTip(what)
        button.setAccessibleName(f"{self.name}: {what.lower()}")
        return button
