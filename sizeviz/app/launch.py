"""Start, run, stop: the application around the window."""

from __future__ import annotations

import ctypes
import logging
import os
import sys
import traceback
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sizeviz.errors import InputError, MissingDependencyError, SizevizError
from sizeviz.scene.opengl import has_display

if TYPE_CHECKING:
    from types import TracebackType

    from sizeviz.app.window import MainWindow

M_ARENA_MAX = -8
"""What malloc.h calls the option that limits how many arenas there are."""

LOG = logging.getLogger(__name__)

GRAB_SIZE = (1600, 1000)
"""Size of the window while it is photographed."""

PREPARE_MS = 150
"""How long after the window is shown what it will need begins to be loaded."""

SWITCH_SECONDS = 0.002
"""How long the worker may hold the interpreter before the window gets its turn."""


def launch(source: str | None, grab: str | None) -> int:
    """Open the window, run the event loop, return the exit code.

    Raises
    ------
    MissingDependencyError
        If there is no display.
    InputError
        If the picture asked for cannot be written.
    """
    if not has_display():
        raise MissingDependencyError(
            "the window needs a display; start an X server, or run it in a virtual one: apt-get install xvfb xauth, "
            "then xvfb-run sizeviz gui"
        )
    if grab is not None and not Path(grab).resolve().parent.is_dir():
        raise InputError(f"{grab}: its folder does not exist; create it first")
    sys.setswitchinterval(SWITCH_SECONDS)
    app = application()
    from qtpy.QtCore import QTimer

    from sizeviz.app.engine import PipelineEngine
    from sizeviz.app.signals import EndRequests
    from sizeviz.app.window import MainWindow

    window = MainWindow(PipelineEngine())
    _catch_errors(window)
    requests = EndRequests(window.close)
    if grab is not None:
        window.resize(*GRAB_SIZE)
    window.show()
    QTimer.singleShot(PREPARE_MS, window.preparation.start)
    code = [0]
    if source is not None:
        window.controller.open_source(source)
    if grab is not None:
        _grab_when_settled(window, grab, code)
    status = app.exec() if hasattr(app, "exec") else app.exec_()
    requests.stop()
    return int(status) or code[0]


def application() -> Any:
    """Return the Qt application, made once; colours and sizes follow the screen's scale."""
    os.environ.setdefault("QT_API", "pyqt5")
    from qtpy.QtCore import QCoreApplication, Qt
    from qtpy.QtGui import QGuiApplication, QIcon
    from qtpy.QtWidgets import QApplication

    existing = QApplication.instance()
    if existing is not None:
        return existing
    _share_one_arena()
    for name in ("AA_EnableHighDpiScaling", "AA_UseHighDpiPixmaps"):  # both are always on in Qt 6
        attribute = getattr(Qt.ApplicationAttribute, name, None)
        if attribute is not None:
            QCoreApplication.setAttribute(attribute)
    QGuiApplication.setHighDpiScaleFactorRoundingPolicy(Qt.HighDpiScaleFactorRoundingPolicy.PassThrough)
    _set_surface_format()
    app = QApplication([sys.argv[0] if sys.argv else "sizeviz"])
    app.setApplicationName("sizeviz")
    app.setApplicationDisplayName("sizeviz")
    app.setDesktopFileName("sizeviz")
    app.setWindowIcon(QIcon(str(Path(__file__).with_name("icons") / "sizeviz.svg")))
    return app


def _share_one_arena() -> None:
    """Let all threads allocate from one arena, where the GNU library is the allocator.

    By default every thread has its own, of which up to 64 MB stay resident after a large mesh was let go.
    """
    with suppress(OSError, AttributeError, TypeError):  # another allocator
        ctypes.CDLL(None).mallopt(M_ARENA_MAX, 1)


def _set_surface_format() -> None:
    """Ask for desktop OpenGL, one sample a pixel, before any window exists: later it is ignored or breaks drawing."""
    from qtpy.QtGui import QSurfaceFormat

    wanted = QSurfaceFormat()
    wanted.setRenderableType(QSurfaceFormat.RenderableType.OpenGL)
    wanted.setProfile(QSurfaceFormat.OpenGLContextProfile.CoreProfile)
    wanted.setVersion(3, 2)
    wanted.setAlphaBufferSize(8)
    wanted.setDepthBufferSize(8)
    wanted.setSamples(0)
    QSurfaceFormat.setDefaultFormat(wanted)


def _catch_errors(window: MainWindow) -> None:
    """Show what goes wrong in a slot instead of ending the process, which is what PyQt would do."""
    from sizeviz.app.news import Notice

    def hook(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if issubclass(kind, KeyboardInterrupt):
            window.close()
            return
        details = "".join(traceback.format_exception(kind, error, trace))
        LOG.error("%s", details)
        level = "warning" if isinstance(error, SizevizError) else "error"
        window.controller.noticed.emit(Notice(level, str(error) or kind.__name__, details))

    sys.excepthook = hook


def _grab_when_settled(window: MainWindow, path: str, code: list[int]) -> None:
    from qtpy.QtCore import QTimer

    def grab() -> None:
        if window.is_settling:
            QTimer.singleShot(300, grab)
            return
        if not window.grab().save(path):
            print(f"error: {path}: cannot be written; choose another place", file=sys.stderr)
            code[0] = 2
        window.close()

    def failed(notice: Any) -> None:
        if notice.level == "error":
            print(f"error: {notice.text}", file=sys.stderr)
            code[0] = 2
            window.close()

    window.controller.settled.connect(lambda: QTimer.singleShot(700, grab))
    window.controller.noticed.connect(failed)
    if window.controller.study is None and not window.controller.jobs.is_busy:
        QTimer.singleShot(700, grab)
