"""Make the pictures of the lessons anew: ``python screenshots/make_lessons.py``.

Without a display it starts a virtual one (``xvfb-run``). The session is the one that the tests play.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
SIZE = (1600, 1000)


def main() -> int:
    """Make them all."""
    if not os.environ.get("DISPLAY") and sys.platform.startswith("linux"):
        runner = shutil.which("xvfb-run")
        if runner is None:
            print("screenshots need a display; install a virtual one: apt-get install xvfb xauth", file=sys.stderr)
            return 1
        screen = f"-screen 0 {SIZE[0]}x{SIZE[1]}x24 -dpi 96"
        return subprocess.run([runner, "-a", "-s", screen, sys.executable, __file__], check=False).returncode
    sys.path.insert(0, str(ROOT / "tests"))
    from app import lesson_session as session

    from sizeviz.app.engine import PipelineEngine
    from sizeviz.app.launch import application
    from sizeviz.app.settings import Settings
    from sizeviz.app.window import MainWindow

    app = application()  # kept: Qt ends with it
    with tempfile.TemporaryDirectory() as folder:
        window = MainWindow(PipelineEngine(), Settings(str(Path(folder) / "settings.ini")))
        window.setGeometry(0, 0, *SIZE)
        window.show()
        window.activateWindow()

        def take(name: str) -> None:
            path = HERE / f"{name}.png"
            if name.endswith("-menu"):
                session.screen().copy(0, 0, *SIZE).save(str(path))  # the screen may be larger than the window
            else:
                student.photograph(path)
            print(path.name)

        student = session.Student(window, take)
        student.rest(500)
        session.lesson_on_a_line(student)
        session.ball_in_the_plane(student, "ring", (0.62, 0.42))
        session.explanation(student)
        session.presenter(student)
        session.adaptive_process(student, "40", "1.2")
        window.close()
    app.processEvents()
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
