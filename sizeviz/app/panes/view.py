"""The OpenGL widget of a pane: draws a scene once, and moves the picture it has while a slow scene is dragged about."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from pyvistaqt import QtInteractor
from qtpy.QtCore import QTimer

if TYPE_CHECKING:
    from qtpy.QtWidgets import QWidget

    from sizeviz.scene.camera import Camera2D

SLOW_SECONDS = 0.03
"""A scene that takes longer to draw than this is drawn anew only when the camera rests."""

REST_MS = 110
"""How long the camera must rest before a slow scene is drawn anew."""

LEAST_COVER = 0.6
"""Share of the pane, along either side, that a moved picture must still cover; below it the scene is drawn anew."""

COLOR_BUFFER = 0x4000
NEAREST, LINEAR = 0x2600, 0x2601


class PaneView(QtInteractor):
    """pyvistaqt's widget with everything switched off that is not drawing.

    ``paintGL`` of pyvistaqt draws the scene whenever Qt asks for the pixels. Here a paint that finds the scene
    unchanged copies the last frame, and while the camera of a slow scene moves, the last frame moves with it: what is
    on the screen follows the hand at the cost of one copy, and becomes sharp when the hand rests.

    Parameters
    ----------
    parent : QWidget
        Owner.
    """

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, auto_update=False, multi_samples=1, lighting="none", border=False)
        self.frames = 0  # scenes drawn, not pictures moved
        self._wanted: Camera2D | None = None
        self._drawn: Camera2D | None = None
        self._drawn_size = (0, 0)
        self._dirty = True
        self._seconds = 0.0
        self._ground = (1.0, 1.0, 1.0)
        self._rest = QTimer(self)
        self._rest.setSingleShot(True)
        self._rest.setInterval(REST_MS)
        self._rest.timeout.connect(self.redraw)

    @property
    def is_moving(self) -> bool:
        """Whether what is on the screen is an older frame, moved."""
        return self._rest.isActive()

    def redraw(self) -> None:
        """Draw the scene anew as soon as the event loop comes round."""
        self._rest.stop()
        self._dirty = True
        self.update()

    def move_to(self, camera: Camera2D) -> None:
        """Look elsewhere, at once where the scene is quick to draw and with the last frame where it is not."""
        self._wanted = camera
        if self._seconds > SLOW_SECONDS and self._covers(camera):
            self._rest.start()
            self.update()
        else:
            self.redraw()

    def set_ground(self, color: tuple[int, int, int]) -> None:
        """Say what is behind the scene; a moved frame leaves some of it bare."""
        self._ground = color[0] / 255.0, color[1] / 255.0, color[2] / 255.0

    def paintGL(self) -> None:
        """Draw, or copy the last frame to where it belongs now."""
        if self._dirty or self._drawn is None or self._drawn_size != self._size():
            self._draw()
        else:
            self._copy()

    def _draw(self) -> None:
        began = time.perf_counter()
        super().paintGL()
        self._seconds = time.perf_counter() - began
        self._dirty = False
        self._drawn, self._drawn_size = self._wanted, self._size()
        self.frames += 1

    def _copy(self) -> None:
        window, gl = self.ren_win, self._gl
        if window is None or gl is None or not window.GetReadyForRendering():
            return
        state = window.GetState()
        state.Reset()  # Qt touched OpenGL since VTK last did
        state.Push()
        width, height = self._drawn_size
        left, low, right, high = self._place()
        gl.glClearColor(*self._ground, 1.0)
        gl.glViewport(0, 0, width, height)
        gl.glClear(COLOR_BUFFER)
        smooth = LINEAR if right - left != width else NEAREST
        window.BlitDisplayFramebuffer(0, 0, 0, width, height, left, low, right - left, high - low, COLOR_BUFFER, smooth)
        gl.glColorMask(False, False, False, True)  # a compositor must not see through the pane
        gl.glClearColor(0.0, 0.0, 0.0, 1.0)
        gl.glClear(COLOR_BUFFER)
        gl.glColorMask(True, True, True, True)
        state.Pop()

    def _place(self) -> tuple[int, int, int, int]:
        """Return where the last frame lies now: left, lower, right and upper side, in pixels from the lower left."""
        return frame_place(self._drawn, self._wanted, *self._drawn_size)

    def _covers(self, camera: Camera2D) -> bool:
        if self._drawn is None or self._dirty or self._drawn_size != self._size():
            return False
        width, height = self._drawn_size
        left, low, right, high = frame_place(self._drawn, camera, width, height)
        across = min(right, width) - max(left, 0)
        up = min(high, height) - max(low, 0)
        return across >= LEAST_COVER * width and up >= LEAST_COVER * height

    def _size(self) -> tuple[int, int]:
        ratio = self.devicePixelRatioF()
        return max(1, round(self.width() * ratio)), max(1, round(self.height() * ratio))


def frame_place(drawn: Any, now: Any, width: int, height: int) -> tuple[int, int, int, int]:
    """Return where a frame drawn with one camera lies for another, in pixels from the lower left corner.

    Parameters
    ----------
    drawn, now : Camera2D
        Camera of the frame, and the present one.
    width, height : int
        Size of the frame and of the pane, in pixels.

    Returns
    -------
    tuple of int
        Left, lower, right and upper side.
    """
    scale = drawn.height / now.height
    pixels = height / now.height
    x = 0.5 * width + (drawn.x - now.x) * pixels
    y = 0.5 * height + (drawn.y - now.y) * pixels
    half_wide, half_high = 0.5 * width * scale, 0.5 * height * scale
    return round(x - half_wide), round(y - half_high), round(x + half_wide), round(y + half_high)
