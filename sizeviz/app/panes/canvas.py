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
        """Take another scene; it is drawn at the next refresh."""

    def look(self, camera: Camera2D) -> None:
        """Look elsewhere."""

    def show_edges(self, visible: bool) -> None:
        """Draw or hide the element edges."""

    def refresh(self) -> None:
        """Draw as soon as the event loop comes round, once for any number of calls."""

    def dispose(self) -> None:
        """Free what VTK holds."""


class GLCanvas:
    """The canvas of the real window.

    It draws only when asked to: pyvistaqt's own timer is off, so an idle window costs nothing, and ``update`` draws
    once where ``render`` would draw twice.

    Parameters
    ----------
    parent : QWidget
        Owner.
    """

    def __init__(self, parent: QWidget) -> None:
        from pyvistaqt import QtInteractor

        from sizeviz.scene.renderer import Renderer

        self._view = QtInteractor(parent, auto_update=False, multi_samples=1, lighting="none", border=False)
        self._view.setAcceptDrops(False)
        self._view.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._renderer = Renderer(self._view)

    def widget(self) -> QWidget:
        """Return the pyvistaqt widget."""
        widget: QWidget = self._view
        return widget

    def show_scene(self, spec: SceneSpec) -> None:
        """Take another scene; only what differs is touched."""
        self._renderer.show(spec)

    def look(self, camera: Camera2D) -> None:
        """Look elsewhere."""
        self._renderer.look(camera)

    def show_edges(self, visible: bool) -> None:
        """Draw or hide the element edges."""
        self._renderer.show_edges(visible)

    def refresh(self) -> None:
        """Schedule one repaint."""
        self._view.update()

    def dispose(self) -> None:
        """Free what VTK holds; the widget must not be drawn any more."""
        self._view.close()
