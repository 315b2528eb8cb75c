"""Where the last frame of a pane lies when the camera has moved."""

from __future__ import annotations

import pytest

pytest.importorskip("pyvistaqt")

from sizeviz.app.panes.view import frame_place
from sizeviz.scene.camera import Camera2D

DRAWN = Camera2D(0.5, 0.5, 1.0)


def test_an_unmoved_frame_fills_the_pane() -> None:
    assert frame_place(DRAWN, DRAWN, (400, 300), (400, 300)) == (0, 0, 400, 300)


def test_a_dragged_frame_moves_with_the_hand() -> None:
    moved = DRAWN.panned(30, 20, 300)  # 30 pixels to the right, 20 down
    assert frame_place(DRAWN, moved, (400, 300), (400, 300)) == (30, -20, 430, 280)


def test_a_zoomed_frame_keeps_the_point_under_the_cursor() -> None:
    x, y = DRAWN.to_model(100, 50, 400, 300)
    left, low, right, high = frame_place(DRAWN, DRAWN.zoomed(2.0, x, y), (400, 300), (400, 300))
    assert (right - left, high - low) == (800, 600)
    # the cursor was a quarter from the left and five sixths from below, and still is where it was
    assert left + 0.25 * 800 == pytest.approx(100) and low + 600 * 5 / 6 == pytest.approx(250)
