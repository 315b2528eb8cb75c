"""The brush: its panel, its strokes by mouse and key, what they leave."""

from __future__ import annotations

import time

import numpy as np
import pytest
from app.driver import at, glass
from qtpy.QtCore import Qt

from sizeviz.app.panels.paint import PaintPanel


def test_the_brush_is_what_the_panel_says(qtbot) -> None:
    panel = PaintPanel()
    qtbot.addWidget(panel)
    panel.set_mode("multiply")
    panel.factor.set_value(0.25)
    panel.radius.set_value(0.1)
    panel.mask.setChecked(True)
    panel.mask_low.set_value(0.3)
    panel.mask_high.set_value(0.01)
    brush = panel.brush()
    assert (brush.mode, brush.value, brush.mask) == ("multiply", 0.25, (0.01, 0.3))
    assert panel.factor.isEnabled() and not panel.value.isEnabled()
    panel.step_radius(1.0)
    assert panel.brush().radius == pytest.approx(0.115)


def test_painting_with_the_mouse_is_one_step_and_escape_drops_a_stroke(qtbot, opened) -> None:
    opened.actions_["paint"].trigger()
    assert [pane.view.color_by for pane in opened.board.visible_panes] == ["prescribed", "target"]
    before = opened.controller.study.source.field
    qtbot.mousePress(glass(opened), Qt.MouseButton.LeftButton, pos=at(opened, 0.2, 0.2))
    qtbot.mouseMove(glass(opened), at(opened, 0.3, 0.3))
    assert glass(opened).ring.label.startswith("h ")
    qtbot.keyClick(opened, Qt.Key.Key_Escape)
    qtbot.mouseRelease(glass(opened), Qt.MouseButton.LeftButton, pos=at(opened, 0.3, 0.3))
    assert opened.controller.study.source.field is before and opened.tool.active
    qtbot.mousePress(glass(opened), Qt.MouseButton.LeftButton, pos=at(opened, 0.2, 0.2))
    qtbot.mouseMove(glass(opened), at(opened, 0.4, 0.3))
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        qtbot.mouseRelease(glass(opened), Qt.MouseButton.LeftButton, pos=at(opened, 0.4, 0.3))
    assert opened.controller.store.stack.count() == 1
    assert "1 stroke painted" in opened.source.now.text()
    opened.actions_["paint"].trigger()
    assert [pane.view.color_by for pane in opened.board.visible_panes] == ["ratio", "ratio"]


@pytest.mark.parametrize("shape", ["line", "polygon"])
def test_lines_and_polygons_are_clicked_and_finished(qtbot, opened, shape: str) -> None:
    opened.actions_["paint"].trigger()
    opened.paint.shape.setCurrentIndex(opened.paint.shape.findData(shape))
    opened.paint.radius.set_value(0.03)
    for corner in ((0.2, 0.2), (0.8, 0.2), (0.5, 0.8)):
        qtbot.mouseClick(glass(opened), Qt.MouseButton.LeftButton, pos=at(opened, *corner))
    assert opened.controller.store.stack.count() == 0 and opened.controller.painting.stroke is not None
    glass(opened).setFocus()
    qtbot.keyClick(glass(opened), Qt.Key.Key_Return)
    assert opened.controller.store.stack.count() == 1 and opened.controller.painting.stroke is None
    field = opened.controller.study.source.field
    inner = np.hypot(*(field.background.points - (0.5, 0.4)).T).argmin()
    filled = field.sizes[inner] == pytest.approx(opened.paint.brush().value)
    assert filled == (shape == "polygon")


def test_brackets_and_wheel_change_the_radius(qtbot, opened) -> None:
    opened.actions_["paint"].trigger()
    before = opened.paint.radius.value()
    qtbot.keyClick(opened, Qt.Key.Key_BracketRight)
    assert opened.paint.radius.value() > before
    qtbot.keyClick(opened, Qt.Key.Key_BracketLeft)
    assert opened.paint.radius.value() == pytest.approx(before, rel=1e-2)


def test_a_preview_keeps_nobody_from_applying(qtbot, opened, monkeypatch) -> None:
    opened.judge_panel.automatic.setChecked(False)
    targets = opened.controller.engine.targets

    def slowly(*given):
        time.sleep(0.2)
        return targets(*given)

    monkeypatch.setattr(opened.controller.engine, "targets", slowly)
    opened.actions_["paint"].trigger()
    qtbot.mousePress(glass(opened), Qt.MouseButton.LeftButton, pos=at(opened, 0.4, 0.4))
    assert opened.controller.jobs.is_busy and opened.progress.button.isHidden()
    qtbot.mouseRelease(glass(opened), Qt.MouseButton.LeftButton, pos=at(opened, 0.4, 0.4))
    assert opened.judge_panel.apply.isEnabled()
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        opened.judge_panel.apply.click()


def test_an_error_while_painting_ends_the_painter(qtbot, opened, qtlog, monkeypatch) -> None:
    glass = opened.board.panes[0].surface.glass

    class Broken:
        def paint(self, glass, painter) -> None:
            raise ValueError("cannot be drawn")

    glass.overlay = Broken()
    with qtbot.captureExceptions() as errors:
        glass.grab()
        glass.overlay = None
        glass.grab()
    assert [kind for kind, *_ in errors][:1] == [ValueError]
    assert not any("painter" in record.message.lower() for record in qtlog.records)
