"""Two to four panes side by side: linked cameras, shared ranges, one of them active."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from qtpy.QtCore import Signal
from qtpy.QtWidgets import QGridLayout, QWidget

from sizeviz.app.panes.pane import EDGE_PIXELS, WORST_KEYS, Pane
from sizeviz.app.turns import Turns
from sizeviz.scene.compose import scale_for, values_of
from sizeviz.scene.view import FIELD_QUANTITIES, ViewState

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sizeviz.app.controller import Controller
    from sizeviz.app.news import Displayed
    from sizeviz.app.panes.canvas import Canvas
    from sizeviz.app.panes.surface import Surface
    from sizeviz.scene.camera import Camera2D
    from sizeviz.scene.scale import ColorScale
    from sizeviz.scene.spec import SceneSpec
    from sizeviz.scene.subject import Subject

FIRST_VIEWS: tuple[ViewState, ...] = (
    ViewState(method="gradient-limiting"),
    ViewState(method="size-preserving"),
    ViewState(method="gradient-limiting", color_by="quality"),
    ViewState(method="size-preserving", color_by="quality"),
)
"""What the panes show until somebody chooses otherwise."""

LIGHT = 4_000
"""As long as the panes show fewer elements than this, all are brought up to date at once; else each has its turn."""

NODES_PER_ELEMENT = 16
"""So many nodes of a field take as long to show as one element."""


@dataclass(frozen=True, eq=False)
class Selection:
    """Elements selected in one method's mesh."""

    method: str
    elements: NDArray[np.intp]


class PaneBoard(QWidget):
    """Holds the panes. Each is made once, when it is first needed, and kept.

    Parameters
    ----------
    controller : Controller
        Where to ask what there is to show.
    make_canvas : callable
        Makes a pane's drawing widget.
    parent : QWidget, optional
        Owner.
    """

    hovered = Signal(object, float, float)
    left = Signal()
    clicked = Signal(object, float, float)
    menu_requested = Signal(object, float, float)
    views_changed = Signal()
    active_changed = Signal(object)
    pane_made = Signal(object)
    shown = Signal(object)
    worst_requested = Signal(object)

    def __init__(
        self, controller: Controller, make_canvas: Callable[[QWidget], Canvas], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._controller, self._make_canvas = controller, make_canvas
        self.turns = Turns(self)
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(8, 8, 8, 8)
        self._grid.setSpacing(8)
        self.panes: list[Pane] = []
        self.linked, self.shared_range, self.dark = True, True, False
        self.selection: Selection | None = None
        self._count = 0
        self._active = 0
        self.set_count(2)

    @property
    def visible_panes(self) -> list[Pane]:
        """The panes on show."""
        return self.panes[: self._count]

    @property
    def active(self) -> Pane:
        """The pane that keys and lists act on."""
        return self.panes[min(self._active, self._count - 1)]

    @property
    def is_light(self) -> bool:
        """Whether all that is on show takes no time worth a turn of the event loop."""
        elements = 0
        for pane in self.visible_panes:
            if not pane.surface.canvas.is_ready:
                return False
            subject = self._controller.displayed(pane.view.method).subject
            elements += 0 if subject.mesh is None else subject.mesh.n_quads
            elements += 0 if subject.prescribed is None else len(subject.prescribed.sizes) // NODES_PER_ELEMENT
        return elements < LIGHT

    @property
    def is_drawing(self) -> bool:
        """Whether any pane's picture is still on its way to the screen."""
        return self.turns.is_busy or any(pane.surface.canvas.is_drawing for pane in self.visible_panes)

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods on show, each once, in the order of the panes."""
        return tuple(dict.fromkeys(pane.view.method for pane in self.visible_panes))

    def set_count(self, count: int) -> None:
        """Show so many panes, 1 to 4."""
        while len(self.panes) < count:
            self._make_pane()
        leader, new = self.panes[min(self._active, count - 1)], self.panes[self._count : count]
        self._count = count
        for pane in new:
            if self.linked and pane is not leader:
                pane.surface.look_like(leader.surface)
        columns = 2 if count == 4 else count
        for k, pane in enumerate(self.panes):
            self._grid.removeWidget(pane)
            pane.setVisible(k < count)
            if k < count:
                self._grid.addWidget(pane, k // columns, k % columns)
            elif pane.spec is not None:
                pane.forget()
        for k in range(4):
            self._grid.setColumnStretch(k, int(k < columns))
        self.set_active(self.active)
        self.views_changed.emit()
        self.refresh()

    def curtained(self) -> list[Surface]:
        """Hide the pictures while the page is turned, and return them: they are laid out one a turn."""
        surfaces = [pane.surface for pane in self.visible_panes]
        for surface in surfaces:
            surface.hide()
        return surfaces

    def set_active(self, pane: Pane) -> None:
        """Make a pane the one that keys and lists act on."""
        self._active = self.panes.index(pane)
        for other in self.panes:
            other.set_active(other is pane and self._count > 1)
        self.active_changed.emit(pane)

    def set_linked(self, linked: bool) -> None:
        """Link the cameras, all to the active pane's, or let them go."""
        self.linked = linked
        if linked:
            self._follow(self.active, self.active.surface.camera)

    def set_shared_range(self, shared: bool) -> None:
        """Let panes that show the same quantity share one colour range, or each have its own."""
        self.shared_range = shared
        self.refresh()

    def swap(self) -> None:
        """Exchange the first two panes' views."""
        if self._count < 2:
            return
        first, second = self.panes[:2]
        one, two = first.view, second.view
        first.set_view(two, tell=False)
        second.set_view(one, tell=False)
        self.views_changed.emit()
        self.refresh()

    def select(self, selection: Selection | None) -> None:
        """Outline some elements of one method's mesh."""
        self.selection = selection
        self.refresh()

    def refresh(self) -> None:
        """Show what the controller has now; of large meshes each pane composes in one turn, and shows in another."""
        self.turns.take({pane: partial(self._compose, pane) for pane in self.visible_panes})
        if self.is_light:
            self.turns.finish()

    def fit(self) -> None:
        """Show everything in every pane."""
        for pane in self.visible_panes:
            pane.surface.fit()

    def go_to(self, method: str, element: int, across: float = 24.0) -> Pane | None:
        """Centre the pane that shows a method on one of its elements, about 24 such elements across.

        Of a mesh that is coarser than that, everything is shown.

        A list may name an element of a mesh that the pane, whose turn came earlier or is still to come, does not show:
        then nothing moves.
        """
        pane = next((p for p in [self.active, *self.visible_panes] if p.view.method == method), None)
        mesh = None if pane is None else pane.subject.mesh
        if pane is None or mesh is None or not 0 <= element < mesh.n_quads:
            return None
        x, y = mesh.points[mesh.quads[element]].mean(axis=0)
        size = float(np.sqrt(abs(mesh.areas[element])))
        near = pane.surface.camera.at(float(x), float(y), across * size)
        pane.surface.fit() if near.height >= pane.surface.fitted.height else pane.surface.move_camera(near)
        return pane

    def set_tool_active(self, active: bool) -> None:
        """Hand the left mouse button to the brush, or back to panning."""
        for pane in self.panes:
            pane.surface.tool_active = active
            pane.surface.glass.ring = None
            pane.surface.glass.update()

    def dispose(self) -> None:
        """Free what VTK holds."""
        self.turns.drop()
        for pane in self.panes:
            pane.surface.canvas.dispose()

    # -- inside ----------------------------------------------------------------------------------------------------

    def _make_pane(self) -> None:
        pane = Pane(FIRST_VIEWS[len(self.panes)], self._make_canvas, self)
        pane.setAccessibleName(f"Pane {len(self.panes) + 1}")
        if self.panes:
            measure = self.panes[0].view.measure
            pane.set_view(pane.view.with_changes(measure=measure), tell=False)
        pane.activated.connect(lambda: self.set_active(pane))
        pane.view_changed.connect(lambda view: self._on_view(pane))
        pane.verdict.clicked.connect(lambda: self._ask_worst(pane))
        pane.surface.camera_changed.connect(lambda camera: self._follow(pane, camera))
        pane.surface.hovered.connect(lambda x, y: self.hovered.emit(pane, x, y))
        pane.surface.left.connect(self.left)
        pane.surface.clicked.connect(lambda x, y: self.clicked.emit(pane, x, y))
        pane.surface.menu_requested.connect(lambda x, y: self.menu_requested.emit(pane, x, y))
        pane.set_edge_rule(lambda: self._edges_show(pane))
        self.panes.append(pane)
        self.pane_made.emit(pane)

    def _compose(self, pane: Pane) -> None:
        """Compose what the controller has now for one pane, to be shown in a turn of its own."""
        if pane not in self.visible_panes:
            return
        shown = [(other, self._controller.displayed(other.view.method)) for other in self.visible_panes]
        displayed = dict(shown)[pane]
        chosen = None
        if self.selection is not None and self.selection.method == pane.view.method and not displayed.stale:
            chosen = self.selection.elements
        subject = displayed.subject
        spec = pane.composed(subject, dark=self.dark, scale=self._shared_scale(pane, shown), selected=chosen)
        stale = displayed.is_stale(pane.view.color_by)
        self.turns.take({(pane, "show"): partial(self._show, pane, subject, spec, stale)})

    def _show(self, pane: Pane, subject: Subject, spec: SceneSpec, stale: bool) -> None:
        pane.show_scene(subject, spec, stale)
        self.shown.emit(pane)

    def _ask_worst(self, pane: Pane) -> None:
        self.set_active(pane)
        if pane.view.color_by in WORST_KEYS:
            self.worst_requested.emit(pane.view.color_by)

    def _on_view(self, pane: Pane) -> None:
        self.views_changed.emit()
        self.refresh()

    def _follow(self, leader: Pane, camera: Camera2D) -> None:
        if not self.linked or leader not in self.visible_panes:
            return
        for pane in self.visible_panes:
            alike = pane.surface.camera == camera and pane.surface.shows_all == leader.surface.shows_all
            if pane is not leader and not alike:
                pane.surface.set_camera(camera, leader.surface.shows_all)
                pane.update_edges()

    def _shared_scale(self, pane: Pane, shown: list[tuple[Pane, Displayed]]) -> ColorScale | None:
        if not self.shared_range:
            return None
        view = pane.view
        alike = [
            (other.view, displayed)
            for other, displayed in shown
            if other.view.with_changes(method=view.method) == view
            or {other.view.color_by, view.color_by} == set(FIELD_QUANTITIES)
        ]
        values = [values_of(displayed.subject, other) for other, displayed in alike]
        return scale_for([array for array in values if array is not None], view)

    def _edges_show(self, pane: Pane) -> bool:
        mesh = pane.subject.mesh
        if mesh is None or pane.view.color_by in FIELD_QUANTITIES:
            return False
        camera, surface = pane.surface.camera, pane.surface
        x0, y0, x1, y1 = camera.box(surface.aspect)
        inner = [(x0 + (x1 - x0) * u, y0 + (y1 - y0) * v) for u in (0.2, 0.5, 0.8) for v in (0.2, 0.5, 0.8)]
        locator = self._controller.locator(mesh)
        found = [element for element in (locator.element_at(x, y) for x, y in inner) if element is not None]
        if not found:
            return mesh.n_quads < 20_000
        size = float(np.median(np.sqrt(np.abs(locator.areas(found)))))
        return size * surface.height() / camera.height > EDGE_PIXELS
