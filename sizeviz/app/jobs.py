"""Work in the background: one worker, the latest request wins, exactly one end to every job.

The worker touches neither Qt widgets nor VTK. A job tells how far it is through a plain tuple that the window polls,
so that a kernel's many steps cost nothing.
"""

from __future__ import annotations

import logging
import os
import sys
import threading
import time
import traceback
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from qtpy.QtCore import QObject, QRunnable, Qt, QThreadPool, QTimer, Signal

from sizeviz.errors import Cancelled

if TYPE_CHECKING:
    from collections.abc import Callable

    from sizeviz.monitor import Monitor

POLL_MS = 60
"""How often progress is looked at while a job runs; nothing is polled while none does."""

LOG = logging.getLogger(__name__)

WORKER_NICENESS = 5
"""How far the worker stands back behind the window, as ``nice`` counts."""


class JobMonitor:
    """What a job steps: keeps the last word, and raises when the job is to stop."""

    def __init__(self) -> None:
        self.state: tuple[float, str] = (0.0, "")
        self._stop = threading.Event()

    def step(self, fraction: float, message: str = "") -> None:
        """Note how far the job is; raise ``Cancelled`` if it was asked to stop."""
        if self._stop.is_set():
            raise Cancelled
        self.state = (max(fraction, self.state[0]), message or self.state[1])

    def cancel(self) -> None:
        """Ask the job to stop at its next step."""
        self._stop.set()

    @property
    def is_cancelled(self) -> bool:
        """Whether the job was asked to stop."""
        return self._stop.is_set()


@dataclass(eq=False)
class Job:
    """One piece of work and what became of it.

    Parameters
    ----------
    title : str
        What the person sees it called.
    work : callable
        Takes a monitor and returns the result; runs on the worker.
    then : callable
        Takes the result; runs in the window, only if the job was completed.
    is_patient : bool
        Whether it stands back behind the window's drawing; what follows the hand and is short does not.
    """

    title: str
    work: Callable[[Monitor], Any]
    then: Callable[[Any], None]
    is_patient: bool = True
    monitor: JobMonitor = field(default_factory=JobMonitor)
    began: float = 0.0


@dataclass(frozen=True)
class Failure:
    """Why a job failed: a line to show, and details to copy."""

    message: str
    details: str


class _Bridge(QObject):
    """Lives in the window's thread; its signals carry a worker's outcome over to it."""

    ended = Signal(object, str, object)


class _Runnable(QRunnable):
    def __init__(self, job: Job, bridge: _Bridge) -> None:
        super().__init__()
        self._job, self._bridge = job, bridge

    def run(self) -> None:
        """Do the work; whatever happens, say so once."""
        if self._job.is_patient:
            _give_way()
        outcome, payload = _outcome(self._job)
        try:
            self._bridge.ended.emit(self._job, outcome, payload)
        except RuntimeError:  # the window is gone
            LOG.debug("%s ended after the window was closed", self._job.title)


def _give_way() -> None:
    """Let the window go first when both want a core, and with it its drawing threads.

    Threads that the worker starts are as patient as it is. Elsewhere than on Linux a priority is the whole process's.
    """
    if sys.platform == "linux":
        with suppress(OSError):
            window = os.getpriority(os.PRIO_PROCESS, os.getpid())
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), window + WORKER_NICENESS)


def _outcome(job: Job) -> tuple[str, Any]:
    try:
        if job.monitor.is_cancelled:
            return "cancelled", None
        return "completed", job.work(job.monitor)
    except Cancelled:
        return "cancelled", None
    except MemoryError:
        return "failed", Failure("not enough memory; ask for larger elements", traceback.format_exc())
    except BaseException as error:  # a worker must never die silently, whatever was raised
        words = str(error).strip() or type(error).__name__
        return "failed", Failure(words.splitlines()[0], traceback.format_exc())


class JobRunner(QObject):
    """Runs one job at a time; a new one takes the place of whatever runs or waits.

    There are two threads, for a thread that once stood back may not step forward again; never do both work at a time.

    Signals
    -------
    started(Job)
        A job was handed to the worker.
    progressed(float, str, float)
        Fraction, words, and estimated seconds left (negative while unknown).
    completed(Job), failed(Job, Failure), cancelled(Job)
        Exactly one of them ends every job.
    idle()
        Nothing runs or waits any more.
    """

    started = Signal(object)
    progressed = Signal(float, str, float)
    completed = Signal(object)
    failed = Signal(object, object)
    cancelled = Signal(object)
    idle = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._pools = {is_patient: QThreadPool(self) for is_patient in (True, False)}
        for pool in self._pools.values():
            pool.setMaxThreadCount(1)
            pool.setExpiryTimeout(-1)
        self._bridge = _Bridge()
        self._bridge.ended.connect(self._on_ended, Qt.ConnectionType.QueuedConnection)
        self._running: Job | None = None
        self._waiting: Job | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(POLL_MS)
        self._timer.timeout.connect(self._poll)

    @property
    def running(self) -> Job | None:
        """The job at work, if any."""
        return self._running

    @property
    def is_busy(self) -> bool:
        """Whether a job runs or waits."""
        return self._running is not None

    @property
    def n_at_work(self) -> int:
        """How many threads are at work at this moment, also on what nobody waits for any more."""
        return sum(pool.activeThreadCount() for pool in self._pools.values())

    def submit(self, job: Job) -> None:
        """Run a job as soon as the worker is free; one that runs is cancelled, one that waits is dropped."""
        if self._waiting is not None:
            dropped, self._waiting = self._waiting, None
            self.cancelled.emit(dropped)
        if self._running is None:
            self._start(job)
            return
        self._waiting = job
        self._running.monitor.cancel()

    def cancel(self) -> None:
        """Stop what runs and drop what waits."""
        if self._waiting is not None:
            dropped, self._waiting = self._waiting, None
            self.cancelled.emit(dropped)
        if self._running is not None:
            self._running.monitor.cancel()

    def shut_down(self, patience_ms: int = 5000) -> bool:
        """Stop for good and wait for the worker; return whether it ended in time."""
        self.cancel()
        self._timer.stop()
        ended = [pool.waitForDone(patience_ms) for pool in self._pools.values()]
        return all(ended)

    def _start(self, job: Job) -> None:
        self._running = job
        job.began = time.perf_counter()
        self.started.emit(job)
        self._timer.start()
        self._pools[job.is_patient].start(_Runnable(job, self._bridge))

    def _on_ended(self, job: Job, outcome: str, payload: Any) -> None:
        self._timer.stop()
        self._running = None
        following, self._waiting = self._waiting, None
        if outcome == "completed" and job.monitor.is_cancelled:
            outcome = "cancelled"  # it ended before it noticed; nobody wants its result any more
        if outcome == "completed":
            self._hand_over(job, payload)
        elif outcome == "failed":
            LOG.error("%s: %s", job.title, payload.message)
            self.failed.emit(job, payload)
        else:
            self.cancelled.emit(job)
        if following is not None and self._running is None:
            self._start(following)
        elif following is not None:
            self.submit(following)
        if self._running is None:
            self.idle.emit()

    def _hand_over(self, job: Job, result: Any) -> None:
        try:
            job.then(result)
        except Exception as error:
            LOG.exception("%s", job.title)
            self.failed.emit(job, Failure(str(error) or type(error).__name__, traceback.format_exc()))
            return
        self.completed.emit(job)

    def _poll(self) -> None:
        if self._running is None:
            return
        fraction, message = self._running.monitor.state
        elapsed = time.perf_counter() - self._running.began
        left = elapsed * (1.0 - fraction) / fraction if fraction > 0.03 and elapsed > 0.3 else -1.0
        self.progressed.emit(fraction, message or self._running.title, left)
