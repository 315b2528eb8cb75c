"""Geometric predicates over arrays of points, with exact signs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry import _predicates_kernels as kernels

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def orientations(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> NDArray[np.int8]:
    """Return 1 where the points turn left, -1 where they turn right, 0 where they are exactly collinear.

    Parameters
    ----------
    a, b, c : (N, 2) float64
        Points, broadcast against each other.

    References
    ----------
    Shewchuk (1997), DOI 10.1007/PL00009321.
    """
    return kernels.orientations(*_rows(a, b, c))


def circle_sides(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> NDArray[np.int8]:
    """Return 1 where ``d`` lies inside the circle through ``a, b, c``, -1 outside, 0 exactly on it.

    Parameters
    ----------
    a, b, c, d : (N, 2) float64
        Points, broadcast against each other; ``a, b, c`` turn left (the sign is opposite where they turn right).

    References
    ----------
    Shewchuk (1997), DOI 10.1007/PL00009321.
    """
    return kernels.circle_sides(*_rows(a, b, c, d))


def _rows(*points: ArrayLike) -> list[NDArray[np.float64]]:
    return [np.array(p) for p in np.broadcast_arrays(*(np.asarray(p, dtype=np.float64).reshape(-1, 2) for p in points))]
