"""Random size fields for sweeps: point sources, valleys, spirals, noise, plateaus, on a grid over a domain's box."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import gaussian_filter

from sizeviz.sizing import BackgroundMesh, Grid, SizeField

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sizeviz.geometry import Domain

KINDS = ("points", "valleys", "spiral", "noise", "plateaus", "steps")


def random_field(kind: str, rng: np.random.Generator, domain: Domain, *, ratio: float, nodes: int = 257) -> SizeField:
    """Return a field between ``h`` and ``ratio * h``, where h is chosen so that meshes stay below about 60k quads.

    Parameters
    ----------
    kind : str
        One of ``KINDS``.
    rng : numpy.random.Generator
        Where the randomness comes from.
    domain : Domain
        Whose bounding box the background covers.
    ratio : float
        Largest size over smallest.
    nodes : int
        Background nodes along the longer side.
    """
    x0, y0, x1, y1 = domain.bounds
    step = max(x1 - x0, y1 - y0) / (nodes - 1)
    grid = Grid(
        x0, y0, step, step, max(2, int(np.ceil((x1 - x0) / step)) + 1), max(2, int(np.ceil((y1 - y0) / step)) + 1)
    )
    background = BackgroundMesh.regular(grid)
    shape = _PATTERNS[kind](background.points - [x0, y0], max(x1 - x0, y1 - y0), rng, grid)
    shape = (shape - shape.min()) / max(np.ptp(shape), 1e-300)
    largest = max(x1 - x0, y1 - y0) / rng.uniform(5.0, 20.0)
    sizes = largest * ratio ** (shape - 1.0)
    # a background cannot hold a valley narrower than its cells: keep the smallest size at a quarter of a cell or more
    return SizeField(background, np.maximum(sizes, 0.25 * step), f"random {kind}")


def _points(p: NDArray, width: float, rng: np.random.Generator, grid: Grid) -> NDArray:
    seeds = rng.uniform(0, 1, (rng.integers(1, 9), 2)) * [grid.dx * (grid.nx - 1), grid.dy * (grid.ny - 1)]
    distance = np.sqrt(((p[:, None] - seeds) ** 2).sum(axis=2)).min(axis=1)
    return np.minimum(distance, 0.4 * width) ** rng.uniform(0.3, 1.0)


def _valleys(p: NDArray, width: float, rng: np.random.Generator, grid: Grid) -> NDArray:
    out = np.full(len(p), np.inf)
    for _ in range(rng.integers(1, 4)):
        angle, offset = rng.uniform(0, np.pi), rng.uniform(-0.3, 0.3) * width
        out = np.minimum(out, np.abs((p - 0.5 * width) @ [np.cos(angle), np.sin(angle)] - offset))
    return np.minimum(out, 0.3 * width)


def _spiral(p: NDArray, width: float, rng: np.random.Generator, grid: Grid) -> NDArray:
    q = p - 0.5 * width
    radius, angle = np.hypot(*q.T), np.arctan2(q[:, 1], q[:, 0])
    pitch = width / rng.uniform(3, 7)
    return np.abs((radius - pitch * angle / (2 * np.pi)) / pitch % 1.0 - 0.5)


def _noise(p: NDArray, width: float, rng: np.random.Generator, grid: Grid) -> NDArray:
    return gaussian_filter(rng.normal(size=(grid.ny, grid.nx)), rng.uniform(4, 20), mode="nearest").ravel()


def _plateaus(p: NDArray, width: float, rng: np.random.Generator, grid: Grid) -> NDArray:
    smooth = _noise(p, width, rng, grid)
    return np.digitize(smooth, np.quantile(smooth, [0.25, 0.5, 0.75])).astype(float)


def _steps(p: NDArray, width: float, rng: np.random.Generator, grid: Grid) -> NDArray:
    angle = rng.uniform(0, np.pi)
    along = p @ [np.cos(angle), np.sin(angle)]
    return (along > np.median(along)).astype(float)


_PATTERNS: dict[str, Callable[[NDArray, float, np.random.Generator, Grid], NDArray]] = {
    "points": _points,
    "valleys": _valleys,
    "spiral": _spiral,
    "noise": _noise,
    "plateaus": _plateaus,
    "steps": _steps,
}
