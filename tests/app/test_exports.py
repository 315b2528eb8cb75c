"""Pages and films leave the window beside its own thread."""

from __future__ import annotations

import pytest
from PIL import Image

from sizeviz.app import exports
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


@pytest.mark.gl
@pytest.mark.slow
def test_a_turning_alpha_becomes_a_film_with_progress(qtbot, opened, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(exports, "TAKES", 2)
    source = opened.controller.study.source
    coarse = source.field.with_sizes(source.field.sizes.clip(0.08))
    opened.controller.automatic = False
    opened.controller.store.commit(opened.controller.study.with_source(replaced(source, coarse)), "coarser")
    seen = []
    opened.controller.jobs.progressed.connect(lambda *state: seen.append(state))
    with qtbot.waitSignal(opened.controller.jobs.completed, timeout=400_000):
        exports.save_film(opened, str(tmp_path / "a.gif"))
    with Image.open(tmp_path / "a.gif") as film:
        assert film.n_frames == 2
    assert any("filming" in words for _, words, _ in seen)


def test_a_film_that_cannot_be_made_says_why(qtbot, opened, tmp_path) -> None:
    with qtbot.waitSignal(opened.controller.jobs.failed, timeout=60_000):
        exports.save_film(opened, str(tmp_path / "a.avi"))
    assert "no film format for '.avi'" in opened.toast.text.text()


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
