"""Clean-up: fewer irregular nodes, the same area and boundary, the same for any number of threads."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.conformity import irregular_fraction, shape_quality
from sizeviz.errors import Cancelled
from sizeviz.geometry import QuadMesh
from sizeviz.improvement import SmoothOptions, cleaned, improved
from sizeviz.improvement import cleanup as module
from tests.improvement.squares import disturbed, edge_uses, thirds, uniform, unit


def check(before: QuadMesh, after: QuadMesh) -> None:
    """Say that a mesh covers what it did, is conforming, and kept every boundary node."""
    assert after.areas.sum() == pytest.approx(before.areas.sum(), abs=1e-12)
    assert edge_uses(after).max() == 2
    assert (edge_uses(after) == 1).sum() == (edge_uses(before) == 1).sum()
    assert (after.curve >= 0).sum() == (before.curve >= 0).sum()
    assert len(np.unique(after.quads)) == after.n_points
    assert (shape_quality(after) > 0).all()
    # Euler: the square has one boundary loop
    assert after.n_points - len(edge_uses(after)) + after.n_quads == 1


@pytest.mark.parametrize("seed", range(2))
def test_most_irregular_nodes_of_a_cut_triangulation_go(seed: int) -> None:
    mesh = thirds(16, seed)
    result = cleaned(mesh, unit(), uniform())
    check(mesh, result)
    assert irregular_fraction(result) < 0.5 * irregular_fraction(mesh)


def test_rounds_that_may_lose_a_little_leave_fewer_irregular_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = thirds(24, 1)
    result = cleaned(mesh, unit(), uniform(), SmoothOptions(rounds=3))
    monkeypatch.setattr(module, "LOSS", 0.0)
    strict = cleaned(mesh, unit(), uniform(), SmoothOptions(rounds=3))
    check(mesh, result)
    assert irregular_fraction(result) < 0.9 * irregular_fraction(strict)


def test_a_regular_grid_is_left_alone() -> None:
    mesh = disturbed(12, 0.1, 0)
    result = cleaned(mesh, unit(), uniform())
    assert result.n_quads == mesh.n_quads
    assert irregular_fraction(result) == 0


def test_result_is_bitwise_the_same_for_any_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "TILE", 512)
    mesh = thirds(20, 3)
    one, two = (improved(mesh, unit(), uniform(), SmoothOptions(threads=n)) for n in (1, 2))
    assert np.array_equal(one.points, two.points)
    assert np.array_equal(one.quads, two.quads)
    check(mesh, one)


def test_improving_raises_quality_to_the_floor() -> None:
    mesh = thirds(16, 4)
    result = improved(mesh, unit(), uniform())
    check(mesh, result)
    assert shape_quality(result).min() > 0.6
    assert shape_quality(result).mean() > shape_quality(mesh).mean()


def test_a_flat_boundary_node_gets_a_second_element() -> None:
    # cutting triangles in three leaves one element at some corners of the triangulation on the boundary
    mesh = thirds(8, 6)
    result = improved(mesh, unit(), uniform())
    count = np.bincount(result.quads.ravel())
    assert count[(result.curve >= 0) & ~result.fixed].min() >= 2


class Stopper:
    """A monitor that cancels after a few steps."""

    def __init__(self) -> None:
        self.steps = 0

    def step(self, fraction: float, message: str = "") -> None:
        self.steps += 1
        assert 0.0 <= fraction <= 1.0
        if self.steps > 5:
            raise Cancelled


def test_clean_up_can_be_cancelled() -> None:
    with pytest.raises(Cancelled):
        improved(thirds(12, 5), unit(), uniform(), monitor=Stopper())
