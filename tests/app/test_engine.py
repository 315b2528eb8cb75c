from __future__ import annotations

import time

import pytest

from sizeviz.app.controller import Controller
from sizeviz.app.engine import PipelineEngine
from sizeviz.errors import Cancelled
from sizeviz.monitor import SILENT


class Compiler:
    """Stands for the compiler: notes when it is called, and takes as long as it is told."""

    def __init__(self, monkeypatch, calls: list[str], seconds: float = 0.0) -> None:
        self.compiled, self.calls, self.seconds = False, calls, seconds
        monkeypatch.setattr("sizeviz.compiled.are_compiled", lambda: self.compiled)
        monkeypatch.setattr("sizeviz.compiled.compile_kernels", self.compile)

    def compile(self, monitor=SILENT) -> None:
        self.calls.append("compile")
        steps = max(round(self.seconds / 0.02), 1)
        for k in range(steps):
            monitor.step(k / steps, "compiling, once only: mesh")
            time.sleep(self.seconds / steps)
        self.compiled = True


class Recording:
    def __init__(self) -> None:
        self.steps: list[tuple[float, str]] = []

    def step(self, fraction: float, message: str = "") -> None:
        self.steps.append((fraction, message))


@pytest.fixture
def calls(monkeypatch) -> list[str]:
    calls: list[str] = []

    def load(spec, monitor=SILENT):
        calls.append(f"load {spec}")
        monitor.step(0.0, "loading")
        return spec

    def run(study, methods, monitor=SILENT):
        calls.append(f"run {methods[0]}")
        monitor.step(0.0, "running")
        return study

    monkeypatch.setattr("sizeviz.sources.load", load)
    monkeypatch.setattr("sizeviz.study.run", run)
    return calls


def test_kernels_are_compiled_once_and_before_any_work(monkeypatch, calls) -> None:
    Compiler(monkeypatch, calls)
    engine, monitor = PipelineEngine(), Recording()
    engine.load("ring", monitor)
    engine.run(None, "size-preserving", monitor)
    assert calls == ["compile", "load ring", "run size-preserving"]
    assert monitor.steps[0] == (0.0, "compiling, once only: mesh") and monitor.steps[1] == (0.8, "loading")


def test_a_run_compiles_too_where_nothing_was_loaded(monkeypatch, calls) -> None:
    Compiler(monkeypatch, calls)
    PipelineEngine().run(None, "none")
    assert calls == ["compile", "run none"]


def test_cancelled_compiling_begins_no_work(monkeypatch, calls) -> None:
    class Stopped:
        def step(self, fraction: float, message: str = "") -> None:
            raise Cancelled

    Compiler(monkeypatch, calls)
    with pytest.raises(Cancelled):
        PipelineEngine().load("ring", Stopped())
    assert calls == ["compile"]


def test_the_window_says_that_it_compiles_and_cancel_stops_it(qtbot, monkeypatch, calls) -> None:
    compiler = Compiler(monkeypatch, calls, seconds=20.0)
    controller = Controller(PipelineEngine())
    said: list[str] = []
    controller.progressed.connect(lambda fraction, words, left: said.append(words))
    controller.open_source("ring")
    qtbot.waitUntil(lambda: any(words.startswith("compiling, once only") for words in said), timeout=3000)
    with qtbot.waitSignal(controller.jobs.cancelled, timeout=500):
        controller.cancel()
    assert calls == ["compile"] and not compiler.compiled and controller.study is None
    assert controller.jobs.shut_down()
