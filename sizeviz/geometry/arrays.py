"""Checks that turn what a caller hands over into the frozen arrays that the nouns hold."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Scalar = TypeVar("Scalar", bound=np.generic)


def read_only(array: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return the array, C-contiguous and no longer writable through this reference.

    An array that owns its data and is already contiguous is not copied: its builder hands it over.
    """
    frozen = np.ascontiguousarray(array)
    if frozen is array and frozen.flags.writeable:
        frozen = frozen.view()
    frozen.flags.writeable = False
    return frozen


def as_points(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return ``value`` as finite ``(N, 2)`` float64 points.

    Raises
    ------
    InputError
        If the shape is wrong or a coordinate is not finite; ``name`` says which input it is.
    """
    points = np.asarray(value, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2:
        raise InputError(f"{name}: expected points of shape (N, 2), got {points.shape}; give x and y columns")
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        raise InputError(f"{name}: point {int(np.argmax(bad))} is not finite; remove or repair it")
    return read_only(points)


def as_cells(value: ArrayLike, corners: int, n_points: int, name: str) -> NDArray[np.int32]:
    """Return ``value`` as ``(M, corners)`` int32 rows of point indices below ``n_points``.

    Raises
    ------
    InputError
        If the shape is wrong or an index is out of range.
    """
    cells = np.asarray(value)
    if cells.ndim != 2 or cells.shape[1] != corners:
        raise InputError(f"{name}: expected cells of shape (M, {corners}), got {cells.shape}")
    if len(cells) and (cells.min() < 0 or cells.max() >= n_points):
        raise InputError(f"{name}: a cell names a point outside 0..{n_points - 1}; the connectivity is corrupt")
    return read_only(cells.astype(np.int32, copy=False))


def as_sizes(value: ArrayLike, count: int, name: str) -> NDArray[np.float64]:
    """Return ``value`` as ``(count,)`` float64 sizes, all finite and above zero.

    Raises
    ------
    InputError
        If the shape is wrong, or a size is NaN, infinite, zero or negative.
    """
    sizes = np.asarray(value, dtype=np.float64)
    if sizes.shape != (count,):
        raise InputError(f"{name}: expected {count} sizes, one a node, got shape {sizes.shape}")
    if count == 0:
        raise InputError(f"{name}: the field is empty; give at least one node")
    for bad, what in ((np.isnan(sizes), "NaN"), (np.isinf(sizes), "infinite"), (sizes <= 0, "not above zero")):
        if bad.any():
            raise InputError(
                f"{name}: {int(bad.sum())} of {count} sizes {'is' if bad.sum() == 1 else 'are'} {what} "
                f"(first at node {int(np.argmax(bad))}); element sizes must be finite and positive"
            )
    return read_only(sizes)
