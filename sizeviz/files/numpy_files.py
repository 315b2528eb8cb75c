"""NumPy arrays, ``.npy`` and ``.npz``: sizes or intensities on grids, and sizes on triangulations.

In an ``.npz`` sizeviz keeps ``sizes`` with ``grid`` (x0, y0, dx, dy), or with ``points`` and ``triangles``. Pickled
objects are never read.
"""

from __future__ import annotations

import ast
import io
import struct
import zipfile
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.convert import SIZE_NAMES, field_of, luminance
from sizeviz.files.guard import MAX_BYTES, check_available, check_nodes, one_line
from sizeviz.files.image import Image
from sizeviz.files.raw import Cells, RawMesh
from sizeviz.sizing import BackgroundMesh, Grid, SizeField

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from sizeviz.files.options import ReadOptions

MAX_MEMBERS = 1000
"""Most members of an archive."""

_MAX_HEADER = 10_000


def parse_field(data: bytes, path: Path, options: ReadOptions) -> SizeField:
    """Return the field of a 2-D array of sizes, row 0 at the smallest y, or of sizes at the nodes of triangles.

    A grid spans ``x`` and ``y`` of an ``.npz``, else ``options.extent``, else the unit square.

    Raises
    ------
    InputError
        If the file is corrupt, or holds no array that can be sizes.
    """
    arrays = named_arrays(data)
    if "points" in arrays and "triangles" in arrays:
        return field_of(_triangulation(arrays), path.name, options)
    sizes = _chosen(arrays, options.array, SIZE_NAMES)
    if sizes.dtype.kind not in "fiu" or sizes.ndim != 2 or min(sizes.shape) < 2:
        hint = "; tensors and volumes are not supported" if sizes.ndim > 2 else ""
        raise InputError(
            f"it holds {sizes.dtype} of shape {sizes.shape}; give a 2-D array of sizes, at least 2 x 2{hint}"
        )
    ny, nx = sizes.shape
    check_nodes(sizes.size)
    return SizeField(
        BackgroundMesh.regular(_grid(arrays, nx, ny, options)), sizes.astype(np.float64).ravel(), path.name
    )


def parse_image(data: bytes, path: Path, options: ReadOptions) -> Image:
    """Return the image in a 2-D array, or in one with 3 or 4 colours a pixel; row 0 is at the smallest y.

    Raises
    ------
    InputError
        If the file is corrupt, or holds no such array.
    """
    arrays = named_arrays(data)
    pixels = _chosen(arrays, options.array, ("intensity", "image"))
    if pixels.dtype.kind not in "bfiu" or pixels.ndim not in (2, 3):
        raise InputError(f"it holds {pixels.dtype} of shape {pixels.shape}; give a 2-D array of intensities")
    grey = luminance(pixels) if pixels.ndim == 3 else pixels
    if {"x", "y"} <= set(arrays) or "grid" in arrays:
        grid = _grid(arrays, grey.shape[1], grey.shape[0], options)
        return Image(grey, (grid.dx, grid.dy), (grid.x0, grid.y0), path.name)
    return Image(grey, label=path.name)


def written_npy(field: SizeField) -> list[bytes]:
    """Return a .npy file of a field on a grid: the sizes alone, ``(ny, nx)``.

    Raises
    ------
    InputError
        If the background is no grid.
    """
    grid = field.background.grid
    if grid is None:
        raise InputError(f"{field.label}: is not on a regular grid, which .npy needs; write .npz or .vtu instead")
    return [npy(field.sizes.reshape(grid.ny, grid.nx))]


def written_npz(field: SizeField) -> list[bytes]:
    """Return an .npz file of a field, with the grid or the triangulation that it lives on."""
    background = field.background
    grid = background.grid
    if grid is None:
        return [npz({"sizes": field.sizes, "points": background.points, "triangles": background.triangles})]
    where = np.array([grid.x0, grid.y0, grid.dx, grid.dy])
    return [npz({"sizes": field.sizes.reshape(grid.ny, grid.nx), "grid": where})]


def npy(array: NDArray[Any]) -> bytes:
    """Return an array as the bytes of a .npy file."""
    buffer = io.BytesIO()
    np.lib.format.write_array(buffer, np.asarray(array), allow_pickle=False)
    return buffer.getvalue()


def npz(arrays: dict[str, NDArray[Any]]) -> bytes:
    """Return named arrays as the bytes of an .npz file, the same for the same arrays."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=4) as archive:
        for name, array in arrays.items():
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), npy(array), zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def read_npy(data: bytes) -> NDArray[Any]:
    """Return the array in the bytes of a .npy file; nothing is allocated before the sizes are checked.

    Raises
    ------
    InputError
        If it is corrupt, or holds Python objects.
    """
    if data[:6] != b"\x93NUMPY" or len(data) < 12:
        raise InputError("it is not a NumPy file; save it again with numpy.save")
    width = 2 if data[6] == 1 else 4
    start = 8 + width
    length = struct.unpack_from("<H" if width == 2 else "<I", data, 8)[0]
    check_available(length, min(len(data) - start, _MAX_HEADER), "the header")
    try:
        header = ast.literal_eval(data[start : start + length].decode("latin-1").strip())
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InputError("its header is corrupt; save it again with numpy.save") from None
    if not isinstance(header, dict) or not {"descr", "fortran_order", "shape"} <= set(header):
        raise InputError("its header is corrupt; save it again with numpy.save")
    dtype, shape = np.dtype(np.lib.format.descr_to_dtype(header["descr"])), header["shape"]
    if dtype.hasobject:
        raise InputError("it holds Python objects, which are never read; save plain numbers")
    if not (isinstance(shape, tuple) and all(type(n) is int and n >= 0 for n in shape)):
        raise InputError("its shape is corrupt; save it again with numpy.save")
    count = 1
    for n in shape:
        count *= n
    check_available(count * dtype.itemsize, len(data) - start - length, f"an array of shape {one_line(shape, 60)}")
    flat = np.frombuffer(data, dtype, count, start + length) if count else np.empty(0, dtype)
    return flat.reshape(shape, order="F" if header["fortran_order"] else "C")


def members(data: bytes, limit: int = MAX_BYTES) -> Iterator[tuple[str, bytes]]:
    """Yield the name and content of each member of a zip archive, none of which may unpack beyond the limit.

    Raises
    ------
    InputError
        If it is no zip archive, is corrupt or encrypted, or unpacks to more than ``limit`` bytes in all.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            listed = archive.infolist()
            check_nodes(len(listed), "members", MAX_MEMBERS)
            check_available(sum(info.file_size for info in listed), limit, "the unpacked content")
            for info in listed:
                with archive.open(info) as member:
                    content = member.read(info.file_size + 1)  # what the directory says is not to be trusted
                if len(content) != info.file_size:
                    raise InputError(f"member {one_line(info.filename, 60)!r} is not as long as announced")
                yield info.filename, content
    except (zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError) as error:
        raise InputError(f"its archive cannot be unpacked ({one_line(error, 80)}); save it again") from None


def named_arrays(data: bytes) -> dict[str, NDArray[Any]]:
    """Return the arrays of an .npz by name, or of an .npy as ``sizes``.

    Raises
    ------
    InputError
        As ``read_npy`` and ``members``.
    """
    if data[:2] != b"PK":
        return {"sizes": read_npy(data)}
    arrays = {name.removesuffix(".npy"): read_npy(content) for name, content in members(data) if name.endswith(".npy")}
    if not arrays:
        raise InputError("it holds no array; save it again with numpy.savez")
    return arrays


def _chosen(arrays: dict[str, NDArray[Any]], name: str | None, usual: tuple[str, ...]) -> NDArray[Any]:
    if name is None:
        flat = [key for key, array in arrays.items() if array.ndim >= 2]
        name = next((key for key in usual if key in arrays), flat[0] if len(flat) == 1 else None)
    if name is None or name not in arrays:
        found = ", ".join(one_line(key, 40) for key in list(arrays)[:12])
        raise InputError(f"it has no array {name or usual[0]!r} (found: {found}); name the one to use")
    return arrays[name]


def _triangulation(arrays: dict[str, NDArray[Any]]) -> RawMesh:
    points, triangles = arrays["points"], arrays["triangles"]
    if points.ndim != 2 or points.shape[1] not in (2, 3) or points.dtype.kind not in "fiu":
        raise InputError(f"its points have shape {points.shape}; expected (N, 2)")
    if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
        raise InputError(f"its triangles have shape {triangles.shape}; expected (M, 3) whole numbers")
    space = np.zeros((len(points), 3))
    space[:, : points.shape[1]] = points
    data = {name: array for name, array in arrays.items() if name not in ("points", "triangles")}
    numeric = {name: array for name, array in data.items() if array.dtype.kind in "fiu" and array.ndim}
    return RawMesh(space, (Cells("triangle", triangles.astype(np.int64), np.arange(len(triangles))),), numeric)


def _grid(arrays: dict[str, NDArray[Any]], nx: int, ny: int, options: ReadOptions) -> Grid:
    where = arrays.get("grid")
    if where is not None and where.shape == (4,) and where.dtype.kind == "f" and np.isfinite(where).all():
        x0, y0, dx, dy = map(float, where)
        return Grid(x0, y0, dx, dy, nx, ny)
    x0, y0, x1, y1 = options.extent or (0.0, 0.0, 1.0, 1.0)
    x0, dx = _axis(arrays.get("x"), nx, x0, x1, "x")
    y0, dy = _axis(arrays.get("y"), ny, y0, y1, "y")
    return Grid(x0, y0, dx, dy, nx, ny)


def _axis(values: NDArray[Any] | None, count: int, low: float, high: float, name: str) -> tuple[float, float]:
    """Return the first coordinate and the spacing of one axis."""
    if values is None:
        return low, (high - low) / (count - 1)
    if values.dtype.kind not in "fiu" or values.shape != (count,) or not np.isfinite(values).all():
        raise InputError(f"{name} must hold {count} finite coordinates; it has shape {values.shape}")
    steps = np.diff(values.astype(np.float64))
    spacing = float(values[-1] - values[0]) / (count - 1)
    if not (steps > 0).all() or not np.allclose(steps, spacing, rtol=1e-6, atol=0):
        raise InputError(f"{name} must grow in equal steps; resample the field onto a regular grid")
    return float(values[0]), spacing
