"""A sheet of pixels for words, pictures and colour bars; text in DejaVu Sans, which every install brings along."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from PIL import Image as Pillow
from PIL import ImageDraw, ImageFont

from sizeviz.errors import InputError
from sizeviz.files import replacing

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.scene.scale import ColorScale
    from sizeviz.scene.spec import Color

Box = tuple[int, int, int, int]
"""Left, top, right, bottom, in pixels."""


class Canvas:
    """A sheet to draw on.

    Parameters
    ----------
    width, height : int
        Size in pixels.
    ground, ink : Color
        Colour of the sheet and of what is written on it.
    """

    def __init__(self, width: int, height: int, ground: Color, ink: Color) -> None:
        self.image = Pillow.new("RGB", (width, height), ground)
        self.ground, self.ink = ground, ink
        self._draw = ImageDraw.Draw(self.image)

    @property
    def faint(self) -> Color:
        """Ink for what may stand back: half way to the ground."""
        return _blend(self.ink, self.ground, 0.42)

    def text(
        self,
        x: float,
        y: float,
        words: str,
        size: int,
        *,
        bold: bool = False,
        color: Color | None = None,
        anchor: str = "la",
    ) -> None:
        """Write a line; ``anchor`` as in Pillow: l, m, r for the side and a, m, s, d for the height."""
        self._draw.text((x, y), words, font=font(size, bold), fill=color or self.ink, anchor=anchor)

    def picture(self, pixels: NDArray[np.uint8], box: Box, frame: bool = True) -> None:
        """Paste a picture, scaled to a box, with a hairline around it."""
        left, top, right, bottom = box
        picture = Pillow.fromarray(pixels)
        if picture.size != (right - left, bottom - top):
            picture = picture.resize((right - left, bottom - top), Pillow.Resampling.BOX)
        self.image.paste(picture, (left, top))
        if frame:
            self.rectangle((left - 1, top - 1, right, bottom), _blend(self.ink, self.ground, 0.7))

    def rectangle(self, box: Box, color: Color, width: int = 1) -> None:
        """Draw an empty rectangle."""
        self._draw.rectangle(box, outline=color, width=width)

    def dot(self, x: float, y: float, radius: float, color: Color) -> None:
        """Draw a filled disc."""
        self._draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=color)

    def bar(self, scale: ColorScale, box: Box, size: int) -> None:
        """Draw a horizontal colour bar with its title above and its ticks below."""
        left, top, right, bottom = box
        self.text(left, top - size * 0.55, scale.title, size, anchor="ls", color=self.faint)
        strip = np.broadcast_to(scale.bar(right - left)[None], (bottom - top, right - left, 3))
        self.picture(np.ascontiguousarray(strip), box)
        for at, label in scale.ticks():
            x = left + at * (right - left)
            self._draw.line((x, bottom, x, bottom + size // 3), fill=self.faint, width=max(1, size // 12))
            self.text(x, bottom + size * 0.5, label, size, anchor="ma")

    def save(self, path: Path) -> None:
        """Write the sheet as PNG or another raster format by its suffix, whole or not at all."""
        save_raster(self.image, path)


def text_width(words: str, size: int, bold: bool = False) -> float:
    """Return how long a line of text is, in pixels."""
    return float(font(size, bold).getlength(words))


@cache
def font(size: int, bold: bool = False) -> ImageFont.FreeTypeFont:
    """Return DejaVu Sans at a size in pixels, from matplotlib's own copy."""
    spec = find_spec("matplotlib")
    root = Path(next(iter(spec.submodule_search_locations or ()))) if spec else Path()
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(str(root / "mpl-data" / "fonts" / "ttf" / name), size)


def save_raster(image: Pillow.Image, path: Path) -> None:
    """Write a picture beside its place and move it there, so that nobody ever sees half of it.

    Raises
    ------
    InputError
        If the place cannot be written, or the suffix names no picture format.
    """
    suffix = path.suffix.lower().lstrip(".")
    formats: dict[str, Literal["PNG", "JPEG", "TIFF", "WEBP"]] = {
        "png": "PNG", "jpg": "JPEG", "jpeg": "JPEG", "tif": "TIFF", "tiff": "TIFF", "webp": "WEBP",
    }  # fmt: skip
    if suffix not in formats:
        raise InputError(f"{path}: no picture format for {path.suffix!r}; use .png, .jpg, .tif, .webp, .svg or .pdf")
    with replacing(path) as part:
        image.save(part, formats[suffix], **({"compress_level": 3} if suffix == "png" else {}))


def _blend(color: Color, other: Color, share: float) -> Color:
    r, g, b = (round(a + (c - a) * share) for a, c in zip(color, other, strict=True))
    return r, g, b
