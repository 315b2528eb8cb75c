"""The brush in the hand: mouse and keys on the panes become strokes for the controller."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from qtpy.QtCore import QObject, Signal

from sizeviz.app.inspect.readout import value_at
from sizeviz.app.panes.surface import Ring
from sizeviz.scene.view import FIELD_QUANTITIES

if TYPE_CHECKING:
    from sizeviz.app.controller import Controller
    from sizeviz.app.panels.paint import PaintPanel
    from sizeviz.app.panes.board import PaneBoard
    from sizeviz.app.panes.pane import Pane
    from sizeviz.scene.view import ViewState

AS_IT_COMES: dict[str, Any] = {"cmap": None, "range_mode": "auto", "log": None, "classes": 0}
"""A view's colours as they are before anybody chooses others."""


class PaintTool(QObject):
    """Takes the left mouse button while it is active.

    While painting the first pane shows the field under the brush and the others the processed fields; afterwards
    every pane shows again what it did before.

    Parameters
    ----------
    controller : Controller
        Where strokes go.
    board : PaneBoard
        The panes to paint in.
    panel : PaintPanel
        The brush's settings.
    """

    active_changed = Signal(bool)

    def __init__(self, controller: Controller, board: PaneBoard, panel: PaintPanel) -> None:
        super().__init__(board)
        self._controller, self._board, self._panel = controller, board, panel
        self.active = False
        self._before: dict[Pane, ViewState] = {}
        self._corners: list[tuple[float, float]] = []
        for pane in board.panes:
            self._adopt(pane)
        board.pane_made.connect(self._adopt)
        panel.toggled.connect(self.set_active)
        panel.brush_changed.connect(lambda brush: self._redraw_ring())
        controller.painting.changed.connect(self._redraw_ring)

    def set_active(self, active: bool) -> None:
        """Take the brush up, or put it down."""
        if active == self.active:
            return
        if active and self._controller.study is None:
            self._panel.show_active(False)
            return
        self.active = active
        if not active:
            self.abort()
        self._board.set_tool_active(active)
        self._show_fields(active)
        self._panel.show_active(active)
        self.active_changed.emit(active)

    def abort(self) -> None:
        """Drop the stroke under way."""
        self._corners.clear()
        self._show_path(None)
        self._controller.painting.abort()

    def finish(self) -> None:
        """Close the line or polygon under way."""
        if len(self._corners) > 1:
            self._controller.painting.reshape(self._corners)
            self._controller.painting.end()
        elif self._corners:
            self._controller.painting.abort()
        self._corners.clear()
        self._show_path(None)

    # -- inside ----------------------------------------------------------------------------------------------------

    def _adopt(self, pane: Pane) -> None:
        surface = pane.surface
        surface.tool_active = self.active
        surface.stroke_began.connect(self._press)
        surface.stroke_moved.connect(lambda x, y: self._move(pane, x, y))
        surface.stroke_ended.connect(self._release)
        surface.stroke_closed.connect(self.finish)
        surface.hovered.connect(lambda x, y: self._hover(pane, x, y))
        surface.left.connect(lambda: self._leave(pane))
        surface.radius_stepped.connect(self._panel.step_radius)

    def _press(self, x: float, y: float) -> None:
        shape = self._panel.stroke_shape()
        if shape == "freehand":
            self._controller.painting.begin(self._panel.brush(), shape, x, y)
            return
        if not self._corners:
            self._controller.painting.begin(self._panel.brush(), shape, x, y)
        self._corners.append((x, y))
        self._controller.painting.reshape(self._corners)

    def _move(self, pane: Pane, x: float, y: float) -> None:
        if self._panel.stroke_shape() == "freehand":
            self._controller.painting.extend(x, y)

    def _release(self, x: float, y: float) -> None:
        if self._panel.stroke_shape() == "freehand":
            self._controller.painting.end()

    def _hover(self, pane: Pane, x: float, y: float) -> None:
        if not self.active:
            return
        if self._corners:
            self._show_path((x, y))
        glass = pane.surface.glass
        glass.ring = Ring(x, y, self._panel.radius.value(), self._label(pane, x, y))
        glass.update()

    def _label(self, pane: Pane, x: float, y: float) -> str:
        subject = self._controller.displayed(pane.view.method).subject  # ahead of the pane, which waits for its turn
        field = subject.field("target" if pane.view.color_by == "target" else "prescribed")
        value = value_at(field, x, y)
        return "" if value is None else f"{'h*' if pane.view.color_by == 'target' else 'h'} {value:.4g}"

    def _leave(self, pane: Pane) -> None:
        pane.surface.glass.ring = None
        pane.surface.glass.update()

    def _redraw_ring(self) -> None:
        for pane in self._board.panes:
            ring = pane.surface.glass.ring
            if ring is not None:
                label = self._label(pane, ring.x, ring.y)
                pane.surface.glass.ring = Ring(ring.x, ring.y, self._panel.radius.value(), label)
                pane.surface.glass.update()

    def _show_path(self, tip: tuple[float, float] | None) -> None:
        path = [*self._corners, tip] if tip is not None and self._corners else []
        if len(path) > 2 and self._panel.stroke_shape() == "polygon":
            path.append(path[0])
        for pane in self._board.panes:
            pane.surface.glass.path = path
            pane.surface.glass.update()

    def _show_fields(self, active: bool) -> None:
        if active:
            self._before = {pane: pane.view for pane in self._board.panes}
            for k, pane in enumerate(self._board.visible_panes):
                quantity = "prescribed" if k == 0 else "target"
                pane.set_view(pane.view.with_changes(color_by=quantity, **AS_IT_COMES), tell=False)
        else:
            for pane, view in self._before.items():
                if pane.view.color_by in FIELD_QUANTITIES:  # whoever chose something else meanwhile wants to see that
                    pane.set_view(view.with_changes(method=pane.view.method), tell=False)
        self._board.views_changed.emit()
        self._board.refresh()
