from __future__ import annotations

import gc
import os

import pytest
from qtpy.QtCore import QEvent
from qtpy.QtWidgets import QApplication

os.environ.setdefault("QT_API", "pyqt5")


@pytest.fixture(autouse=True)
def _no_widget_outlives_its_test():
    """Destroy windows here, in Qt's order: left to the garbage collector, their parts go in any order, at any time."""
    yield
    application = QApplication.instance()
    if application is None:
        return
    for widget in application.topLevelWidgets():
        if widget.parent() is None:
            widget.close()
            widget.deleteLater()
    application.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    gc.collect()


@pytest.fixture(scope="session")
def qapp_cls():
    from sizeviz.app.launch import application

    return lambda args: application()


@pytest.fixture
def engine():
    from app.fakes import FakeEngine

    return FakeEngine()


@pytest.fixture
def controller(qtbot, engine):
    from sizeviz.app.controller import Controller

    controller = Controller(engine)
    yield controller
    assert controller.jobs.shut_down()
    gc.collect()


@pytest.fixture
def flat_window(qtbot, engine, tmp_path):
    """The whole window, its panes drawn by nobody: no OpenGL is needed."""
    from app.fakes import FlatCanvas

    from sizeviz.app.settings import Settings
    from sizeviz.app.window import MainWindow

    window = MainWindow(engine, Settings(str(tmp_path / "settings.ini")), FlatCanvas)
    qtbot.addWidget(window)
    window.resize(1400, 900)
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow, timeout=3000)
    yield window
    window.close()


@pytest.fixture
def opened(qtbot, flat_window):
    with qtbot.waitSignal(flat_window.controller.settled, timeout=10_000):
        flat_window.controller.open_source("ring")
    return flat_window
