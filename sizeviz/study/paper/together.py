"""Long jobs side by side: much of each runs on one core, so two of them end sooner together than in turn."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TYPE_CHECKING, TypeVar

from sizeviz.errors import Cancelled
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

Result = TypeVar("Result")

PAUSE = 0.1
"""Seconds between two looks at how far the jobs are."""


class _Relay:
    """A monitor for a worker thread: it notes how far the job is, and stops it when told to."""

    def __init__(self) -> None:
        self.fraction, self.message = 0.0, ""
        self.stopped = threading.Event()

    def step(self, fraction: float, message: str = "") -> None:
        """Note the progress; raise Cancelled once the job is to stop."""
        self.fraction, self.message = fraction, message or self.message
        if self.stopped.is_set():
            raise Cancelled


def together(jobs: Sequence[Callable[[Monitor], Result]], monitor: Monitor = SILENT) -> list[Result]:
    """Run jobs at the same time and return their results in order.

    Parameters
    ----------
    jobs : sequence of callable
        Each takes a monitor of its own.
    monitor : Monitor
        Told the mean of their progress, on the calling thread.

    Raises
    ------
    Cancelled
        If the monitor says so, once every job has stopped.
    Exception
        The first job's that failed; the others are stopped.
    """
    relays = [_Relay() for _ in jobs]
    with ThreadPoolExecutor(max(len(jobs), 1)) as pool:
        running = [pool.submit(job, relay) for job, relay in zip(jobs, relays, strict=True)]
        try:
            pending = set(running)
            while pending:
                done, pending = wait(pending, timeout=PAUSE)
                for one in done:
                    one.result()
                slowest = min(relays, key=lambda relay: relay.fraction)
                monitor.step(sum(relay.fraction for relay in relays) / len(relays), slowest.message)
        except BaseException:
            for relay in relays:
                relay.stopped.set()
            raise
    return [one.result() for one in running]
