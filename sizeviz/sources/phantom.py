"""A synthetic cardiac short-axis phantom: a drawing of a slice through a chest, made here, of nobody.

It stands for the cardiac image of the paper's Section 5.2, which no package ships: two blood pools, a ring of heart
muscle with papillary muscles, lungs, fat and a spine, with edges as soft as a scanner's.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.files import Image
from sizeviz.geometry import Domain
from sizeviz.sources.pictures import size_from_curvature
from sizeviz.sources.source import Source

if TYPE_CHECKING:
    from numpy.typing import NDArray

PIXELS = 256
"""Pixels along each side."""

SOFTNESS = 1.2
"""Width of an edge, in pixels."""

TOLERANCE = 1e-3
"""Share of the range of intensities: h* at alpha = 2 then asks for about 115,000 elements."""


@dataclass(frozen=True)
class Ellipse:
    """A part of the drawing; later parts cover earlier ones.

    Parameters
    ----------
    x, y : float
        Centre, in -1..1, y upwards.
    a, b : float
        Half axes.
    level : float
        Intensity, 0 to 1.
    turn : float
        Angle of the first axis, in degrees.
    """

    x: float
    y: float
    a: float
    b: float
    level: float
    turn: float = 0.0

    def cover(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how much of each pixel is covered, 0 to 1, falling off over the width of an edge."""
        angle = np.deg2rad(self.turn)
        u = (x - self.x) * np.cos(angle) + (y - self.y) * np.sin(angle)
        v = (y - self.y) * np.cos(angle) - (x - self.x) * np.sin(angle)
        radius = np.hypot(u / self.a, v / self.b)
        slope = np.maximum(np.hypot(u / self.a**2, v / self.b**2) / np.maximum(radius, 1e-9), 1e-9)
        depth = (1.0 - radius) / slope * (0.5 * PIXELS / SOFTNESS)
        return 0.5 * (1.0 + np.tanh(depth))


PARTS: tuple[Ellipse, ...] = (
    Ellipse(0.0, 0.0, 0.94, 0.74, 0.78),  # skin and fat
    Ellipse(0.0, 0.0, 0.88, 0.68, 0.36),  # muscle
    Ellipse(-0.52, 0.05, 0.27, 0.44, 0.06, 8.0),  # right lung
    Ellipse(0.55, 0.02, 0.25, 0.46, 0.06, -10.0),  # left lung
    Ellipse(0.0, -0.5, 0.1, 0.1, 0.5),  # spine
    Ellipse(0.0, -0.5, 0.035, 0.035, 0.85),  # its canal
    Ellipse(0.16, -0.36, 0.055, 0.055, 0.88),  # aorta
    Ellipse(0.03, 0.06, 0.44, 0.36, 0.7, -20.0),  # fat around the heart
    Ellipse(0.03, 0.06, 0.41, 0.33, 0.32, -20.0),  # wall
    Ellipse(-0.09, 0.1, 0.27, 0.25, 0.86, -25.0),  # right ventricle
    Ellipse(0.14, 0.02, 0.275, 0.265, 0.3),  # muscle of the left ventricle
    Ellipse(0.14, 0.02, 0.175, 0.165, 0.95),  # left ventricle
    Ellipse(0.215, 0.095, 0.035, 0.028, 0.32, 40.0),  # papillary muscles
    Ellipse(0.2, -0.07, 0.03, 0.036, 0.32, 20.0),
)
"""The drawing, back to front."""


def short_axis_image() -> Image:
    """Return the drawing over the unit square, intensities from 0 to 1."""
    at = (np.arange(PIXELS) + 0.5) * (2.0 / PIXELS) - 1.0
    x, y = np.meshgrid(at, at)
    values = np.full((PIXELS, PIXELS), 0.02)
    for part in PARTS:
        cover = part.cover(x, y)
        values = (1.0 - cover) * values + cover * part.level
    shading = 1.0 - 0.12 * np.hypot(x - 0.2, y - 0.7) ** 2 / 2.0  # the coil lies on the chest
    step = 1.0 / PIXELS
    return Image(values * shading, (step, step), (0.5 * step, 0.5 * step), label="synthetic short-axis phantom")


def phantom() -> Source:
    """Return the phantom, with sizes from its curvature, from 1/700 to 1/20."""
    image = short_axis_image()
    field = size_from_curvature(image, tolerance=TOLERANCE, nodes_a_pixel=2)
    return Source(
        name="phantom",
        label="Synthetic cardiac short-axis phantom: sizes from the curvature of a drawn image",
        domain=Domain.unit_square(),
        field=field,
        reference=field,
        image=image,
        provenance={"kind": "synthetic", "data": "drawn by sizeviz; not a recording of anybody"},
    )
