"""Where VTK draws: a pyvistaqt widget with everything switched off that is not drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QStackedLayout, QWidget

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sizeviz.app.panes.view import PaneView
    from sizeviz.scene.camera import Camera2D
    from sizeviz.scene.spec import SceneSpec


class Canvas(Protocol):
    """What a pane needs of its drawing widget; tests without OpenGL bring their own."""

    @property
    def is_ready(self) -> bool:
        """Whether showing a scene costs no start-up."""

    @property
    def is_drawing(self) -> bool:
        """Whether what was last asked for is still on its way to the screen."""

    def preparations(self) -> Sequence[Callable[[], object]]:
        """Return what can be done before there is anything to draw, in pieces."""

    def widget(self) -> QWidget:
        """Return the widget to lay out."""

    def show_scene(self, spec: SceneSpec) -> None:
        """Take another scene; it is drawn as soon as the event loop comes round."""

    def clear(self) -> None:
        """Show nothing, and keep nothing of what was shown."""

    def look(self, camera: Camera2D) -> None:
        """Look elsewhere."""

    def show_edges(self, visible: bool) -> None:
        """Draw or hide the element edges."""

    def dispose(self) -> None:
        """Free what VTK holds."""


class GLCanvas:
    """The canvas of the real window.

    It draws only when asked to: pyvistaqt's own timer is off, so an idle window costs nothing.

    VTK is loaded, and the OpenGL widget made, when there is first something to draw, or before that by
    ``preparations``: the window's first page needs neither, and is there a second sooner without them.

    Parameters
    ----------
    parent : QWidget
        Owner.
    """

    def __init__(self, parent: QWidget) -> None:
        self._holder = QWidget(parent)
        self._whole = QStackedLayout(self._holder)
        self._view: PaneView | None = None
        self._is_used = False
        self._camera: Camera2D | None = None
        self._edges = False

    @property
    def view(self) -> PaneView | None:
        """The OpenGL widget, None until there was something to draw."""
        return self._view

    @property
    def is_ready(self) -> bool:
        """Whether the OpenGL widget is there."""
        return self._view is not None

    def widget(self) -> QWidget:
        """Return the widget to lay out."""
        return self._holder

    @property
    def is_drawing(self) -> bool:
        """Whether what was last asked for is still on its way to the screen."""
        return self._view is not None and self._view.is_drawing

    def preparations(self) -> list[Callable[[], object]]:
        """Return what makes the OpenGL widget and compiles its programs, in pieces, ahead of the first drawing."""
        return [self._ready, lambda: self._rehearse(False), lambda: self._rehearse(True), self._forget_rehearsal]

    def show_scene(self, spec: SceneSpec) -> None:
        """Take another scene; only what differs is touched."""
        if self._view is not None or spec.layers:
            self._is_used = True
            self._ready().show_scene(spec, self._edges)

    def clear(self) -> None:
        """Leave an empty pane in the colour of its surroundings, and keep nothing of what was shown."""
        from sizeviz.scene.spec import SceneSpec

        if self._view is not None:
            ground = self._holder.palette().base().color()
            colors = ground.red(), ground.green(), ground.blue()
            self._view.show_scene(SceneSpec((), (0.0, 0.0, 1.0, 1.0), ground=colors), False)

    def look(self, camera: Camera2D) -> None:
        """Look elsewhere; a scene that is slow to draw follows with its last frame until the camera rests."""
        self._camera = camera
        if self._view is not None:
            self._view.move_to(camera)

    def show_edges(self, visible: bool) -> None:
        """Draw or hide the element edges; while a frame is moved they wait for the next one."""
        self._edges = visible
        if self._view is not None:
            self._view.show_edges(visible)

    def dispose(self) -> None:
        """Free what VTK holds; the widget must not be drawn any more."""
        if self._view is not None:
            self._view.stop()
            self._view.close()

    def _rehearse(self, edges: bool) -> None:
        """Draw one cell of every kind out of sight, unless there is already something to see."""
        if not self._is_used:
            self._ready().rehearse(rehearsal_scene(), edges)

    def _forget_rehearsal(self) -> None:
        if not self._is_used:
            self.clear()

    def _ready(self) -> PaneView:
        if self._view is None:
            from sizeviz.app.panes.view import PaneView

            self._view = view = PaneView(self._holder)
            view.setAcceptDrops(False)
            view.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            self._whole.addWidget(view)
            if self._camera is not None:
                view.move_to(self._camera)
        return self._view


def rehearsal_scene() -> SceneSpec:
    """Return a scene with one cell of every kind of layer, white on white: what draws it draws all others."""
    import numpy as np

    from sizeviz.scene.spec import CellLayer, ImageLayer, LineLayer, SceneSpec, TriangleLayer

    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    square, white = np.array([[0, 1, 2, 3]], dtype=np.int32), np.full((4, 3), 255, dtype=np.uint8)
    sides = np.array([[0, 1]], dtype=np.int32)
    return SceneSpec(
        (
            ImageLayer("image", white.reshape(2, 2, 3), (0.0, 0.0, 1.0, 1.0)),
            TriangleLayer("triangles", points, square[:, :3].copy(), white),
            CellLayer("cells", points, square, white[:1]),
            LineLayer("colored", points, sides, (255, 255, 255), 1.0, white[:1]),
            LineLayer("plain", points, sides, (255, 255, 255), 1.2),
        ),
        (0.0, 0.0, 1.0, 1.0),
    )
