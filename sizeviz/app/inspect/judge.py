"""What was judged: the table of all methods, histograms with a range to drag, and the worst elements."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from qtpy.QtCore import QAbstractTableModel, QModelIndex, QSignalBlocker, Qt, Signal
from qtpy.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from sizeviz.app.inspect.tables import FORMATS, Table, statistics
from sizeviz.app.panels.controls import choice, hint
from sizeviz.scene.subject import METHOD_TITLES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from sizeviz.conformity import Measure, MeshReport
    from sizeviz.scene.subject import Subject
    from sizeviz.study import Study

WORST = 100
"""Rows of the list of worst elements."""

HEAD_PADDING = 14
"""Pixels above and below the words in a table's head, together."""


class GridModel(QAbstractTableModel):
    """A read-only table of words."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.table = Table(("",), ())

    def set_table(self, table: Table) -> None:
        """Show another table."""
        self.beginResetModel()
        self.table = table
        self.endResetModel()

    def rowCount(self, parent: QModelIndex | None = None) -> int:
        """Return the number of rows."""
        return len(self.table.rows)

    def columnCount(self, parent: QModelIndex | None = None) -> int:
        """Return the number of columns."""
        return len(self.table.header)

    def data(self, index: QModelIndex, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return a cell's words, numbers to the right."""
        if role == Qt.ItemDataRole.DisplayRole:
            return self.table.rows[index.row()][index.column()]
        if role == Qt.ItemDataRole.TextAlignmentRole and index.column() > 0:
            return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        return None

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return a column's head."""
        if orientation == Qt.Orientation.Horizontal and section < len(self.table.header):
            if role == Qt.ItemDataRole.DisplayRole:
                return self.head(section)
            if role == Qt.ItemDataRole.TextAlignmentRole and section > 0:
                return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        return None

    def head(self, section: int) -> str:
        """Return a column's head, on as many lines as it has parts."""
        return self.table.header[section].replace(" (", "\n(").replace(" ", "\n", 1)


class StatisticsPanel(QWidget):
    """The table of the paper for the methods at hand, and its copies."""

    copied = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model = GridModel(self)
        self.view = _table_view(self.model, "Statistics of the methods")
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 10, 12, 8)
        column.setSpacing(7)
        column.addWidget(self.view, 1)
        row = QHBoxLayout()
        row.setSpacing(6)
        row.addWidget(hint("Copy as"))
        self.buttons: dict[str, QPushButton] = {}
        for name in FORMATS:
            button = QPushButton(name)
            button.setAccessibleName(f"Copy the table as {name}")
            button.setToolTip(f"Copy the table as {name}, to paste it elsewhere")
            button.clicked.connect(lambda checked=False, name=name: self.copy(name))
            self.buttons[name] = button
            row.addWidget(button, 1)
        column.addLayout(row)

    def show_study(
        self,
        study: Study | None,
        methods: tuple[str, ...],
        measure: Measure,
        stale: Mapping[str, MeshReport] | None = None,
    ) -> None:
        """Show the numbers of a study's methods, older ones where there are no newer."""
        self.model.set_table(statistics(study, methods, measure, stale))
        header = self.view.horizontalHeader()
        header.setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.ResizeToContents)
        heads = [self.model.head(column).splitlines() for column in range(self.model.columnCount())]
        metrics = header.fontMetrics()
        widest = max((metrics.horizontalAdvance(line) for lines in heads for line in lines), default=0)
        header.setMinimumSectionSize(widest + HEAD_PADDING)  # many methods are scrolled to; no head is cut
        header.setFixedHeight(max(len(lines) for lines in heads) * metrics.lineSpacing() + HEAD_PADDING)

    def copy(self, name: str) -> None:
        """Put the table on the clipboard."""
        QApplication.clipboard().setText(FORMATS[name](self.model.table))
        self.copied.emit(name)


class WorstPanel(QWidget):
    """The worst elements of one method; choosing a row goes there."""

    chosen = Signal(str, int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._method = ""
        self._elements: NDArray[np.intp] = np.empty(0, dtype=np.intp)
        self.title = QLabel("Worst elements")
        self.title.setProperty("role", "heading")
        self.order = choice([("by R", "ratio"), ("by quality", "quality")])
        self.order.setAccessibleName("Order of the worst elements")
        self.model = GridModel(self)
        self.view = _table_view(self.model, "Worst elements")
        self.view.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.view.selectionModel().currentRowChanged.connect(self._move)
        for chosen in (self.view.clicked, self.view.activated):
            chosen.connect(lambda index: self._choose(index))
        head = QHBoxLayout()
        head.addWidget(self.title, 1)
        head.addWidget(self.order)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 8, 12, 10)
        column.setSpacing(7)
        column.addLayout(head)
        column.addWidget(self.view, 1)
        self._shown: tuple[Subject, str, Measure] | None = None
        self.order.currentIndexChanged.connect(self._again)

    def show_subject(self, subject: Subject, method: str, measure: Measure) -> None:
        """List the worst elements of a method's mesh."""
        self._shown = (subject, method, measure)
        self._again()

    @property
    def elements(self) -> NDArray[np.intp]:
        """The elements listed, worst first."""
        return self._elements

    def select(self, element: int) -> None:
        """Mark an element's row, if it is listed, without going there."""
        rows = np.flatnonzero(self._elements == element)
        with QSignalBlocker(self.view.selectionModel()):
            if len(rows):
                self.view.selectRow(int(rows[0]))
            else:
                self.view.clearSelection()
        self.view.viewport().update()

    def _again(self) -> None:
        if self._shown is None:
            return
        subject, self._method, measure = self._shown
        self.title.setText(f"Worst: {METHOD_TITLES.get(self._method, self._method).lower()}")
        ratios = subject.element_values("ratio", measure)
        quality = subject.element_values("quality", measure)
        if ratios is None or quality is None or subject.mesh is None:
            self._elements = np.empty(0, dtype=np.intp)
            self._set(Table(("Element", "R", "Quality", "x", "y"), ()))
            return
        by_ratio = self.order.currentData() == "ratio"
        self._elements = worst(-ratios if by_ratio else quality, WORST)
        centres = subject.mesh.points[subject.mesh.quads[self._elements]].mean(axis=1)
        rows = tuple(
            (str(e), f"{ratios[e]:.3f}", f"{quality[e]:.3f}", f"{x:.4g}", f"{y:.4g}")
            for e, (x, y) in zip(self._elements, centres, strict=True)
        )
        self._set(Table(("Element", "R", "Quality", "x", "y"), rows))

    def _set(self, table: Table) -> None:
        with QSignalBlocker(self.view.selectionModel()):
            self.model.set_table(table)
        self.view.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)

    def _move(self, index: QModelIndex, before: QModelIndex) -> None:
        """Follow the arrow keys; the row that Qt marks when the keyboard merely passes by is nobody's choice."""
        if before.isValid() or index.row() > 0:
            self._choose(index)

    def _choose(self, index: QModelIndex) -> None:
        if 0 <= index.row() < len(self._elements):
            self.chosen.emit(self._method, int(self._elements[index.row()]))


def worst(values: NDArray[np.float64], count: int) -> NDArray[np.intp]:
    """Return the positions of the smallest values, smallest first, ties by position."""
    count = min(count, len(values))
    part = np.argpartition(values, count - 1)[:count] if count else np.empty(0, dtype=np.intp)
    return part[np.lexsort((part, values[part]))]


def _table_view(model: GridModel, name: str) -> QTableView:
    view = QTableView()
    view.setModel(model)
    view.setAccessibleName(name)
    view.verticalHeader().hide()
    view.verticalHeader().setDefaultSectionSize(20)
    view.setShowGrid(False)
    view.setAlternatingRowColors(True)
    view.setWordWrap(False)
    view.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
    view.setTabKeyNavigation(False)
    view.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
    view.horizontalHeader().setHighlightSections(False)
    return view
