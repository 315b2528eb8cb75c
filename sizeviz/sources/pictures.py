"""Sizes from pictures: fine where an image bends, or where it is dark or bright."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry import Domain
from sizeviz.geometry.arrays import read_only
from sizeviz.sizing import BackgroundMesh, Grid, SizeField

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.files import Image

MOST_NODES_ALONG = 1025
"""Background nodes along the longer side of a picture, at most."""


def extent(image: Image) -> Domain:
    """Return the rectangle that the pixels of an image cover, edge to edge, in model units."""
    (ny, nx), (dx, dy), (x0, y0) = image.shape, image.spacing, image.origin
    corner = x0 - 0.5 * dx, y0 - 0.5 * dy
    return Domain.rectangle(*corner, corner[0] + nx * dx, corner[1] + ny * dy, label=image.label)


def size_from_curvature(
    image: Image,
    finest: float = 1 / 700,
    coarsest: float = 1 / 20,
    tolerance: float = 0.01,
    smoothing: float = 1.5,
    nodes_a_pixel: int = 1,
) -> SizeField:
    """Return sizes at which linear elements reproduce a picture to a tolerance, as in section 5.2 of the paper.

    h = sqrt(8 tolerance / |k|), where k is the principal curvature of greatest magnitude of the smoothed image's
    graph, seen from far enough for its slopes to be small: the eigenvalue of the matrix of second derivatives.
    (The paper says mean curvature and gives no formula; that vanishes at saddles, which bend as much.)

    Parameters
    ----------
    image : Image
        Its range of intensities counts as 1, the longer side of its extent as 1.
    finest, coarsest : float
        Least and greatest size, as shares of the longer side.
    tolerance : float
        Error allowed between two nodes, as a share of the range of intensities.
    smoothing : float
        Standard deviation of the Gaussian filter, in pixels.
    nodes_a_pixel : int
        Background nodes for each pixel along each axis, above 0.

    Raises
    ------
    InputError
        If the sizes or the tolerance are not above 0, or the finest is not below the coarsest.
    """
    from scipy import ndimage  # here, so that listing the examples does not load it

    _check_range(finest, coarsest)
    if not (tolerance > 0 and smoothing > 0 and nodes_a_pixel >= 1):
        raise InputError(f"{image.label}: tolerance {tolerance}, smoothing {smoothing} and nodes must be above 0")
    side = _longer_side(image)
    step_x, step_y = (spacing / side for spacing in image.spacing)
    heights = _normalised(image.values)
    xx = ndimage.gaussian_filter(heights, smoothing, order=(0, 2), mode="nearest") / step_x**2
    yy = ndimage.gaussian_filter(heights, smoothing, order=(2, 0), mode="nearest") / step_y**2
    xy = ndimage.gaussian_filter(heights, smoothing, order=(1, 1), mode="nearest") / (step_x * step_y)
    bending = np.abs(0.5 * (xx + yy)) + np.hypot(0.5 * (xx - yy), xy)
    background, at_nodes = _on_nodes(image, bending, nodes_a_pixel)
    sizes = np.sqrt(8.0 * tolerance / np.maximum(at_nodes, 8.0 * tolerance / coarsest**2))
    return SizeField(background, side * np.maximum(sizes, finest), f"size from {image.label}")


def size_from_intensity(
    image: Image, finest: float = 1 / 200, coarsest: float = 1 / 20, nodes_a_pixel: int = 1
) -> SizeField:
    """Return sizes that grow in proportion to intensity: finest where the picture is darkest.

    Parameters
    ----------
    image : Image
        The picture.
    finest, coarsest : float
        Sizes at the least and the greatest intensity, as shares of the longer side of the image's extent; exchange
        them for small elements where the picture is bright.
    nodes_a_pixel : int
        Background nodes for each pixel along each axis, above 0.

    Raises
    ------
    InputError
        If a size is not above 0.
    """
    _check_range(min(finest, coarsest), max(finest, coarsest))
    background, brightness = _on_nodes(image, _normalised(image.values), nodes_a_pixel)
    sizes = finest + (coarsest - finest) * brightness
    return SizeField(background, _longer_side(image) * sizes, f"size from {image.label}")


def _check_range(finest: float, coarsest: float) -> None:
    if not (0 < finest <= coarsest < np.inf):
        raise InputError(f"sizes from {finest} to {coarsest}: both must be above 0, the finest first")


def _longer_side(image: Image) -> float:
    (ny, nx), (dx, dy) = image.shape, image.spacing
    return max(nx * dx, ny * dy)


def _normalised(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return values scaled to 0..1; all 0 where they do not vary."""
    span = float(np.ptp(values))
    return (values - values.min()) / span if span > 0 else np.zeros_like(values)


def _on_nodes(
    image: Image, values: NDArray[np.float64], nodes_a_pixel: int
) -> tuple[BackgroundMesh, NDArray[np.float64]]:
    """Return a regular background over an image's extent, and pixel values interpolated at its nodes."""
    from scipy import ndimage

    ny, nx = image.shape
    share = min(nodes_a_pixel, (MOST_NODES_ALONG - 1) / max(nx, ny))
    count_x, count_y = max(2, round(nx * share) + 1), max(2, round(ny * share) + 1)
    if share < 1.0:  # every pixel has its say in a picture that has more of them than there are nodes
        values = ndimage.gaussian_filter(values, 0.5 / share, mode="nearest")
    x0, y0, x1, y1 = extent(image).bounds
    grid = Grid(x0, y0, (x1 - x0) / (count_x - 1), (y1 - y0) / (count_y - 1), count_x, count_y)
    rows, columns = np.linspace(-0.5, ny - 0.5, count_y), np.linspace(-0.5, nx - 0.5, count_x)
    at = np.meshgrid(rows, columns, indexing="ij")
    return BackgroundMesh.regular(grid), read_only(ndimage.map_coordinates(values, at, order=1, mode="nearest").ravel())
