"""Random size fields for sweeps: points, valleys, spirals, noise, plateaus, steps, on grids and triangulations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates

from sizeviz.geometry import Domain
from sizeviz.geometry.delaunay import delaunay
from sizeviz.meshing import MeshOptions, generated
from sizeviz.sizing import (
    BackgroundMesh,
    Grid,
    LimitOptions,
    PreserveOptions,
    SizeField,
    ideal_count,
    limited,
    preserved,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Pattern = Callable[[NDArray[np.float64]], NDArray[np.float64]]

KINDS = ("points", "valleys", "spiral", "noise", "plateaus", "steps")

BACKGROUNDS = ("grid", "triangles")


def random_field(
    kind: str,
    rng: np.random.Generator,
    domain: Domain,
    *,
    ratio: float,
    most: float,
    options: PreserveOptions,
    background: str = "grid",
) -> tuple[SizeField, SizeField, float]:
    """Return a field whose largest size is ``ratio`` times its smallest, and the preserved one.

    The largest size is a fifth to a twentieth of the domain's width. Where the preserved field asks for more than
    ``most`` elements all sizes grow, up to a bound; what that cannot do, a lower ratio does.

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
    most : float
        Elements that the preserved field may ask for.
    options : PreserveOptions
        How it is preserved.
    background : str
        One of ``BACKGROUNDS``: a regular grid of 65 to 257 nodes along the longer side, or triangles
        graded towards the smallest sizes, down to a hundredth of the widest.

    Returns
    -------
    field, target : SizeField
        The random field, and the preserved one.
    asked : float
        Elements that ``target`` asks for.
    """
    x0, y0, x1, y1 = domain.bounds
    width = max(x1 - x0, y1 - y0)
    box = np.array([x1 - x0, y1 - y0]) / width
    pattern = _PATTERNS[kind](rng, box)
    nodes = int(rng.choice([65, 129, 257]))
    mesh = _grid(domain, nodes) if background == "grid" else _graded(domain, nodes, pattern)
    shape = pattern((mesh.points - [x0, y0]) / width)
    shape = (shape - shape.min()) / max(float(np.ptp(shape)), 1e-300)
    steady, bound = rng.random() < 0.5, width * rng.uniform(0.2, 1.0)
    largest = width / rng.uniform(5.0, 20.0)
    while True:
        share = 1.0 / ratio + (1.0 - 1.0 / ratio) * shape if steady else ratio ** (shape - 1.0)
        field = SizeField(mesh, largest * share, f"random {kind}")
        target = preserved(field, options)
        asked = ideal_count(target, domain)
        if asked <= most:
            return field, target, asked
        if largest < bound:
            largest *= min(2.0, 1.05 * np.sqrt(asked / most))
        elif ratio > 4.0:
            ratio = max(4.0, 0.5 * ratio)
        else:
            bound *= 2.0


def _grid(domain: Domain, nodes: int) -> BackgroundMesh:
    x0, y0, x1, y1 = domain.bounds
    step = max(x1 - x0, y1 - y0) / (nodes - 1)
    counts = [max(2, int(np.ceil(side / step - 1e-9)) + 1) for side in (x1 - x0, y1 - y0)]
    return BackgroundMesh.regular(Grid(x0, y0, step, step, *counts))


def _graded(domain: Domain, nodes: int, pattern: Pattern) -> BackgroundMesh:
    """Return a triangulation of the domain's box whose edges grow up to a hundredfold with the pattern."""
    grid = _grid(domain, nodes)
    x0, y0, x1, y1 = grid.bounds
    width = max(x1 - x0, y1 - y0)
    shape = pattern((grid.points - [x0, y0]) / width)
    shape = (shape - shape.min()) / max(float(np.ptp(shape)), 1e-300)
    spacing = SizeField(grid, 8.0 * width / nodes * 100.0 ** (shape - 1.0))
    while True:
        graded = limited(spacing, LimitOptions(epsilon=0.3))
        if ideal_count(graded, box := Domain.rectangle(x0, y0, x1, y1)) < nodes**2 / 4:
            points = generated(box, graded, MeshOptions(scale=1.0)).points
            return BackgroundMesh(points, delaunay(points))
        spacing = spacing.with_sizes(np.maximum(spacing.sizes, 1.5 * spacing.sizes.min()))


def _points(rng: np.random.Generator, box: NDArray[np.float64]) -> Pattern:
    seeds, power = rng.uniform(0, 1, (rng.integers(1, 9), 2)) * box, rng.uniform(0.3, 1.0)

    def value(p: NDArray[np.float64]) -> NDArray[np.float64]:
        distance = np.min([np.hypot(*(p - seed).T) for seed in seeds], axis=0)
        return np.minimum(distance, 0.4) ** power

    return value


def _valleys(rng: np.random.Generator, box: NDArray[np.float64]) -> Pattern:
    lines = [(rng.uniform(0, np.pi), rng.uniform(-0.3, 0.3)) for _ in range(rng.integers(1, 4))]

    def value(p: NDArray[np.float64]) -> NDArray[np.float64]:
        away = [np.abs((p - 0.5 * box) @ [np.cos(angle), np.sin(angle)] - offset) for angle, offset in lines]
        return np.minimum(np.min(away, axis=0), 0.3)

    return value


def _spiral(rng: np.random.Generator, box: NDArray[np.float64]) -> Pattern:
    pitch = 1.0 / rng.uniform(3, 7)

    def value(p: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y = (p - 0.5 * box).T
        return np.abs((np.hypot(x, y) - pitch * np.arctan2(y, x) / (2 * np.pi)) / pitch % 1.0 - 0.5)

    return value


def _noise(rng: np.random.Generator, box: NDArray[np.float64]) -> Pattern:
    table = gaussian_filter(rng.normal(size=(257, 257)), rng.uniform(4, 20), mode="nearest")
    return lambda p: map_coordinates(table, 256.0 * p.T[::-1], order=1, mode="nearest")


def _plateaus(rng: np.random.Generator, box: NDArray[np.float64]) -> Pattern:
    smooth = _noise(rng, box)
    across = np.stack(np.meshgrid(np.linspace(0, box[0], 99), np.linspace(0, box[1], 99)), axis=-1).reshape(-1, 2)
    levels = np.quantile(smooth(across), np.sort(10.0 ** rng.uniform(-3.0, -0.05, 3)))
    return lambda p: np.digitize(smooth(p), levels).astype(float)


def _steps(rng: np.random.Generator, box: NDArray[np.float64]) -> Pattern:
    angle, offset = rng.uniform(0, np.pi), rng.uniform(-0.2, 0.2)
    return lambda p: ((p - 0.5 * box) @ [np.cos(angle), np.sin(angle)] > offset).astype(float)


_PATTERNS: dict[str, Callable[[np.random.Generator, NDArray[np.float64]], Pattern]] = {
    "points": _points,
    "valleys": _valleys,
    "spiral": _spiral,
    "noise": _noise,
    "plateaus": _plateaus,
    "steps": _steps,
}
