"""Smoothing: untangling, invariances, the boundary, threads, bad input."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.conformity import shape_quality
from sizeviz.errors import InputError
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.improvement import SmoothOptions, smoothed
from sizeviz.improvement._workspace import Workspace
from sizeviz.sizing import BackgroundMesh, Grid, SizeField
from tests.improvement.squares import disturbed, graded, uniform, unit


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("objective", ["reciprocal", "paper", "shape"])
def test_a_tangled_grid_becomes_regular_again(seed: int, objective: str) -> None:
    mesh = disturbed(16, 0.9, seed)
    assert (shape_quality(mesh) <= 0).mean() > 0.05
    result = smoothed(mesh, unit(), uniform(), SmoothOptions(objective=objective, sweeps=60))  # type: ignore[arg-type]
    assert shape_quality(result).min() > 0.9


def test_quality_does_not_fall_on_a_valid_mesh() -> None:
    mesh = disturbed(20, 0.3, 5)
    before, after = shape_quality(mesh), shape_quality(smoothed(mesh, unit(), uniform()))
    assert before.min() > 0
    assert after.min() >= before.min()
    assert after.mean() > before.mean()


def test_result_is_bitwise_the_same_for_any_number_of_threads() -> None:
    mesh = disturbed(80, 0.4, 1)
    one, two, three = (smoothed(mesh, unit(), graded(), SmoothOptions(threads=n, sweeps=4)) for n in (1, 2, 3))
    assert np.array_equal(one.points, two.points)
    assert np.array_equal(one.points, three.points)


def test_boundary_nodes_stay_on_their_sides_and_corners_where_they_were() -> None:
    mesh = disturbed(24, 0.3, 2)
    result = smoothed(mesh, unit(), graded())
    assert np.array_equal(result.points[mesh.fixed], mesh.points[mesh.fixed])
    x, y = result.points.T
    for c, off in enumerate((y, x - 1, y - 1, x)):
        assert np.abs(off[mesh.curve == c]).max() == 0.0
    moved = (mesh.curve >= 0) & ~mesh.fixed
    assert (result.points[moved] != mesh.points[moved]).any()
    assert result.areas.sum() == pytest.approx(1.0, abs=1e-12)


def test_nodes_slide_around_a_closed_curve() -> None:
    n, layers = 48, 6
    angle = 2 * np.pi * np.arange(n) / n
    fine = 2 * np.pi * np.arange(4096) / 4096
    circle = np.column_stack([np.cos(fine), np.sin(fine)])
    domain = Domain(2 * circle, holes=(circle,))
    twist = 0.8 * np.sin(angle) / n
    rings = [
        (1 + k / layers) * np.column_stack([np.cos(angle + twist), np.sin(angle + twist)]) for k in range(layers + 1)
    ]
    start = (np.arange(layers)[:, None] * n + np.arange(n)).ravel()
    after = (np.arange(layers)[:, None] * n + (np.arange(n) + 1) % n).ravel()
    quads = np.column_stack([start, start + n, after + n, after])
    points = np.vstack(rings)
    curve = np.full(len(points), -1)
    curve[:n], curve[-n:] = 1, 0
    mesh = QuadMesh(points, quads, curve, np.zeros(len(points), dtype=bool))
    background = BackgroundMesh.regular(Grid(-2.0, -2.0, 0.5, 0.5, 9, 9))
    result = smoothed(mesh, domain, SizeField(background, np.full(81, 0.1)), SmoothOptions(sweeps=40))
    radius = np.hypot(*result.points.T)
    assert np.abs(radius[:n] - 1).max() < 1e-5
    assert np.abs(radius[-n:] - 2).max() < 1e-5
    assert shape_quality(result).min() > shape_quality(mesh).min()


@pytest.mark.parametrize("scale", [1e-3, 1e4])
def test_scaling_everything_scales_the_result(scale: float) -> None:
    mesh, field = disturbed(12, 0.4, 3), graded()
    grid = field.background.grid
    assert grid is not None
    background = BackgroundMesh.regular(Grid(0.0, 0.0, scale * grid.dx, scale * grid.dy, grid.nx, grid.ny))
    large = smoothed(
        mesh.with_points(scale * mesh.points), Domain.rectangle(0, 0, scale, scale),
        SizeField(background, scale * field.sizes),
    )  # fmt: skip
    small = smoothed(mesh, unit(), field)
    assert np.allclose(large.points / scale, small.points, rtol=0, atol=1e-9)


def test_moving_everything_moves_the_result() -> None:
    mesh, shift = disturbed(12, 0.4, 4), np.array([3.0, -7.0])
    background = BackgroundMesh.regular(Grid(3.0, -7.0, 0.125, 0.125, 9, 9))
    moved = smoothed(
        mesh.with_points(mesh.points + shift), Domain.rectangle(3, -7, 4, -6), SizeField(background, np.full(81, 0.1))
    )
    assert np.allclose(moved.points - shift, smoothed(mesh, unit(), uniform()).points, rtol=0, atol=1e-9)


def test_elements_follow_the_sizes() -> None:
    mesh = disturbed(24, 0.1, 6)
    result = smoothed(mesh, unit(), graded(), SmoothOptions(sweeps=60))
    centre = result.points[result.quads].mean(axis=1)
    left, right = result.areas[centre[:, 0] < 0.2].mean(), result.areas[centre[:, 0] > 0.8].mean()
    assert right > 1.5 * left


def test_an_empty_mesh_is_refused() -> None:
    nothing = QuadMesh(np.zeros((4, 2)), np.zeros((0, 4), dtype=np.int32), np.full(4, -1), np.zeros(4, dtype=bool))
    with pytest.raises(InputError, match="no element"):
        smoothed(nothing, unit(), uniform())


def test_a_mesh_of_another_domain_is_refused() -> None:
    mesh = disturbed(4, 0.0, 0)
    other = QuadMesh(mesh.points, mesh.quads, np.where(mesh.curve == 3, 9, mesh.curve), mesh.fixed)
    with pytest.raises(InputError, match="curve 9"):
        smoothed(other, unit(), uniform())


@pytest.mark.parametrize(
    ("name", "value"),
    [("objective", "best"), ("sweeps", -1), ("rounds", -2), ("floor", 1.0), ("threads", 0)],
)
def test_options_out_of_range_are_refused(name: str, value: object) -> None:
    with pytest.raises(InputError, match=name):
        SmoothOptions(**{name: value})  # type: ignore[arg-type]


def test_only_nodes_that_are_awake_move_and_they_wake_their_neighbours() -> None:
    work = Workspace(disturbed(16, 0.0, 0), unit(), uniform(1 / 16), SmoothOptions(threads=1))
    middle = int(np.argmin(np.hypot(*(work.xy - 0.5).T)))
    home = work.xy[middle].copy()
    work.xy[middle] += 0.01
    before, awake = work.xy.copy(), np.zeros(len(work.xy), dtype=np.bool_)
    awake[middle] = True
    work.aim()
    work._sweep_part(0, 1, work.phases[0], (work.objective, 0.0), awake)
    assert len(work.phases) == len(work.phases[0]) == 1
    assert np.array_equal(work.xy[:middle], before[:middle])
    assert (np.hypot(*(work.xy - before).T) > 1e-4).sum() < 10
    assert work.xy[middle] == pytest.approx(home, abs=3e-3)
    near = np.unique(work.quads[(work.quads == middle).any(axis=1)])
    assert awake[near[near <= middle]].all()
    assert awake.sum() < 60
