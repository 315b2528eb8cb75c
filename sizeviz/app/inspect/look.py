"""Hovering, pinning and going to elements."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from qtpy.QtCore import QObject, Signal

from sizeviz.app.inspect.readout import reading
from sizeviz.app.panes.surface import Mark

if TYPE_CHECKING:
    from qtpy.QtWidgets import QLabel

    from sizeviz.app.controller import Controller
    from sizeviz.app.inspect.judge import WorstPanel
    from sizeviz.app.inspect.readout import Reading
    from sizeviz.app.panes.board import PaneBoard
    from sizeviz.app.panes.pane import Pane


class Inspector(QObject):
    """Shows what is under the cursor, and keeps one element pinned.

    Parameters
    ----------
    controller : Controller
        Whose meshes are looked at.
    board : PaneBoard
        The panes.
    readout : QLabel
        Where the words go.
    worst : WorstPanel
        The list that is linked with the view.
    """

    pinned = Signal(object)

    def __init__(self, controller: Controller, board: PaneBoard, readout: QLabel, worst: WorstPanel) -> None:
        super().__init__(board)
        self._controller, self._board, self._readout, self._worst = controller, board, readout, worst
        self.pin: tuple[str, int] | None = None
        self._under: tuple[Pane, float, float] | None = None
        board.hovered.connect(self._hover)
        board.left.connect(self._leave)
        board.clicked.connect(self._click)
        board.shown.connect(self._look_again)
        board.worst_requested.connect(self.go_to_worst)
        worst.chosen.connect(self.go_to)
        controller.study_changed.connect(lambda old, new: self._after_change())
        controller.painting.changed.connect(self._read_again)

    def read(self, pane: Pane, x: float, y: float) -> Reading:
        """Return all that is known at a point of a pane: its mesh, and the fields as the brush has them now."""
        mesh = pane.subject.mesh
        locator = None if mesh is None else self._controller.locator(mesh)
        now = self._controller.displayed(pane.view.method).subject  # ahead of the pane, which waits for its turn
        subject = replace(pane.subject, prescribed=now.prescribed, target=now.target)
        return reading(subject, locator, pane.view.measure, x, y)

    def go_to(self, method: str, element: int) -> None:
        """Look at an element, and pin it."""
        if self._board.go_to(method, element) is not None:
            self.set_pin(method, element)

    def go_to_worst(self, quantity: str) -> None:
        """Look at the worst element of the active pane's method, by R or by quality."""
        pane = self._board.active
        values = pane.subject.element_values("ratio" if quantity == "ratio" else "quality", pane.view.measure)
        if values is not None:
            self.go_to(pane.view.method, int(values.argmax() if quantity == "ratio" else values.argmin()))

    def set_pin(self, method: str, element: int | None) -> None:
        """Pin an element of a method's mesh, or none."""
        self.pin = None if element is None else (method, element)
        self._draw_pin()
        if element is not None:
            self._worst.select(element)
        self.pinned.emit(self.pin)

    # -- inside ----------------------------------------------------------------------------------------------------

    def _hover(self, pane: Pane, x: float, y: float) -> None:
        self._under = pane, x, y
        seen = self.read(pane, x, y)
        self._readout.setText("   " + seen.words())
        glass, mesh = pane.surface.glass, pane.subject.mesh
        if seen.element is None or mesh is None or pane.spec is None or not self._shows_elements(pane):
            glass.marks.pop("hover", None)
        else:
            glass.marks["hover"] = Mark(mesh.points[mesh.quads[seen.element]])
        glass.update()

    def _look_again(self, pane: Pane) -> None:
        """Tell of what a pane shows now, whether or not the mouse moves."""
        if self._controller.painting.stroke is not None:
            return  # what a stroke changes is told as it changes
        if self._under is not None and self._under[0] is pane:
            self._hover(*self._under)
        self._draw_pin()

    def _read_again(self) -> None:
        """Tell what the brush has changed under it."""
        if self._under is not None:
            self._readout.setText("   " + self.read(*self._under).words())

    def _leave(self) -> None:
        self._under = None
        self._readout.setText("")
        for pane in self._board.panes:
            if pane.surface.glass.marks.pop("hover", None) is not None:
                pane.surface.glass.update()

    def _click(self, pane: Pane, x: float, y: float) -> None:
        if not self._shows_elements(pane):
            return
        element = self.read(pane, x, y).element
        same = self.pin == (pane.view.method, element)
        self.set_pin(pane.view.method, None if same else element)

    def _draw_pin(self) -> None:
        for pane in self._board.panes:
            glass, mesh = pane.surface.glass, pane.subject.mesh
            before = glass.marks.pop("pin", None)
            if self.pin is not None and mesh is not None and self.pin[0] == pane.view.method:
                element = self.pin[1]
                if element < mesh.n_quads:
                    corners = mesh.points[mesh.quads[element]]
                    x, y = corners.mean(axis=0)
                    glass.marks["pin"] = Mark(corners, _pin_words(self.read(pane, float(x), float(y)), element), True)
            if before is not None or "pin" in glass.marks:
                glass.update()

    def _after_change(self) -> None:
        """Let go of a pin whose mesh is gone."""
        study = self._controller.study
        if self.pin is not None and study is not None:
            run = study.runs.get(self.pin[0])
            pane = next((p for p in self._board.visible_panes if p.view.method == self.pin[0]), None)
            if run is None or run.mesh is None or pane is None or pane.subject.mesh is not run.mesh:
                self.pin = None
                self.pinned.emit(None)
        self._draw_pin()

    @staticmethod
    def _shows_elements(pane: Pane) -> bool:
        return pane.view.color_by not in ("prescribed", "target")


def _pin_words(seen: Reading, element: int) -> str:
    parts = [f"element {element}"]
    if seen.ratio is not None:
        parts.append(f"R {seen.ratio:.3f}")
    if seen.quality is not None:
        parts.append(f"q {seen.quality:.3f}")
    return "   ".join(parts)
