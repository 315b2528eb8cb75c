"""Jobs side by side: results in order, progress on the caller's thread, and all of them stop."""

from __future__ import annotations

import threading
import time

import pytest

from sizeviz.errors import Cancelled
from sizeviz.study.paper.together import together


def counting(steps: int, stopped: list[str], name: str):
    def job(monitor):
        try:
            for k in range(steps):
                time.sleep(0.01)
                monitor.step((k + 1) / steps, name)
        except Cancelled:
            stopped.append(name)
            raise
        return name, threading.get_ident()

    return job


class Watch:
    def __init__(self, stop: float = 2.0) -> None:
        self.seen, self.threads, self.stop = [], set(), stop

    def step(self, fraction: float, message: str = "") -> None:
        self.seen.append(fraction)
        self.threads.add(threading.get_ident())
        if fraction > self.stop:
            raise Cancelled


def test_results_in_order_and_progress_on_this_thread():
    watch = Watch()
    (one, its_thread), (two, other) = together([counting(30, [], "one"), counting(10, [], "two")], watch)
    assert (one, two) == ("one", "two")
    assert its_thread != other
    assert watch.threads == {threading.get_ident()}
    assert watch.seen == sorted(watch.seen) and watch.seen[-1] == pytest.approx(1.0)


def test_cancelling_stops_them_all():
    stopped: list[str] = []
    with pytest.raises(Cancelled):
        together([counting(1000, stopped, "one"), counting(1000, stopped, "two")], Watch(0.01))
    assert sorted(stopped) == ["one", "two"]


def test_a_failure_stops_the_others():
    stopped: list[str] = []

    def failing(monitor):
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        together([counting(1000, stopped, "one"), failing])
    assert stopped == ["one"]
