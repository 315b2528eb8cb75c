"""Where the size field comes from: gallery, file, formula, blank canvas."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

from qtpy.QtCore import QSize, Qt, Signal
from qtpy.QtGui import QColor, QIcon, QPixmap
from qtpy.QtWidgets import QHBoxLayout, QLineEdit, QListView, QListWidget, QListWidgetItem, QPushButton, QSpinBox

from sizeviz.app.panels.controls import Form, hint, number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from qtpy.QtWidgets import QWidget

    from sizeviz.app.engine import Example
    from sizeviz.sources import Source

THUMBNAIL = QSize(72, 72)


class SourcePanel(Form):
    """The first step of the pipeline."""

    open_requested = Signal(str)
    file_requested = Signal()
    canvas_requested = Signal(int, float)

    def __init__(self, examples: Sequence[Example], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.now = hint("Nothing open yet")
        self.gallery = Gallery(examples)
        self.gallery.chosen.connect(self.open_requested)
        self.formula = QLineEdit()
        self.formula.setPlaceholderText("0.02 + 0.2*abs(x - 0.5)")
        self.formula.setAccessibleName("Formula in x and y")
        self.formula.setClearButtonEnabled(True)
        self.formula.returnPressed.connect(self._open_formula)
        self.file_button = QPushButton("Open file…")
        self.file_button.setToolTip("Images, NumPy arrays, meshes with sizes; or drop a file on the window (Ctrl+O)")
        self.file_button.clicked.connect(self.file_requested)
        self.canvas_button = QPushButton("Blank canvas")
        self.canvas_button.clicked.connect(self._open_canvas)
        self.nodes = QSpinBox()
        self.nodes.setRange(3, 2049)
        self.nodes.setValue(257)
        self.nodes.setSuffix("²")
        self.nodes.setFixedWidth(70)
        self.nodes.setAccessibleName("Canvas nodes along each side")
        self.size = number(0.05, 1e-4, 1.0, 4)
        self.size.setFixedWidth(78)
        self.size.setAccessibleName("Canvas element size")
        self._lay_out()

    def show_source(self, source: Source | None) -> None:
        """Say what is open."""
        if source is None:
            self.now.setText("Nothing open yet")
            return
        nodes = len(source.field.sizes)
        strokes = source.provenance.get("strokes", 0)
        painted = f" · {strokes} stroke{'s' if strokes != 1 else ''} painted" if strokes else ""
        title, _, rest = source.label.partition(": ")
        self.now.setText(f"<b>{title}</b><br>{nodes:,} nodes{painted}")
        self.now.setToolTip(rest or title)

    def _lay_out(self) -> None:
        self.add_wide(self.now)
        self.add_wide(self.gallery)
        self.add("Formula", self.formula, "An element size h(x, y) on the unit square; press Enter to open it")
        self.add_wide(self.file_button)
        row = QHBoxLayout()
        row.setSpacing(6)
        row.addWidget(self.canvas_button, 1)
        row.addWidget(self.nodes)
        row.addWidget(self.size)
        self.canvas_button.setToolTip("One size everywhere on the unit square, to paint on")
        self.nodes.setToolTip("Nodes along each side; up to 512² the processed fields follow the brush")
        self.size.setToolTip("Element size of the empty canvas, in model units")
        self.grid.addLayout(row, self.grid.rowCount(), 0, 1, 2)

    def _open_formula(self) -> None:
        formula = self.formula.text().strip()
        if formula:
            self.open_requested.emit(f"expr:{formula}")

    def _open_canvas(self) -> None:
        self.canvas_requested.emit(self.nodes.value(), self.size.value())


class Gallery(QListWidget):
    """The examples as pictures; a click, or Enter, opens one."""

    chosen = Signal(str)

    def __init__(self, examples: Sequence[Example], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Gallery of examples")
        self.setViewMode(QListView.ViewMode.IconMode)
        self.setIconSize(THUMBNAIL)
        self.setGridSize(QSize(THUMBNAIL.width() + 15, THUMBNAIL.height() + 30))
        self.setMovement(QListView.Movement.Static)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setUniformItemSizes(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        for example in examples:
            item = QListWidgetItem(thumbnail(example.name), example.title)
            item.setToolTip(f"<b>{example.title}</b><br>{example.words}")
            item.setData(Qt.ItemDataRole.UserRole, example.name)
            self.addItem(item)
        rows = -(-max(self.count(), 1) // 3)
        self.setFixedHeight(min(rows, 2) * self.gridSize().height() + 8)
        self.itemClicked.connect(self._open)
        self.itemActivated.connect(self._open)
        self._opened_by_click = False

    def _open(self, item: QListWidgetItem) -> None:
        self.chosen.emit(item.data(Qt.ItemDataRole.UserRole))


def thumbnail(name: str) -> QIcon:
    """Return an example's picture, shipped with the package; a plain tile where there is none."""
    data = files("sizeviz.app") / "thumbnails" / f"{name}.png"
    pixmap = QPixmap()
    if data.is_file():
        pixmap.loadFromData(data.read_bytes())
    else:
        pixmap = QPixmap(THUMBNAIL)
        pixmap.fill(QColor("#34799b"))
    return QIcon(pixmap)
