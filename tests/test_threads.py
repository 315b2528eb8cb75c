"""Ranges over threads: each once, errors and Cancel from any of them, calls within calls."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from sizeviz.errors import Cancelled
from sizeviz.threads import run_chunks


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize(("count", "chunk"), [(0, 3), (1, 1), (100, 7)])
def test_every_row_is_done_once(count: int, chunk: int, threads: int) -> None:
    done = np.zeros(count, dtype=int)

    def kernel(start: int, stop: int) -> None:
        time.sleep(1e-4)
        done[start:stop] += 1

    run_chunks(kernel, count, chunk=chunk, threads=threads)
    assert (done == 1).all()


@pytest.mark.parametrize("bad", [0, 7, 15])
def test_an_error_in_any_range_comes_out_and_stops_the_rest(bad: int) -> None:
    begun = []

    def kernel(start: int, stop: int) -> None:
        begun.append(start)
        time.sleep(2e-3)
        if start == bad:
            raise ValueError(f"range {start}")

    with pytest.raises(ValueError, match=f"range {bad}"):
        run_chunks(kernel, 16, chunk=1, threads=2)
    assert bad > 0 or len(begun) < 16


def test_an_error_in_a_helper_stops_the_calling_thread_too() -> None:
    caller, met, begun = threading.get_ident(), threading.Event(), []

    def kernel(start: int, stop: int) -> None:
        begun.append(start)
        if threading.get_ident() != caller:
            met.set()
            raise ValueError("in a helper")
        assert met.wait(10)
        time.sleep(0.01)

    with pytest.raises(ValueError, match="in a helper"):
        run_chunks(kernel, 64, chunk=1, threads=2)
    assert len(begun) < 8


def test_cancel_waits_for_what_is_under_way() -> None:
    busy = threading.Semaphore(0)

    class Stopper:
        def step(self, fraction: float, message: str = "") -> None:
            if fraction > 0.0:
                raise Cancelled

    def kernel(start: int, stop: int) -> None:
        busy.release()
        time.sleep(5e-3)
        busy.acquire()

    with pytest.raises(Cancelled):
        run_chunks(kernel, 100, chunk=1, threads=3, monitor=Stopper())
    assert not busy.acquire(blocking=False)


def test_a_kernel_may_itself_use_threads() -> None:
    done = np.zeros((8, 8), dtype=int)

    def outer(first: int, last: int) -> None:
        for row in range(first, last):

            def inner(start: int, stop: int, row: int = row) -> None:
                done[row, start:stop] += 1

            run_chunks(inner, 8, chunk=1, threads=4)

    run_chunks(outer, 8, chunk=1, threads=4)
    assert (done == 1).all()


def test_progress_never_goes_back() -> None:
    seen: list[float] = []

    class Noter:
        def step(self, fraction: float, message: str = "") -> None:
            seen.append(fraction)

    run_chunks(lambda start, stop: time.sleep(1e-3), 40, chunk=1, threads=2, monitor=Noter())
    assert seen == sorted(seen)
    assert (seen[0], seen[-1]) == (0.0, 1.0)
