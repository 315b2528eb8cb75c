"""The promise R <= 1: kept by a finer mesh where the first cannot be repaired."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.conformity import judged
from sizeviz.errors import InputError
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.improvement import GuaranteeOptions, GuaranteeReport, guaranteed, tightened
from sizeviz.meshing import MeshOptions, generated
from sizeviz.sizing import BackgroundMesh, Grid, PreserveOptions, SizeField, preserved
from sizeviz.sources.shapes import shape
from sizeviz.study import promise as module
from sizeviz.study.promise import Promise, promised


def jump() -> SizeField:
    """Return sizes that jump by a factor of 20 along an oblique line."""
    background = BackgroundMesh.unit_square_grid(65, 65)
    return SizeField(background, np.where(background.points @ [1.0, 0.4] > 0.7, 0.4, 0.02), "jump")


def test_a_mesh_that_is_far_too_coarse_is_replaced() -> None:
    field, domain = jump(), Domain.unit_square()
    tight = tightened(field, preserved(field, PreserveOptions(alpha=1.0)))
    coarse = generated(domain, tight, MeshOptions(scale=1.6))
    best = promised(domain, field, tight, coarse)
    assert best.report.holds
    assert best.raw is not coarse
    assert best.raw.n_quads > coarse.n_quads
    assert best.tight.sizes.max() < tight.sizes.max()
    report = judged(best.mesh, field)
    assert report.correct_percent["max-edge"] == 100.0
    assert report.n_inverted == 0
    assert best.mesh.areas.sum() == pytest.approx(1.0, abs=1e-12)


def test_a_mesh_that_can_be_repaired_is_kept() -> None:
    background, domain = BackgroundMesh.unit_square_grid(65, 65), Domain.unit_square()
    field = SizeField(background, 0.03 + 0.1 * np.hypot(*(background.points - 0.5).T), "bowl")
    tight = tightened(field, preserved(field, PreserveOptions()))
    raw = generated(domain, tight, MeshOptions(scale=1.0))
    best = promised(domain, field, tight, raw)
    assert best.report.holds
    assert best.raw is raw and best.tight is tight


def test_a_limit_on_the_elements_ends_the_search_with_a_report() -> None:
    field, domain = jump(), Domain.unit_square()
    tight = tightened(field, preserved(field, PreserveOptions(alpha=1.0)))
    coarse = generated(domain, tight, MeshOptions(scale=1.6))
    best = promised(domain, field, tight, coarse, MeshOptions(max_elements=100))
    assert not best.report.holds
    assert "left" in best.report.verdict
    assert len(best.report.reasons) == len(best.report.elements) > 0
    assert best.raw is coarse


def test_a_hopeless_mesh_is_not_repaired() -> None:
    field, domain = jump(), Domain.unit_square()
    coarse = generated(domain, field, MeshOptions(scale=1.6))
    mesh, report = guaranteed(coarse, domain, field, field, GuaranteeOptions(hopeless=0.01))
    assert len(report.elements) > 0.01 * mesh.n_quads
    with pytest.raises(InputError, match="hopeless"):
        GuaranteeOptions(hopeless=0.0)


def test_a_gap_far_narrower_than_the_sizes_is_meshed_finely_enough() -> None:
    # two elements at its mouth were still a hundredth too long in a mesh of 0.8 of the sizes
    domain = shape("eccentric")
    x0, y0, x1, y1 = domain.bounds
    grid = Grid(x0, y0, (x1 - x0) / 200, (y1 - y0) / 200, 201, 201)
    field = SizeField(BackgroundMesh.regular(grid), np.full(201 * 201, 0.06), "even")
    tight = tightened(field, preserved(field, PreserveOptions()))
    best = promised(domain, field, tight, generated(domain, tight, MeshOptions(scale=1.0)))
    assert best.report.holds
    assert judged(best.mesh, field).correct_percent["max-edge"] == 100.0


def grid_with(points: np.ndarray, tight: float, left: np.ndarray) -> Promise:
    """Return a grid of 10 x 10 elements made for an even tight field, of which some are left."""
    first = (np.arange(10)[:, None] * 11 + np.arange(10)).ravel()
    quads = np.column_stack([first, first + 1, first + 12, first + 11]).astype(np.int32)
    mesh = QuadMesh(points, quads, np.full(121, -1, dtype=np.int32), np.zeros(121, dtype=bool))
    background = BackgroundMesh.unit_square_grid(41, 41)
    field = SizeField(background, np.full(41 * 41, tight), "even")
    report = GuaranteeReport(100, left, np.full(len(left), 1.5), ("that no move could shorten",) * len(left))
    return Promise(field, mesh, mesh, report)


def ticks() -> np.ndarray:
    y, x = np.mgrid[0:11, 0:11] / 10.0
    return np.column_stack([x.ravel(), y.ravel()])


def test_sizes_are_lowered_around_poor_elements_where_the_field_asks_for_far_larger_ones() -> None:
    points = ticks()
    points[60] += [0.045, 0.045]  # the element above its lower left corner is nearly a triangle
    promise = grid_with(points, 0.1, np.empty(0, dtype=np.int64))
    large = promise.tight.with_sizes(5.0 * promise.tight.sizes)
    finer = module._with_room(promise, large, 1.5, 0.75)
    assert finer.at(points[60:61])[0] == pytest.approx(0.08)
    assert finer.at(np.array([[0.02, 0.98]]))[0] == pytest.approx(0.1)


def test_where_most_elements_are_left_sizes_are_lowered_by_little_at_a_time() -> None:
    points = ticks()
    asked = SizeField(BackgroundMesh.unit_square_grid(41, 41), np.full(41 * 41, 0.1 / 1.5), "asked")
    middle = np.array([[0.5, 0.5]])
    for left, share in ((np.arange(100), module.FAR_SHARE), (np.array([44, 45, 54, 55]), module.SHARE / 1.5)):
        finer = module._with_room(grid_with(points, 0.1, left), asked, 1.5, 0.5)
        assert finer.at(middle)[0] == pytest.approx(0.1 * share, rel=1e-6)
