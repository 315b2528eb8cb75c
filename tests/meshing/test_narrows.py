"""Sharp corners, gaps and short edges: elements keep a shape there that the domain allows."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.conformity import shape_quality
from sizeviz.geometry import Domain
from sizeviz.improvement import improved
from sizeviz.improvement.room import with_room
from sizeviz.meshing import MeshOptions, generated
from sizeviz.meshing.frontal.narrows import fitted
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sources.shapes import SHAPES, shape


def constant(size: float) -> SizeField:
    return SizeField(BackgroundMesh.unit_square_grid(9, 9), np.full(81, size), "constant")


def wedge(degrees: float) -> Domain:
    half = np.deg2rad(0.5 * degrees)
    tip, far = np.array([0.0, 0.5]), 0.9
    sides = [tip + far * np.array([np.cos(half), sign * np.sin(half)]) for sign in (-1, 1)]
    return Domain(np.vstack([tip, *sides]), label=f"wedge of {degrees:g} degrees")


@pytest.mark.parametrize("degrees", [10.0, 15.0, 25.0, 40.0, 55.0])
def test_a_sharp_corner_gets_one_element_as_good_as_its_angle_allows(degrees: float) -> None:
    domain, size = wedge(degrees), constant(0.06)
    mesh = improved(generated(domain, size, MeshOptions(scale=1.0)), domain, size)
    tip = np.flatnonzero((mesh.points == [0.0, 0.5]).all(axis=1))
    at_tip = np.flatnonzero((mesh.quads == tip).any(axis=1))
    assert len(at_tip) == 1
    assert shape_quality(mesh)[at_tip[0]] > 0.9 * np.sin(np.deg2rad(degrees))
    assert shape_quality(mesh).min() > 0.8 * np.sin(np.deg2rad(degrees))
    assert mesh.areas.sum() == pytest.approx(domain.area, rel=1e-12)


def test_square_corners_and_wide_domains_keep_the_field() -> None:
    size = constant(0.05)
    for name in ("square", "L", "plate", "annulus"):
        net, sizes = fitted(shape(name), size, 1.0)
        assert sizes is size
        assert not any(piece.whole for piece in net.pieces)


def test_sizes_shrink_into_a_gap_and_grow_out_of_it() -> None:
    domain = shape("eccentric")  # the circles come within 0.02 of each other at the right
    _, sizes = fitted(domain, constant(0.1), 1.0)
    gap, wide = sizes.at([[0.99, 0.5]])[0], sizes.at([[0.1, 0.5]])[0]
    assert 0.018 < gap < 0.03
    assert wide == pytest.approx(0.1)


def test_a_line_that_runs_into_a_side_at_a_sharp_angle_makes_two_regions() -> None:
    domain = Domain([[0, 0], [1, 0], [1, 1], [0, 1]], lines=(np.array([[0.2, 0.0], [0.9, 0.25], [1.0, 0.6]]),))
    net, _ = fitted(domain, constant(0.08), 1.0)
    assert len(net.kites) == 2
    assert sum(piece.whole for piece in net.pieces) == 4
    mesh = improved(generated(domain, constant(0.08), MeshOptions(scale=1.0)), domain, constant(0.08))
    assert shape_quality(mesh).min() > 0.25
    assert mesh.areas.sum() == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_has_well_shaped_elements_even_where_sizes_are_too_large(name: str) -> None:
    domain, size = shape(name), constant(0.08)
    mesh = improved(generated(domain, size, MeshOptions(scale=1.0)), domain, size)
    quality = shape_quality(mesh)
    assert quality.min() > (0.2 if name == "wedge" else 0.3)
    assert quality.mean() > 0.8


def test_targets_grow_from_short_boundary_edges() -> None:
    domain, size = shape("comb"), constant(0.1)
    raw = generated(domain, size, MeshOptions(scale=1.0))
    targets = with_room(raw, size)
    assert targets.at([[0.2, 0.2]])[0] < 0.05
    assert targets.at([[0.9, 0.7]])[0] == pytest.approx(0.1)


def test_inner_lines_have_no_element_with_a_flat_corner() -> None:
    domain = shape("regions")
    background = BackgroundMesh.unit_square_grid(201, 201)
    away = np.hypot(*(background.points - [0.5, 0.25]).T)
    size = SizeField(background, np.minimum(0.05, 0.006 + 0.5 * away))
    mesh = improved(generated(domain, size, MeshOptions(scale=1.0)), domain, size)
    assert shape_quality(mesh).min() > 0.25
    assert mesh.areas.sum() == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("away", [1e-2, 1e-4, 1e-7])
@pytest.mark.parametrize("beside", ["side", "point"])
def test_sizes_grow_from_a_point_that_nearly_touches_a_side_or_another_point(away: float, beside: str) -> None:
    points = np.array([[0.5, away]]) if beside == "side" else np.array([[0.4, 0.5], [0.4, 0.5 + away]])
    domain = Domain([[0, 0], [1, 0], [1, 1], [0, 1]], fixed_points=points)
    size = constant(0.05)
    mesh = improved(generated(domain, size, MeshOptions(scale=1.0)), domain, size)
    for point in points:
        assert (mesh.points == point).all(axis=1).any()
    assert shape_quality(mesh).min() > 0.6
    assert mesh.n_quads < 1000
    assert mesh.areas.sum() == pytest.approx(1.0, rel=1e-12)
