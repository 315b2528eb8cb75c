from __future__ import annotations

import os
import threading
import time

import pytest

from sizeviz.app.jobs import WORKER_NICENESS, Job, JobRunner


class Ledger:
    """Writes down every signal of a runner."""

    def __init__(self, runner: JobRunner) -> None:
        self.lines: list[tuple[str, str]] = []
        self.failures = []
        runner.completed.connect(lambda job: self.lines.append(("completed", job.title)))
        runner.cancelled.connect(lambda job: self.lines.append(("cancelled", job.title)))
        runner.failed.connect(self._failed)

    def _failed(self, job, failure) -> None:
        self.lines.append(("failed", job.title))
        self.failures.append(failure)

    def of(self, title: str) -> list[str]:
        return [outcome for outcome, name in self.lines if name == title]


@pytest.fixture
def runner(qtbot):
    runner = JobRunner()
    yield runner
    assert runner.shut_down()


def stepping(seconds: float):
    def work(monitor):
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            monitor.step(0.5, "working")
            time.sleep(0.005)
        return "done"

    return work


def test_a_job_runs_off_the_windows_thread_and_its_result_comes_back_to_it(qtbot, runner) -> None:
    seen = {}
    job = Job("a", lambda m: threading.get_ident(), lambda r: seen.update(worker=r, then=threading.get_ident()))
    with qtbot.waitSignal(runner.idle, timeout=3000):
        runner.submit(job)
    assert seen["then"] == threading.get_ident() != seen["worker"]


def test_the_worker_stands_back_behind_the_window_wherever_that_stands(qtbot, runner) -> None:
    found = []

    def work(monitor):
        return os.getpriority(os.PRIO_PROCESS, threading.get_native_id())

    for is_patient in (True, False, True):  # one after another, whoever stood back before
        with qtbot.waitSignal(runner.idle, timeout=3000):
            runner.submit(Job("a", work, found.append, is_patient))
    window = os.getpriority(os.PRIO_PROCESS, os.getpid())
    patient = min(window + WORKER_NICENESS, 19)
    assert found == [patient, window, patient]


def test_jobs_of_both_kinds_never_work_at_the_same_time(qtbot, runner) -> None:
    at_work, most = [0], [0]

    def work(monitor):
        at_work[0] += 1
        most[0] = max(most[0], at_work[0])
        time.sleep(0.03)
        at_work[0] -= 1

    with qtbot.waitSignal(runner.idle, timeout=3000):
        for is_patient in (True, False, True, False):
            runner.submit(Job("a", work, lambda r: None, is_patient))
            qtbot.wait(10)
    assert most == [1]
    qtbot.waitUntil(lambda: runner.n_at_work == 0, timeout=3000)  # a thread says that it ended just before it does


@pytest.mark.parametrize("error", [ValueError("no\nmore"), RuntimeError(""), KeyboardInterrupt(), MemoryError()])
def test_whatever_a_worker_raises_is_one_failure_with_details(qtbot, runner, error) -> None:
    ledger = Ledger(runner)

    def work(monitor):
        raise error

    with qtbot.waitSignal(runner.idle, timeout=3000):
        runner.submit(Job("a", work, pytest.fail))
    assert ledger.lines == [("failed", "a")]
    assert "\n" not in ledger.failures[0].message and "Traceback" in ledger.failures[0].details
    with qtbot.waitSignal(runner.idle, timeout=3000):  # and the next job runs as if nothing had been
        runner.submit(Job("b", stepping(0.0), lambda r: None))
    assert ledger.of("b") == ["completed"]


def test_cancel_takes_no_longer_than_a_fifth_of_a_second(qtbot, runner) -> None:
    ledger = Ledger(runner)
    runner.submit(Job("a", stepping(30.0), pytest.fail))
    qtbot.wait(50)
    began = time.perf_counter()
    with qtbot.waitSignal(runner.idle, timeout=2000):
        runner.cancel()
    assert time.perf_counter() - began < 0.2
    assert ledger.lines == [("cancelled", "a")]


def test_the_latest_request_wins_and_every_job_ends_once(qtbot, runner) -> None:
    ledger, results = Ledger(runner), []
    titles = [f"job {k}" for k in range(6)]
    with qtbot.waitSignal(runner.idle, timeout=5000):
        for title in titles[:-1]:
            runner.submit(Job(title, stepping(20.0), results.append))
        runner.submit(Job(titles[-1], stepping(0.05), results.append))
    assert [ledger.of(title) for title in titles] == [["cancelled"]] * 5 + [["completed"]]
    assert results == ["done"]


def test_a_result_that_comes_too_late_is_not_applied(qtbot, runner) -> None:
    ledger = Ledger(runner)
    release = threading.Event()
    runner.submit(Job("deaf", lambda m: release.wait(5), pytest.fail))
    qtbot.wait(30)
    runner.cancel()
    release.set()
    qtbot.waitUntil(lambda: not runner.is_busy, timeout=2000)
    assert ledger.lines == [("cancelled", "deaf")]


def test_an_error_while_applying_a_result_is_a_failure_too(qtbot, runner) -> None:
    ledger = Ledger(runner)
    with qtbot.waitSignal(runner.idle, timeout=3000):
        runner.submit(Job("a", stepping(0.0), lambda r: 1 / 0))
    assert ledger.lines == [("failed", "a")] and "division" in ledger.failures[0].message


def test_progress_is_polled_only_while_a_job_runs(qtbot, runner) -> None:
    seen = []
    runner.progressed.connect(lambda *state: seen.append(state))
    with qtbot.waitSignal(runner.idle, timeout=3000):
        runner.submit(Job("a", stepping(0.7), lambda r: None))
    assert len(seen) >= 5 and seen[-1][:2] == (0.5, "working") and seen[-1][2] > 0
    assert not runner._timer.isActive()


def test_shutting_down_waits_for_the_worker(qtbot) -> None:
    runner = JobRunner()
    runner.submit(Job("a", stepping(30.0), pytest.fail))
    qtbot.wait(30)
    assert runner.shut_down(2000)
