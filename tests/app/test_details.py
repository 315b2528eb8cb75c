"""Small things a person notices: keys, messages, menus, the brush's cursor, what a saved picture shows."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from app.driver import Person
from app.fakes import fake_source
from qtpy.QtCore import QPoint, Qt
from qtpy.QtWidgets import QApplication, QScrollArea, QToolButton

from sizeviz.app.inspect.histogram import bins
from sizeviz.app.news import Notice
from sizeviz.app.palette import KEYS
from sizeviz.app.panels.paint import PaintPanel


def test_a_key_that_is_a_shortcut_only_closes_the_overlay(qtbot, opened) -> None:
    for key in (Qt.Key.Key_Escape, Qt.Key.Key_B):
        opened.actions_["shortcuts"].trigger()
        qtbot.keyClick(opened.overlay, key)
        assert not opened.overlay.isVisible() and not opened.tool.active


def test_the_palette_names_a_command_s_keys_beside_it(opened) -> None:
    opened.palette_.open()
    opened.palette_.filter("fit to pane")
    item = opened.palette_.list.item(0)
    assert (item.text(), item.data(KEYS)) == ("View:  Fit to pane", "F")
    assert not opened.palette_.grab().isNull()
    opened.palette_.hide()


def test_a_refused_number_gives_way_to_the_study_s(opened) -> None:
    spin = opened.size_panel.alpha.spin
    Person(opened).type_number(spin, "0")
    assert "alpha is 0.0" in opened.toast.text.text()
    assert spin.value() == opened.controller.study.options.preserve.alpha == 2.0


def test_a_message_is_as_high_as_its_words(opened) -> None:
    for words in ("short", "a message that goes on and on " * 8):
        opened.toast.tell(Notice("error", words))
        text = opened.toast.text
        assert text.height() >= text.heightForWidth(text.width())
        assert opened.toast.height() <= max(text.heightForWidth(text.width()), opened.toast.copy_button.height()) + 28


def test_a_message_covers_neither_colour_bar_nor_verdict(opened) -> None:
    Person(opened).wait_settled()
    opened.toast.tell(Notice("info", "Saved"))
    lowest = opened.toast.mapToGlobal(QPoint(0, opened.toast.height())).y()
    assert all(lowest <= pane.bar.mapToGlobal(QPoint(0, 0)).y() for pane in opened.board.visible_panes)


def test_after_the_first_page_the_keys_go_to_the_picture(opened) -> None:
    Person(opened).wait_settled()
    assert QApplication.focusWidget() is opened.board.active.surface.glass


def test_the_table_keeps_the_last_numbers_and_calls_them_stale(qtbot, opened) -> None:
    opened.judge_panel.automatic.setChecked(False)
    before = opened.statistics.model.table
    opened.controller.change(lambda o: replace(o, preserve=replace(o.preserve, alpha=3.0)), "α = 3")
    Person(opened).wait(lambda: not opened.is_settling)
    after = opened.statistics.model.table
    assert after.header == ("", "Gradient limiting", "Size preserving (stale)")
    assert after.rows[:-1] == before.rows[:-1]  # all but the seconds, which are of a run that is gone
    assert opened.statistics.model.headerData(2, Qt.Orientation.Horizontal) == "Size\npreserving\n(stale)"
    qtbot.waitUntil(lambda: all(head_fits(opened.statistics.view, column) for column in (1, 2)), timeout=2000)
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        opened.controller.apply()
    assert "stale" not in "".join(opened.statistics.model.table.header)


def test_a_click_on_a_verdict_goes_to_the_worst_element_of_its_pane(qtbot, opened) -> None:
    second = opened.board.panes[1]
    second.set_view(second.view.with_changes(color_by="quality"))
    qtbot.mouseClick(second.verdict, Qt.MouseButton.LeftButton)
    assert opened.board.active is second
    assert opened.inspector.pin == ("size-preserving", int(second.subject.report.quality.argmin()))
    second.set_view(second.view.with_changes(color_by="target"))
    opened.inspector.set_pin("", None)
    qtbot.mouseClick(second.verdict, Qt.MouseButton.LeftButton)
    assert opened.inspector.pin is None


def test_histograms_name_the_method_whose_elements_they_count(opened) -> None:
    for pane, words in zip(opened.board.visible_panes, ("gradient limiting", "size preserving"), strict=True):
        opened.board.set_active(pane)
        Person(opened).wait(lambda: not opened.is_settling)
        assert [histogram.count.text() for histogram in opened.histograms] == [words, words]


def test_opening_something_does_not_make_the_window_grow(qtbot, flat_window) -> None:
    flat_window.resize(1024, 700)
    sizes = []
    with qtbot.waitSignal(flat_window.controller.settled, timeout=10_000):
        flat_window.controller.open_source("ring")
    for _ in range(20):
        QApplication.processEvents()
        sizes.append((flat_window.width(), flat_window.height()))
    Person(flat_window).wait(lambda: not flat_window.is_settling)
    assert flat_window.board.isVisible() and set(sizes) == {(1024, 700)}
    buttons = [button for button in flat_window.toolbar.findChildren(QToolButton) if button.text()]
    assert [button.objectName() for button in buttons if not button.isVisible()] == ["search"]
    flat_window.resize(1400, 900)
    QApplication.processEvents()
    assert all(button.isVisible() for button in buttons)


def test_the_worst_of_a_coarse_mesh_is_shown_with_everything(opened) -> None:
    pane = opened.board.active
    opened.board.go_to(pane.view.method, 0, across=200.0)
    assert pane.surface.camera == pane.surface.fitted and pane.surface.shows_all
    opened.board.go_to(pane.view.method, 0, across=4.0)
    assert pane.surface.camera.height < pane.surface.fitted.height


def test_the_window_fits_a_small_screen_whatever_it_shows(opened) -> None:
    for name in ("panes-2", "panes-4", "lesson-line"):
        opened.actions_[name].trigger()
        opened.resize(1024, 700)
        QApplication.processEvents()
        assert (opened.width(), opened.height()) == (1024, 700), name


def test_the_table_shows_all_its_rows(opened) -> None:
    view = opened.statistics.view
    assert view.verticalScrollBar().maximum() == 0 and view.horizontalScrollBar().maximum() == 0


def test_no_head_of_the_table_is_cut_with_three_methods(qtbot, opened) -> None:
    opened.actions_["panes-3"].trigger()
    pane = opened.board.panes[2]
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        pane.set_view(pane.view.with_changes(method="guaranteed"))
    Person(opened).wait(lambda: not opened.is_settling)
    assert opened.statistics.model.columnCount() == 4
    assert all(head_fits(opened.statistics.view, column) for column in (1, 2, 3))


def head_fits(view, column: int) -> bool:
    """Return whether a column's head is shown whole."""
    header = view.horizontalHeader()
    words = view.model().headerData(column, Qt.Orientation.Horizontal)
    room = header.fontMetrics().boundingRect(0, 0, 999, 999, 0, words)
    return header.sectionSize(column) >= room.width() + 12 and header.height() >= room.height() + 10


def test_what_is_under_a_resting_cursor_is_told_again_when_the_picture_moves(qtbot, opened) -> None:
    first, second = opened.board.visible_panes
    spot = Person(opened).spot(second, 0.5, 0.5)
    qtbot.mouseMove(second.surface.glass, spot + QPoint(30, 30))
    qtbot.mouseMove(second.surface.glass, spot)
    before = opened.readout.text()
    opened.inspector.go_to(first.view.method, 0)  # the other pane is linked
    glass, camera = second.surface.glass, second.surface.camera
    cursor = glass._cursor  # of two moves in one turn the system may deliver the first only
    x, y = camera.to_model(cursor.x(), cursor.y(), glass.width(), glass.height())
    assert "element" in before and opened.readout.text().startswith(f"   x {x:.5g}   y {y:.5g}")


def test_what_is_under_a_resting_cursor_is_told_again_when_a_run_ends(qtbot, opened) -> None:
    pane = opened.board.active
    spot = Person(opened).spot(pane, 0.5, 0.5)
    qtbot.mouseMove(pane.surface.glass, spot + QPoint(30, 30))
    qtbot.mouseMove(pane.surface.glass, spot)
    before = opened.readout.text()
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        opened.controller.change(
            lambda o: replace(o, preserve=replace(o.preserve, alpha=3.0)).with_comparable_slope(), "α = 3"
        )
    Person(opened).wait(lambda: not opened.is_settling)
    assert "R " in before and opened.readout.text() != before


def test_menus_of_a_pane_are_seen_whole_or_above_each_other(opened) -> None:
    for width in (1100, 1250, 1400, 1600):
        opened.resize(width, 900)
        QApplication.processEvents()
        for pane in opened.board.visible_panes:
            for menu in (pane.method, pane.quantity):
                assert menu.width() >= menu.sizeHint().width() or menu.width() > 0.8 * pane.width() - 20


def test_the_size_under_the_brush_is_the_size_just_painted(qtbot, opened) -> None:
    opened.actions_["paint"].trigger()
    opened.paint.value.set_value(0.0123)
    pane = opened.board.panes[0]
    glass, spot = pane.surface.glass, Person(opened).spot(pane, 0.8, 0.8)
    qtbot.mouseMove(glass, spot)
    before = glass.ring.label
    qtbot.mousePress(glass, Qt.MouseButton.LeftButton, pos=spot)
    assert glass.ring.label == "h 0.0123" != before
    assert "h 0.0123 " in opened.readout.text()
    qtbot.keyClick(opened, Qt.Key.Key_Escape)
    assert glass.ring.label == before
    qtbot.mouseRelease(glass, Qt.MouseButton.LeftButton, pos=spot)


def test_a_brush_at_first_asks_for_thousands_of_elements_not_millions(qtbot) -> None:
    panel = PaintPanel()
    qtbot.addWidget(panel)
    steep = fake_source("steep", 65, 1e-5).field
    panel.suit(steep, 1.0)
    dab = np.pi * (panel.brush().radius / panel.brush().value) ** 2
    assert 500 < dab < 3000


def test_a_list_of_a_larger_mesh_moves_nothing(opened) -> None:
    Person(opened).wait_settled()
    pane = opened.board.active
    camera = pane.surface.camera
    opened.inspector.go_to(pane.view.method, pane.subject.mesh.n_quads)
    assert pane.surface.camera == camera
    assert opened.inspector.pin is None


def test_a_saved_picture_is_what_the_pane_shows(opened, tmp_path) -> None:
    from PIL import Image

    from sizeviz.app.intents import save_picture

    pane = opened.board.active
    pane.set_view(pane.view.with_changes(cmap="viridis", classes=3))
    save_picture(opened, str(tmp_path / "all.svg"))
    mesh = pane.subject.mesh
    shown = len(set(re.findall(r"fill: (#\w{6})", (tmp_path / "all.svg").read_text("utf-8"))))
    assert shown < 16  # three classes, ground and ink; not one colour an element
    opened.board.go_to(pane.view.method, mesh.n_quads // 2, 6.0)
    save_picture(opened, str(tmp_path / "near.png"))
    with Image.open(tmp_path / "near.png") as picture:
        size = picture.size
    surface = pane.surface
    assert (size[0] - 2 * (size[0] // 40)) / surface.aspect == pytest.approx(size[1], abs=0.25 * size[1])


def test_panels_beside_the_panes_can_be_put_away_and_stay_away(opened) -> None:
    Person(opened).wait_settled()
    opened.actions_["panel-pipeline"].trigger()
    opened.actions_["panel-results"].trigger()
    assert opened.pipeline_dock.isHidden() and opened.inspector_dock.isHidden()
    opened.actions_["lesson-line"].trigger()
    opened.lessons.leave()
    assert opened.pipeline_dock.isHidden() and opened.inspector_dock.isHidden()
    opened.actions_["explain"].trigger()  # which is shown there
    assert opened.pipeline_dock.isHidden() and opened.inspector_dock.isVisible()
    opened.actions_["panel-pipeline"].trigger()
    assert opened.pipeline_dock.isVisible()


def test_the_options_fit_their_panel_with_every_part_open(opened) -> None:
    Person(opened).wait_settled()
    for section in opened.sections:
        section.head.setChecked(True)
    QApplication.processEvents()
    scroll = opened.pipeline_dock.findChild(QScrollArea)
    assert scroll.widget().width() <= scroll.viewport().width()


def test_a_verdict_on_older_elements_does_not_shine(qtbot, opened) -> None:
    opened.controller.automatic = False
    verdict = opened.board.panes[1].verdict
    assert verdict.property("role") in ("good", "bad")
    opened.size_panel.alpha.spin.setValue(3.0)
    assert verdict.property("role") == "muted"
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        opened.controller.apply()
    assert verdict.property("role") in ("good", "bad")


def test_what_was_chosen_while_painting_stays(opened) -> None:
    first, second = opened.board.visible_panes
    opened.actions_["paint"].trigger()
    assert [pane.view.color_by for pane in (first, second)] == ["prescribed", "target"]
    first.set_view(first.view.with_changes(color_by="quality"))
    second.set_view(second.view.with_changes(method="none"))
    opened.actions_["paint"].trigger()
    assert first.view.color_by == "quality"
    assert (second.view.method, second.view.color_by) == ("none", "ratio")


def test_an_error_goes_when_what_it_was_about_has_worked(qtbot, opened) -> None:
    opened.controller.open_source("nan")
    qtbot.waitUntil(opened.toast.isVisible, timeout=5000)
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        opened.controller.open_source("mri")
    assert not opened.toast.isVisible()


def test_a_wrong_range_says_what_is_wrong_with_it(opened) -> None:
    editor = opened.board.panes[0].open_editor()
    editor.mode.setCurrentIndex(editor.mode.findData("fixed"))
    assert editor.remedy.isHidden()
    editor.low.setValue(9.0)
    assert editor.remedy.text() == "From must lie below to" and editor.remedy.isVisible()
    editor.low.setValue(-1.0)
    assert "above 0" in editor.remedy.text()
    editor.low.setValue(0.5)
    assert editor.remedy.isHidden()
    editor.close()


def test_equal_qualities_have_a_range_with_readable_ends() -> None:
    edges, heights = bins(np.full(9, 1.0) - 1e-9 * np.arange(9), "quality")
    assert np.ptp(edges) >= 0.02 and heights.sum() == 9
