"""Where VTK draws: a pyvistaqt widget with everything switched off that is not drawing."""

from __future__ import annotations

from importlib import import_module
from threading import Thread
from typing import TYPE_CHECKING, Protocol

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QStackedLayout, QWidget

if TYPE_CHECKING:
    from sizeviz.app.panes.view import PaneView
    from sizeviz.scene.camera import Camera2D
    from sizeviz.scene.renderer import Renderer
    from sizeviz.scene.spec import SceneSpec


PRELOADED = ("sizeviz.app.panes.view", "sizeviz.scene.renderer", "sizeviz.study")
"""What is loaded once the first page is there: panes need the first two, and opening anything the third."""


class Canvas(Protocol):
    """What a pane needs of its drawing widget; tests without OpenGL bring their own."""

    @property
    def is_ready(self) -> bool:
        """Whether showing a scene costs no start-up."""

    def widget(self) -> QWidget:
        """Return the widget to lay out."""

    def show_scene(self, spec: SceneSpec) -> None:
        """Take another scene; it is drawn as soon as the event loop comes round."""

    def look(self, camera: Camera2D) -> None:
        """Look elsewhere."""

    def show_edges(self, visible: bool) -> None:
        """Draw or hide the element edges."""

    def dispose(self) -> None:
        """Free what VTK holds."""


class GLCanvas:
    """The canvas of the real window.

    It draws only when asked to: pyvistaqt's own timer is off, so an idle window costs nothing.

    VTK is loaded, and the OpenGL widget made, when there is first something to draw: the window's first page needs
    neither, and is there a second sooner without them.

    Parameters
    ----------
    parent : QWidget
        Owner.
    """

    def __init__(self, parent: QWidget) -> None:
        self._holder = QWidget(parent)
        self._whole = QStackedLayout(self._holder)
        self._drawing: tuple[PaneView, Renderer] | None = None
        self._camera: Camera2D | None = None
        self._edges = False

    @property
    def view(self) -> PaneView | None:
        """The OpenGL widget, None until there was something to draw."""
        return None if self._drawing is None else self._drawing[0]

    @property
    def is_ready(self) -> bool:
        """Whether the OpenGL widget is there."""
        return self._drawing is not None

    def widget(self) -> QWidget:
        """Return the widget to lay out."""
        return self._holder

    def show_scene(self, spec: SceneSpec) -> None:
        """Take another scene; only what differs is touched."""
        if self._drawing is None:
            if not spec.layers:
                return
            self._drawing = self._made()
        view, renderer = self._drawing
        view.set_ground(spec.ground)
        if renderer.show(spec, self._edges):
            view.redraw()

    def look(self, camera: Camera2D) -> None:
        """Look elsewhere; a scene that is slow to draw follows with its last frame until the camera rests."""
        self._camera = camera
        if self._drawing is not None:
            view, renderer = self._drawing
            renderer.look(camera)
            view.move_to(camera)

    def show_edges(self, visible: bool) -> None:
        """Draw or hide the element edges; while a frame is moved they wait for the next one."""
        self._edges = visible
        if self._drawing is not None:
            view, renderer = self._drawing
            if renderer.show_edges(visible) and not view.is_moving:
                view.redraw()

    def dispose(self) -> None:
        """Free what VTK holds; the widget must not be drawn any more."""
        if self._drawing is not None:
            self._drawing[0].close()

    def _made(self) -> tuple[PaneView, Renderer]:
        from sizeviz.app.panes.view import PaneView
        from sizeviz.scene.renderer import Renderer

        view = PaneView(self._holder)
        view.setAcceptDrops(False)
        view.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._whole.addWidget(view)
        renderer = Renderer(view)
        if self._camera is not None:
            renderer.look(self._camera)
            view.move_to(self._camera)
        return view, renderer


def preload() -> Thread:
    """Load VTK beside the window, once its first page is there; whoever needs it earlier waits for the rest only."""
    thread = Thread(target=lambda: [import_module(name) for name in PRELOADED], name="preload")
    thread.start()
    return thread
