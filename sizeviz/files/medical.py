"""Medical images: NIfTI by nibabel, DICOM by pydicom (the extra ``medical``); millimetres become model units."""

from __future__ import annotations

import importlib
import io
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError, MissingDependencyError
from sizeviz.files.convert import luminance, sliced
from sizeviz.files.guard import MAX_BYTES, MAX_PIXELS, check_available, check_nodes, inflated, one_line, quiet, started
from sizeviz.files.image import Image
from sizeviz.files.raw import RawGrid

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sizeviz.files.options import ReadOptions

_DEFLATED = b"1.2.840.10008.1.2.1.99"

_HEADER = 544
"""Bytes of the longer of the two headers of NIfTI, with what says whether extensions follow."""

_SURPLUS = 2**20
"""Bytes that may follow the voxels of a packed file; a file that goes on is not unpacked to its end."""


def parse_nifti(data: bytes, path: Path, options: ReadOptions) -> Image:
    """Return one slice of a NIfTI image, x to the right and y upwards, in the spacing its header gives.

    The axes are the file's own; the oblique directions of the scanner are not followed.

    Raises
    ------
    InputError
        If the file is corrupt, too large, or holds vectors or tensors.
    MissingDependencyError
        If nibabel is not installed.
    """
    nibabel = _needed("nibabel")
    packed = data[:2] == b"\x1f\x8b"
    start = started(data, _HEADER, wbits=31) if packed else data
    volume = nibabel.Nifti2Image if start[:4] in (b"\x1c\x02\0\0", b"\0\0\x02\x1c") else nibabel.Nifti1Image
    with quiet("nibabel.global"):
        header = volume.header_class.from_fileobj(io.BytesIO(start))
        shape = tuple(int(n) for n in header.get_data_shape())
        offset = max(int(header["vox_offset"]), 0)
        needed = _volume_bytes(shape, header.get_data_dtype())
        what = f"its {' x '.join(map(str, shape))} voxels"
        if packed:
            check_available(needed + offset, MAX_BYTES, what)
            data = inflated(data, needed + offset + _SURPLUS, wbits=31)
        check_available(needed, len(data) - offset, what)
        image = volume.from_bytes(data)
        values = _at_time(image.dataobj, shape, options)
    zooms = [float(z) for z in header.get_zooms()[:3]] + [1.0] * 3
    kept = list(shape[:3]) + [1] * (3 - len(shape[:3]))
    grid = RawGrid(
        (kept[0], kept[1], kept[2]),
        np.zeros(3),
        np.array([z if z > 0 else 1.0 for z in zooms[:3]]),
    )
    plane, pixels = sliced(grid, values.reshape(kept, order="A").transpose(2, 1, 0).ravel(), options)
    return Image(pixels, (plane.dx, plane.dy), (plane.x0, plane.y0), path.name)


def parse_dicom(data: bytes, path: Path, options: ReadOptions) -> Image:
    """Return one frame of a DICOM image, upright, rescaled as its header says, in its pixel spacing.

    Raises
    ------
    InputError
        If the file is corrupt, too large, holds no image, or is compressed in a way that pydicom cannot unpack alone.
    MissingDependencyError
        If pydicom is not installed.
    """
    pydicom = _needed("pydicom")
    with quiet("pydicom"):
        if _DEFLATED in data:  # asked before anything unpacks it without a limit
            raise InputError("it is a deflated DICOM file; store it as Explicit VR Little Endian")
        file = pydicom.dcmread(io.BytesIO(data))
        frames = _check_dicom(file)
        number = frames // 2 if options.slice is None else options.slice
        if number >= frames:
            raise InputError(f"slice {number} does not exist; there are slices 0 to {frames - 1}")
        pixels = _decoded(pydicom, io.BytesIO(data), number if frames > 1 else None, file)
        spacing = _pixel_spacing(file)
        slope, intercept = (float(file.get(k, d)) for k, d in (("RescaleSlope", 1.0), ("RescaleIntercept", 0.0)))
    grey = luminance(pixels) if pixels.ndim == 3 else pixels
    grey = slope * grey.astype(np.float64) + intercept
    if str(file.get("PhotometricInterpretation", "")) == "MONOCHROME1":  # stored inverted: white is the least
        grey = grey.max() + grey.min() - grey
    return Image(grey[::-1], spacing, label=path.name)


def _needed(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingDependencyError(
            f"{module} is not installed, which reads this kind of image; run: pip install 'sizeviz[medical]'"
        ) from error


def _volume_bytes(shape: tuple[int, ...], dtype: np.dtype[Any]) -> int:
    """Return how many bytes the voxels take; whether they can be shown is checked."""
    if len(shape) < 2 or any(n < 1 for n in shape):
        raise InputError(f"its shape is {shape}; an image of two or three dimensions is needed")
    if (len(shape) > 4 and max(shape[4:]) > 1) or dtype.names or dtype.kind not in "biuf":
        raise InputError(
            f"it holds vectors, tensors or colours (shape {shape}, {dtype}); one number a voxel is supported"
        )
    needed = int(dtype.itemsize)
    for n in shape:
        needed *= n
    return needed


def _at_time(stored: Any, shape: tuple[int, ...], options: ReadOptions) -> NDArray[Any]:
    frames = shape[3] if len(shape) > 3 else 1
    if options.frame >= frames:
        raise InputError(f"frame {options.frame} does not exist; there are frames 0 to {frames - 1}")
    where = (slice(None), slice(None), slice(None), options.frame)[: len(shape)] + (0,) * (len(shape) - 4)
    return np.asarray(stored[where])


def _check_dicom(file: Any) -> int:
    """Return the number of frames of an image of a size that can be read."""
    if "PixelData" not in file:
        raise InputError("it holds no pixel data of whole numbers; give a DICOM image")
    rows, columns = int(file.get("Rows", 0)), int(file.get("Columns", 0))
    frames = int(file.get("NumberOfFrames", 1) or 1)
    samples = int(file.get("SamplesPerPixel", 1) or 1)
    check_nodes(rows * columns, "pixels", MAX_PIXELS)
    check_nodes(samples, "samples a pixel", 4)
    check_nodes(frames, "frames", 100_000)
    if min(rows, columns, frames) < 1:
        raise InputError(f"it is an image of {rows} x {columns} pixels in {frames} frames; the header is corrupt")
    if not file.file_meta.TransferSyntaxUID.is_compressed:
        bits = int(file.get("BitsAllocated", 0))
        check_available(rows * columns * samples * frames * bits // 8, len(file.PixelData), "its pixels")
    return frames


def _decoded(pydicom: Any, stream: io.BytesIO, number: int | None, file: Any) -> NDArray[Any]:
    syntax = file.file_meta.TransferSyntaxUID
    try:
        pixels: NDArray[Any] = pydicom.pixels.pixel_array(stream, index=number)
    except (RuntimeError, NotImplementedError) as error:
        if not syntax.is_compressed:
            raise
        found = f"its pixels are compressed ({one_line(syntax.name, 60)}) and cannot be unpacked here"
        raise InputError(f"{found}; store it uncompressed, for example with: gdcmconv --raw IN OUT") from error
    return pixels


def _pixel_spacing(file: Any) -> tuple[float, float]:
    """Return the spacing along x and y: DICOM gives the distance between rows first."""
    values = file.get("PixelSpacing") or file.get("ImagerPixelSpacing") or (1.0, 1.0)
    between_rows, between_columns = (float(v) for v in values)
    return between_columns, between_rows
