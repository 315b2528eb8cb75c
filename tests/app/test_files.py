from __future__ import annotations

import errno
import gc
import os
from weakref import ref

import numpy as np
import pytest
from app.fakes import FakeEngine, FlatCanvas
from qtpy.QtWidgets import QApplication, QFileDialog

from sizeviz.app.settings import Settings
from sizeviz.app.window import MainWindow
from sizeviz.files import read_field
from sizeviz.sources.painting import Brush, painted
from sizeviz.study import Study
from sizeviz.study.storage import StudyFile, read_study, write_study
from sizeviz.study.storage.autosave import leftovers


def paint(controller, x: float = 0.3, size: float = 0.004) -> None:
    controller.painting.begin(Brush(radius=0.1, value=size), "freehand", x, 0.4)
    controller.painting.extend(x + 0.3, 0.5)
    controller.painting.end()


def notices(window) -> list:
    said: list = []
    window.controller.noticed.connect(said.append)
    return said


def save(qtbot, window, path) -> None:
    said = notices(window)
    window.files.save(path)
    qtbot.waitUntil(lambda: bool(said), timeout=10_000)


def another_window(qtbot, folder) -> MainWindow:
    window = MainWindow(FakeEngine(), Settings(str(folder / "settings.ini")), FlatCanvas)
    qtbot.addWidget(window)
    window.show()
    return window


@pytest.mark.parametrize("way", ["save", "autosave"])
def test_what_was_saved_or_autosaved_holds_no_mesh(qtbot, opened, tmp_path, way: str) -> None:
    paint(opened.controller)
    qtbot.waitUntil(lambda: not opened.controller.missing(), timeout=10_000)
    meshes = [ref(run.mesh) for run in opened.controller.study.runs.values()]
    if way == "save":
        save(qtbot, opened, tmp_path / "kept")
        assert not opened.files.is_modified
    else:
        opened.files.autosave()
        qtbot.waitUntil(lambda: opened.files._kept() is opened.controller.study, timeout=10_000)
    paint(opened.controller, 0.5, 0.006)
    qtbot.waitUntil(lambda: not opened.controller.missing(), timeout=10_000)
    opened.controller.store.stack.clear()
    opened.files._timer.stop()
    qtbot.waitUntil(lambda: not gc.collect() and not any(mesh() for mesh in meshes), timeout=5000)


def test_a_painted_study_comes_back_with_strokes_original_and_view(qtbot, opened, tmp_path) -> None:
    original = opened.controller.study.source.field
    paint(opened.controller)
    paint(opened.controller, 0.5, 0.006)
    qtbot.waitUntil(lambda: not opened.controller.missing(), timeout=10_000)
    sizes = opened.controller.study.source.field.sizes
    opened.actions_["panes-3"].trigger()
    opened.actions_["color-quality"].trigger()
    shown = [(pane.view.method, pane.view.color_by) for pane in opened.board.visible_panes]
    save(qtbot, opened, tmp_path / "two strokes")
    assert opened.windowTitle().startswith("two strokes.sizeviz") and not opened.isWindowModified()

    window = another_window(qtbot, tmp_path)
    with qtbot.waitSignal(window.controller.settled, timeout=10_000):
        window.controller.open_source(str(tmp_path / "two strokes.sizeviz"))
    study = window.controller.study
    assert np.array_equal(study.source.field.sizes, sizes)
    known = window.controller.painting.painted(study.source)
    assert np.array_equal(known.original.sizes, original.sizes) and len(known.strokes) == 2
    again = known.original
    for stroke in known.strokes:
        again = painted(again, stroke, known.original)
    assert np.array_equal(again.sizes, sizes)
    assert [(pane.view.method, pane.view.color_by) for pane in window.board.visible_panes] == shown
    assert window.controller.engine.calls == []  # the results were in the file
    assert not window.files.is_modified and window.settings.recent[0].endswith("two strokes.sizeviz")
    eraser = Brush(mode="erase", radius=2.0, hardness=1.0)
    window.controller.painting.begin(eraser, "freehand", 0.5, 0.5)
    window.controller.painting.end()
    assert np.allclose(window.controller.study.source.field.sizes, original.sizes)
    window.close()


def test_save_asks_for_a_place_once(qtbot, opened, tmp_path, monkeypatch) -> None:
    asked: list[str] = []

    def ask(parent, title, start, kinds):
        asked.append(start)
        return str(tmp_path / "mine.sizeviz"), kinds

    monkeypatch.setattr(QFileDialog, "getSaveFileName", ask)
    said = notices(opened)
    opened.actions_["save"].trigger()
    qtbot.waitUntil(lambda: len(said) == 1, timeout=10_000)
    paint(opened.controller)
    assert opened.isWindowModified()
    opened.actions_["save"].trigger()
    qtbot.waitUntil(lambda: len(said) == 2, timeout=10_000)
    assert len(asked) == 1 and said[1].text == "Saved mine.sizeviz" and not opened.isWindowModified()
    assert len(read_study(tmp_path / "mine.sizeviz").strokes) == 1
    opened.actions_["save-as"].trigger()
    qtbot.waitUntil(lambda: len(said) == 3, timeout=10_000)
    assert len(asked) == 2


def test_a_study_that_another_program_changed_is_not_replaced_unasked(qtbot, opened, tmp_path) -> None:
    path = tmp_path / "shared.sizeviz"
    save(qtbot, opened, path)
    other = StudyFile(Study(opened.controller.study.source), view={"from": "elsewhere"})
    write_study(path, other)
    paint(opened.controller)
    said = notices(opened)
    opened.files.save(path)
    assert said[0].level == "warning" and "changed by another program" in said[0].text
    assert read_study(path).view == {"from": "elsewhere"} and opened.files.is_modified
    opened.files.save(path)  # again, knowing it
    qtbot.waitUntil(lambda: not opened.files.is_modified, timeout=10_000)
    assert len(read_study(path).strokes) == 1
    paint(opened.controller)
    path.unlink()  # gone is not changed: nothing can be lost
    opened.files.save(path)
    qtbot.waitUntil(lambda: not opened.files.is_modified, timeout=10_000)
    assert path.exists()


@pytest.mark.parametrize("place", ["no/such/folder.sizeviz", "/proc/folder.sizeviz"])
def test_a_save_that_fails_is_a_notice_and_the_window_lives_on(qtbot, opened, tmp_path, place: str) -> None:
    paint(opened.controller)
    said = notices(opened)
    opened.files.save(tmp_path / place)
    qtbot.waitUntil(lambda: bool(said), timeout=10_000)
    assert said[0].level == "error" and "folder.sizeviz" in said[0].text
    assert opened.files.is_modified and opened.toast.isVisible()
    save(qtbot, opened, tmp_path / "better.sizeviz")
    assert not opened.files.is_modified


def test_a_full_disk_is_a_notice(qtbot, opened, tmp_path, monkeypatch) -> None:
    def full(handle: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("os.fsync", full)
    paint(opened.controller)
    said = notices(opened)
    opened.files.save(tmp_path / "full.sizeviz")
    qtbot.waitUntil(lambda: bool(said), timeout=10_000)
    assert "the disk is full" in said[0].text
    for _ in range(3):
        opened.files.autosave()
        qtbot.waitUntil(lambda: not opened.files._saving.is_busy, timeout=5000)
    assert [notice.text.startswith("Autosave: ") for notice in said] == [False, True]
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        paint(opened.controller, 0.5)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 torn", b"not a study at all"])
def test_a_corrupt_file_is_a_notice_and_leaves_the_study_alone(qtbot, opened, tmp_path, content: bytes) -> None:
    path = tmp_path / "bad.sizeviz"
    path.write_bytes(content)
    before = opened.controller.study
    said = notices(opened)
    opened.controller.open_source(str(path))
    qtbot.waitUntil(lambda: bool(said), timeout=10_000)
    assert said[0].level == "error" and "bad.sizeviz" in said[0].text
    assert opened.controller.study is before


def test_a_view_that_makes_no_sense_is_ignored(qtbot, opened, tmp_path) -> None:
    path = tmp_path / "odd.sizeviz"
    view = {"panes": [{"method": "magic", "color_by": 7}, "x"], "camera": [0.1, "y", 1e400]}
    write_study(path, StudyFile(Study(opened.controller.study.source), view={**view, "camera": [0.1, "y", -1]}))
    said = notices(opened)
    with qtbot.waitSignal(opened.controller.opened, timeout=10_000):
        opened.controller.open_source(str(path))
    qtbot.wait(50)
    assert not said and len(opened.board.visible_panes) == 2


def test_unsaved_changes_are_found_again_after_closing(qtbot, opened, tmp_path) -> None:
    paint(opened.controller)
    sizes = opened.controller.study.source.field.sizes
    opened.close()
    assert len(leftovers(tmp_path / "autosave")) == 1

    window = another_window(qtbot, tmp_path)
    found = window.files.leftovers()
    assert len(found) == 1
    with qtbot.waitSignal(window.controller.settled, timeout=10_000):
        window.actions_["recover"].trigger()
    assert np.array_equal(window.controller.study.source.field.sizes, sizes)
    assert window.files.is_modified and not found[0].path.exists()
    save(qtbot, window, tmp_path / "saved.sizeviz")
    window.close()
    assert leftovers(tmp_path / "autosave") == [] and not list((tmp_path / "autosave").iterdir())


def test_an_autosave_follows_a_change_by_itself_and_a_save_makes_it_needless(qtbot, opened, tmp_path) -> None:
    folder = tmp_path / "autosave"
    opened.files._timer.setInterval(20)
    assert not folder.exists()
    paint(opened.controller)
    qtbot.waitUntil(lambda: folder.exists() and any(folder.glob("[0-9]*.sizeviz")), timeout=10_000)
    assert leftovers(folder) == []  # its program is alive
    qtbot.waitUntil(lambda: not opened.files._saving.is_busy, timeout=5000)
    save(qtbot, opened, tmp_path / "kept.sizeviz")
    assert not list(folder.glob("*.sizeviz"))


def test_a_painted_study_is_copied_as_what_refers_to_its_files(qtbot, opened, tmp_path) -> None:
    QApplication.clipboard().setText("before")
    paint(opened.controller)
    said = notices(opened)
    for name in ("copy-command", "copy-python"):
        opened.actions_[name].trigger()
    assert [notice.level for notice in said] == ["error", "error"] and "save the study first" in said[0].text
    assert QApplication.clipboard().text() == "before"
    save(qtbot, opened, tmp_path / "painted.sizeviz")
    opened.actions_["copy-python"].trigger()
    assert str(tmp_path / "painted.sizeviz") in QApplication.clipboard().text()
    opened.actions_["copy-command"].trigger()
    words = QApplication.clipboard().text()
    assert words.startswith("sizeviz compare ") and str(tmp_path / "painted.npz") in words
    assert np.array_equal(read_field(tmp_path / "painted.npz").sizes, opened.controller.study.source.field.sizes)
    assert "--measure" not in words
    opened.judge_panel.measure.setCurrentIndex(opened.judge_panel.measure.findData("max-edge"))
    opened.judge_panel.measure.activated.emit(opened.judge_panel.measure.currentIndex())
    opened.actions_["copy-command"].trigger()
    assert QApplication.clipboard().text().count("--measure max-edge") == 1
