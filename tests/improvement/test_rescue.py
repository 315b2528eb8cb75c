"""The rescue: elements that no move makes valid get another connectivity."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.conformity import shape_quality
from sizeviz.geometry import QuadMesh
from sizeviz.improvement import SmoothOptions
from sizeviz.improvement._workspace import Workspace
from sizeviz.improvement.cleanup import rescue
from tests.improvement.squares import disturbed, edge_uses, uniform, unit


def prepared(mesh: QuadMesh) -> Workspace:
    work = Workspace(mesh, unit(), uniform(), SmoothOptions())
    work.sweep(6)
    return work


def test_an_inner_node_with_two_elements_goes() -> None:
    mesh = disturbed(6, 0.0, 0)
    a, b, c, d = mesh.quads[14]
    inner = mesh.n_points
    quads = np.vstack([np.delete(mesh.quads, 14, axis=0), [[a, b, c, inner], [a, inner, c, d]]])
    points = np.vstack([mesh.points, mesh.points[[b]] + 1e-3])
    curve, fixed = np.append(mesh.curve, -1), np.append(mesh.fixed, False)
    work = prepared(QuadMesh(points, quads.astype(np.int32), curve, fixed))
    assert len(work.below(0.5))
    assert rescue(work, 0.5) == 0
    result = work.result()
    assert shape_quality(result).min() > 0.5
    assert np.bincount(result.quads.ravel())[result.curve < 0].min() >= 3


def test_a_flat_boundary_node_with_one_element_gets_another() -> None:
    mesh = disturbed(6, 0.0, 0)
    # the edge between two elements at the bottom is turned: 3 keeps one element, whose angle there is flat
    quads = mesh.quads.copy()
    quads[2], quads[3] = (2, 3, 4, 11), (2, 11, 10, 9)
    work = prepared(QuadMesh(mesh.points, quads, mesh.curve, mesh.fixed))
    assert len(work.below(0.05))
    assert rescue(work, 0.3) == 0
    result = work.result()
    assert shape_quality(result).min() > 0.3
    assert abs(result.areas.sum() - 1) < 1e-12
    assert edge_uses(result).max() == 2
    assert result.n_points - len(edge_uses(result)) + result.n_quads == 1


@pytest.mark.parametrize(("n", "turned"), [(6, (2, 4)), (4, (0, 2)), (8, (1, 3, 5))])
def test_flat_elements_side_by_side_are_mended_one_after_the_other(n: int, turned: tuple[int, ...]) -> None:
    mesh = disturbed(n, 0.0, 0)
    quads, width = mesh.quads.copy(), n + 1
    for i in turned:
        quads[i], quads[i + 1] = (i, i + 1, i + 2, i + 2 + width), (i, i + 2 + width, i + 1 + width, i + width)
    work = prepared(QuadMesh(mesh.points, quads, mesh.curve, mesh.fixed))
    assert len(work.below(1e-3)) == len(turned)
    assert rescue(work, 0.3) == 0
    result = work.result()
    assert shape_quality(result).min() > 0.3
    assert abs(result.areas.sum() - 1) < 1e-12
    assert edge_uses(result).max() == 2
    assert result.n_points - len(edge_uses(result)) + result.n_quads == 1


def test_what_is_good_is_left_alone() -> None:
    mesh = disturbed(6, 0.1, 1)
    work = prepared(mesh)
    quads = work.quads.copy()
    assert rescue(work, 0.3) == 0
    assert np.array_equal(work.quads, quads)
