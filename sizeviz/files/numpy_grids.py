"""Size fields on regular grids as NumPy arrays: ``.npy``, or ``.npz`` with ``sizes`` and optional ``x``, ``y``."""

from __future__ import annotations

import zipfile
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.sizing import BackgroundMesh, Grid, SizeField

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from sizeviz.geometry import Domain


def read_field(path: Path, domain: Domain | None = None) -> SizeField:
    """Return the field of a 2-D array of sizes, row 0 at the smallest y.

    The grid spans ``x`` and ``y`` of an ``.npz``, else the bounds of the domain, else the unit square.

    Raises
    ------
    InputError
        If the file is corrupt, the array is not 2-D, or a size is not finite and above 0.
    """
    arrays = _arrays(path)
    sizes = arrays.get("sizes")
    if sizes is None:
        raise InputError(f"{path}: has no array called 'sizes', only {', '.join(arrays) or 'nothing'}; add it")
    if sizes.dtype.kind not in "fiu" or sizes.ndim != 2 or min(sizes.shape) < 2:
        raise InputError(
            f"{path}: holds {sizes.dtype} of shape {sizes.shape}; give a 2-D array of sizes, at least 2 x 2"
        )
    ny, nx = sizes.shape
    x0, y0, x1, y1 = domain.bounds if domain is not None else (0.0, 0.0, 1.0, 1.0)
    x0, dx = _axis(arrays.get("x"), nx, x0, x1, f"{path}: x")
    y0, dy = _axis(arrays.get("y"), ny, y0, y1, f"{path}: y")
    background = BackgroundMesh.regular(Grid(x0, y0, dx, dy, nx, ny))
    return SizeField(background, sizes.astype(np.float64).ravel(), label=path.name)


def write_field(path: Path, field: SizeField) -> None:
    """Write a field that lives on a regular grid; ``.npz`` keeps the axes, ``.npy`` the sizes alone.

    Raises
    ------
    InputError
        If the background is no grid.
    """
    grid = field.background.grid
    if grid is None:
        raise InputError(f"{field.label}: is not on a regular grid, which .npy and .npz need; write .vtu instead")
    sizes = np.asarray(field.sizes).reshape(grid.ny, grid.nx)
    with path.open("wb") as file:
        if path.suffix.lower() == ".npy":
            np.save(file, sizes)
            return
        x, y = grid.x0 + grid.dx * np.arange(grid.nx), grid.y0 + grid.dy * np.arange(grid.ny)
        np.savez_compressed(file, sizes=sizes, x=x, y=y)


def _arrays(path: Path) -> dict[str, NDArray[np.float64]]:
    try:
        loaded = np.load(path, allow_pickle=False)
        if isinstance(loaded, np.ndarray):
            return {"sizes": loaded}
        with loaded:
            return {name: loaded[name] for name in loaded.files}
    except (ValueError, OSError, EOFError, KeyError, zipfile.BadZipFile, zipfile.LargeZipFile) as problem:
        raise InputError(f"{path}: is not a NumPy file that can be read; save it again with numpy.save") from problem


def _axis(values: NDArray[np.float64] | None, count: int, low: float, high: float, name: str) -> tuple[float, float]:
    """Return the first coordinate and the spacing of one axis."""
    if values is None:
        return low, (high - low) / (count - 1)
    if values.dtype.kind not in "fiu" or values.shape != (count,) or not np.isfinite(values).all():
        raise InputError(f"{name}: must hold {count} finite coordinates, one a column or row; got {values.shape}")
    steps = np.diff(values.astype(np.float64))
    spacing = float(values[-1] - values[0]) / (count - 1)
    if not (steps > 0).all() or not np.allclose(steps, spacing, rtol=1e-6, atol=0):
        raise InputError(f"{name}: must grow in equal steps; resample the field onto a regular grid")
    return float(values[0]), spacing
