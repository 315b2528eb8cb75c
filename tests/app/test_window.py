from __future__ import annotations

import csv
import gc
import io
import time
import weakref

import numpy as np
import pytest
from app.driver import Person
from app.fakes import FakeEngine, FlatCanvas, fake_source
from qtpy.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from qtpy.QtGui import QDropEvent
from qtpy.QtWidgets import (
    QAbstractSpinBox,
    QApplication,
    QCheckBox,
    QComboBox,
    QLineEdit,
    QPushButton,
    QSlider,
    QTabBar,
    QToolButton,
)

from sizeviz.app.actions import COMMANDS
from sizeviz.app.feedback import time_left
from sizeviz.app.inspect.judge import worst
from sizeviz.app.news import Notice
from sizeviz.app.palette import match
from sizeviz.app.panels.options import SizePanel, SmoothPanel
from sizeviz.app.panels.paint import PaintPanel
from sizeviz.app.settings import Settings
from sizeviz.app.window import MainWindow
from sizeviz.scene.camera import Camera2D

INNER = ("ScrollLeftButton", "ScrollRightButton", "qt_toolbar_ext_button")
"""Parts of Qt's own widgets, which Qt names itself."""


def glass(window, pane: int = 0):
    return window.board.panes[pane].surface.glass


def at(window, x: float, y: float, pane: int = 0) -> QPoint:
    widget = glass(window, pane)
    px, py = window.board.panes[pane].surface.camera.to_pixel(x, y, widget.width(), widget.height())
    return QPoint(round(px), round(py))


def test_nothing_open_shows_the_gallery_alone(flat_window) -> None:
    assert flat_window.pages.currentWidget() is flat_window.welcome
    assert not flat_window.pipeline_dock.isVisible() and not flat_window.actions_["undo"].isEnabled()


def test_opening_shows_panes_verdict_and_table(opened) -> None:
    assert opened.pages.currentWidget() is opened.board
    first, second = opened.board.visible_panes
    assert "correct, worst R" in first.verdict.text() and first.verdict.text().startswith("✗")
    assert first.surface.canvas.spec.title == "Gradient limiting"
    assert second.surface.canvas.spec.title == "Size preserving"
    table = opened.statistics.model.table
    assert table.header == ("", "Gradient limiting", "Size preserving")
    assert table.rows[0] == ("Elements", "576", "576")


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


def test_hover_reads_and_click_pins_the_element_under_the_cursor(qtbot, opened) -> None:
    mesh = opened.board.panes[0].subject.mesh
    centre = mesh.points[mesh.quads[300]].mean(axis=0)
    where = at(opened, *centre)
    qtbot.mouseMove(glass(opened), where + QPoint(40, 40))  # a pointer that is there already would not move
    qtbot.mouseMove(glass(opened), where)
    qtbot.waitUntil(lambda: "element 300" in opened.readout.text(), timeout=5000)
    assert "h*" in opened.readout.text()
    assert "hover" in glass(opened).marks
    qtbot.mouseClick(glass(opened), Qt.MouseButton.LeftButton, pos=where)
    assert opened.inspector.pin == ("gradient-limiting", 300)
    assert "pin" in glass(opened).marks and "pin" not in glass(opened, 1).marks
    qtbot.mouseClick(glass(opened), Qt.MouseButton.LeftButton, pos=where)
    assert opened.inspector.pin is None


def test_the_worst_element_is_gone_to_and_marked_in_the_list(opened) -> None:
    opened.actions_["worst-ratio"].trigger()
    pane = opened.board.active
    ratios = pane.subject.report.ratios["mean-edge"]
    element = int(ratios.argmax())
    assert opened.inspector.pin == (pane.view.method, element)
    x, y = pane.subject.mesh.points[pane.subject.mesh.quads[element]].mean(axis=0)
    assert (pane.surface.camera.x, pane.surface.camera.y) == pytest.approx((x, y))
    assert opened.worst.view.selectionModel().selectedRows()[0].row() == 0
    assert list(opened.worst.elements) == list(np.argsort(-ratios, kind="stable")[:100])


def test_a_row_of_the_list_leads_to_its_element(opened) -> None:
    opened.worst.view.selectRow(7)
    assert opened.inspector.pin == (opened.board.active.view.method, int(opened.worst.elements[7]))


def test_a_range_of_the_histogram_selects_exactly_those_elements(opened) -> None:
    histogram = opened.histograms[0]
    histogram.set_range(1.1, 1.2)
    ratios = opened.board.active.subject.report.ratios["mean-edge"]
    expected = np.flatnonzero((ratios >= 1.1) & (ratios <= 1.2))
    assert len(expected) and list(opened.board.selection.elements) == list(expected)
    lines = next(layer for layer in opened.board.panes[0].spec.layers if layer.name == "selected")
    assert len(lines.segments) == 4 * len(expected)
    histogram.clear_button.setChecked(False)
    assert opened.board.selection is None


def test_the_table_is_copied_in_three_formats(opened) -> None:
    beginnings = {"CSV": ",Gradient limiting", "Markdown": "|  | Gradient", "LaTeX": r"\begin{tabular}{lrr}"}
    for name, first in beginnings.items():
        opened.statistics.copy(name)
        assert QApplication.clipboard().text().startswith(first)
    opened.statistics.copy("CSV")
    rows = list(csv.reader(io.StringIO(QApplication.clipboard().text())))
    assert len(rows) == 13 and rows[1] == ["Elements", "576", "576"]


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


def test_undo_and_redo_by_keyboard_with_a_history(qtbot, opened) -> None:
    opened.controller.set_source(fake_source("second"), "Open second")
    qtbot.waitUntil(lambda: not opened.controller.missing(), timeout=5000)
    assert opened.controller.store.stack.text(0) == "Open second"
    qtbot.keyClick(opened, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert opened.controller.study.source.label == "Ring" and "Ring" in opened.windowTitle()
    qtbot.keyClick(opened, Qt.Key.Key_Y, Qt.KeyboardModifier.ControlModifier)
    assert opened.controller.study.source.label == "Second"


def test_a_dropped_file_is_opened(qtbot, opened, tmp_path) -> None:
    path = tmp_path / "sizes.npy"
    np.save(path, np.full((5, 5), 0.1))
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(path))])
    where = QPointF(200, 200) if hasattr(QDropEvent, "position") else QPoint(200, 200)
    event = QDropEvent(where, Qt.DropAction.CopyAction, mime, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier)
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        opened.dropEvent(event)
    assert opened.controller.study.source.name == "sizes.npy"
    assert opened.settings.recent[0].endswith("sizes.npy")


def test_an_error_is_shown_with_details_to_copy_and_the_window_lives(qtbot, opened) -> None:
    with qtbot.waitSignal(opened.controller.noticed, timeout=5000):
        opened.controller.open_source("nan.npy")
    assert opened.toast.isVisible() and "NaN" in opened.toast.text.text()
    opened.toast.copy_button.click()
    assert "Traceback" in QApplication.clipboard().text()
    opened.toast.close_button.click()
    assert not opened.toast.isVisible()
    opened.actions_["swap"].trigger()


def test_progress_appears_with_cancel_and_goes(qtbot, opened, engine) -> None:
    engine.seconds = 20.0
    opened.controller.set_source(fake_source("slow"), "Open slow")
    qtbot.waitUntil(lambda: opened.progress.bar.value() > 0, timeout=5000)
    assert opened.progress.button.isVisible()
    with qtbot.waitSignal(opened.controller.jobs.idle, timeout=500):
        opened.progress.button.click()
    assert not opened.progress.button.isVisible() and opened.judge_panel.apply.isEnabled()


def test_stale_panes_wear_a_badge(qtbot, opened, engine) -> None:
    engine.seconds = 20.0
    opened.size_panel.alpha.spin.setValue(3.0)
    qtbot.wait(20)
    assert not opened.board.panes[1].badge.isHidden()
    opened.controller.cancel()
    qtbot.waitUntil(lambda: not opened.controller.jobs.is_busy)
    assert "Stale" in opened.judge_panel.note.text()


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


def test_themes_change_ground_and_are_remembered(opened) -> None:
    opened.actions_["theme"].setChecked(True)
    assert opened.settings.theme == "dark" and sum(opened.board.panes[0].spec.ground) < 120
    opened.actions_["theme"].setChecked(False)
    assert opened.settings.theme == "light" and sum(opened.board.panes[0].spec.ground) == 3 * 255


def test_the_layout_is_remembered(qtbot, engine, tmp_path) -> None:
    settings = Settings(str(tmp_path / "s.ini"))
    first = MainWindow(engine, settings, FlatCanvas)
    qtbot.addWidget(first)
    first.resize(1234, 777)
    first.show()
    first.close()
    second = MainWindow(engine, settings, FlatCanvas)
    qtbot.addWidget(second)
    assert (second.width(), second.height()) == (1234, 777)
    second.close()


def test_closing_during_a_run_ends_it_and_frees_the_canvases(qtbot, engine, tmp_path) -> None:
    engine.seconds = 30.0
    window = MainWindow(engine, Settings(str(tmp_path / "s.ini")), FlatCanvas)
    qtbot.addWidget(window)
    window.show()
    window.controller.open_source("ring")
    qtbot.waitUntil(lambda: any("run" in call for call in engine.calls), timeout=5000)
    window.close()
    assert window.controller.jobs._pool.activeThreadCount() == 0
    assert all(pane.surface.canvas.disposed for pane in window.board.panes)


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


def test_pictures_are_saved_or_the_reason_is_told(qtbot, opened, tmp_path) -> None:
    from sizeviz.app.intents import save_picture

    with qtbot.waitSignal(opened.controller.noticed) as caught:
        save_picture(opened, str(tmp_path / "no" / "where" / "x.svg"))
    assert caught.args[0].level == "error" and "cannot be written" in caught.args[0].text
    with qtbot.waitSignal(opened.controller.noticed) as caught:
        save_picture(opened, str(tmp_path / "x.svg"))
    assert caught.args[0].level == "info" and (tmp_path / "x.svg").stat().st_size > 1000


def test_messages_that_are_no_errors_go_by_themselves(qtbot, opened, monkeypatch) -> None:
    monkeypatch.setattr("sizeviz.app.feedback.TOAST_MS", 30)
    opened.toast.tell(Notice("info", "Saved"))
    assert opened.toast.isVisible()
    qtbot.waitUntil(lambda: not opened.toast.isVisible(), timeout=2000)


def test_time_left_reads_like_words() -> None:
    assert [time_left(s) for s in (-1.0, 0.4, 12.2, 300.0)] == ["", "almost done", "12 s left", "5 min left"]


def test_the_worst_are_worst_first_and_ties_go_by_number() -> None:
    values = np.array([0.5, 0.1, 0.9, 0.1, 0.3])
    assert list(worst(values, 3)) == [1, 3, 4] and list(worst(values, 99)) == [1, 3, 4, 0, 2]


def test_a_formula_is_opened_by_enter(qtbot, opened, engine: FakeEngine) -> None:
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        opened.source.formula.setFocus()
        qtbot.keyClicks(opened.source.formula, "0.1+x")
        qtbot.keyClick(opened.source.formula, Qt.Key.Key_Return)
    assert "load expr:0.1+x" in engine.calls


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


def test_the_menus_of_narrow_panes_stay_readable(qtbot, opened) -> None:
    opened.resize(1400, 900)
    for count in (3, 4, 2):
        opened.actions_[f"panes-{count}"].trigger()
        QApplication.processEvents()
        for pane in opened.board.visible_panes:
            for menu in (pane.method, pane.quantity):
                assert menu.width() >= menu.sizeHint().width()


def test_a_session_has_no_complaint_from_qt(qtbot, opened, qtlog) -> None:
    pane = opened.board.panes[0]
    opened.actions_["paint"].trigger()
    person = Person(opened)
    person.drag(pane, [(0.2, 0.2), (0.6, 0.5)])
    person.hover(pane, 0.4, 0.4)
    opened.actions_["theme"].trigger()
    opened.actions_["panes-4"].trigger()
    person.wait_settled(10)
    opened.grab()
    assert [record.message for record in qtlog.records] == []


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
