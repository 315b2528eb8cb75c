"""The player of the adaptive process: a slow pretended process, and the real one's folder."""

from __future__ import annotations

import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from app.driver import LEFT
from qtpy.QtCore import QPoint, QPointF
from scene.fakes import lattice

from sizeviz.app.lessons.process import Asked, ProcessController, ProcessShown
from sizeviz.app.lessons.process_words import process_rows, process_words
from sizeviz.files import write_mesh
from sizeviz.study.evolution import Evolution, Iteration, write_evolution

RATIOS = (9.0, 2.5, 1.3, 1.05)


def row(k: int, n: int) -> Iteration:
    return Iteration(
        number=k, mesh=f"mesh-{k:03d}.vtu", n_quads=n * n, n_nodes=(n + 1) ** 2, background_ratio=0.9,
        analytic_ratio=RATIOS[k], background_correct=100.0, analytic_correct=90.0,
        strict_ratio=1.2 * RATIOS[k], strict_correct=80.0, quality_min=0.5, quality_mean=0.9,
        quality_max=1.0, quality_std=0.1, irregular=3.0, seconds=0.1,
    )  # fmt: skip


def pretend(folder, monitor=None, seconds: float = 0.0, last: int = 3) -> Evolution:
    """Write meshes that grow finer, as the process would."""
    evolution = Evolution(source="ring", options={"method": "size-preserving", "measure": "mean-edge"}, limit=1.1)
    for k in range(last + 1):
        for step in range(10):
            if monitor is not None:
                monitor.step((k + step / 10) / 4, f"iteration {k}")
            time.sleep(seconds / 10)
        mesh = lattice(6 + 4 * k, 0.03)
        ratio = np.linspace(0.5, RATIOS[k], mesh.n_quads)
        write_mesh(folder / f"mesh-{k:03d}.vtu", mesh, {"ratio": ratio})
        evolution = replace(evolution, iterations=(*evolution.iterations, row(k, 6 + 4 * k)))
        write_evolution(folder, evolution)
    return evolution


class Pretender:
    """Runs the pretended process; notes on which thread, and what it was asked."""

    def __init__(self) -> None:
        self.seconds = 0.1
        self.threads: set[int] = set()
        self.asked: list[Asked] = []

    def __call__(self, engine, source, options, asked, folder, monitor) -> None:
        self.threads.add(threading.get_ident())
        self.asked.append(asked)
        pretend(folder, monitor, self.seconds)


@pytest.fixture
def run():
    return Pretender()


@pytest.fixture
def process(controller, run):
    process = ProcessController(controller, run)
    yield process
    process.close()


def ended(process) -> bool:
    shown = process.shown
    return not shown.running and shown.count == 4 and shown.subject is not None and not process._controller.jobs.is_busy


# -- without a window --------------------------------------------------------------------------------------------------


def test_a_process_is_followed_iteration_by_iteration_on_the_worker(qtbot, process, run):
    seen = []
    run.seconds = 0.4
    process.changed.connect(lambda shown: seen.append(shown.count))
    process.start(Asked(cells=6))
    qtbot.waitUntil(lambda: ended(process), timeout=10_000)
    assert seen == sorted(seen) and set(seen) > {0, 4} and process.shown.number == 3
    assert process.shown.subject.mesh.n_quads == 18 * 18 and process.shown.subject.ratio.max() == pytest.approx(1.05)
    assert threading.get_ident() not in run.threads and run.asked == [Asked(cells=6)]


def test_earlier_meshes_are_read_while_the_process_runs_and_nothing_is_broken_off(qtbot, process, run):
    run.seconds = 0.4
    process.start(Asked())
    qtbot.waitUntil(lambda: process.shown.count >= 2, timeout=10_000)
    process.show_iteration(0)
    qtbot.waitUntil(
        lambda: process.shown.subject is not None and process.shown.subject.mesh.n_quads == 36, timeout=5000
    )
    assert process.shown.running and process.shown.number == 0
    qtbot.waitUntil(lambda: not process.shown.running, timeout=10_000)
    assert process.shown.count == 4 and process.shown.number == 0  # what a person looks at stays


def test_a_cancelled_process_keeps_what_was_finished(qtbot, process, run):
    run.seconds = 0.5
    process.start(Asked())
    qtbot.waitUntil(lambda: process.shown.count >= 1, timeout=10_000)
    began = time.perf_counter()
    process.cancel()
    qtbot.waitUntil(lambda: not process.shown.running, timeout=3000)
    assert time.perf_counter() - began < 1.0
    qtbot.waitUntil(lambda: not process._controller.jobs.is_busy, timeout=3000)
    assert 1 <= process.shown.count < 4 and "has not converged" in process_words(process.shown)


def test_a_failure_is_told_once_and_the_player_is_free_again(qtbot, controller):
    def fail(engine, source, options, asked, folder, monitor):
        raise ValueError("no mesh")

    process = ProcessController(controller, fail)
    notices = []
    controller.noticed.connect(notices.append)
    process.start(Asked())
    qtbot.waitUntil(lambda: not process.shown.running, timeout=3000)
    assert [notice.text for notice in notices] == ["no mesh"]
    process.close()


def test_a_second_run_is_not_begun_over_another(qtbot, process, controller, engine):
    engine.seconds = 0.5
    controller.open_source("ring")
    notices = []
    controller.noticed.connect(notices.append)
    process.start(Asked())
    assert not process.shown.running and "under way" in notices[0].text
    qtbot.waitUntil(lambda: not controller.jobs.is_busy, timeout=10_000)


def test_a_folder_of_sizeviz_adapt_is_opened_at_its_last_mesh(qtbot, process, tmp_path):
    pretend(tmp_path)
    assert process.open(tmp_path)
    qtbot.waitUntil(lambda: process.shown.subject is not None, timeout=5000)
    assert process.shown.number == 3 and process.shown.subject.title == "Iteration 3"
    for number in (0, 1, 2, 3, 0):
        process.show_iteration(number)
        qtbot.waitUntil(lambda n=number: process.shown.subject.mesh.n_quads == (6 + 4 * n) ** 2, timeout=5000)


def test_a_folder_without_a_process_and_a_broken_record_are_told_apart(process, controller, tmp_path):
    notices = []
    controller.noticed.connect(notices.append)
    assert not process.open(tmp_path) and not notices
    (tmp_path / "evolution.json").write_text("{", encoding="utf-8")
    assert not process.open(tmp_path) and "not the record" in notices[0].text


def test_each_iteration_is_told_in_words_with_its_numbers(tmp_path):
    evolution = pretend(tmp_path)
    first, second, _, last = (process_words(ProcessShown(evolution, k)) for k in range(4))
    assert "9 times" in first and "had not yet seen" in second and "converged in 3 iterations" in last
    assert ("", "elements", "324") in process_rows(ProcessShown(evolution, 3))
    assert "Algorithm 3" in process_words(ProcessShown()) and not process_rows(ProcessShown())
    idle = replace(evolution, iterations=evolution.iterations[:1], limit=10.0)
    assert idle.converged and "coarser first mesh" in process_words(ProcessShown(idle, 0))


# -- the page ----------------------------------------------------------------------------------------------------------


def test_the_player_plays_by_mouse(qtbot, flat_window, run):
    lessons = flat_window.lessons
    lessons.process._run = run
    flat_window.actions_["lesson-process"].trigger()
    page = lessons.process_page
    assert flat_window.pages.currentWidget() is page
    page.cells.setValue(8)
    qtbot.mouseClick(page.start, LEFT)
    assert page.start.text() == "Cancel" and not page.form.isEnabled()
    qtbot.waitUntil(lambda: ended(lessons.process), timeout=10_000)
    assert (
        page.heading.text() == "Iteration 3 of 3"
        and run.asked[0].cells == 8
        and page.transport.label.text() == "4 of 4"
        and page.start.text() == "Start"
    )
    assert page.pane.surface.canvas.spec.title == "Iteration 3" and page.pane.surface.canvas.edges
    qtbot.mouseClick(page.transport.back, LEFT)
    qtbot.waitUntil(lambda: page.pane.surface.canvas.spec.title == "Iteration 2", timeout=5000)
    at = page.plot.mapFromScene(page.plot.getViewBox().mapViewToScene(QPointF(0.1, 0.5)))
    qtbot.mouseClick(page.plot.viewport(), LEFT, pos=QPoint(at))
    qtbot.waitUntil(lambda: page.pane.surface.canvas.spec.title == "Uniform mesh", timeout=5000)
    qtbot.mouseClick(page.transport.play, LEFT)
    qtbot.waitUntil(lambda: page.pane.surface.canvas.spec.title == "Iteration 3", timeout=8000)
    page.leave.click()
    assert flat_window.pages.currentWidget() is flat_window.welcome


def test_every_control_of_the_lessons_has_a_name_and_can_be_reached(flat_window):
    from qtpy.QtCore import Qt
    from qtpy.QtWidgets import QAbstractButton, QAbstractSpinBox, QComboBox, QSlider

    for name in ("lesson-line", "lesson-process"):
        flat_window.actions_[name].trigger()
        page = flat_window.pages.currentWidget()
        for control in page.findChildren((QAbstractButton, QAbstractSpinBox, QComboBox, QSlider)):
            if control.objectName() not in ("ScrollLeftButton", "ScrollRightButton"):
                words = control.accessibleName() or getattr(control, "text", lambda: "")()
                assert words, control
                assert control.focusPolicy() & Qt.FocusPolicy.TabFocus, words
