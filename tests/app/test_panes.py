"""Panes side by side: methods, ranges, cameras, colour bars."""

from __future__ import annotations

import gc
import weakref

import pytest
from app.driver import Person
from qtpy.QtCore import QPoint, Qt
from qtpy.QtWidgets import QApplication

from sizeviz.scene.camera import Camera2D


def test_both_panes_share_one_range_until_told_otherwise(opened) -> None:
    scales = [pane.bar.scale for pane in opened.board.visible_panes]
    assert scales[0] == scales[1]
    opened.actions_["shared-range"].trigger()
    scales = [pane.bar.scale for pane in opened.board.visible_panes]
    assert scales[0] != scales[1]


def test_linked_cameras_move_together_and_free_ones_do_not(qtbot, opened) -> None:
    one, two = (pane.surface for pane in opened.board.visible_panes)
    qtbot.mousePress(one.glass, Qt.MouseButton.LeftButton, pos=QPoint(100, 100))
    qtbot.mouseMove(one.glass, QPoint(140, 80))
    qtbot.mouseRelease(one.glass, Qt.MouseButton.LeftButton, pos=QPoint(140, 80))
    assert one.camera == two.camera and one.camera.x < 0.5
    opened.actions_["link"].trigger()
    one.move_camera(Camera2D(0.1, 0.1, 0.2))
    assert two.camera != one.camera
    opened.actions_["link"].trigger()
    assert two.camera == one.camera


def test_swapping_exchanges_the_methods(opened) -> None:
    opened.actions_["swap"].trigger()
    assert [pane.view.method for pane in opened.board.visible_panes] == ["size-preserving", "gradient-limiting"]


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_one_to_four_panes(opened, count: int) -> None:
    opened.actions_[f"panes-{count}"].trigger()
    assert len([pane for pane in opened.board.panes if pane.isVisible()]) == count
    assert all(pane.spec.scale is not None for pane in opened.board.visible_panes)


def test_a_linked_pane_that_shows_everything_does_so_at_any_size(opened) -> None:
    opened.actions_["panes-3"].trigger()
    opened.board.set_active(opened.board.panes[2])
    opened.actions_["fit"].trigger()
    opened.actions_["panes-1"].trigger()
    Person(opened).rest(50)
    surface = opened.board.active.surface
    assert surface.shows_all and surface.camera == surface.fitted
    surface.move_camera(surface.camera.zoomed(2.0, 0.5, 0.5))
    assert not surface.shows_all


def test_panes_that_come_look_where_the_others_do(opened) -> None:
    opened.board.go_to("gradient-limiting", 300, 6.0)
    camera = opened.board.active.surface.camera
    opened.actions_["panes-4"].trigger()
    Person(opened).rest(50)
    assert all(pane.surface.camera == camera for pane in opened.board.visible_panes)
    opened.actions_["panes-2"].trigger()
    opened.actions_["fit"].trigger()
    opened.actions_["panes-3"].trigger()
    Person(opened).rest(50)
    surfaces = [pane.surface for pane in opened.board.visible_panes]
    assert all(surface.shows_all and surface.camera == surfaces[0].camera for surface in surfaces)


def test_hidden_panes_and_earlier_sources_keep_no_mesh(qtbot, opened) -> None:
    opened.actions_["panes-4"].trigger()
    Person(opened).wait_settled(10)
    meshes = [weakref.ref(pane.subject.mesh) for pane in opened.board.visible_panes]
    opened.actions_["panes-2"].trigger()
    hidden = opened.board.panes[2:]
    assert all(pane.spec is None and pane.subject.mesh is None and pane.surface.canvas.spec is None for pane in hidden)
    opened.controller.open_source("again")
    Person(opened).wait_settled(10)
    opened.controller.store.stack.clear()
    qtbot.waitUntil(lambda: not gc.collect() and not any(mesh() for mesh in meshes), timeout=5000)
    opened.actions_["panes-4"].trigger()
    Person(opened).wait_settled(10)
    assert all(pane.spec.scale is not None and pane.subject.mesh is not None for pane in opened.board.visible_panes)


def test_stale_panes_wear_a_badge(qtbot, opened, engine) -> None:
    engine.seconds = 20.0
    opened.size_panel.alpha.spin.setValue(3.0)
    qtbot.wait(20)
    assert not opened.board.panes[1].badge.isHidden()
    opened.controller.cancel()
    qtbot.waitUntil(lambda: not opened.controller.jobs.is_busy)
    assert "Stale" in opened.judge_panel.note.text()


def test_the_colour_bars_editor_changes_its_pane_only(qtbot, opened) -> None:
    opened.actions_["shared-range"].setChecked(False)
    editor = opened.board.panes[0].open_editor()
    editor.mode.setCurrentIndex(editor.mode.findData("fixed"))
    editor.low.setValue(0.5)
    editor.high.setValue(1.5)
    editor.classes.setValue(4)
    scale = opened.board.panes[0].bar.scale
    assert (scale.low, scale.high, scale.classes) == (0.5, 1.5, 4)
    assert opened.board.panes[1].bar.scale.classes == 0
    editor.low.setValue(2.0)  # above the upper end: shown as wrong, not applied
    assert editor.low.property("invalid") and opened.board.panes[0].bar.scale.low == 0.5
    editor.close()


def test_the_menus_of_narrow_panes_stay_readable(qtbot, opened) -> None:
    opened.resize(1400, 900)
    for count in (3, 4, 2):
        opened.actions_[f"panes-{count}"].trigger()
        QApplication.processEvents()
        for pane in opened.board.visible_panes:
            for menu in (pane.method, pane.quantity):
                assert menu.width() >= menu.sizeHint().width()
