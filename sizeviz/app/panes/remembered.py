"""How a study was looked at, as plain values in its file; what is not understood on the way back is left alone."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from sizeviz.scene.camera import Camera2D
from sizeviz.scene.subject import MEASURE_TITLES, METHOD_TITLES
from sizeviz.scene.view import QUANTITIES

if TYPE_CHECKING:
    from sizeviz.app.panes.board import PaneBoard

KNOWN: Mapping[str, frozenset[str]] = {
    "method": frozenset(METHOD_TITLES),
    "color_by": frozenset(QUANTITIES),
    "measure": frozenset(MEASURE_TITLES),
}
"""What is kept of a pane's view, and the values it can have."""


def view_values(board: PaneBoard) -> dict[str, Any]:
    """Return how many panes there are, what each shows, and where the camera is."""
    camera = board.active.surface.camera
    return {
        "panes": [{name: getattr(pane.view, name) for name in KNOWN} for pane in board.visible_panes],
        "linked": board.linked,
        "shared_range": board.shared_range,
        "camera": [camera.x, camera.y, camera.height],
    }


def restore_view(board: PaneBoard, values: Mapping[str, Any]) -> None:
    """Bring panes and camera back to what a file says."""
    panes = values.get("panes")
    if isinstance(panes, list) and 1 <= len(panes) <= 4:
        board.set_count(len(panes))
        for pane, kept in zip(board.visible_panes, panes, strict=True):
            if isinstance(kept, Mapping):
                known = {name: kept[name] for name, allowed in KNOWN.items() if _among(kept.get(name), allowed)}
                pane.set_view(pane.view.with_changes(**known), tell=False)
        board.views_changed.emit()
        board.refresh()
    camera = values.get("camera")
    if isinstance(camera, list) and len(camera) == 3 and all(_is_number(value) for value in camera) and camera[2] > 0:
        board.active.surface.move_camera(Camera2D(*(float(value) for value in camera)))


def _among(value: object, allowed: frozenset[str]) -> bool:
    return isinstance(value, str) and value in allowed


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
