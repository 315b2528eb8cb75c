"""Operations of the guarantee: around elements that are too large, and where quality is low."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.conformity import shape_quality
from sizeviz.geometry import QuadMesh
from sizeviz.improvement import SmoothOptions, _mend_kernels
from sizeviz.improvement._conform import Judge
from sizeviz.improvement._workspace import Workspace
from sizeviz.improvement.mend import Mender
from sizeviz.sizing import AnalyticSize, BackgroundMesh, SizeField
from tests.improvement.squares import disturbed, edge_uses, uniform, unit


def dip(low: float) -> SizeField:
    """Return sizes of 0.13 that fall to ``low`` in the middle of the unit square."""
    background = BackgroundMesh.unit_square_grid(65, 65)
    away = np.hypot(*(background.points - 0.5).T)
    return SizeField(background, 0.13 - (0.13 - low) * np.exp(-((away / 0.2) ** 2)), "dip")


def prepared(field: SizeField, mesh: QuadMesh) -> tuple[Workspace, Judge]:
    work = Workspace(mesh, unit(), field, SmoothOptions())
    work.sweep(10)
    return work, Judge(work, field)


def test_splits_shorten_what_moves_cannot() -> None:
    work, judge = prepared(dip(0.07), disturbed(10, 0.1, 3))
    before = judge.ratio.max()
    assert before > 1.02
    nodes = judge.rings(judge.wrong, 1)
    assert Mender(work, judge).mend(nodes, 0.75, 0.5, False) > 0
    assert judge.ratio.max() < before
    mesh = work.result()
    assert mesh.n_quads > 100
    assert mesh.areas.min() > 0
    assert mesh.areas.sum() == pytest.approx(1.0, abs=1e-12)
    assert edge_uses(mesh).max() == 2
    assert mesh.n_points - len(edge_uses(mesh)) + mesh.n_quads == 1


def test_the_judge_knows_the_elements_after_an_operation() -> None:
    work, judge = prepared(dip(0.07), disturbed(10, 0.1, 3))
    Mender(work, judge).mend(np.arange(len(work.xy)), 0.75, 0.5, True)
    rows = judge.alive
    kept = judge.ratio.copy(), judge.quality.copy()
    judge.look(rows)
    assert np.array_equal(judge.ratio[rows], kept[0][rows])
    assert np.array_equal(judge.quality[rows], kept[1][rows])
    assert (judge.ratio[work.quads[:, 0] < 0] == 0).all()


def test_a_corner_that_moves_cannot_open_gets_another_connectivity() -> None:
    mesh = disturbed(8, 0.0, 0)
    # two elements around an inner node: whatever the moves, one of them keeps a corner of half a turn or more
    a, b, c, d = mesh.quads[27]
    quads = np.vstack([np.delete(mesh.quads, 27, axis=0), [[a, b, c, mesh.n_points], [a, mesh.n_points, c, d]]])
    points = np.vstack([mesh.points, mesh.points[[b]] + 1e-3])
    tangled = QuadMesh(points, quads.astype(np.int32), np.append(mesh.curve, -1), np.append(mesh.fixed, False))
    work, judge = prepared(uniform(0.2), tangled)
    low = np.flatnonzero(judge.quality < 0.7)
    assert len(low)
    assert Mender(work, judge).mend(judge.rings(low, 1), 0.75, 0.5, True) > 0
    assert shape_quality(work.result()).min() > 0.75
    assert not len(judge.wrong)


def test_each_of_several_bad_elements_counts() -> None:
    work, judge = prepared(uniform(0.2), disturbed(8, 0.1, 1))
    rows = np.arange(5)
    demerit, lowest = _mend_kernels.grade(rows, 5, work.patch, np.zeros(len(work.quads)), 1.0)
    assert demerit == pytest.approx((1.0 - judge.quality[rows]).sum(), rel=1e-12)
    assert lowest == judge.quality[rows].min()


def test_nothing_is_changed_where_nothing_is_asked() -> None:
    work, judge = prepared(uniform(0.2), disturbed(8, 0.1, 1))
    quads, xy = work.quads.copy(), work.xy.copy()
    assert Mender(work, judge).mend(np.arange(len(work.xy)), 0.5, 0.5, True) == 0
    assert np.array_equal(work.quads[: len(quads)], quads)
    assert np.array_equal(work.xy[: len(xy)], xy)


def test_estimates_of_a_formulas_minimum_end_in_exact_ones() -> None:
    field = dip(0.07)
    exact = AnalyticSize(lambda x, y: 0.13 - 0.06 * np.exp(-(((x - 0.5) ** 2 + (y - 0.5) ** 2) / 0.04)), field)
    work = Workspace(disturbed(10, 0.1, 3), unit(), field, SmoothOptions())
    judge = Judge(work, exact)
    work.sweep(5)
    judge.look(judge.alive)
    judge.verify()
    near = judge.ratio > 0.95
    edges = np.roll(work.xy[work.quads], -1, axis=1) - work.xy[work.quads]
    ratio = np.hypot(*edges.T).max(axis=0) / exact.min_over(work.xy, work.quads)
    assert judge.ratio[near] == pytest.approx(ratio[near], rel=1e-9)
    assert ((ratio > 1 + 1e-9) == (judge.ratio > 1 + 1e-9)).all()
