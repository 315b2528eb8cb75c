"""The lessons as a person who has not read the paper meets them, on the real pipeline and with OpenGL."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from app import lesson_session as session
from app.driver import orange_share

from sizeviz.app.engine import PipelineEngine
from sizeviz.app.settings import Settings
from sizeviz.app.window import MainWindow

pytestmark = pytest.mark.display

SOURCE = "expr:min(0.12, 0.02 + abs(hypot(x - 0.5, y - 0.5) - 0.3))"


@pytest.fixture
def window(qtbot, tmp_path):
    window = MainWindow(PipelineEngine(), Settings(str(tmp_path / "settings.ini")))
    qtbot.addWidget(window)
    window.resize(1500, 940)
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow, timeout=5000)
    yield window
    window.close()


@pytest.mark.slow
def test_a_person_follows_the_lessons(window):
    pictures = {}

    def take(name: str) -> None:
        pictures[name] = student.look()

    student = session.Student(window, take)
    session.lesson_on_a_line(student)
    session.ball_in_the_plane(student, SOURCE, (0.55, 0.45))
    session.explanation(student)
    session.presenter(student)
    session.adaptive_process(student, "12", "1.2")

    # every step looks different from the one before
    names = [name for name in pictures if name != "lesson-ball-menu"]  # a menu is a window of its own
    for before, after in itertools.pairwise(names):
        assert np.mean(pictures[before] != pictures[after]) > 0.002, (before, after)
    # the mesh that misses the valley is half orange, that of size preserving is not
    strip = {name: pictures[name][500:720, 130:900] for name in ("lesson-line-2", "lesson-line-4")}
    assert orange_share(strip["lesson-line-2"]) > 0.005
    # the first mesh of the process is too large, the last is not
    assert orange_share(pictures["lesson-process-0"]) > orange_share(pictures["lesson-process"])
