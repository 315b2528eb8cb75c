"""Draw the picture of the interactive page as a browser shows it. Needs chromium; nothing is drawn without it."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

from sizeviz import Study, StudyOptions, load, run, save_page

HERE = Path(__file__).parent


def photograph(page: Path, picture: Path, width: int = 1280, height: int = 980) -> None:
    """Write what a headless browser shows of a page."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        print("page-ring.png is left as it is: there is no chromium; apt-get install chromium")
        return
    with tempfile.TemporaryDirectory() as profile:
        command = [
            browser, "--headless=new", "--no-sandbox", "--hide-scrollbars", "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader", f"--user-data-dir={profile}", f"--window-size={width},{height}",
            "--virtual-time-budget=20000", f"--screenshot={picture}", page.as_uri(),
        ]  # fmt: skip
        subprocess.run(command, check=True, capture_output=True, timeout=300)
    print(picture)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        study = run(Study(load("ring"), StudyOptions().with_comparable_slope()))
        page = save_page(study, Path(folder) / "ring.html")
        photograph(page, HERE / "page-ring.png")
