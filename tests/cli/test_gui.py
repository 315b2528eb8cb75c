"""The window from the command line: opened, photographed, closed; and a clear line where there is no display."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from PIL import Image

from sizeviz.cli import run_command_line

if TYPE_CHECKING:
    from pathlib import Path


def test_without_a_display_the_window_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.delenv("QT_QPA_PLATFORM", raising=False)
    for arguments in ([], ["gui", "ring"]):
        assert run_command_line(arguments) == 1
        said = capsys.readouterr().err
        assert said.count("\n") == 1 and "needs a display" in said and "xvfb" in said


def test_a_word_that_is_no_command_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["nonsense"]) == 2
    assert "'nonsense' is no command" in capsys.readouterr().err


@pytest.mark.display
def test_grab_runs_to_the_end_and_saves_what_is_seen(tmp_path: Path) -> None:
    picture = tmp_path / "window.png"
    command = [sys.executable, "-m", "sizeviz", "gui", "valley", "--grab", str(picture)]
    environment = {**os.environ, "XDG_CONFIG_HOME": str(tmp_path), "XDG_RUNTIME_DIR": str(tmp_path)}
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment)
    assert done.returncode == 0, done.stderr
    with Image.open(picture) as image:
        assert image.width >= 1200 and image.height >= 800
        colours = image.convert("RGB").getcolors(maxcolors=1 << 24)
    assert colours is not None and len(colours) > 200  # the panes are drawn: not one flat colour
