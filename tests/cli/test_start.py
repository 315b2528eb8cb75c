"""The program starts fast, knows its name and version, and agrees with the library's defaults."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import get_args

import pytest

import sizeviz
from sizeviz.cli import run_command_line
from sizeviz.cli.app import COMMANDS
from sizeviz.cli.options import FieldOptions, MesherName, PipelineOptions, study_options
from sizeviz.meshing import GENERATORS
from sizeviz.study import StudyOptions


def test_help_names_every_command(capsys: pytest.CaptureFixture) -> None:
    assert run_command_line(["--help"]) == 0
    printed = capsys.readouterr().out
    for command, (_, what) in COMMANDS.items():
        assert command in printed
        assert what.split()[0] in printed


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command: str, capsys: pytest.CaptureFixture) -> None:
    assert run_command_line([command, "--help"]) == 0
    assert f"Usage: sizeviz {command}" in capsys.readouterr().out


def test_no_command_opens_the_window(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[object] = []
    monkeypatch.setattr("sizeviz.app.main", lambda sources, grab: opened.append((sources, grab)) or 0)
    assert run_command_line([]) == 0
    assert run_command_line(["gui", "ring", "--grab", "seen.png"]) == 0
    assert opened == [([], None), (["ring"], "seen.png")]


def test_version_goes_to_the_shell() -> None:
    done = subprocess.run([sys.executable, "-m", "sizeviz", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == sizeviz.__version__


@pytest.mark.parametrize(("arguments", "code"), [(["--help"], 0), (["nonsense"], 2)])
def test_exit_codes_reach_the_shell(arguments: list[str], code: int) -> None:
    done = subprocess.run([sys.executable, "-m", "sizeviz", *arguments], capture_output=True, check=False)
    assert done.returncode == code


@pytest.mark.parametrize(("code", "limit"), [("import sizeviz", 0.3), ("import sizeviz.cli", 0.5)])
def test_it_starts_fast(code: str, limit: float) -> None:
    """Processor time of the best of three, so that a busy machine does not count."""

    def seconds() -> float:
        before = os.times()
        subprocess.run([sys.executable, "-c", code], check=True)
        after = os.times()
        return after.children_user + after.children_system - before.children_user - before.children_system

    assert min(seconds() for _ in range(3)) < limit


def test_help_imports_nothing_heavy() -> None:
    code = "import sys; from sizeviz.cli import run_command_line as r; r(['compare', '--help']); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.split(".")[0] for name in done.stdout.split()}
    assert not loaded & {"numpy", "numba", "scipy", "vtkmodules", "pyvista", "matplotlib", "PyQt5"}


def test_defaults_are_those_of_the_library() -> None:
    assert study_options(PipelineOptions()) == StudyOptions()
    assert study_options(FieldOptions()) == StudyOptions()


def test_every_mesher_can_be_named() -> None:
    assert set(get_args(MesherName)) == set(GENERATORS)


def test_comparison_takes_one_over_alpha_unless_told_otherwise() -> None:
    assert study_options(PipelineOptions(alpha=4.0), comparable=True).limit.epsilon == 0.25
    assert study_options(PipelineOptions(alpha=4.0, epsilon=0.1), comparable=True).limit.epsilon == 0.1
    assert study_options(PipelineOptions(alpha=4.0)).limit.epsilon == StudyOptions().limit.epsilon


def test_progress_is_drawn_on_a_terminal_alone(tmp_path: Path) -> None:
    """The same command by a pipe and by a pseudo-terminal."""
    import pty

    command = [sys.executable, "-m", "sizeviz", "field", "expr:0.01 + 0.1*x", "-o", str(tmp_path / "h.vtu")]
    piped = subprocess.run(command, capture_output=True, check=True)
    assert not piped.stderr
    ours, theirs = pty.openpty()
    process = subprocess.Popen(command, stdout=theirs, stderr=theirs, env={**os.environ, "TERM": "xterm"})
    os.close(theirs)
    shown, deadline = b"", time.monotonic() + 60
    while time.monotonic() < deadline:
        try:
            piece = os.read(ours, 4096)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        shown += piece
    os.close(ours)
    assert process.wait() == 0
    assert "%" in shown.decode() and "\x1b[" in shown.decode()
