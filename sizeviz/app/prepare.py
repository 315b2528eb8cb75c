"""What can be done before anybody asks for it, while the first page waits: modules loaded, OpenGL made ready."""

from __future__ import annotations

from importlib import import_module
from threading import Thread
from typing import TYPE_CHECKING

from qtpy.QtCore import QObject, Qt, QTimer

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from qtpy.QtWidgets import QWidget

    from sizeviz.app.panes.board import PaneBoard

PRELOADED = (
    "sizeviz.app.panes.view", "vtkmodules.vtkInteractionWidgets", "vtkmodules.vtkViewsContext2D",
    "sizeviz.study", "sizeviz.sources", "sizeviz.sources.gallery", "sizeviz.sources.picture_examples",
    "sizeviz.sizing.tree", "sizeviz.app.inspect.locate", "scipy.spatial",
)  # fmt: skip
"""Modules that panes and the first run need: loaded by a thread beside the window, they cost neither any time."""

PAUSE_MS = 40
"""Time between two pieces of the preparation, for whatever a person does meanwhile."""


class Preparation(QObject):
    """Loads modules on a thread, then lays panels out and makes the panes' OpenGL ready, a piece at a time.

    Whoever needs something before it is ready waits for that only; nothing here has to come to its end.

    Parameters
    ----------
    board : PaneBoard
        Whose panes are made ready.
    panels : sequence of QWidget
        What appears beside them; drawn once out of sight, each knows its style, fonts and layout.
    parent : QObject, optional
        Owner.
    """

    def __init__(self, board: PaneBoard, panels: Sequence[QWidget], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._board, self._panels = board, panels
        self._thread: Thread | None = None
        self._pieces: list[Callable[[], object]] = []
        self._timer = QTimer(self)
        self._timer.setInterval(PAUSE_MS)
        self._timer.timeout.connect(self._next)
        self.is_done = False

    def start(self) -> None:
        """Begin; the window must be on the screen."""
        self._thread = Thread(target=_load, name="preload")
        self._thread.start()
        self._pieces = [self._meet_compositor, self._leave_compositor]
        canvases = [pane.surface.canvas for pane in self._board.visible_panes]
        self._pieces += [piece for canvas in canvases for piece in canvas.preparations()]
        self._pieces += [panel.grab for panel in [*self._board.visible_panes, *self._panels]]
        self._timer.start()

    def stop(self) -> None:
        """Leave the rest."""
        self._timer.stop()

    def _meet_compositor(self) -> None:
        """Show one pixel of OpenGL: from then on Qt puts the window together with it, which takes a while to set up."""
        from sizeviz.app.qt import QOpenGLWidget

        self._pixel = QOpenGLWidget(self._board.window())
        self._pixel.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._pixel.resize(1, 1)
        self._pixel.show()

    def _leave_compositor(self) -> None:
        self._pixel.hide()
        self._pixel.deleteLater()

    def _next(self) -> None:
        if self._thread is not None and self._thread.is_alive():
            return
        if self._pieces:
            self._pieces.pop(0)()
        else:
            self.is_done = True
            self._timer.stop()


def _load() -> None:
    for name in PRELOADED:
        import_module(name)
    from numba.core import entrypoints
    from numba.core.compiler_lock import global_compiler_lock
    from numba.core.registry import cpu_target

    with global_compiler_lock:  # a run that was begun at once may be loading its first kernel at this moment
        entrypoints.init_all()  # what the first call of the first kernel would do, in the middle of a run
        cpu_target.typing_context.refresh()
        cpu_target.target_context.refresh()
