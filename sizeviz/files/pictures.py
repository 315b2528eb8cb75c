"""Pictures: PNG, TIFF and JPEG of 8 or 16 bits (TIFF also of 32), colour to luminance."""

from __future__ import annotations

import io
from contextlib import nullcontext
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.convert import luminance
from sizeviz.files.guard import MAX_PIXELS, check_nodes, quiet, silent_stderr
from sizeviz.files.image import Image

if TYPE_CHECKING:
    from pathlib import Path

    from sizeviz.files.options import ReadOptions


def parse(data: bytes, path: Path, options: ReadOptions) -> Image:
    """Return a picture as intensities, upright: the lowest row of pixels is row 0.

    Grey values stay as they are stored (8-bit ones run from 0 to 255, 16-bit ones to 65535); colours become Rec. 709
    luma of the stored values; transparency is left out; a pixel is one unit wide.

    Raises
    ------
    InputError
        If the file is no PNG, TIFF or JPEG, is corrupt or too large.
    """
    import PIL.Image
    import PIL.ImageOps

    with quiet("PIL.TiffImagePlugin"):  # what Pillow warns of is checked here, or an error
        try:
            picture = PIL.Image.open(io.BytesIO(data), formats=("PNG", "TIFF", "JPEG"))
        except PIL.UnidentifiedImageError:
            raise InputError("it is no PNG, TIFF or JPEG picture; convert it to one of these") from None
        except PIL.Image.DecompressionBombError:
            raise InputError(f"it has more than {MAX_PIXELS} pixels; make the picture smaller") from None
        check_nodes(picture.width * picture.height, "pixels", MAX_PIXELS)
        frame = options.slice or 0
        if frame >= getattr(picture, "n_frames", 1):
            raise InputError(f"page {frame} does not exist; the picture has {getattr(picture, 'n_frames', 1)}")
        if frame:
            picture.seek(frame)
            check_nodes(picture.width * picture.height, "pixels", MAX_PIXELS)
        with silent_stderr() if picture.format == "TIFF" else nullcontext():
            upright = PIL.ImageOps.exif_transpose(picture)
            upright.load()
        if upright.mode in ("P", "PA", "CMYK", "YCbCr", "LAB", "HSV", "1"):
            upright = upright.convert("L" if upright.mode == "1" else "RGB")
        pixels = np.asarray(upright)
    grey = pixels if pixels.ndim == 2 else luminance(pixels)
    return Image(grey[::-1], label=path.name)
