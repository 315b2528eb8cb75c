"""Each operation on the connectivity: applied, undone bit for bit, and what it changes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from sizeviz.geometry import Domain, QuadMesh
from sizeviz.improvement import SmoothOptions
from sizeviz.improvement import _attempt_kernels as attempts
from sizeviz.improvement import _operation_kernels as operations
from sizeviz.improvement._candidate_kernels import IMPOSSIBLE, swap_change
from sizeviz.improvement._mesh_kernels import fill_rings, find_next, sector_counts
from sizeviz.improvement._workspace import Workspace
from sizeviz.improvement.cleanup import Cleaner
from sizeviz.sizing import BackgroundMesh, Grid, SizeField
from tests.improvement.squares import disturbed, edge_uses, uniform, unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

ANY, NONE = 1e9, -1e9
"""Worth of valence energy that makes every valid operation stand, and one that lets none stand."""
NEW_ELEMENTS = {"collapse": -1, "swap": 0, "rotate": 0, "open": 1, "pillow": 4}


def prepared(n: int = 10) -> tuple[Workspace, Cleaner]:
    work = Workspace(disturbed(n, 0.1, 1), unit(), uniform(1.0 / n), SmoothOptions(threads=1))
    work.sweep(2)
    return work, Cleaner(work)


def state(cleaner: Cleaner) -> list[NDArray[Any]]:
    work = cleaner.work
    return [a.copy() for a in (work.xy, work.quads, work.ring, work.count, work.station, work.sizes, work.inv)]


def tried(cleaner: Cleaner, kind: str, worth: float) -> int:
    """Try one operation at the node nearest to the middle; return how many nodes it moved, 0 where it was undone."""
    work, tile = cleaner.work, cleaner.tiles[0]
    away = np.hypot(*(work.xy - 0.5).T) + np.where(work.count == 4, 0.0, 9.0)
    code = work.ring[int(np.argmin(away)), 0]
    aims = (work.size.sampler, work.sizes, work.inv, work.hint, work.bound, work.scale**2)
    number = getattr(operations, kind.upper())
    law = (work.objective, worth, 0.0, 1e9, 0.0, 1e-3)
    argument = np.int64(2 if kind == "open" else 0)
    return attempts.attempt(
        number, np.int64(code), argument, np.int64(-1), cleaner.patch, cleaner.topo, cleaner._marks(tile), aims,
        work.rails, law, tile.room, tile.tops,
    )  # fmt: skip


@pytest.mark.parametrize("kind", sorted(NEW_ELEMENTS))
def test_an_operation_that_stands_keeps_area_and_topology(kind: str) -> None:
    work, cleaner = prepared()
    before = work.result()
    assert tried(cleaner, kind, ANY) > 0
    after = work.result()
    assert after.n_quads == before.n_quads + NEW_ELEMENTS[kind]
    assert after.areas.sum() == pytest.approx(1.0, abs=1e-12)
    assert edge_uses(after).max() == 2
    assert after.n_points - len(edge_uses(after)) + after.n_quads == 1
    alive = np.flatnonzero(work.quads[:, 0] >= 0)
    for v in range(len(work.xy)):
        around = sorted(4 * q + k for q in alive for k in range(4) if work.quads[q, k] == v)
        assert sorted(work.ring[v, : work.count[v]]) == around


@pytest.mark.parametrize("kind", sorted(NEW_ELEMENTS))
def test_an_operation_that_does_not_stand_leaves_no_trace(kind: str) -> None:
    work, cleaner = prepared()
    before = state(cleaner)
    tops = cleaner.tiles[0].tops.copy()
    assert tried(cleaner, kind, NONE) == 0
    for old, new in zip(before, state(cleaner), strict=True):
        assert np.array_equal(old[: len(work.xy)], new[: len(work.xy)]) or _same_where_alive(old, new, before)
    assert np.array_equal(cleaner.tiles[0].tops[:2], tops[:2])


def _same_where_alive(old: NDArray[Any], new: NDArray[Any], before: list[NDArray[Any]]) -> bool:
    """Compare live rows only: what a dead element or node holds means nothing."""
    alive = before[3] > 0 if len(old) == len(before[3]) else before[1][:, 0] >= 0
    return np.array_equal(old[alive], new[alive])


def test_a_doublet_becomes_one_element() -> None:
    mesh = disturbed(6, 0.1, 0)
    a, b, c, d = mesh.quads[14]
    middle = mesh.n_points
    quads = np.vstack([np.delete(mesh.quads, 14, axis=0), [[middle, a, b, c]], [[middle, c, d, a]]])
    points = np.vstack([mesh.points, mesh.points[mesh.quads[14]].mean(axis=0)])
    doubled = QuadMesh(points, quads, np.append(mesh.curve, -1), np.append(mesh.fixed, False))
    work = Workspace(doubled, unit(), uniform(1 / 6), SmoothOptions(threads=1))
    work.aim()
    cleaner = Cleaner(work)
    assert cleaner.run(-1000, 4) == 1
    result = work.result()
    assert result.n_quads == mesh.n_quads
    assert result.n_points == mesh.n_points
    assert result.areas.sum() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("turn", [0, 1])
def test_a_turned_edge_begins_without_flat_corners(turn: int) -> None:
    # within two squares it would leave corners of 180 degrees at the ends of the old one
    work = Workspace(disturbed(10, 0.0, 0), unit(), uniform(0.1), SmoothOptions(threads=1))
    cleaner, room = Cleaner(work), Cleaner(work).tiles[0].room
    old, new, spots = room[0], room[1], room[2]
    code = work.ring[int(np.argmin(np.hypot(*(work.xy - 0.5).T))), 0]
    n_old, n_new, n_spots = operations.build_swap(
        np.int64(code), np.int64(turn), cleaner.patch, cleaner.topo[1], cleaner.topo[3], old, new, spots
    )
    assert (n_old, n_new, n_spots) == (2, 2, 4)
    points = work.xy.copy()
    points[spots[:n_spots, 0].astype(int)] = spots[:n_spots, 1:]
    quads = np.vstack(
        [new[:n_new], work.quads[(work.quads[:, 0] >= 0) & ~np.isin(np.arange(len(work.quads)), old[:2])]]
    )
    ahead, behind = (
        points[np.roll(quads, -1, axis=1)] - points[quads],
        points[np.roll(quads, 1, axis=1)] - points[quads],
    )
    corner = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    assert corner.min() > 0.3 * 0.1**2


def test_what_failed_is_tried_again_only_after_a_change_nearby() -> None:
    work, cleaner = prepared()
    tile = cleaner.tiles[0]
    assert tried(cleaner, "swap", NONE) == 0
    assert np.count_nonzero(cleaner.failed) == 1
    stamp = tile.tops[2]
    assert tried(cleaner, "swap", ANY) == 0
    assert tile.tops[2] == stamp, "it was built and measured again"
    assert tried(cleaner, "collapse", ANY) > 0
    assert np.count_nonzero(cleaner.failed[work.quads[:, 0] >= 0]) == 0
    assert tried(cleaner, "swap", ANY) > 0


def strip() -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Return a rectangle of two squares; the edge between them joins two nodes of the boundary."""
    points = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]])
    return points, np.array([[0, 1, 4, 3], [1, 2, 5, 4]], dtype=np.int32)


@pytest.mark.parametrize("line", ["none", "beside", "there"])
def test_an_edge_between_two_fixed_nodes_turns_unless_a_line_lies_there(line: str) -> None:
    points, quads = strip()
    across = np.array([[1.0, 0.0], [1.0, 1.0]])
    # two lines that pass by its ends say nothing about the edge between them
    beside = (np.array([[1.0, 0.0], [2.0, 1.0]]), np.array([[1.0, 1.0], [0.0, 0.0]]))
    lines = {"none": (), "there": (across,), "beside": beside}[line]
    domain = Domain.rectangle(0.0, 0.0, 2.0, 1.0)
    domain = Domain(domain.outer, lines=lines)
    mesh = QuadMesh(points, quads, np.zeros(6, dtype=np.int32), np.ones(6, dtype=bool))
    work = Workspace(mesh, domain, SizeField(BackgroundMesh.regular(Grid(0.0, 0.0, 1.0, 1.0, 3, 2)), np.ones(6)),
                     SmoothOptions(threads=1))  # fmt: skip
    cleaner = Cleaner(work)
    a, b = (int(np.argmin(np.hypot(*(work.xy - p).T))) for p in ([1.0, 0.0], [1.0, 1.0]))
    code = find_next(a, b, work.quads, work.ring, work.count)
    change = swap_change(np.int64(code), np.int64(0), cleaner.patch, cleaner.topo)
    assert (change == IMPOSSIBLE) == (line == "there")


@pytest.mark.parametrize(("slope", "wanted"), [(0.2, 3), (1.5, 2), (5.0, 2)])
def test_elements_are_wanted_on_each_side_of_a_line(slope: float, wanted: int) -> None:
    # a side below 135 degrees has room for one element, the other then for two
    end = np.array([1.0, slope])
    points = np.array([[0.0, 0.0], [1.0, 0.0], end, [-1.0, 0.0], 2.0 * end, [0.0, 3.0 * slope + 3.0]])
    quads = np.array([[0, 1, 4, 2], [0, 2, 5, 3]], dtype=np.int32)
    count, ring = np.zeros(6, dtype=np.int32), np.zeros((6, 6), dtype=np.int32)
    fill_rings(quads, ring, count)
    links = np.array([[2], [-1], [0], [-1], [-1], [-1]], dtype=np.int32)
    assert sector_counts(0, (points, quads, ring, count), links) == wanted
