"""Films: every take is in them, in the order and the colours that were planned."""

from __future__ import annotations

import itertools
import re
import subprocess
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image
from study.cases import valley_source

from sizeviz.cli import run_command_line
from sizeviz.errors import Cancelled, InputError, MissingDependencyError
from sizeviz.scene import film as module
from sizeviz.scene.film import Film, save_film
from sizeviz.scene.film_plans import adaptive_film, alpha_film
from sizeviz.study import Study, StudyOptions
from sizeviz.study.adaptive import AdaptOptions, adapted


@pytest.fixture(scope="module")
def turning() -> Film:
    return alpha_film(Study(valley_source(33, 0.05, 0.15)), (1.0, 2.0, 4.0))


def test_a_turning_alpha_is_a_run_of_both_methods_for_each(turning: Film) -> None:
    assert [take.caption for take in turning.takes] == ["α = 1.00", "α = 2.00", "α = 4.00"]
    counts = np.array([[pane.mesh.n_quads for pane in take.panes()] for take in turning.takes])
    assert (np.diff(counts[:, 1]) > 0).all(), "a larger ball, more elements"
    limited, preserved = (values for values, _ in turning.curve.lines.values())
    for k, take in enumerate(turning.takes):
        for pane, shares in zip(take.panes(), (limited, preserved), strict=True):
            assert shares[k] == pytest.approx(100.0 * (pane.ratio <= 1.0 + 1e-9).mean())
    assert preserved[-1] > limited[0]


@pytest.mark.gl
def test_a_gif_holds_every_take(turning: Film, tmp_path: Path) -> None:
    with Image.open(save_film(turning, tmp_path / "a.gif", width=400)) as film:
        assert film.n_frames == 3 and film.size[0] == 400 and film.info["duration"] == 250
        pictures = []
        for k in range(3):
            film.seek(k)
            pictures.append(np.asarray(film.convert("RGB")).astype(int))
    assert all(np.abs(a - b).max() > 50 for a, b in itertools.pairwise(pictures))


@pytest.mark.gl
def test_an_mp4_can_be_read_back(turning: Film, tmp_path: Path) -> None:
    path = save_film(turning, tmp_path / "a.mp4", width=400)
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    done = subprocess.run(command, capture_output=True, check=True, timeout=60)
    assert b"h264" in done.stderr and b"400x" in done.stderr
    height = int(re.search(rb" 400x(\d+)", done.stderr)[1])
    frames = np.frombuffer(done.stdout, np.uint8).reshape(-1, height, 400, 3)
    assert len(frames) == 9, "three takes of a quarter of a second"
    assert all(len(np.unique(frame)) > 50 for frame in frames)
    assert np.abs(frames[0].astype(int) - frames[-1]).max() > 50


@pytest.mark.gl
def test_an_adaptive_process_is_filmed_from_its_folder(tmp_path: Path) -> None:
    options = AdaptOptions(study=StudyOptions().with_comparable_slope(), cells=6, iterations=2, limit=0.1)
    evolution = adapted(valley_source(33, 0.05, 0.15), options, tmp_path / "adapted")
    plan = adaptive_film(tmp_path / "adapted")
    assert [take.caption for take in plan.takes] == ["iteration 0", "iteration 1", "iteration 2"]
    assert plan.curve.lines["against the given field"][0] == [row.analytic_ratio for row in evolution.iterations]
    out = tmp_path / "film.gif"
    assert run_command_line(["film", str(tmp_path / "adapted"), "-o", str(out), "--width", "360"]) == 0
    with Image.open(out) as film:
        assert film.n_frames == 3


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        (["ring", "-o", "f.avi"], "no film format for '.avi'; use .mp4 or .gif"),
        (["ring", "-o", "f.gif", "--width", "10"], "width is 10"),
        (["ring", "-o", "f.gif", "--takes", "0"], "takes is 0"),
        (["ring", "-o", "f.gif", "--first", "0"], "alpha turns from 0.0 to 6.0; give 1e-06 to 1e+06"),
        ([".", "-o", "f.gif"], "holds no adaptive process"),
    ],
)
def test_what_cannot_be_filmed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, typed: list[str], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sizeviz.scene.opengl.require_gl", lambda: None)
    assert run_command_line(["film", *typed]) == 2
    assert words in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_without_ffmpeg_the_remedy_is_named(turning: Film, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "find_spec", lambda name: None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'sizeviz\[video\]'; \.gif needs nothing"):
        save_film(turning, tmp_path / "a.mp4")


@pytest.mark.gl
def test_a_film_can_be_cancelled_and_leaves_nothing(turning: Film, tmp_path: Path) -> None:
    class Stop:
        def step(self, fraction: float, message: str = "") -> None:
            if fraction > 0.5:
                raise Cancelled

    for name in ("a.mp4", "a.gif"):
        with pytest.raises(Cancelled):
            save_film(turning, tmp_path / name, width=320, monitor=Stop())
    assert not list(tmp_path.iterdir())


def test_a_film_of_nothing_is_refused(turning: Film, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing to film"):
        save_film(Film("", turning.views, [], turning.curve), tmp_path / "a.gif")
