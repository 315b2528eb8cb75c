"""One pane: what and how above, the picture, the colour bar and the verdict in words below."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import QPoint, Qt, Signal
from qtpy.QtWidgets import QBoxLayout, QFrame, QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from sizeviz.app.panels.controls import ElidedLabel, Menu, VerdictLabel
from sizeviz.app.panes.colorbar import ColorBar, ColorBarEditor
from sizeviz.app.panes.surface import Surface
from sizeviz.scene.compose import compose
from sizeviz.scene.subject import METHOD_TITLES, Subject
from sizeviz.scene.view import QUANTITIES, ViewState

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray
    from qtpy.QtGui import QResizeEvent

    from sizeviz.app.panes.canvas import Canvas
    from sizeviz.scene.scale import ColorScale
    from sizeviz.scene.spec import SceneSpec

EDGE_PIXELS = 7.0
"""Element edges are drawn once elements in view are wider than this."""

WORST_KEYS = {"ratio": "W", "quality": "Q"}
"""Quantities that have a worst element, each with the key that goes there."""

OFFERED = tuple(METHOD_TITLES)
"""Methods that a pane can be set to."""


class Pane(QFrame):
    """A surface with its controls.

    Parameters
    ----------
    view : ViewState
        What it shows at first.
    make_canvas : callable
        Makes the drawing widget.
    parent : QWidget, optional
        Owner.
    """

    view_changed = Signal(object)
    activated = Signal()

    def __init__(
        self, view: ViewState, make_canvas: Callable[[QWidget], Canvas], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName("pane")
        self.view = view
        self.spec: SceneSpec | None = None
        self.subject = Subject()
        self.surface = Surface(make_canvas, self)
        self.bar = ColorBar(self)
        self.method, self.quantity = Menu(), Menu()
        for name in OFFERED:
            self.method.addItem(METHOD_TITLES[name], name)
        for quantity, words in QUANTITIES.items():
            self.quantity.addItem(words, quantity)
        self.detail = ElidedLabel()
        self.detail.setProperty("role", "muted")
        self.badge = QLabel("stale")
        self.badge.setObjectName("badge")
        self.badge.setToolTip("An older result; the study has changed since. Apply runs it again.")
        self.badge.hide()
        self.fit_button = QToolButton()
        self.fit_button.setObjectName("small")
        self.fit_button.setText("Fit")
        self.verdict = VerdictLabel()
        self._edges: Callable[[], bool] = lambda: False
        self._lay_out()
        self._name()
        self._connect()
        self._sync()

    # -- showing ---------------------------------------------------------------------------------------------------

    def show_subject(
        self,
        subject: Subject,
        stale: bool,
        *,
        dark: bool,
        scale: ColorScale | None = None,
        selected: NDArray[np.intp] | None = None,
    ) -> None:
        """Compose and show what the pane's view asks of a subject."""
        self.show_scene(subject, self.composed(subject, dark=dark, scale=scale, selected=selected), stale)

    def composed(
        self,
        subject: Subject,
        *,
        dark: bool,
        scale: ColorScale | None = None,
        selected: NDArray[np.intp] | None = None,
    ) -> SceneSpec:
        """Return what the pane's view asks of a subject; of a large one that is work enough for one turn."""
        return compose(subject, self.view.with_changes(dark=dark, edges=False), scale=scale, selected=selected)

    def show_scene(self, subject: Subject, spec: SceneSpec, stale: bool) -> None:
        """Show a scene composed of a subject, and say what it says."""
        self.subject, self.spec = subject, spec
        self.surface.canvas.show_scene(spec)
        self.surface.set_bounds(spec.bounds)
        self.update_edges()
        self.bar.set_scale(spec.scale)
        self.detail.setText(spec.detail)
        self.detail.setToolTip(spec.detail)
        self.method.setToolTip(f"{spec.title}: {spec.detail}")
        older = stale and spec.scale is not None
        self._say(spec, older)
        self.badge.setVisible(older)

    def forget(self) -> None:
        """Keep nothing of what was shown: a pane that nobody sees must not hold the memory of a mesh."""
        self.subject, self.spec = Subject(), None
        self.surface.canvas.clear()

    def set_edge_rule(self, rule: Callable[[], bool]) -> None:
        """Give the rule that says whether elements are now large enough for their edges."""
        self._edges = rule

    @property
    def shows_edges(self) -> bool:
        """Whether elements are now large enough for their edges."""
        return self._edges()

    def update_edges(self) -> None:
        """Draw or hide element edges as the zoom asks."""
        self.surface.canvas.show_edges(self.shows_edges)

    def set_view(self, view: ViewState, tell: bool = True) -> None:
        """Show something else."""
        if view == self.view:
            return
        self.view = view
        self._sync()
        if tell:
            self.view_changed.emit(view)

    def set_active(self, active: bool) -> None:
        """Mark the pane that keys and lists act on."""
        self.setProperty("active", active)
        self.style().polish(self)

    def open_editor(self) -> ColorBarEditor:
        """Open the colour bar's editor above the bar."""
        editor = ColorBarEditor(self.view, self.bar.scale, self)
        editor.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        editor.view_changed.connect(self.set_view)
        editor.adjustSize()
        editor.move(self.bar.mapToGlobal(QPoint(8, -editor.height() - 2)))
        editor.show()
        return editor

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Put the menus above each other where they have no room beside each other; the width alone decides."""
        super().resizeEvent(event)
        margins = self._head.contentsMargins()
        room = self.width() - margins.left() - margins.right() - self._head.spacing()
        fits = self.method.sizeHint().width() + self.quantity.sizeHint().width() <= room
        direction = QBoxLayout.Direction
        self._head.setDirection(direction.LeftToRight if fits else direction.TopToBottom)

    # -- inside ----------------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        self._head = head = QBoxLayout(QBoxLayout.Direction.LeftToRight)
        head.setContentsMargins(8, 7, 8, 3)
        head.setSpacing(6)
        head.addWidget(self.method)
        head.addWidget(self.quantity)
        head.addStretch(1)
        under = QHBoxLayout()
        under.setContentsMargins(14, 0, 8, 4)
        under.setSpacing(6)
        under.addWidget(self.detail, 1)
        under.addWidget(self.badge)
        under.addWidget(self.fit_button)
        foot = QVBoxLayout()
        foot.setContentsMargins(0, 4, 0, 6)
        foot.setSpacing(2)
        foot.addWidget(self.bar)
        line = QHBoxLayout()
        line.setContentsMargins(14, 0, 14, 2)
        line.addWidget(self.verdict)
        foot.addLayout(line)
        column = QVBoxLayout(self)
        column.setContentsMargins(1, 1, 1, 1)
        column.setSpacing(0)
        column.addLayout(head)
        column.addLayout(under)
        column.addWidget(self.surface, 1)
        column.addLayout(foot)

    def _name(self) -> None:
        self.method.setAccessibleName("Method shown")
        self.method.setToolTip("Which method's result this pane shows")
        self.quantity.setAccessibleName("Quantity shown")
        self.quantity.setToolTip("What the colours mean; R(e) = μ(e) / (β min h over e), eq. (3)")
        self.fit_button.setAccessibleName("Fit to pane")
        self.fit_button.setToolTip("Show everything (double-click, or F)")
        self.verdict.setAccessibleName("Verdict")

    def _connect(self) -> None:
        self.method.activated.connect(self._choose)
        self.quantity.activated.connect(self._choose)
        self.fit_button.clicked.connect(self.surface.fit)
        self.bar.edit_requested.connect(self.open_editor)
        self.surface.activated.connect(self.activated)
        self.surface.camera_changed.connect(lambda camera: self.update_edges())

    def _choose(self, *_: object) -> None:
        self.activated.emit()
        quantity = self.quantity.currentData()
        changes = {"method": self.method.currentData(), "color_by": quantity}
        if quantity != self.view.color_by:  # another quantity has another range and its own map
            changes |= {"cmap": None, "range_mode": "auto", "low": None, "high": None, "log": None, "classes": 0}
        self.set_view(self.view.with_changes(**changes))

    def _sync(self) -> None:
        self.method.setCurrentIndex(max(self.method.findData(self.view.method), 0))
        self.quantity.setCurrentIndex(max(self.quantity.findData(self.view.color_by), 0))

    def _say(self, spec: SceneSpec, older: bool) -> None:
        sign = {True: "✓  ", False: "✗  ", None: ""}[spec.passed]
        self.verdict.setText(sign + spec.verdict)
        worst = WORST_KEYS.get(self.view.color_by) if spec.scale is not None else None
        self.verdict.setToolTip(spec.verdict if worst is None else f"Go to the worst element ({worst})")
        cursor = Qt.CursorShape.ArrowCursor if worst is None else Qt.CursorShape.PointingHandCursor
        if self.verdict.cursor().shape() != cursor:
            self.verdict.setCursor(cursor)
        role = "muted" if older else {True: "good", False: "bad", None: ""}[spec.passed]
        if self.verdict.property("role") != role:
            self.verdict.setProperty("role", role)
            self.verdict.style().polish(self.verdict)
