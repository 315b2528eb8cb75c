"""An off-screen plotter that turns scenes into pixels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

import numpy as np

from sizeviz.scene.opengl import use_offscreen
from sizeviz.scene.renderer import Renderer

if TYPE_CHECKING:
    from types import TracebackType

    from numpy.typing import NDArray

    from sizeviz.scene.camera import Camera2D
    from sizeviz.scene.spec import SceneSpec


class Stage:
    """One off-screen window, used for any number of pictures and closed at the end of a ``with`` block.

    Parameters
    ----------
    oversampling : int
        Pixels drawn per pixel asked for, along each side; they are averaged by whoever scales the picture down.
    """

    def __init__(self, oversampling: int = 1) -> None:
        use_offscreen()
        import pyvista

        self.oversampling = oversampling
        self._plotter: Any = pyvista.Plotter(off_screen=True, lighting="none", border=False)
        self._plotter.render_window.SetMultiSamples(1)
        self._renderer = Renderer(self._plotter)
        self._ready = False

    def shoot(self, spec: SceneSpec, camera: Camera2D, width: int, height: int) -> NDArray[np.uint8]:
        """Return the scene as ``(height, width, 3)`` pixels, times the oversampling."""
        # straight to VTK: pyvista's own setter draws once more
        self._plotter.render_window.SetSize(width * self.oversampling, height * self.oversampling)
        self._renderer.show(spec)
        self._renderer.look(camera)
        if not self._ready:
            self._plotter.show(auto_close=False, interactive=False)
            self._ready = True
        self._plotter.render()
        pixels: NDArray[np.uint8] = np.asarray(self._plotter.screenshot(return_img=True))
        return pixels[..., :3]

    def close(self) -> None:
        """Free the window and all that VTK holds for it."""
        self._plotter.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
