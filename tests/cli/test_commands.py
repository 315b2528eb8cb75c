"""The commands as a person types them: what they write, what they print, and how they end."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from files.reader_seeds import quad_mesh
from PIL import Image

from sizeviz.cli import run_command_line
from sizeviz.cli.tables import print_report
from sizeviz.files import read_field, read_mesh, write_mesh
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sources import load

VALLEY = "expr:min(0.1, max(0.02, abs(x - 0.4 - 0.2*y)))"


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("compared") / "deep" / "folder"
    assert run_command_line(["compare", VALLEY, "--out", str(out)]) == 0
    return out


@pytest.mark.gl
class TestCompare:
    def test_writes_what_it_promises_and_nothing_else(self, compared: Path) -> None:
        names = {path.name for path in compared.iterdir()}
        assert names == {
            "mesh-gradient-limiting.vtu", "mesh-size-preserving.vtu", "mesh-guaranteed.vtu",
            "compare.png", "report.json",
        }  # fmt: skip

    def test_report_agrees_with_the_meshes(self, compared: Path) -> None:
        report = json.loads((compared / "report.json").read_text())
        assert list(report["methods"]) == ["gradient-limiting", "size-preserving", "guaranteed"]
        promised = report["methods"]["guaranteed"]
        assert promised["correct_percent"]["max_edge"] == 100.0 and promised["guarantee"].startswith("R <= 1 on all")
        for method, entry in report["methods"].items():
            content = read_mesh(compared / f"mesh-{method}.vtu")
            assert entry["n_quads"] == content.mesh.n_quads
            assert entry["max_ratio"]["mean_edge"] == pytest.approx(content.cell_data["ratio"].max(), rel=1e-12)
            assert entry["quality"]["min"] == pytest.approx(content.cell_data["quality"].min(), rel=1e-12)
            assert set(content.cell_data) == {"ratio", "quality", "size"}
            assert set(content.point_data) == {"size_prescribed", "size_target"}
        assert report["options"]["epsilon"] == 1.0 / report["options"]["alpha"]

    def test_a_scale_is_told_only_of_methods_that_use_it(self, compared: Path, capsys: pytest.CaptureFixture) -> None:
        report = json.loads((compared / "report.json").read_text())
        print_report(report)
        assert "· mesh scale 0.87" in capsys.readouterr().out
        print_report({**report, "methods": {"guaranteed": report["methods"]["guaranteed"]}})
        assert "mesh scale" not in capsys.readouterr().out

    def test_picture_shows_both_methods(self, compared: Path) -> None:
        with Image.open(compared / "compare.png") as picture:
            pixels = np.asarray(picture.convert("RGB"))
        assert min(pixels.shape[:2]) > 500
        assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 100, "colours, not a blank sheet"


@pytest.mark.gl
def test_run_writes_mesh_picture_report_and_prints_the_table(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    out = tmp_path / "out"
    options = ["--method", "none", "--measure", "max-edge", "--no-smooth", "--seed", "3", "--mesh-scale", "0.9"]
    assert run_command_line(["run", VALLEY, "--out", str(out), *options]) == 0
    assert {path.name for path in out.iterdir()} == {"mesh.vtu", "picture.png", "report.json"}
    report = json.loads((out / "report.json").read_text())
    assert list(report["methods"]) == ["none"]
    typed = report["options"]
    assert (typed["smooth"], typed["seed"], typed["mesh_scale"], typed["measure"]) == (False, 3, 0.9, "max-edge")
    printed = capsys.readouterr()
    assert f"{report['methods']['none']['n_quads']:,}" in printed.out
    assert "R ≤ 1, longest edge" in printed.out and "mesh scale 0.9" in printed.out
    assert not printed.err, "no progress where nobody watches"


def test_field_writes_the_processed_field_only(tmp_path: Path) -> None:
    background = BackgroundMesh.unit_square_grid(33, 17)
    given = SizeField(background, 0.1 + np.random.default_rng(0).random(33 * 17))
    np.save(tmp_path / "given.npy", given.sizes.reshape(17, 33))
    for suffix in ("npy", "npz", "vtu"):
        out = tmp_path / f"h.{suffix}"
        assert run_command_line(["field", str(tmp_path / "given.npy"), "-o", str(out), "--alpha", "4"]) == 0
        back = read_field(out)
        assert back.sizes.min() == pytest.approx(given.sizes.min(), rel=1e-6)
        assert (back.sizes <= given.sizes * (1 + 1e-6)).all()
        steps = np.diff(back.sizes.reshape(17, 33), axis=1) if suffix != "vtu" else np.zeros(1)
        assert np.abs(steps).max() <= (1 / 32) / 4 * (1 + 1e-6), "slope at most 1 / alpha"
    assert {path.name for path in tmp_path.iterdir()} == {"given.npy", "h.npy", "h.npz", "h.vtu"}


@pytest.mark.gl
@pytest.mark.parametrize("quantity", ["ratio", "quality", "size"])
def test_shot_draws_pixels(compared: Path, tmp_path: Path, quantity: str) -> None:
    out = tmp_path / "shot.png"
    mesh = str(compared / "mesh-size-preserving.vtu")
    assert run_command_line(["shot", mesh, "-o", str(out), "--color-by", quantity, "--width", "500"]) == 0
    with Image.open(out) as picture:
        assert picture.size[0] == 500


@pytest.mark.gl
def test_shot_draws_vectors(compared: Path, tmp_path: Path) -> None:
    out = tmp_path / "shot.svg"
    assert run_command_line(["shot", str(compared / "mesh-gradient-limiting.vtu"), "-o", str(out)]) == 0
    text = out.read_text()
    assert "<path" in text and "<image" not in text


def test_shot_makes_a_page_of_a_mesh(compared: Path, tmp_path: Path) -> None:
    out = tmp_path / "shot.html"
    assert run_command_line(["shot", str(compared / "mesh-guaranteed.vtu"), "-o", str(out), "--color-by", "size"]) == 0
    text = out.read_text("utf-8")
    assert '"quantity":"size"' in text and '"ratio"' in text and "<title>mesh-guaranteed.vtu" in text


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from sizeviz.study import Study, run
    from sizeviz.study.storage import StudyFile, write_study

    path = tmp_path_factory.mktemp("saved") / "valley.sizeviz"
    return write_study(path, StudyFile(run(Study(load(VALLEY)), ("none", "size-preserving"))))


@pytest.mark.parametrize("quantity", ["ratio", "quality", "size", "prescribed", "target"])
def test_shot_draws_a_study(saved: Path, tmp_path: Path, quantity: str) -> None:
    assert run_command_line(["shot", str(saved), "-o", str(tmp_path / "shot.svg"), "--color-by", quantity]) == 0
    assert "<path" in (tmp_path / "shot.svg").read_text() and "Size preserving" in (tmp_path / "shot.svg").read_text()


@pytest.mark.gl
def test_shot_draws_pixels_of_a_study(saved: Path, tmp_path: Path) -> None:
    assert run_command_line(["shot", str(saved), "-o", str(tmp_path / "shot.png")]) == 0
    with Image.open(tmp_path / "shot.png") as picture:
        assert picture.size[0] == 1400


def test_shot_makes_a_page_of_a_study_and_picks_a_run(saved: Path, tmp_path: Path) -> None:
    assert run_command_line(["shot", str(saved), "-o", str(tmp_path / "p.html")]) == 0
    text = (tmp_path / "p.html").read_text("utf-8")
    assert "Field as given" in text and "Size preserving" in text
    assert run_command_line(["shot", str(saved), "-o", str(tmp_path / "p.svg"), "--method", "none"]) == 0
    assert "Field as given" in (tmp_path / "p.svg").read_text()


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        (["--method", "guaranteed"], "holds no mesh of guaranteed; it has none, size-preserving"),
        (["--source", "ring"], "is a study, which has a source of its own"),
        (["--color-by", "error"], "cannot colour by error: no image to measure against"),
    ],
)
def test_shot_says_what_a_study_cannot_show(
    saved: Path, tmp_path: Path, capsys: pytest.CaptureFixture, typed: list[str], words: str
) -> None:
    assert run_command_line(["shot", str(saved), "-o", str(tmp_path / "p.svg"), *typed]) == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.gl
def test_shot_judges_anew_against_a_source(compared: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    out = tmp_path / "shot.png"
    mesh = str(compared / "mesh-size-preserving.vtu")
    assert run_command_line(["shot", mesh, "-o", str(out), "--source", "expr:0.001", "--width", "400"]) == 0
    judged_small = np.asarray(Image.open(out).convert("RGB"))
    assert run_command_line(["shot", mesh, "-o", str(out), "--source", "expr:10", "--width", "400"]) == 0
    judged_large = np.asarray(Image.open(out).convert("RGB"))
    assert (judged_small != judged_large).mean() > 0.3


def test_examples_lists_the_gallery(capsys: pytest.CaptureFixture) -> None:
    assert run_command_line(["examples"]) == 0
    printed = capsys.readouterr().out
    for name in ("ring", "valley", "mri", "terrain", "coast"):
        assert name in printed


@pytest.mark.gl
def test_doctor_names_versions_and_finds_nothing_missing(capsys: pytest.CaptureFixture) -> None:
    assert run_command_line(["doctor"]) == 0
    printed = capsys.readouterr().out
    for word in ("numba", "OpenGL off-screen", "draws", "fonts", "extra gmsh"):
        assert word in printed


def test_doctor_names_the_packages_without_opengl(
    capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sizeviz.scene import opengl

    monkeypatch.setattr(opengl, "probe", lambda: "no OpenGL")
    assert run_command_line(["doctor"]) == 1
    assert "apt-get install libegl1 libgl1-mesa-dri" in capsys.readouterr().out


def test_doctor_names_what_the_window_lacks(
    capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from sizeviz.cli import doctor
    from sizeviz.scene import opengl

    ldd = tmp_path / "ldd"
    ldd.write_text("#!/bin/sh\necho '\tlibxcb-icccm.so.4 => not found'\necho '\tlibc.so.6 => /lib/libc.so.6 (0x7f)'\n")
    ldd.chmod(0o755)
    monkeypatch.setattr(opengl, "probe", lambda: None)
    monkeypatch.setattr(doctor.shutil, "which", lambda name: str(ldd) if name == "ldd" else None)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert run_command_line(["doctor"]) == 0, "the command line can do its work"
    printed = capsys.readouterr().out
    assert "libxcb-icccm.so.4 missing" in printed and "apt-get install libxcb-icccm4" in printed
    assert "the window needs one" in printed and "apt-get install xvfb xauth" in printed


def in_a_process_without_opengl(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command where no EGL driver can be found and there is no display: VTK itself would end the process."""
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    environment |= {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nowhere.json", "PYTHONPATH": str(Path(__file__).parents[2])}
    command = [sys.executable, "-m", "sizeviz", *arguments]
    return subprocess.run(command, capture_output=True, text=True, env=environment, timeout=500)


def test_a_machine_without_opengl(tmp_path: Path) -> None:
    said = in_a_process_without_opengl("doctor")
    assert said.returncode == 1 and "apt-get install libegl1 libgl1-mesa-dri" in said.stdout
    mesh = write_mesh(tmp_path / "m.vtu", quad_mesh())
    drawn = in_a_process_without_opengl("shot", str(mesh), "-o", str(tmp_path / "m.png"), "--color-by", "quality")
    assert drawn.returncode == 1 and drawn.stderr.count("\n") == 1 and "apt-get install libegl1" in drawn.stderr
    vector = in_a_process_without_opengl("shot", str(mesh), "-o", str(tmp_path / "m.svg"), "--color-by", "quality")
    assert vector.returncode == 0, "vectors and pages need no OpenGL"
    window = in_a_process_without_opengl("gui")
    assert window.returncode == 1 and "needs a display" in window.stderr and window.stderr.count("\n") == 1
    assert {path.name for path in tmp_path.iterdir()} == {"m.vtu", "m.svg"}


def test_without_opengl_the_numbers_are_still_written(
    tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sizeviz.scene import opengl

    monkeypatch.setattr(opengl, "probe", lambda: "pictures need OpenGL; install it: apt-get install x")
    assert run_command_line(["run", VALLEY, "--out", str(tmp_path), "--preset", "fast"]) == 1
    assert {path.name for path in tmp_path.iterdir()} == {"mesh.vtu", "report.json"}
    assert "but not the picture: pictures need OpenGL" in capsys.readouterr().err


def test_beta_above_one_is_a_warning(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert run_command_line(["field", "expr:0.1 + x", "-o", str(tmp_path / "h.vtu"), "--beta", "1.5"]) == 0
    assert "warning: beta is 1.5" in capsys.readouterr().err
