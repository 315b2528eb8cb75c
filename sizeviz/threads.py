"""Chunks of ``nogil`` kernels over a thread pool.

Numba's ``parallel=True`` is not used: its fallback threading layer aborts the process when two threads enter it.
"""

from __future__ import annotations

import os
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import TYPE_CHECKING

from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from collections.abc import Callable


def default_threads() -> int:
    """Return the number of cores this process may use."""
    try:
        return max(1, len(os.sched_getaffinity(0)))
    except AttributeError:  # not on every platform
        return max(1, os.cpu_count() or 1)


def run_chunks(
    kernel: Callable[[int, int], object],
    count: int,
    *,
    chunk: int,
    threads: int | None = None,
    monitor: Monitor = SILENT,
    message: str = "",
) -> None:
    """Call ``kernel(start, stop)`` for consecutive ranges that cover ``range(count)``.

    The kernels run on worker threads, so they must release the GIL and write disjoint parts of their output;
    the monitor is stepped on the calling thread after each chunk, so a chunk should last 20 to 50 ms.

    Parameters
    ----------
    kernel : callable
        Takes the half-open range of rows it is to do.
    count, chunk : int
        Number of rows in all, and in one call.
    threads : int, optional
        Worker threads; every core by default. The result must not depend on it.
    monitor : Monitor
        Stepped from 0 to 1 over the whole range.
    message : str
        What the monitor is told.

    Raises
    ------
    Cancelled
        If the monitor says so; chunks not yet begun are dropped, those under way are waited for.
    """
    monitor.step(0.0, message)
    ranges = [(start, min(start + chunk, count)) for start in range(0, count, chunk)]
    workers = min(threads or default_threads(), len(ranges))
    if workers <= 1:
        for done, (start, stop) in enumerate(ranges, 1):
            kernel(start, stop)
            monitor.step(done / len(ranges), message)
        return
    with ThreadPoolExecutor(workers) as pool:
        pending: set[Future[object]] = {pool.submit(kernel, start, stop) for start, stop in ranges}
        try:
            while pending:
                done_now, pending = wait(pending, return_when=FIRST_COMPLETED)
                for future in done_now:
                    future.result()
                monitor.step(1.0 - len(pending) / len(ranges), message)
        except BaseException:
            for future in pending:
                future.cancel()
            raise
