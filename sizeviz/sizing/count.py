"""How many elements a field asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from sizeviz.geometry.arrays import read_only

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import Domain
    from sizeviz.sizing.field import SizeField

NEARLY_FLAT = 0.1
"""Relative range of a triangle's sizes below which quadrature is more accurate than the closed form."""

PIECES_OUTSIDE = 20_000
"""Triangles that the part of a domain outside the background is cut into at least."""


def ideal_count(field: SizeField, domain: Domain) -> float:
    """Return the number of square elements that a field asks for, N* = integral of dA / h^2 over a domain.

    Exact for the piecewise-linear field on the background. Where the domain reaches beyond it the nearest
    background size counts, and the integral is a fine quadrature.
    """
    region = shapely.Polygon(domain.outer, domain.holes)
    corners = field.background.points[field.background.triangles]
    sizes = field.sizes[field.background.triangles]
    outline = _outline(field)
    if outline.equals(region):
        return float(integrals(corners, sizes).sum())
    shapely.prepare(region)
    triangles = shapely.polygons(corners)
    inside = shapely.covers(region, triangles)
    total = float(integrals(corners[inside], sizes[inside]).sum())
    cut = np.flatnonzero(~inside & shapely.intersects(region, triangles))
    total += sum(_on_piece(shapely.intersection(region, triangles[t]), corners[t], sizes[t]) for t in cut)
    return total + _outside(field, shapely.difference(region, outline))


def integrals(corners: NDArray[np.float64], sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the integral of 1 / h^2 over triangles with linear h.

    By the formula of Hermite and Genocchi it is twice the area times the second divided difference of -log h at the
    three sizes; where they nearly agree, a symmetric rule of degree 5 replaces the cancelling difference.

    Parameters
    ----------
    corners : (T, 3, 2) float64
        The area is signed: clockwise triangles count negative.
    sizes : (T, 3) float64
        Sizes at the corners, above 0.

    Returns
    -------
    (T,) float64
    """
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    twice_area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    low, mid, high = np.sort(sizes, axis=1).T
    flat = high - low < NEARLY_FLAT * low
    mean = np.empty(len(sizes))
    mean[flat] = 0.5 * _mean_by_rule(sizes[flat])
    low, mid, high = low[~flat], mid[~flat], high[~flat]
    mean[~flat] = (_log_slope(mid, high) - _log_slope(low, mid)) / (high - low)
    return twice_area * mean


def _log_slope(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the first divided difference of -log, 1 / low in the limit of equal arguments."""
    ratio = (high - low) / low
    safe = np.where(ratio > 0, ratio, 1.0)
    return -np.where(ratio > 0, np.log1p(safe) / safe, 1.0) / low


def _mean_by_rule(sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of 1 / h^2 over triangles by Radon's rule of seven points."""
    root = np.sqrt(15.0)
    nodes = [(1 / 3, 1 / 3, 1 / 3, 9 / 40)]
    for sign in (-1.0, 1.0):
        near = (6 + sign * root) / 21
        weight = (155 + sign * root) / 1200
        nodes += [
            (near, near, 1 - 2 * near, weight),
            (near, 1 - 2 * near, near, weight),
            (1 - 2 * near, near, near, weight),
        ]
    total = np.zeros(len(sizes))
    for a, b, c, weight in nodes:
        total += weight / (sizes @ np.array([a, b, c])) ** 2
    return total


def _on_piece(piece: shapely.Geometry, corners: NDArray[np.float64], sizes: NDArray[np.float64]) -> float:
    """Return the integral over a part of one triangle, as a signed sum of triangles fanned from one point of it."""
    total = 0.0
    for part in shapely.get_parts(piece):
        if part.geom_type != "Polygon" or part.is_empty:
            continue
        part = (
            shapely.orient_polygons(part)
            if hasattr(shapely, "orient_polygons")
            else shapely.geometry.polygon.orient(part)
        )
        for ring in (part.exterior, *part.interiors):
            points = shapely.get_coordinates(ring)
            fan = np.stack([np.broadcast_to(corners[0], points[1:].shape), points[:-1], points[1:]], axis=1)
            total += float(integrals(fan, _linear(fan.reshape(-1, 2), corners, sizes).reshape(-1, 3)).sum())
    return total


def _linear(
    points: NDArray[np.float64], corners: NDArray[np.float64], sizes: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return a triangle's linear sizes at points of it, kept within the range of its corners."""
    frame = np.column_stack([corners[1] - corners[0], corners[2] - corners[0]])
    weights = np.linalg.solve(frame, (points - corners[0]).T)
    values = sizes[0] + weights[0] * (sizes[1] - sizes[0]) + weights[1] * (sizes[2] - sizes[0])
    return np.clip(values, sizes.min(), sizes.max())


def _outline(field: SizeField) -> shapely.Geometry:
    """Return the region that a background covers."""
    background = field.background
    if background.grid is not None:
        return shapely.box(*background.bounds)
    tree = background.tree
    cell, side = np.nonzero(tree.neighbours < 0)
    ends = np.stack([tree.triangles[cell, (side + 1) % 3], tree.triangles[cell, (side + 2) % 3]], axis=1)
    faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(background.points[ends])))
    corners = background.points[tree.triangles[cell]]
    centres = shapely.points(corners.mean(axis=1))
    covered = [face for face in faces if shapely.contains(face, centres).any()]
    return shapely.union_all(covered)


def _outside(field: SizeField, rest: shapely.Geometry) -> float:
    """Return the integral over what the background leaves uncovered, cut into many triangles."""
    if rest.is_empty or rest.area == 0.0:
        return 0.0
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(rest))
    corners = np.array([shapely.get_coordinates(piece)[:3] for piece in pieces])
    while len(corners) < PIECES_OUTSIDE:
        corners = _quartered(corners)
    sizes = field.at(read_only(corners.reshape(-1, 2))).reshape(-1, 3)
    return float(np.abs(integrals(corners, sizes)).sum())


def _quartered(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
    return np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
