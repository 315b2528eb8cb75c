"""How well a mesh could show the image behind its size field: the interpolation error of section 5.2."""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from sizeviz.geometry.arrays import read_only

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.files.image import Image
    from sizeviz.geometry import QuadMesh
    from sizeviz.scene.spec import Bounds

SAMPLES = 4
"""Samples along each side of an element."""

_KNOWN: WeakKeyDictionary[QuadMesh, tuple[Image, NDArray[np.float64]]] = WeakKeyDictionary()


def interpolation_errors(mesh: QuadMesh, image: Image, bounds: Bounds) -> NDArray[np.float64]:
    """Return each element's mean absolute difference between the image and its bilinear interpolant, ``(Q,)``.

    The interpolant takes the image's values at the element's corners. Differences are shares of the image's range of
    intensities, 0 to 1; the image's pixels tile the box ``bounds``. The last answer for a mesh is remembered.
    """
    known = _KNOWN.get(mesh)
    if known is not None and known[0] is image:
        return known[1]
    corners = mesh.points[mesh.quads]
    at_nodes = sampled(image, mesh.points, bounds)[mesh.quads]
    total = np.zeros(mesh.n_quads)
    steps = (np.arange(SAMPLES) + 0.5) / SAMPLES
    for u in steps:
        for v in steps:
            weights = np.array([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])
            where = np.einsum("k,qkd->qd", weights, corners)
            total += np.abs(sampled(image, where, bounds) - at_nodes @ weights)
    spread = float(np.ptp(image.values)) or 1.0
    errors = read_only(total / (SAMPLES**2 * spread))
    _KNOWN[mesh] = image, errors
    return errors


def sampled(image: Image, points: NDArray[np.float64], bounds: Bounds) -> NDArray[np.float64]:
    """Return the image's intensity at model points, bilinear between pixel centres, constant beyond them, ``(N,)``."""
    ny, nx = image.values.shape
    x0, y0, x1, y1 = bounds
    u = np.clip((points[:, 0] - x0) / (x1 - x0) * nx - 0.5, 0.0, nx - 1.0)
    v = np.clip((points[:, 1] - y0) / (y1 - y0) * ny - 0.5, 0.0, ny - 1.0)
    j, i = np.minimum(u.astype(np.intp), nx - 2), np.minimum(v.astype(np.intp), ny - 2)
    s, t = u - j, v - i
    value = image.values
    low = value[i, j] * (1 - s) + value[i, j + 1] * s
    high = value[i + 1, j] * (1 - s) + value[i + 1, j + 1] * s
    return low * (1 - t) + high * t
