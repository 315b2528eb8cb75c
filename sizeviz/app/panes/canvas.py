"""Where VTK draws: a pyvistaqt widget with everything switched off that is not drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from qtpy.QtCore import Qt

if TYPE_CHECKING:
    from qtpy.QtWidgets import QWidget

    from sizeviz.scene.camera import Camera2D
    from sizeviz.scene.spec import SceneSpec


class Canvas(Protocol):
    """What a pane needs of its drawing widget; tests without OpenGL bring their own."""

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

    Parameters
    ----------
    parent : QWidget
        Owner.
    """

    def __init__(self, parent: QWidget) -> None:
        from sizeviz.app.panes.view import PaneView
        from sizeviz.scene.renderer import Renderer

        self._view = PaneView(parent)
        self._view.setAcceptDrops(False)
        self._view.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._renderer = Renderer(self._view)
        self._edges = False

    def widget(self) -> QWidget:
        """Return the pyvistaqt widget."""
        widget: QWidget = self._view
        return widget

    def show_scene(self, spec: SceneSpec) -> None:
        """Take another scene; only what differs is touched."""
        self._view.set_ground(spec.ground)
        if self._renderer.show(spec, self._edges):
            self._view.redraw()

    def look(self, camera: Camera2D) -> None:
        """Look elsewhere; a scene that is slow to draw follows with its last frame until the camera rests."""
        self._renderer.look(camera)
        self._view.move_to(camera)

    def show_edges(self, visible: bool) -> None:
        """Draw or hide the element edges; while a frame is moved they wait for the next one."""
        self._edges = visible
        if self._renderer.show_edges(visible) and not self._view.is_moving:
            self._view.redraw()

    def dispose(self) -> None:
        """Free what VTK holds; the widget must not be drawn any more."""
        self._view.close()
