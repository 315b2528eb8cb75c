"""The window: the frame, connected to what it does, with its lessons."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import Signal

from sizeviz.app.frame import Frame
from sizeviz.app.intents import connect_actions, connect_panels
from sizeviz.app.lessons.hub import Lessons
from sizeviz.app.panes.canvas import GLCanvas

if TYPE_CHECKING:
    from collections.abc import Callable

    from qtpy.QtGui import QCloseEvent
    from qtpy.QtWidgets import QWidget

    from sizeviz.app.engine import Engine
    from sizeviz.app.panes.canvas import Canvas
    from sizeviz.app.settings import Settings
    from sizeviz.app.theme import Theme


class MainWindow(Frame):
    """The application's window.

    Parameters
    ----------
    engine : Engine
        The pipeline.
    settings : Settings, optional
        What is remembered; the platform's own place by default.
    make_canvas : callable
        Makes a pane's drawing widget; tests without OpenGL bring their own.

    Signals
    -------
    closed()
        The window was closed, and all that it held is free.
    """

    closed = Signal()

    def __init__(
        self,
        engine: Engine,
        settings: Settings | None = None,
        make_canvas: Callable[[QWidget], Canvas] = GLCanvas,
    ) -> None:
        super().__init__(engine, settings, make_canvas)
        connect_panels(self)
        connect_actions(self, lambda: self.lessons.escape())
        self.lessons = Lessons(self, make_canvas)  # after the panels: it explains what they show
        self.set_theme(self.theme)
        self.show_state()

    def set_theme(self, theme: Theme) -> None:
        """Change between light and dark."""
        super().set_theme(theme)
        self.lessons.set_theme(theme)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Stop the worker, remember the layout, free VTK; in this order, so that nothing is used after it is gone."""
        self.turns.drop()
        self.preparation.stop()
        self.controller.jobs.shut_down()
        self.lessons.close()
        self.files.close()
        for sender in (self.controller.store.stack, self.controller.store, self.controller, self.controller.jobs):
            sender.blockSignals(True)  # what is torn down from here on is nobody's news
        self.settings.save_layout(self)
        self.log.detach()
        self.board.dispose()
        self.closed.emit()
        super().closeEvent(event)
