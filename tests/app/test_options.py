"""The panels of options, and what their changes do."""

from __future__ import annotations

import pytest
from qtpy.QtCore import Qt

from sizeviz.app.panels.options import SizePanel, SmoothPanel


def test_changing_alpha_by_keyboard_changes_study_note_and_table(qtbot, opened) -> None:
    before = opened.statistics.model.table
    spin = opened.size_panel.alpha.spin
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        spin.setFocus()
        spin.selectAll()
        qtbot.keyClicks(spin.lineEdit(), "4")
        qtbot.keyClick(spin.lineEdit(), Qt.Key.Key_Return)
    options = opened.controller.study.options
    assert options.preserve.alpha == 4.0 and options.limit.epsilon == pytest.approx(0.25)  # comparable
    assert "slope 0.25" in opened.size_panel.note.text() and opened.size_panel.epsilon.value() == 0.25
    assert opened.statistics.model.table != before


def test_each_panel_shows_options_without_telling(opened) -> None:
    told = []
    for panel in (opened.size_panel, opened.mesh_panel, opened.smooth_panel):
        panel.changed.connect(lambda *change: told.append(change))
        panel.show_options(opened.controller.study.options)
    assert told == []


def test_smoothing_off_puts_its_options_out_of_reach(qtbot) -> None:
    from sizeviz.study import StudyOptions

    panel = SmoothPanel()
    qtbot.addWidget(panel)
    with qtbot.waitSignal(panel.changed) as caught:
        panel.smoothing.setChecked(True)
        panel.smoothing.setChecked(False)
    changed = caught.args[0](StudyOptions())
    panel.show_options(changed if not changed.smoothing else StudyOptions(smoothing=False))
    assert not panel.sweeps.isEnabled()


def test_epsilon_is_free_once_it_need_not_be_comparable(qtbot) -> None:
    from sizeviz.study import StudyOptions

    panel = SizePanel()
    qtbot.addWidget(panel)
    panel.show_options(StudyOptions())
    panel.comparable.setChecked(False)
    with qtbot.waitSignal(panel.changed) as caught:
        panel.epsilon.spin.setValue(0.9)
    make, words, key = caught.args
    assert make(StudyOptions()).limit.epsilon == 0.9 and words == "ε = 0.9" and key == "limit.epsilon"
