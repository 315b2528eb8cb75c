"""Where a flat picture looks: a centre and a height, and the arithmetic of panning and zooming."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sizeviz.scene.spec import Bounds

MARGIN = 1.04
"""How much more than its bounds 'fit' shows."""


@dataclass(frozen=True)
class Camera2D:
    """A view from above onto the plane, x to the right and y up.

    Parameters
    ----------
    x, y : float
        Model point in the middle of the pane.
    height : float
        Model length from its lower to its upper edge, above 0.
    """

    x: float
    y: float
    height: float

    @classmethod
    def fitted(cls, bounds: Bounds, aspect: float, margin: float = MARGIN) -> Camera2D:
        """Return the camera that shows a box in a pane of the given width to height."""
        x0, y0, x1, y1 = bounds
        height = max(y1 - y0, (x1 - x0) / max(aspect, 1e-6)) * margin
        return cls(0.5 * (x0 + x1), 0.5 * (y0 + y1), height or 1.0)

    def to_model(self, px: float, py: float, width: int, height: int) -> tuple[float, float]:
        """Return the model point under a pixel, counted from the pane's upper left corner."""
        unit = self.height / max(height, 1)
        return self.x + (px - 0.5 * width) * unit, self.y - (py - 0.5 * height) * unit

    def to_pixel(self, x: float, y: float, width: int, height: int) -> tuple[float, float]:
        """Return the pixel over a model point, counted from the pane's upper left corner."""
        unit = max(height, 1) / self.height
        return 0.5 * width + (x - self.x) * unit, 0.5 * height - (y - self.y) * unit

    def panned(self, dx: float, dy: float, height: int) -> Camera2D:
        """Return the camera after the picture was dragged by pixels, dy downwards."""
        unit = self.height / max(height, 1)
        return Camera2D(self.x - dx * unit, self.y + dy * unit, self.height)

    def zoomed(self, factor: float, x: float, y: float) -> Camera2D:
        """Return the camera that shows things ``factor`` times larger, the model point (x, y) staying in place."""
        return Camera2D(x + (self.x - x) / factor, y + (self.y - y) / factor, self.height / factor)

    def at(self, x: float, y: float, height: float | None = None) -> Camera2D:
        """Return the camera centred on a model point, optionally at another height of view."""
        return Camera2D(x, y, self.height if height is None else height)

    def box(self, aspect: float) -> Bounds:
        """Return the model box that a pane of the given width to height shows."""
        half_y, half_x = 0.5 * self.height, 0.5 * self.height * aspect
        return self.x - half_x, self.y - half_y, self.x + half_x, self.y + half_y
