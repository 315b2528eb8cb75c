"""Fields with an upper bound at some points: the bound holds, grows steadily, and changes nothing elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.geometry.delaunay import delaunay
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sizing.capped import SLOPE, STEP, capped

PLACES = np.array([[0.31, 0.42], [0.5, 0.5], [0.0, 0.7], [1.0, 0.2]])
CAPS = np.array([0.01, 0.02, 0.03, 0.004])


def background(kind: str) -> BackgroundMesh:
    grid = BackgroundMesh.unit_square_grid(17, 17)
    if kind == "grid":
        return grid
    rng = np.random.default_rng(0)
    inside = rng.uniform(0.02, 0.98, (300, 2))
    rim = grid.points[(grid.points % 1 == 0).any(axis=1)]
    points = np.vstack([rim, inside])
    return BackgroundMesh(points, delaunay(points))


@pytest.mark.parametrize("kind", ["grid", "triangles"])
def test_bounds_hold_at_their_points_and_grow_with_distance(kind: str) -> None:
    mesh = background(kind)
    field = SizeField(mesh, 0.1 + 0.1 * mesh.points[:, 0])
    result = capped(field, PLACES, CAPS)
    assert (result.at(PLACES) <= CAPS * (1 + 1e-9)).all()
    nodes = result.background.points
    away = np.hypot(*(nodes[:, None] - PLACES[None]).transpose(2, 0, 1))
    exact = np.minimum(field.at(nodes), (CAPS + SLOPE * away).min(axis=1))
    assert (result.sizes >= exact - 1e-12).all()
    assert (result.sizes <= exact + (2**STEP - 1) * CAPS.max() + 1e-12).all()


@pytest.mark.parametrize("kind", ["grid", "triangles"])
def test_the_background_is_still_covered_once_and_the_rest_unchanged(kind: str) -> None:
    mesh = background(kind)
    field = SizeField(mesh, np.full(len(mesh.points), 0.1))
    result = capped(field, PLACES, CAPS)
    corner = result.background.points[result.background.triangles]
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    assert (area > 0).all()
    assert area.sum() == pytest.approx(1.0, abs=1e-12)
    far = np.random.default_rng(1).random((500, 2))
    far = far[np.hypot(*(far[:, None] - PLACES[None]).transpose(2, 0, 1)).min(axis=1) > 0.4]
    assert len(far)
    assert result.at(far) == pytest.approx(0.1)


def test_where_no_bound_is_lower_the_field_itself_is_returned() -> None:
    mesh = background("grid")
    field = SizeField(mesh, np.full(len(mesh.points), 0.1))
    assert capped(field, PLACES, np.full(4, 0.2)) is field
    assert capped(field, np.empty((0, 2)), np.empty(0)) is field
