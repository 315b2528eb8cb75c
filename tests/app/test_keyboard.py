"""The window by keyboard alone: where the keys go, and that they come back."""

from __future__ import annotations

from app.driver import Person
from qtpy.QtCore import QPoint, Qt
from qtpy.QtWidgets import QApplication

from sizeviz.app.actions import COMMANDS
from sizeviz.app.menus import FILE, LEARN
from sizeviz.app.palette import match


def test_the_keyboard_comes_back_from_the_overlay(qtbot, opened) -> None:
    opened.size_panel.alpha.spin.setFocus()
    opened.actions_["shortcuts"].trigger()
    qtbot.keyClick(opened.overlay, Qt.Key.Key_Escape)
    assert opened.size_panel.alpha.spin.hasFocus()


def test_in_a_low_window_the_overlay_is_scrolled(qtbot, opened) -> None:
    opened.resize(1024, 700)
    opened.actions_["shortcuts"].trigger()
    overlay = opened.overlay
    assert opened.rect().contains(overlay.geometry())
    qtbot.keyClick(overlay, Qt.Key.Key_PageDown)
    assert overlay.isVisible() and overlay.scroll.verticalScrollBar().value() > 0
    qtbot.mouseClick(overlay.scroll.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(50, 50))
    assert not overlay.isVisible()


def test_a_pane_reached_by_tab_is_the_active_one_and_arrows_pan_it(qtbot, opened) -> None:
    Person(opened).wait_settled()
    first, second = opened.board.visible_panes
    second.surface.glass.setFocus(Qt.FocusReason.TabFocusReason)
    assert opened.board.active is second
    camera = second.surface.camera
    qtbot.keyClick(second.surface.glass, Qt.Key.Key_Right)
    qtbot.keyClick(second.surface.glass, Qt.Key.Key_Up)
    moved = second.surface.camera
    assert moved.x > camera.x and moved.y > camera.y and moved.height == camera.height
    assert first.surface.camera == moved  # linked


def test_apply_and_cancel_hand_the_keyboard_to_the_picture(qtbot, opened, engine) -> None:
    engine.seconds = 20.0
    opened.judge_panel.automatic.setChecked(False)
    opened.size_panel.alpha.spin.setValue(3.0)
    opened.judge_panel.apply.setFocus()
    qtbot.keyClick(opened.judge_panel.apply, Qt.Key.Key_Space)
    assert QApplication.focusWidget() is opened.board.active.surface.glass
    opened.progress.button.setFocus()
    qtbot.keyClick(opened.progress.button, Qt.Key.Key_Space)
    qtbot.waitUntil(lambda: not opened.controller.jobs.is_busy, timeout=2000)
    assert QApplication.focusWidget() is opened.board.active.surface.glass


def test_the_list_of_the_worst_is_passed_by_tab_without_going_anywhere(qtbot, opened) -> None:
    Person(opened).wait_settled()
    camera, view = opened.board.active.surface.camera, opened.worst.view
    view.setFocus(Qt.FocusReason.TabFocusReason)
    assert opened.board.active.surface.camera == camera and opened.inspector.pin is None
    qtbot.keyClick(view, Qt.Key.Key_Return)
    assert opened.inspector.pin == ("gradient-limiting", int(opened.worst.elements[0]))
    qtbot.keyClick(view, Qt.Key.Key_Down)
    assert opened.inspector.pin == ("gradient-limiting", int(opened.worst.elements[1]))


def test_every_stop_of_the_keyboard_has_a_name(qtbot, opened) -> None:
    Person(opened).wait_settled()
    for section in opened.sections:
        section.head.setChecked(True)
    nameless = set()
    for _ in range(80):
        widget = QApplication.focusWidget()
        if not (widget.accessibleName() or getattr(widget, "text", lambda: "")()):
            nameless.add(type(widget).__name__)
        qtbot.keyClick(widget, Qt.Key.Key_Tab)
    assert nameless <= {"QLineEdit"}  # the inner line of a number, which has the number's name


def test_everything_of_the_file_and_the_learn_group_is_in_a_menu() -> None:
    shown = {*FILE, *LEARN}
    assert {command.name for command in COMMANDS if command.group in ("File", "Learn")} <= shown
    assert shown - {""} <= {command.name for command in COMMANDS}


def test_without_a_study_nothing_is_offered_that_needs_one(flat_window) -> None:
    for name in ("save", "save-picture", "save-comparison", "save-mesh", "save-target", "copy-table", "worst-ratio"):
        assert not flat_window.actions_[name].isEnabled(), name


def test_the_palette_knows_other_words_and_no_scattered_letters(opened) -> None:
    def found(words: str) -> list[str]:
        opened.palette_.filter(words)
        rows = range(opened.palette_.list.count())
        return [opened.palette_.list.item(k).data(Qt.ItemDataRole.UserRole) for k in rows]

    assert set(found("png")) == {"save-picture", "save-comparison"}
    assert "save-mesh" in found("vtu") and "save-mesh" in found("export mesh")
    assert found("csv")[0] == "copy-table-csv" and found("latex") == ["copy-table-latex"]
    assert "worst-quality" in found("gtwq") and found("zzz") == []
    assert match("png", "Paint Larger brush, erase to original") is None
