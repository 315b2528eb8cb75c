"""The tight field and the guarantee."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.conformity import shape_quality
from sizeviz.errors import InputError
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.improvement import GuaranteeOptions, SmoothOptions, TightOptions, guaranteed, tightened
from sizeviz.sizing import BackgroundMesh, PreserveOptions, SizeField, ideal_count, preserved
from tests.improvement.squares import disturbed, uniform, unit


def bowl(n: int = 65) -> SizeField:
    background = BackgroundMesh.unit_square_grid(n, n)
    return SizeField(background, 0.03 + 0.1 * np.hypot(*(background.points - 0.5).T), "bowl")


def test_the_tight_field_lies_below_both_and_above_the_brute_force_minimum() -> None:
    field = bowl()
    target = preserved(field, PreserveOptions())
    tight = tightened(field, target, TightOptions(radius=1.5, factor=0.9))
    points = field.background.points
    assert (tight.sizes <= target.sizes).all()
    rows = np.random.default_rng(0).integers(0, len(points), 200)
    away = np.hypot(*(points[rows, None] - points[None]).transpose(2, 0, 1))
    # squares of nodes stand for the circle: they may reach a cell or so beyond it
    wide = np.where(away <= 1.5 * target.sizes[rows, None] + 3 / 64, field.sizes, np.inf).min(axis=1)
    assert (tight.sizes[rows] >= 0.9 * np.minimum(target.sizes[rows], wide) - 1e-12).all()
    near = np.where(away <= 0.5 * target.sizes[rows, None], field.sizes, np.inf).min(axis=1)
    assert (tight.sizes[rows] <= np.maximum(0.9 * near, tight.sizes.min()) + 1e-12).all()


def test_a_plateau_is_meshed_finer_wherever_it_lies() -> None:
    background = BackgroundMesh.unit_square_grid(65, 65)
    away = np.hypot(*(background.points - [0.1, 0.1]).T)
    field = SizeField(background, np.clip(0.5 * away, 1e-3, 0.05), "a spot on a plateau")
    target = preserved(field, PreserveOptions())
    tight = tightened(field, target)
    level = away > 0.3
    assert tight.sizes[level] == pytest.approx(0.96 * 0.05)
    assert (tight.sizes <= 0.96 * target.sizes * (1 + 1e-12)).all()


def test_what_is_flat_without_ruling_is_meshed_finer_too() -> None:
    background = BackgroundMesh.unit_square_grid(65, 65)
    away = np.abs(background.points[:, 0] - 0.1)
    field = SizeField(background, np.clip(0.3 * away, 1e-2, 0.25), "a valley beside a plateau")
    target = preserved(field, PreserveOptions())
    tight = tightened(field, target)
    level = away > 0.98 * away.max()
    assert (tight.sizes[level] <= 0.917 * field.sizes[level] * (1 + 1e-12)).all()
    assert (tight.sizes > 0.95 * target.sizes).any()


def test_a_fine_enough_mesh_is_guaranteed() -> None:
    field = bowl()
    mesh = disturbed(40, 0.35, 2)
    result, report = guaranteed(mesh, unit(), preserved(field, PreserveOptions()), field)
    assert report.holds
    assert "all" in report.verdict
    corner = result.points[result.quads]
    longest = np.hypot(*(np.roll(corner, -1, axis=1) - corner).transpose(2, 0, 1)).max(axis=1)
    assert (longest <= field.min_over(result.points, result.quads) * (1 + 1e-9)).all()
    assert (shape_quality(result) > 0.5).all()


def test_what_cannot_be_satisfied_is_reported() -> None:
    mesh = disturbed(4, 0.0, 0)
    held = QuadMesh(mesh.points, mesh.quads, mesh.curve, np.ones(mesh.n_points, dtype=bool))
    result, report = guaranteed(
        held, unit(), uniform(0.1), uniform(0.1), GuaranteeOptions(smooth=SmoothOptions(cleanup=False), rounds=2)
    )
    assert not report.holds
    assert len(report.elements) == result.n_quads
    assert report.ratios == pytest.approx(2.5)
    assert "16 with an edge between two fixed nodes" in report.verdict


@pytest.mark.parametrize(("name", "value"), [("radius", 0.0), ("radius", np.nan), ("factor", 1.5)])
def test_tight_options_out_of_range_are_refused(name: str, value: float) -> None:
    with pytest.raises(InputError, match=name):
        TightOptions(**{name: value})


def test_guarantee_options_out_of_range_are_refused() -> None:
    with pytest.raises(InputError, match="rounds"):
        GuaranteeOptions(rounds=-1)


def test_elements_are_inserted_where_the_mesh_is_too_coarse() -> None:
    # 196 elements are too few for sizes that dip to 0.045 in the middle, however their nodes are moved
    background = BackgroundMesh.unit_square_grid(65, 65)
    away = np.hypot(*(background.points - 0.5).T)
    field = SizeField(background, 0.1 - 0.055 * np.exp(-((away / 0.2) ** 2)), "dip")
    mesh = disturbed(14, 0.1, 3)
    result, report = guaranteed(mesh, unit(), field, field, GuaranteeOptions(smooth=SmoothOptions(cleanup=False)))
    assert report.holds
    assert result.n_quads > mesh.n_quads
    assert shape_quality(result).min() > 0.5
    assert result.areas.sum() == pytest.approx(1.0, abs=1e-12)


def test_the_tight_field_does_not_fall_to_its_floor_where_alpha_is_small() -> None:
    # with a radius of alpha or more it asked for six times as many elements here
    background = BackgroundMesh.unit_square_grid(129, 129)
    x, y = background.points.T
    field = SizeField(background, 0.003 + np.abs(np.hypot(x - 0.5, y - 0.5) - 0.3), "ring")
    target = preserved(field, PreserveOptions(alpha=1.0))
    domain = Domain.unit_square()
    assert ideal_count(tightened(field, target), domain) < 1.5 * ideal_count(target, domain)
    assert ideal_count(tightened(field, target, TightOptions(radius=2.0)), domain) > 2.0 * ideal_count(target, domain)
