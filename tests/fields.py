"""The catalogue of size fields that tests share: grids and triangulations, smooth, rough, steep and flat."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import Delaunay

from sizeviz.sizing import BackgroundMesh, Grid, SizeField

if TYPE_CHECKING:
    from numpy.typing import NDArray

RADIUS, LEAST = 0.2575, 0.25e-3


def ring_offset(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distance of points (N, 2) from the circle of section 5.1."""
    return np.abs(np.hypot(points[:, 0] - 0.5, points[:, 1] - 0.5) - RADIUS)


def ring_sizes(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the analytic sizes of section 5.1."""
    return np.minimum(0.25, ring_offset(points) + LEAST)


def on_grid(nx: int, ny: int, seed: int, *, width: float = 1.0, height: float = 1.0, spread: float = 1.5) -> SizeField:
    """Return random log-normal sizes of about a tenth on a grid."""
    rng = np.random.default_rng(seed)
    background = BackgroundMesh.regular(Grid(-0.3, 0.2, width / (nx - 1), height / (ny - 1), nx, ny))
    return SizeField(background, 0.1 * np.exp(spread * rng.standard_normal(nx * ny)), "random grid")


def as_triangles(field: SizeField) -> SizeField:
    """Return the same field on the same triangles, no longer known to be a grid."""
    background = field.background
    return SizeField(BackgroundMesh(background.points, background.triangles), field.sizes, field.label)


def on_triangles(count: int, seed: int, spread: float = 1.5, grading: int = 4) -> SizeField:
    """Return random sizes on a Delaunay triangulation that is much finer near one point."""
    rng = np.random.default_rng(seed)
    radius, angle = 0.5 * rng.random(count) ** grading, 2 * np.pi * rng.random(count)
    points = np.column_stack([0.5 + radius * np.cos(angle), 0.5 + radius * np.sin(angle)])
    points = np.vstack([points, [[0, 0], [1, 0], [1, 1], [0, 1]]])
    sizes = 0.1 * np.exp(spread * rng.standard_normal(len(points)))
    return SizeField(BackgroundMesh(points, Delaunay(points).simplices), sizes, "random triangles")


def frame(count: int = 9) -> SizeField:
    """Return a field on a square with a square hole: cells of a grid, the middle sixteenth left out."""
    whole = BackgroundMesh.unit_square_grid(count, count)
    centre = whole.points[whole.triangles].mean(axis=1)
    keep = (np.abs(centre - 0.5) > 1 / 8).any(axis=1)
    sizes = 0.05 + 0.1 * whole.points[:, 0]
    return SizeField(BackgroundMesh(whole.points, whole.triangles[keep]), sizes, "frame")


def catalogue() -> dict[str, SizeField]:
    """Return small fields of every kind, by name."""
    smooth = on_grid(23, 17, 1)
    x, y = smooth.background.points.T
    return {
        "rough grid": on_grid(19, 14, 2),
        "smooth grid": smooth.with_sizes(0.08 + 0.05 * np.sin(5 * x) * np.cos(4 * y)),
        "flat cells": on_grid(12, 9, 3, width=3.0, height=0.4),
        "plateau": smooth.with_sizes(np.maximum(0.05, 0.3 - np.abs(x - 0.2))),
        "constant": smooth.with_sizes(np.full(len(x), 0.07)),
        "one cell": on_grid(2, 2, 4),
        "adaptive triangles": on_triangles(150, 5),
        "gentle triangles": on_triangles(120, 6, spread=0.2),
        "frame": frame(),
    }
