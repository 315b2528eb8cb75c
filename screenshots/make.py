"""Make every picture of README and docs, and the gallery's thumbnails, anew.

    python screenshots/make.py [name ...]

Without a display it starts a virtual one (``xvfb-run``). Each window picture comes from a session that is scripted
below, driven by mouse and keyboard events as in the tests.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
SCREEN = "1700x1100x24"
SIZE = (1600, 1000)

if TYPE_CHECKING:
    from collections.abc import Callable

    from app.driver import Person


def main(names: list[str]) -> int:
    """Make the pictures named, or all of them."""
    if not os.environ.get("DISPLAY") and sys.platform.startswith("linux"):
        runner = shutil.which("xvfb-run")
        if runner is None:
            print("screenshots need a display; install a virtual one: apt-get install xvfb xauth", file=sys.stderr)
            return 1
        command = [runner, "-a", "-s", f"-screen 0 {SCREEN} -dpi 96", sys.executable, str(Path(__file__)), *names]
        return subprocess.run(command, check=False).returncode
    sys.path.insert(0, str(ROOT / "tests"))
    wanted = names or ["thumbnails", *SCENES]
    if "thumbnails" in wanted:
        make_thumbnails()
    if "compare" in wanted:
        make_comparison()
    scenes = {name: SCENES[name] for name in wanted if name in SCENES}
    if scenes:
        make_scenes(scenes)
    return 0


def make_thumbnails(size: int = 192) -> None:
    """Draw every example's size field as a small square for the gallery."""
    from PIL import Image

    from sizeviz.scene.camera import Camera2D
    from sizeviz.scene.compose import compose
    from sizeviz.scene.stage import Stage
    from sizeviz.scene.subject import Subject
    from sizeviz.scene.view import ViewState
    from sizeviz.sources import examples

    folder = ROOT / "sizeviz" / "app" / "thumbnails"
    folder.mkdir(exist_ok=True)
    with Stage(oversampling=2) as stage:
        for example in examples():
            source = example.build()
            spec = compose(Subject(prescribed=source.field), ViewState(color_by="prescribed"))
            x0, y0, x1, y1 = source.domain.bounds
            camera = Camera2D(0.5 * (x0 + x1), 0.5 * (y0 + y1), min(x1 - x0, y1 - y0))
            picture = Image.fromarray(stage.shoot(spec, camera, size, size))
            picture.resize((size, size), Image.Resampling.LANCZOS).save(folder / f"{example.name}.png", optimize=True)
            print(f"thumbnails/{example.name}.png")


def make_comparison() -> None:
    """Write the comparisons of both methods, as the command line does."""
    import make_comparisons

    make_comparisons.main()


def make_scenes(scenes: dict[str, Callable[[Person, Path], None]]) -> None:
    """Open one window and let each scene be played in it."""
    from app.driver import Person
    from qtpy.QtGui import QCursor

    from sizeviz.app.engine import PipelineEngine
    from sizeviz.app.launch import application
    from sizeviz.app.settings import Settings
    from sizeviz.app.window import MainWindow

    app = application()  # kept: Qt ends with it
    with tempfile.TemporaryDirectory() as folder:
        window = MainWindow(PipelineEngine(), Settings(str(Path(folder) / "settings.ini")))
        window.resize(*SIZE)
        window.show()
        window.activateWindow()
        QCursor.setPos(0, 0)  # under which nothing lights up
        person = Person(window)
        person.rest(500)
        for name, play in scenes.items():
            play(person, HERE / f"{name}.png")
            print(f"{name}.png")
        window.close()
    app.processEvents()


def welcome(person: Person, path: Path) -> None:
    """Show the first page."""
    person.photograph(path)


def running(person: Person, path: Path) -> None:
    """Show a run under way."""
    person.window.controller.open_source("mri")
    person.wait(lambda: person.window.controller.study, 600)  # before that, kernels may be compiled
    person.wait(lambda: person.window.progress.bar.value() > 550, 600)
    person.photograph(path)
    person.wait_settled(900)


def mri(person: Person, path: Path) -> None:
    """Show both methods on the MRI slice."""
    _open(person, "mri")
    person.photograph(path)


def mri_worst(person: Person, path: Path) -> None:
    """Go to the worst element of gradient limiting, seen in both panes."""
    from qtpy.QtCore import Qt

    _open(person, "mri")
    person.key(Qt.Key.Key_W)
    person.rest(300)
    person.photograph(path)
    person.key(Qt.Key.Key_P)
    person.key(Qt.Key.Key_F)


def four_panes(person: Person, path: Path) -> None:
    """Show R and quality of both methods, in the dark theme."""
    actions = person.window.actions_
    _open(person, "coast")
    actions["theme"].setChecked(True)
    actions["panes-4"].trigger()
    person.rest(600)
    person.photograph(path)
    actions["panes-2"].trigger()
    actions["theme"].setChecked(False)


def painting(person: Person, path: Path) -> None:
    """Draw a stroke on a blank canvas, limited and preserved beside it."""
    from qtpy.QtCore import Qt

    window = person.window
    window.controller.open_canvas(257, 0.06)
    person.wait_settled(300)
    person.key(Qt.Key.Key_B)
    window.paint.value.set_value(0.004)
    window.paint.radius.set_value(0.035)
    person.rest(500)
    pane = window.board.panes[0]
    person.drag(pane, [(0.2, 0.7), (0.4, 0.85), (0.6, 0.7), (0.8, 0.8)], steps=12)
    window.controller.apply()  # on a busy machine the stroke waits to be asked
    person.wait_settled(300)
    person.drag(pane, [(0.15, 0.25), (0.35, 0.45), (0.6, 0.3), (0.82, 0.42)], steps=14, lift=False)
    person.rest(900)
    person.photograph(path)
    person.key(Qt.Key.Key_Escape)
    person.key(Qt.Key.Key_B)


def painted(person: Person, path: Path) -> None:
    """Show the meshes of what was painted."""
    person.wait_settled(600)
    person.photograph(path)


def shortcuts(person: Person, path: Path) -> None:
    """Show the overlay of shortcuts."""
    person.window.actions_["shortcuts"].trigger()
    person.photograph(path)
    person.window.overlay.hide()


def _open(person: Person, name: str) -> None:
    study = person.window.controller.study
    if study is None or study.source.name != name:
        person.window.controller.open_source(name)
        person.rest(100)
        person.wait(lambda: person.window.controller.study and person.window.controller.study.source.name == name, 120)
    person.wait_settled(900)


SCENES: dict[str, Callable[[Person, Path], None]] = {
    "window-welcome": welcome,
    "window-running": running,
    "window-mri": mri,
    "window-mri-worst": mri_worst,
    "window-four-panes-dark": four_panes,
    "window-painting": painting,
    "window-painted": painted,
    "window-shortcuts": shortcuts,
}
"""The window's pictures, in the order they are played."""


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
