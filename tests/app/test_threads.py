"""Work on the worker calls nothing of Qt, VTK or pyvista: every call it makes is watched while it makes them."""

from __future__ import annotations

import sys
import threading
from types import FrameType

import pytest
from app.driver import Person
from app.fakes import FlatCanvas

from sizeviz.app.engine import PipelineEngine
from sizeviz.app.settings import Settings
from sizeviz.app.window import MainWindow

FORBIDDEN = ("PyQt", "PySide", "qtpy", "sip", "vtkmodules", "vtk", "pyvista", "pyvistaqt", "pyqtgraph", "superqt")
"""Whose objects belong to the window's thread."""


def is_forbidden(module: object) -> bool:
    name = str(module or "")
    return name.split(".")[0].rstrip("56") in {word.rstrip("56") for word in FORBIDDEN} or name.startswith("PyQt")


class Watch:
    """Notes every call into a forbidden module on the thread that it is set on."""

    def __init__(self) -> None:
        self.seen: set[str] = set()
        self.calls = 0
        self.threads: set[int] = set()

    def __call__(self, frame: FrameType, event: str, argument: object) -> None:
        self.calls += 1
        if event == "call":
            module = frame.f_globals.get("__name__")
            name = frame.f_code.co_name
            if is_forbidden(module) and name != "find_spec":  # VTK's finder is asked about every import of anything
                self.seen.add(f"{module}.{name}")
        elif event == "c_call":
            owner = getattr(argument, "__self__", None)
            module = type(owner).__module__ if owner is not None else getattr(argument, "__module__", None)
            if is_forbidden(module):
                self.seen.add(f"{module}: {argument!r}")

    def over(self, work):
        def watched(*arguments, **named):
            self.threads.add(threading.get_ident())
            sys.setprofile(self)
            try:
                return work(*arguments, **named)
            finally:
                sys.setprofile(None)

        return watched


def test_the_watch_sees_what_it_is_there_for() -> None:
    from qtpy.QtCore import QObject

    watch = Watch()
    watch.over(lambda: QObject().setObjectName("x"))()
    assert watch.seen


@pytest.mark.slow
def test_no_qt_or_vtk_object_is_touched_on_the_worker(qtbot, tmp_path) -> None:
    watch, engine = Watch(), PipelineEngine()
    for name in ("load", "run", "targets"):
        setattr(engine, name, watch.over(getattr(engine, name)))
    window = MainWindow(engine, Settings(str(tmp_path / "settings.ini")), FlatCanvas)
    qtbot.addWidget(window)
    window.resize(1300, 800)
    window.show()
    person = Person(window)
    window.controller.open_source("expr:0.1 + 0.05*x")
    person.wait_settled(600)
    window.controller.change(lambda options: options.with_comparable_slope(), "slope")
    window.actions_["paint"].trigger()
    person.drag(window.board.panes[0], [(0.2, 0.2), (0.4, 0.4)], lift=False)
    person.wait(lambda: bool(window.controller.painting.preview.targets), 60)
    window.controller.painting.end()
    window.controller.apply()
    person.wait_settled(600)
    assert watch.seen == set()
    assert watch.calls > 1000 and threading.get_ident() not in watch.threads
    window.close()
