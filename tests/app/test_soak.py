from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SOAK = Path(__file__).with_name("soak.py")


@pytest.mark.display
@pytest.mark.slow
def test_twenty_seconds_of_random_actions(tmp_path: Path) -> None:
    """No error at all; stalls and growth with room for a machine that does other things, and for no warm-up."""
    command = [
        sys.executable,
        str(SOAK),
        "--minutes",
        "0.33",
        "--seed",
        "4",
        "--loaded",
        "--stall",
        "0.6",
        "--growth",
        "150",
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith("passed\n") and ", 0 errors" in done.stdout
