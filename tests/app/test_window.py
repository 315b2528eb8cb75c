"""The window as a whole: what it opens, shows, remembers and survives."""

from __future__ import annotations

import numpy as np
from app.driver import Person
from app.fakes import FakeEngine, FlatCanvas, fake_source
from qtpy.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from qtpy.QtGui import QDropEvent
from qtpy.QtWidgets import QApplication

from sizeviz.app.feedback import time_left
from sizeviz.app.news import Notice
from sizeviz.app.settings import Settings
from sizeviz.app.window import MainWindow


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
    assert window.controller.jobs.n_at_work == 0
    assert all(pane.surface.canvas.disposed for pane in window.board.panes)


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


def test_a_formula_is_opened_by_enter(qtbot, opened, engine: FakeEngine) -> None:
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        opened.source.formula.setFocus()
        qtbot.keyClicks(opened.source.formula, "0.1+x")
        qtbot.keyClick(opened.source.formula, Qt.Key.Key_Return)
    assert "load expr:0.1+x" in engine.calls


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
