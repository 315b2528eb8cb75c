"""Chunks of ``nogil`` kernels over a thread pool.

Numba's ``parallel=True`` is not used: its fallback threading layer aborts the process when two threads enter it.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from typing import TYPE_CHECKING

from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from collections.abc import Callable

MOST_HELPERS = 64
"""Threads that can help at once; a thread is only made when all others are busy."""


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

    The calling thread and its helpers take the ranges in order, so kernels must release the GIL and write disjoint
    parts of their output; the monitor is stepped on the calling thread after each range of its own, so one should last
    no more than 20 to 50 ms.

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
        If the monitor says so; ranges not yet begun are dropped, those under way are waited for.
    """
    monitor.step(0.0, message)
    ranges = [(start, min(start + chunk, count)) for start in range(0, count, chunk)]
    workers = min(threads or default_threads(), len(ranges))
    todo = iter(range(len(ranges)))

    def work(step: Callable[[int], object]) -> None:
        # one iterator for all threads: its next() is a single step of the interpreter
        try:
            for k in todo:
                kernel(*ranges[k])
                step(k)
        finally:
            for _ in todo:  # after an error, whoever's it is, nobody begins another range
                pass

    helpers = [_pool().submit(work, lambda k: None) for _ in range(workers - 1)]
    try:
        work(lambda k: monitor.step(k / len(ranges), message))
    finally:
        # a helper that a busy pool has not begun is not needed any more; the others may still use the arrays
        begun = [helper for helper in helpers if not helper.cancel()]
        wait(begun)
    for helper in begun:
        helper.result()
    monitor.step(1.0, message)


@cache
def _pool() -> ThreadPoolExecutor:
    """Return the threads that help whoever calls ``run_chunks``; they are started when first needed, and kept."""
    return ThreadPoolExecutor(MOST_HELPERS, thread_name_prefix="sizeviz")
