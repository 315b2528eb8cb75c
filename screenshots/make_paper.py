"""Make the paper's figures that the docs show: ``python screenshots/make_paper.py [FOLDER]``.

FOLDER is that of an earlier ``sizeviz paper``, whose adaptive processes are taken up; without one they are run anew.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent

FIGURES = (3, 4, 5, 8)
"""Sizes on a line; the adaptive process by both methods; the image on the mesh of size preserving."""


def main(folder: str | None = None) -> None:
    with tempfile.TemporaryDirectory() as own:
        out = Path(folder or own)
        subprocess.run([sys.executable, "-m", "sizeviz", "paper", "--out", str(out)], check=True)
        for number in FIGURES:
            print(shutil.copyfile(out / f"figure-{number}.png", HERE / f"paper-figure-{number}.png"))


if __name__ == "__main__":
    main(*sys.argv[1:2])
