"""Commands: palette, shortcuts, overlay, names."""

from __future__ import annotations

from qtpy.QtCore import Qt
from qtpy.QtWidgets import (
    QAbstractSpinBox,
    QCheckBox,
    QComboBox,
    QLineEdit,
    QPushButton,
    QSlider,
    QTabBar,
    QToolButton,
)

from sizeviz.app.actions import COMMANDS
from sizeviz.app.palette import match

INNER = ("ScrollLeftButton", "ScrollRightButton", "qt_toolbar_ext_button")
"""Parts of Qt's own widgets, which Qt names itself."""


def test_the_palette_finds_and_runs_commands(qtbot, opened) -> None:
    opened.palette_.open()
    qtbot.keyClicks(opened.palette_.query, "worst qual")
    assert "Go to the worst quality" in opened.palette_.list.item(0).text()
    qtbot.keyClick(opened.palette_.query, Qt.Key.Key_Return)
    quality = opened.board.active.subject.report.quality
    assert opened.inspector.pin == (opened.board.active.view.method, int(quality.argmin()))


def test_matching_prefers_words_that_are_there() -> None:
    assert match("swap", "View Swap the first two panes") < match("swap", "View Switch what a pane shows")
    assert match("xyz", "View Swap") is None and match("", "anything") is not None


def test_every_shortcut_is_used_once() -> None:
    keys = [key for command in COMMANDS for key in command.shortcut.split()]
    assert len(keys) == len(set(keys)) and len({command.name for command in COMMANDS}) == len(COMMANDS)


def test_every_command_does_something(opened) -> None:
    for command, action in opened.actions_:
        signal = action.toggled if command.checkable else action.triggered
        assert action.receivers(signal) > 0, command.name


def test_the_overlay_lists_shortcuts_and_any_key_closes_it(qtbot, opened) -> None:
    opened.actions_["shortcuts"].trigger()
    assert opened.overlay.isVisible()
    qtbot.keyClick(opened.overlay, Qt.Key.Key_Space)
    assert not opened.overlay.isVisible()


def test_every_control_has_a_name_and_can_be_reached_by_keyboard(opened) -> None:
    kinds = (QPushButton, QToolButton, QComboBox, QCheckBox, QSlider, QAbstractSpinBox)
    for kind in kinds:
        for control in opened.findChildren(kind):
            if control.objectName() in INNER or isinstance(control.parent(), QLineEdit | QTabBar):
                continue
            words = control.accessibleName() or getattr(control, "text", lambda: "")()
            assert words, f"{control} of {control.parent()}"
            if not isinstance(control, QToolButton):
                assert control.focusPolicy() & Qt.FocusPolicy.TabFocus, words
