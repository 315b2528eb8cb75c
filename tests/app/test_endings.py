"""Every way of ending the window ends the process with exit code 0, and nothing is left behind or complained of."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.display

SCRIPT = Path(__file__).with_name("endings.py")


@pytest.mark.slow
@pytest.mark.parametrize("way", ["button", "key", "terminate", "interrupt", "error", "run", "painted"])
def test_every_ending_is_a_good_one(way: str, tmp_path: Path) -> None:
    apart = {"XDG_CONFIG_HOME": str(tmp_path / "config"), "XDG_STATE_HOME": str(tmp_path / "state")}
    command = [sys.executable, "-X", "faulthandler", str(SCRIPT), way]
    done = subprocess.run(command, env=os.environ | apart, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr or way == "error"
    left = list((tmp_path / "state").rglob("*.sizeviz"))
    assert len(left) == (1 if way == "painted" else 0)  # what was painted can be recovered
