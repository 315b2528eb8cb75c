"""Exchanged diagonals: the triangulation stays one, and what could not be paired then can."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.geometry.delaunay import Triangulation, triangulated
from sizeviz.geometry.predicates import orientations
from sizeviz.meshing.frontal.mending import flipped, mended
from sizeviz.meshing.frontal.pairing import paired


def consistent(t: Triangulation) -> None:
    a, b, c = (t.points[t.triangles[:, k]] for k in range(3))
    assert (orientations(a, b, c) == 1).all()
    for k in range(3):
        for row in np.flatnonzero(t.neighbours[:, k] >= 0):
            other = t.neighbours[row, k]
            back = np.flatnonzero(t.neighbours[other] == row)
            assert len(back) == 1
            assert t.locked[row, k] == t.locked[other, back[0]]
            ends = {int(t.triangles[row, (k + 1) % 3]), int(t.triangles[row, (k + 2) % 3])}
            assert ends == {int(t.triangles[other, (back[0] + m) % 3]) for m in (1, 2)}


def test_a_flip_keeps_a_triangulation_and_twice_is_none_at_all() -> None:
    mesh = triangulated(np.random.default_rng(0).random((60, 2)))
    done = 0
    for t in range(len(mesh.triangles)):
        for i in np.flatnonzero(mesh.neighbours[t] >= 0):
            once = flipped(mesh, t, int(i))
            if once is None:
                continue
            done += 1
            consistent(once)
            back = flipped(once, t, int(np.flatnonzero(once.neighbours[t] == mesh.neighbours[t, i])[0]))
            assert back is not None
            assert {frozenset(row) for row in back.triangles.tolist()} == {
                frozenset(row) for row in mesh.triangles.tolist()
            }
    assert done > 50


def test_a_flip_that_would_fold_is_refused() -> None:
    dart = triangulated([[0, 0], [1, 0.1], [0, 1], [0.2, 0.2]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    inner = int(np.flatnonzero(dart.neighbours[0] >= 0)[0])
    assert flipped(dart, 0, inner) is None


def test_ears_on_one_triangle_are_mended() -> None:
    """Three ears around one triangle: one pair at most, until a diagonal is exchanged."""
    angle = np.deg2rad([90, 150, 210, 270, 330, 30])
    radius = np.array([1.0, 0.95, 1.0, 0.95, 1.0, 0.95])
    loop = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    edges = np.column_stack([np.arange(6), (np.arange(6) + 1) % 6])
    mesh = triangulated(loop, np.vstack([edges, [[1, 3], [3, 5], [5, 1]]]), bounding=[True] * 6 + [False] * 3)
    unlocked = Triangulation(mesh.points, mesh.triangles, mesh.neighbours, mesh.neighbours < 0, mesh.same_as)
    _, single = paired(unlocked)
    assert len(single) == 2
    after, quads, single = mended(unlocked)
    consistent(after)
    assert len(single) == 0
    corner = after.points[quads]
    p, q = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    x, y = loop.T
    area = 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))
    assert 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum() == pytest.approx(area)
