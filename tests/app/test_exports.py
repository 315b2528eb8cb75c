"""Pages and films leave the window beside its own thread."""

from __future__ import annotations

import subprocess
import sys
import types

import numpy as np
import pytest
import pyvista
from app.test_process_player import pretend
from PIL import Image
from qtpy.QtWidgets import QFileDialog

from sizeviz.app import exports, films
from sizeviz.app.films import FilmDialog, Turn
from sizeviz.app.places import ask_place, kinds
from sizeviz.files import read_field
from sizeviz.files.registry import FIELD_READERS, FIELD_WRITERS, IMAGE_READERS, MESH_WRITERS
from sizeviz.progress_lines import LineMonitor, parsed_line

pytestmark = pytest.mark.display


def test_the_panes_become_a_page(qtbot, opened, tmp_path) -> None:
    opened.actions_["color-quality"].trigger()
    with qtbot.waitSignal(opened.controller.jobs.completed, timeout=20_000):
        exports.save_page(opened, str(tmp_path / "p.html"))
    text = (tmp_path / "p.html").read_text("utf-8")
    assert "Gradient limiting" in text and "Size preserving" in text and '"quantity":"quality"' in text
    assert "Saved p.html" in opened.toast.text.text()


def test_a_page_that_cannot_be_written_is_an_error_and_the_window_lives(qtbot, opened, tmp_path) -> None:
    with qtbot.waitSignal(opened.controller.jobs.failed, timeout=20_000):
        exports.save_page(opened, str(tmp_path / "nowhere" / "p.html"))
    assert "the folder does not exist" in opened.toast.text.text()


def test_the_mesh_of_the_active_pane_is_saved_with_its_judgement(qtbot, opened, tmp_path) -> None:
    opened.board.set_active(opened.board.panes[1])
    with qtbot.waitSignal(opened.controller.jobs.completed, timeout=20_000):
        exports.save_mesh(opened, str(tmp_path / "m.vtu"))
    report = opened.controller.study.runs["size-preserving"].report
    held = pyvista.read(tmp_path / "m.vtu")
    np.testing.assert_allclose(held.cell_data["ratio"], report.ratios["mean-edge"])
    assert set(held.point_data.keys()) >= {"size_prescribed", "size_target"}
    assert "Saved m.vtu" in opened.toast.text.text()


def test_fields_are_saved_as_given_and_as_processed(qtbot, opened, tmp_path) -> None:
    study = opened.controller.study
    for save, field in (
        (exports.save_prescribed, study.source.field),
        (exports.save_target, study.runs["gradient-limiting"].target),
    ):
        with qtbot.waitSignal(opened.controller.jobs.completed, timeout=20_000):
            save(opened, str(tmp_path / "f.npz"))
        np.testing.assert_allclose(read_field(tmp_path / "f.npz").sizes, field.sizes)


def test_what_is_older_than_the_study_is_not_saved_and_what_to_do_is_said(opened, tmp_path) -> None:
    opened.controller.automatic = False
    opened.size_panel.alpha.spin.setValue(3.0)
    for save in (exports.save_mesh, exports.save_target):
        opened.toast.hide()
        save(opened, str(tmp_path / "old.vtu"))
        assert "press Apply (F5)" in opened.toast.text.text() and opened.toast.isVisible()
    assert not (tmp_path / "old.vtu").exists()


def test_saving_breaks_no_run_off(qtbot, opened, engine, tmp_path) -> None:
    engine.seconds = 20.0
    opened.size_panel.alpha.spin.setValue(3.0)
    qtbot.waitUntil(lambda: opened.controller.is_running)
    running = opened.controller.jobs.running
    exports.save_page(opened, str(tmp_path / "p.html"))
    exports.save_film(opened, Turn(), str(tmp_path / "a.gif"))
    assert opened.controller.jobs.running is running and not running.monitor.is_cancelled
    assert "wait for its end" in opened.toast.text.text()
    opened.controller.cancel()


def test_a_place_without_suffix_gets_the_one_that_was_offered(monkeypatch) -> None:
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *given: ("/there/mesh", ""))
    assert ask_place(None, "Save", "ring.vtu", "Meshes (*.vtu)") == "/there/mesh.vtu"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *given: ("", ""))
    assert ask_place(None, "Save", "ring.vtu", "Meshes (*.vtu)") == ""


def test_opening_offers_every_format_that_is_read(opened, monkeypatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *given: (asked.append(given[3]) or "", ""))
    opened.actions_["open"].trigger()
    assert asked[0].startswith("Studies, size fields and images (*.sizeviz *.dcm ")
    assert all(f"*{suffix}" in asked[0] for suffix in (*FIELD_READERS, *IMAGE_READERS))


def test_the_dialogs_offer_every_format_that_is_written() -> None:
    assert kinds("Meshes", MESH_WRITERS).startswith("Meshes (*.avs ") and "*.vtu" in kinds("Meshes", MESH_WRITERS)
    assert all(f"*{suffix}" in kinds("Size fields", FIELD_WRITERS) for suffix in FIELD_WRITERS)


@pytest.mark.gl
@pytest.mark.slow
def test_a_turning_alpha_becomes_a_film_with_progress(qtbot, opened, tmp_path) -> None:
    source = opened.controller.study.source
    coarse = source.field.with_sizes(source.field.sizes.clip(0.08))
    opened.controller.automatic = False
    opened.controller.store.commit(opened.controller.study.with_source(replaced(source, coarse)), "coarser")
    seen = []
    opened.controller.jobs.progressed.connect(lambda *state: seen.append(state))
    with qtbot.waitSignal(opened.controller.jobs.completed, timeout=400_000):
        exports.save_film(opened, Turn(takes=2, width=640), str(tmp_path / "a.gif"))
    with Image.open(tmp_path / "a.gif") as film:
        assert film.n_frames == 2 and film.width == 640
    assert any("filming" in words for _, words, _ in seen)


def test_the_dialog_asks_what_turns(qtbot, opened, monkeypatch) -> None:
    asked = []
    monkeypatch.setattr(exports, "save_film", lambda window, turn: asked.append(turn))
    opened.actions_["save-film"].trigger()
    dialog = opened.findChild(FilmDialog)
    dialog.first.setValue(2.0)
    dialog.takes.setValue(12)
    assert "12 runs of the pipeline" in dialog.words.text() and "3 s of film" in dialog.words.text()
    dialog.accept()
    assert asked == [Turn(first=2.0, takes=12)]
    assert asked[0].as_typed() == ["--first", "2", "--last", "6", "--takes", "12", "--width", "1280"]


@pytest.mark.gl
def test_iterations_become_a_film_from_the_player(qtbot, flat_window, tmp_path, monkeypatch) -> None:
    (tmp_path / "p").mkdir()
    pretend(tmp_path / "p", last=1)
    flat_window.lessons.open_process()
    page = flat_window.lessons.process_page
    assert not page.film_button.isEnabled()
    jobs = flat_window.controller.jobs
    with qtbot.waitSignal(jobs.idle, timeout=20_000):
        page.open_folder(tmp_path / "p")
    monkeypatch.setattr(exports, "ask_film_place", lambda *_: str(tmp_path / "i.gif"))
    with qtbot.waitSignal(jobs.completed, timeout=200_000):
        page.film_button.click()
    with Image.open(tmp_path / "i.gif") as film:
        assert film.n_frames == 2
    assert "Saved i.gif" in flat_window.toast.text.text()


def test_cancel_ends_a_film_at_once_and_leaves_nothing(qtbot, opened, tmp_path, monkeypatch) -> None:
    """The process that makes it is silent here, as one inside a long step is."""
    (tmp_path / "a.gif").write_bytes(b"the old one")
    started = tmp_path / "started"
    silent = f"import time, pathlib; pathlib.Path({str(started)!r}).touch(); time.sleep(60)"
    silenced = types.SimpleNamespace(**vars(subprocess))  # of the films alone: others start processes too
    silenced.Popen = lambda command, **kept: subprocess.Popen([sys.executable, "-c", silent], **kept)
    monkeypatch.setattr(films, "subprocess", silenced)
    jobs = opened.controller.jobs
    exports.save_film(opened, Turn(), str(tmp_path / "a.gif"))
    qtbot.waitUntil(started.exists, timeout=20_000)
    with qtbot.waitSignal(jobs.cancelled, timeout=1000):
        jobs.cancel()
    assert (tmp_path / "a.gif").read_bytes() == b"the old one"
    assert sorted(path.name for path in tmp_path.glob("*.gif")) == ["a.gif"]


def test_a_film_that_cannot_be_made_says_why(qtbot, opened, tmp_path) -> None:
    for name, words in (("a.avi", "a.avi: no film format for '.avi'"), ("no/a.gif", "does not exist; create it")):
        with qtbot.waitSignal(opened.controller.jobs.failed, timeout=60_000):
            exports.save_film(opened, Turn(), str(tmp_path / name))
        assert words in opened.toast.text.text() and str(tmp_path) in opened.toast.text.text()


def test_progress_as_lines(capsys) -> None:
    monitor = LineMonitor()
    monitor.step(0.25, "meshing it")
    monitor.step(0.26, "too soon to tell")
    lines = capsys.readouterr().err.splitlines()
    assert [parsed_line(line) for line in lines] == [(0.25, "meshing it")]
    assert parsed_line("progress soon") is None and parsed_line("sizeviz: no") is None


def replaced(source, field):
    from dataclasses import replace

    return replace(source, field=field, reference=field)
