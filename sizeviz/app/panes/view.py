"""The OpenGL widget of a pane: draws large scenes in pieces, and moves the last frame while one is dragged about."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from pyvistaqt import QtInteractor
from qtpy.QtCore import QTimer

from sizeviz.app.turns import Turns
from sizeviz.scene.camera import Camera2D
from sizeviz.scene.renderer import Renderer, is_large

if TYPE_CHECKING:
    from collections.abc import Iterator

    from qtpy.QtGui import QResizeEvent
    from qtpy.QtWidgets import QWidget

    from sizeviz.scene.spec import SceneSpec

SLOW_SECONDS = 0.03
"""A scene that takes longer to draw than this is drawn anew only when the camera rests."""

REST_MS = 110
"""How long the camera must rest before a slow scene is drawn anew."""

LEAST_COVER = 0.6
"""Share of the pane, along either side, that a moved picture must still cover; below it the scene is drawn anew."""

PIECE_SECONDS = 0.006
"""A turn of the event loop prepares or draws pieces of a large scene until this is over."""

COLOR_BUFFER, NOT_FURTHER = 0x4000, 0x0203
NEAREST, LINEAR = 0x2600, 0x2601


class PaneView(QtInteractor):
    """pyvistaqt's widget with everything switched off that is not drawing.

    ``paintGL`` of pyvistaqt draws the scene whenever Qt asks for the pixels. Here a paint that finds the scene
    unchanged copies the last frame, and while the camera of a slow scene moves, the last frame moves with it: what is
    on the screen follows the hand at the cost of one copy, and becomes sharp when the hand rests.

    A large scene is handed to VTK and drawn in pieces, a few in each turn of the event loop. The drawing goes into
    VTK's own frame buffer, and the last frame stays on the screen until the new one is whole: the window never stands
    still for a drawing, however large.

    Parameters
    ----------
    parent : QWidget
        Owner.
    """

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, auto_update=False, multi_samples=1, lighting="none", border=False)
        self.setUpdateBehavior(self.UpdateBehavior.PartialUpdate)  # a paint may leave what is there
        self.frames = 0  # scenes drawn, not pictures moved
        self._scene = Renderer(self)
        self._wanted = Camera2D(0.5, 0.5, 1.1)
        self._drawn: Camera2D | None = None
        self._drawn_size = self._painted_size = (0, 0)
        self._has_frame = False
        self._dirty, self._is_resizing = True, False
        self._seconds = 0.0
        self._ground = (1.0, 1.0, 1.0)
        self._pieces: list[list[Any]] = []
        self._next_piece = 0
        self._under_way = self._wanted, (0, 0)
        self._turn = Turns(self)
        self._coming: tuple[SceneSpec, bool] | None = None
        self._preparing = Turns(self)
        self._rest = QTimer(self)
        self._rest.setSingleShot(True)
        self._rest.setInterval(REST_MS)
        self._rest.timeout.connect(self.redraw)

    @property
    def is_moving(self) -> bool:
        """Whether what is on the screen is an older frame, moved."""
        return self._rest.isActive()

    @property
    def is_drawing(self) -> bool:
        """Whether a scene is on its way to the screen."""
        return self._coming is not None or self._turn.is_busy or (self._dirty and self.isVisible())

    def show_scene(self, spec: SceneSpec, edges: bool) -> None:
        """Take another scene; only what differs is touched, and a large mesh is handed to VTK over several turns."""
        self._coming = spec, edges
        self._preparing.drop()
        steps = self._scene.prepare(spec)
        if is_large(spec):
            self._preparing.take({"prepare": lambda: self._prepare_on(steps)})  # whoever asks has a turn's work already
        else:
            self._prepare_on(steps)

    def show_edges(self, visible: bool) -> None:
        """Draw or hide the element edges; while a frame is moved they wait for the next one."""
        if self._coming is not None:
            self._coming = self._coming[0], visible
        elif self._scene.show_edges(visible) and (self._turn.is_busy or not self.is_moving):
            self.redraw()

    def redraw(self) -> None:
        """Draw the scene anew as soon as the event loop comes round."""
        self._rest.stop()
        self._turn.drop()  # what was drawn of the scene so far is of no use any more
        self._dirty = True
        self.update()

    def move_to(self, camera: Camera2D) -> None:
        """Look elsewhere, at once where the scene is quick to draw and with the last frame where it is not."""
        self._wanted = camera
        if self._seconds > SLOW_SECONDS and self._covers(camera):
            self._rest.start()
        else:
            self._dirty = True  # a drawing under way is finished first: else a hand that never rests would see none
        self.update()

    def rehearse(self, spec: SceneSpec, edges: bool) -> None:
        """Draw a scene out of sight: the next drawing finds the OpenGL context made and its programs compiled."""
        self.show_scene(spec, edges)
        # within a paint only that is drawn which was quick to draw before
        self._drawn, self._drawn_size, self._seconds = self._wanted, self._size(), 0.0
        self.grabFramebuffer()
        self._drawn, self._has_frame, self._seconds, self._dirty = None, False, 0.0, True

    def stop(self) -> None:
        """Draw no more."""
        self._rest.stop()
        self._turn.drop()
        self._preparing.drop()
        self._coming = None

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Take another size; what is drawn for it comes with the next paint."""
        self._is_resizing = True
        super().resizeEvent(event)
        self._is_resizing = False

    def paintGL(self) -> None:
        """Draw, or copy the last frame to where it belongs now."""
        resized = self._drawn_size != self._size()
        is_under_way = self._turn.is_busy and self._under_way[1] == self._size()
        if self._is_resizing:
            self.update()  # Qt wants a paint for every step of a new layout; the drawing comes with the last
        elif resized and self._seconds > SLOW_SECONDS and not self._dirty and not self._turn.is_busy:
            self._rest.start()  # a slow scene is drawn for the new size when the size rests
        elif (self._dirty or resized) and not is_under_way:
            self._pieces = self._scene.pieces()
            if len(self._pieces) == 1 and self._pieces[0] and self._drawn is not None and self._seconds <= SLOW_SECONDS:
                self._draw_whole()
                return
            self._begin()
        if self._has_frame:
            self._copy()
        elif self._painted_size != self._size():
            self._clear()  # else what is on the screen stays there
        self._painted_size = self._size()

    def _prepare_on(self, steps: Iterator[None]) -> None:
        """Hand more of the coming scene to VTK; once all of it is there it takes the present one's place."""
        began = time.perf_counter()
        for _ in steps:
            if time.perf_counter() - began > PIECE_SECONDS:
                self._preparing.take({"prepare": lambda: self._prepare_on(steps)})
                return
        assert self._coming is not None
        (spec, edges), self._coming = self._coming, None
        self._ground = spec.ground[0] / 255.0, spec.ground[1] / 255.0, spec.ground[2] / 255.0
        if self._scene.show(spec, edges):
            self.redraw()

    def _draw_whole(self) -> None:
        began = time.perf_counter()
        self._turn.drop()
        self._scene.look(self._wanted)
        super().paintGL()
        self._seconds = time.perf_counter() - began
        self._dirty = False
        self._drawn, self._drawn_size, self._has_frame = self._wanted, self._size(), True
        self._painted_size = self._drawn_size
        self.frames += 1

    def _begin(self) -> None:
        """Begin to draw in pieces, from the next turn on."""
        self._dirty = False
        self._next_piece = 0
        self._under_way = self._wanted, self._size()
        self._seconds = 0.0
        self._scene.look(self._wanted)
        self._turn.take({"draw": self._draw_on})

    def _draw_on(self) -> None:
        """Draw the next pieces; with the last one the frame is whole, and Qt is asked to show it."""
        if not self.isVisible() or self._ctx is None:
            self._dirty = True
            return
        began = time.perf_counter()
        for number in range(self._next_piece, len(self._pieces)):
            self._draw_piece(number)
            self._next_piece = number + 1
            if time.perf_counter() - began > PIECE_SECONDS:
                break
        self._seconds += time.perf_counter() - began
        if self._next_piece < len(self._pieces):
            self._turn.take({"draw": self._draw_on})
        else:
            self._drawn, self._drawn_size = self._under_way
            self._has_frame = True
            self.frames += 1
            self.update()

    def _draw_piece(self, number: int) -> None:
        window, renderer = self.ren_win, self.renderer
        self._has_frame = self._has_frame and self._under_way[1] == self._drawn_size  # VTK resizes its buffers now
        window.MakeCurrent()
        state = window.GetState()
        state.Reset()  # Qt touched OpenGL since VTK last did
        state.Push()
        state.vtkglDepthFunc(NOT_FURTHER)
        keeps, shows = number > 0, number == len(self._pieces) - 1
        renderer.SetPreserveColorBuffer(keeps)
        renderer.SetPreserveDepthBuffer(keeps)
        window.SetSwapBuffers(shows)  # until then the display buffer keeps the last frame
        try:
            with self._scene.only(self._pieces[number]):
                window.Render()
            window.WaitForCompletion()  # what a piece takes is paid in its own turn
        finally:
            renderer.SetPreserveColorBuffer(False)
            renderer.SetPreserveDepthBuffer(False)
            window.SetSwapBuffers(True)
            state.Pop()

    def _clear(self) -> None:
        if self._gl is not None:
            self._gl.glClearColor(*self._ground, 1.0)
            self._gl.glClear(COLOR_BUFFER)

    def _copy(self) -> None:
        window, gl = self.ren_win, self._gl
        if window is None or gl is None or not window.GetReadyForRendering():
            return
        state = window.GetState()
        state.Reset()  # Qt touched OpenGL since VTK last did
        state.Push()
        (width, height), now = self._drawn_size, self._size()
        left, low, right, high = frame_place(self._drawn, self._wanted, self._drawn_size, now)
        gl.glClearColor(*self._ground, 1.0)
        gl.glViewport(0, 0, *now)
        gl.glClear(COLOR_BUFFER)
        smooth = LINEAR if right - left != width else NEAREST
        window.BlitDisplayFramebuffer(0, 0, 0, width, height, left, low, right - left, high - low, COLOR_BUFFER, smooth)
        gl.glColorMask(False, False, False, True)  # a compositor must not see through the pane
        gl.glClearColor(0.0, 0.0, 0.0, 1.0)
        gl.glClear(COLOR_BUFFER)
        gl.glColorMask(True, True, True, True)
        state.Pop()

    def _covers(self, camera: Camera2D) -> bool:
        if self._drawn is None or self._dirty or self._drawn_size != self._size():
            return False
        width, height = self._drawn_size
        left, low, right, high = frame_place(self._drawn, camera, self._drawn_size, self._drawn_size)
        across = min(right, width) - max(left, 0)
        up = min(high, height) - max(low, 0)
        return across >= LEAST_COVER * width and up >= LEAST_COVER * height

    def _size(self) -> tuple[int, int]:
        ratio = self.devicePixelRatioF()
        return max(1, round(self.width() * ratio)), max(1, round(self.height() * ratio))


def frame_place(drawn: Any, now: Any, frame: tuple[int, int], pane: tuple[int, int]) -> tuple[int, int, int, int]:
    """Return where a frame drawn with one camera lies for another, in pixels from the lower left corner.

    Parameters
    ----------
    drawn, now : Camera2D
        Camera of the frame, and the present one.
    frame, pane : tuple of int
        Width and height of the frame, and of the pane as it is now, in pixels.

    Returns
    -------
    tuple of int
        Left, lower, right and upper side.
    """
    pixels = pane[1] / now.height
    x = 0.5 * pane[0] + (drawn.x - now.x) * pixels
    y = 0.5 * pane[1] + (drawn.y - now.y) * pixels
    half_high = 0.5 * drawn.height * pixels
    half_wide = half_high * frame[0] / frame[1]
    return round(x - half_wide), round(y - half_high), round(x + half_wide), round(y + half_high)
