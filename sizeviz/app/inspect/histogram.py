"""Histograms of R and of quality, in the colours of the panes; a dragged range selects elements."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from qtpy.QtCore import Qt, Signal
from qtpy.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from sizeviz.scene.compose import scale_for
from sizeviz.scene.scale import CORRECT
from sizeviz.scene.subject import METHOD_TITLES
from sizeviz.scene.view import QUANTITIES, ViewState

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.app.theme import Theme
    from sizeviz.scene.subject import Subject
    from sizeviz.scene.view import Quantity

BINS = 60

NARROWEST = 0.02
"""Least range of quality that is shown: digits beyond that say nothing, and do not fit under the bars."""


class HistogramPanel(QWidget):
    """One quantity of one method's elements.

    Parameters
    ----------
    quantity : {'ratio', 'quality'}
        What is counted.
    theme : Theme
        Colours of ground and words.
    parent : QWidget, optional
        Owner.

    Signals
    -------
    selected(str, object)
        A method and the elements within the range, or None where the range was put away.
    """

    selected = Signal(str, object)

    def __init__(self, quantity: Quantity, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        import pyqtgraph

        self._pg: Any = pyqtgraph
        self.quantity: Quantity = quantity
        self._method = ""
        self._values: NDArray[np.float64] | None = None
        self._telling = True
        self._has_selected = False
        self.title = QLabel(QUANTITIES[quantity])
        self.title.setProperty("role", "heading")
        self.count = QLabel("")
        self.count.setProperty("role", "muted")
        self.clear_button = QPushButton("Select a range")
        self.clear_button.setCheckable(True)
        self.clear_button.setAccessibleName(f"Select elements: {QUANTITIES[quantity]}")
        self.clear_button.setToolTip("Drag the ends of a range: the elements within it are outlined in the panes")
        self.clear_button.toggled.connect(self._toggle)
        self.plot = pyqtgraph.PlotWidget(background=None)
        self.plot.setAccessibleName(f"Histogram: {QUANTITIES[quantity]}")
        self.plot.setToolTip("Elements by value; heights grow with the square root of the count, so that few are seen")
        self.plot.setMouseEnabled(False, False)
        self.plot.setMenuEnabled(False)
        self.plot.hideButtons()
        self.plot.setMinimumHeight(96)
        self.plot.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.plot.hideAxis("left")
        self._bars: Any = None
        self.range = pyqtgraph.LinearRegionItem(brush=(214, 22, 133, 40), pen={"color": (214, 22, 133), "width": 2})
        self.range.setVisible(False)
        self.range.sigRegionChanged.connect(self._select)
        self.plot.addItem(self.range)
        self._lay_out()
        self.set_theme(theme)

    def _lay_out(self) -> None:
        head = QHBoxLayout()
        head.addWidget(self.title)
        head.addWidget(self.count, 1)
        head.addWidget(self.clear_button)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 8, 12, 4)
        column.setSpacing(4)
        column.addLayout(head)
        column.addWidget(self.plot, 1)

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        self.plot.setBackground(theme.panel)
        axis = self.plot.getPlotItem().getAxis("bottom")
        axis.setPen(theme.border)
        axis.setTextPen(theme.muted)

    def show_subject(self, subject: Subject, method: str, view: ViewState) -> None:
        """Count a method's elements."""
        self._method = method
        self._values = subject.element_values(self.quantity, view.measure)
        if self._bars is not None:
            self.plot.removeItem(self._bars)
            self._bars = None
        self._name_method()
        if self._values is None or not len(self._values):
            return
        edges, heights = bins(self._values, self.quantity)
        scale = scale_for([self._values], view.with_changes(color_by=self.quantity, range_mode="auto", cmap=None))
        centres = 0.5 * (edges[1:] + edges[:-1])
        brushes = [tuple(int(c) for c in color) for color in scale.colors(centres)] if scale is not None else []
        # Square roots, so that the few elements that fail are seen beside the many that pass.
        self._bars = self._pg.BarGraphItem(
            x0=edges[:-1], x1=edges[1:], height=np.sqrt(heights), brushes=brushes, pen=None
        )
        self._bars.setZValue(-10)
        self.plot.addItem(self._bars)
        self.plot.setXRange(edges[0], edges[-1], padding=0.02)
        self.plot.setYRange(0.0, float(np.sqrt(heights.max())), padding=0.03)
        self._select()

    def set_range(self, low: float, high: float) -> None:
        """Select the elements between two values."""
        self.clear_button.setChecked(True)
        self.range.setRegion((low, high))

    def _toggle(self, on: bool) -> None:
        self.clear_button.setText("Clear range" if on else "Select a range")
        if on and self._values is not None and len(self._values):
            low, high = float(self._values.min()), float(self._values.max())
            ends = (1.0, max(high, 1.01)) if self.quantity == "ratio" else (low, low + 0.2 * (high - low))
            self._telling = False
            self.range.setRegion(ends)
            self._telling = True
        self.range.setVisible(on)
        self._select()

    def _name_method(self) -> None:
        self.count.setText("" if self._values is None else METHOD_TITLES.get(self._method, self._method).lower())

    def _select(self) -> None:
        if not self._telling:
            return
        if not self.range.isVisible() or self._values is None:
            self._name_method()
            if self._has_selected:
                self._has_selected = False
                self.selected.emit(self._method, None)
            return
        self._has_selected = True
        low, high = self.range.getRegion()
        chosen = within(self._values, low, high, self.quantity)
        self.count.setText(f"{len(chosen):,} selected")
        self.selected.emit(self._method, chosen)


def within(values: NDArray[np.float64], low: float, high: float, quantity: Quantity) -> NDArray[np.intp]:
    """Return the elements between two values; a range of R that begins at 1 begins where elements fail."""
    if quantity == "ratio" and low == 1.0:
        low = np.nextafter(CORRECT, 2.0)
    return np.flatnonzero((values >= low) & (values <= high))


def bins(values: NDArray[np.float64], quantity: Quantity) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return edges and counts; R = 1 is always an edge, and elements at 1 are counted below it."""
    low, high = float(values.min()), float(values.max())
    if quantity != "ratio":
        high = max(high, low + 1e-6)
        low = min(low, high - NARROWEST)
        heights, edges = np.histogram(values, BINS, (low, high))
        return edges, heights
    low, high = min(low, 0.95), max(high, 1.02)
    step = (high - low) / BINS
    below, above = int(np.ceil((1.0 - low) / step)), int(np.ceil((high - 1.0) / step))
    edges = 1.0 + step * np.arange(-below, above + 1)
    # bins are closed on the right, so that R = 1 is counted with what passes
    index = np.ceil((np.where(values <= CORRECT, np.minimum(values, 1.0), values) - 1.0) / step) - 1.0 + below
    heights = np.bincount(np.clip(index, 0, below + above - 1).astype(np.intp), minlength=below + above)
    return edges, heights
