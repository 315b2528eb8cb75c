"""Clean-up: operations on the connectivity that lower the valence energy, each relaxed before it is judged.

The mesh is cut into tiles of consecutive nodes of the Hilbert order. An operation whose nodes, and whose neighbours'
elements, lie within one tile touches nothing that another tile reads, so tiles run on any number of threads with the
same result; the cuts are shifted from round to round.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.improvement import _cleanup_kernels, _mesh_kernels
from sizeviz.improvement._candidate_kernels import MOST_CANDIDATES
from sizeviz.improvement._cavity_kernels import MOST_CORE, MOST_ELEMENTS
from sizeviz.improvement._operation_kernels import DEGENERATE
from sizeviz.improvement._star_kernels import star_size
from sizeviz.improvement._workspace import Workspace, longer
from sizeviz.improvement.lines import line_pairs
from sizeviz.improvement.options import SmoothOptions
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.threads import run_chunks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry.domain import Domain
    from sizeviz.geometry.quadmesh import QuadMesh
    from sizeviz.sizing import SizeField

TILE = 8192
"""Nodes of a tile."""
SPARE = 64
"""New nodes and elements that a tile has room for, beyond one in sixteen of its own."""
MOST_NODES = 200
MOST_REGION = 300
WORTH = 0.5
"""Distortion that one unit of valence energy is worth."""
GAIN = 1e-3
"""Least gain that an operation must bring."""
LOWEST_QUALITY = 0.55
LARGEST_STRETCH = 2.2
"""Longest edge over target size that an operation may leave, unless it was larger before."""
RESCUES = ((0.6, 2.2), (0.4, 3.0), (0.3, 3.0), (0.2, 4.0), (0.05, 8.0), (1e-3, 1e3), (1e-6, 1e3))
"""Quality demanded of a rescue and the longest edge over target size it may leave, ever more modest."""
TRIES = 12
"""Operations that a visit of the wide clean-up may try."""
MOST_VISITS, FEW_VISITS = 12, 5
"""How often one node is taken from the queue in one pass, so that a pass ends; the second where losses are allowed."""
LOSS = 0.45
"""Distortion that an operation may cost which changes no valence energy, but moves a pair of irregular nodes."""
BUDGET = 1024
"""Nodes visited between two looks at the monitor."""


class _Tile:
    """One tile's queue, free rows and scratch arrays."""

    def __init__(self, number: int, nodes: NDArray[np.int64], spare: range, spare_quads: range, width: int) -> None:
        self.number = number
        self.first, self.last = int(nodes[0]), int(nodes[-1]) + 1
        self.spare = spare
        room = len(nodes) + len(spare)
        self.queue = np.zeros(room, dtype=np.int64)
        free_nodes, free_quads = np.zeros(room, dtype=np.int64), np.zeros(3 * room, dtype=np.int64)
        free_nodes[: len(spare)], free_quads[: len(spare_quads)] = spare, spare_quads
        self.tops = np.array([len(spare), len(spare_quads), 0, 0, 0], dtype=np.int64)
        fan = tuple(np.zeros(MOST_ELEMENTS + 1, dtype=np.int64) for _ in range(3))
        kept = (
            np.zeros((MOST_ELEMENTS, 4), dtype=np.int32), np.zeros((MOST_CORE, width), dtype=np.int32),
            np.zeros(MOST_CORE, dtype=np.int32), np.zeros((MOST_NODES, 3)), np.zeros((MOST_REGION, 3)),
            np.zeros(MOST_REGION, dtype=np.int32),
        )  # fmt: skip
        self.room = (
            np.zeros(MOST_ELEMENTS, dtype=np.int64), np.zeros((MOST_ELEMENTS + 2, 4), dtype=np.int64),
            np.zeros((4, 3)), fan, np.zeros(MOST_ELEMENTS + 2, dtype=np.int64), np.zeros(MOST_CORE, dtype=np.int64),
            np.zeros(MOST_NODES, dtype=np.int64), np.zeros(MOST_REGION, dtype=np.int64), np.zeros(4, dtype=np.int64),
            np.zeros(star_size(width)), kept, free_nodes, free_quads, np.zeros(MOST_REGION, dtype=np.int64),
        )  # fmt: skip


class Cleaner:
    """The tiles of a workspace; ``work`` must be rebuilt (``Workspace.compact``) when they are done.

    Parameters
    ----------
    work : Workspace
        Whose arrays are changed in place, and lengthened.
    shift : bool
        Whether the cuts between tiles lie half a tile further on.
    whole : bool
        Whether one tile holds everything.
    """

    def __init__(self, work: Workspace, shift: bool = False, whole: bool = False) -> None:
        self.work = work
        n = len(work.xy)
        tile_of = (np.arange(n, dtype=np.int64) + (TILE // 2 if shift and n > TILE else 0)) // (n if whole else TILE)
        n_tiles = int(tile_of[-1]) + 1
        spare = SPARE + (n if whole else TILE) // 16
        self.patch = work.patch
        boundary = np.zeros(n, dtype=np.bool_)
        _mesh_kernels.mark_boundary(work.quads, work.ring, work.count, boundary)
        ideal = np.zeros(n, dtype=np.int32)
        links = _links(work)
        _mesh_kernels.ideal_counts(work.patch, boundary, links, ideal)
        zone = np.zeros(n, dtype=np.int32)
        _mesh_kernels.own_nodes(tile_of, self.patch, zone)
        guard = (work.curve >= 0) | work.fixed | boundary
        more = n_tiles * spare
        work.lengthen(more, more)
        self.patch = work.patch
        links = np.vstack([links, np.full((more, links.shape[1]), -1, dtype=np.int32)])
        self.topo = (longer(ideal, more, 4), longer(guard, more, False), longer(boundary, more, False), links)
        self.zone = np.concatenate([zone, np.repeat(np.arange(n_tiles, dtype=np.int32), spare)])
        self.seen = np.zeros(n + more, dtype=np.int64), np.zeros(len(work.quads), dtype=np.int64)
        self.awake, self.failed = np.zeros(n + more, dtype=np.bool_), np.zeros(len(work.quads), dtype=np.int16)
        self.loss = 0.0
        self.queued, self.visits = np.zeros(n + more, dtype=np.bool_), np.zeros(n + more, dtype=np.int32)
        first_quad = len(work.quads) - more
        self.tiles = [
            _Tile(
                t, np.flatnonzero(tile_of == t), range(n + t * spare, n + (t + 1) * spare),
                range(first_quad + t * spare, first_quad + (t + 1) * spare), work.ring.shape[1],
            )
            for t in range(n_tiles)
        ]  # fmt: skip

    def run(self, limit: int, tries: int, monitor: Monitor = SILENT, *, loss: float = 0.0) -> int:
        """Make one pass with operations that change the valence energy by at most ``limit``; return how many stood.

        Each must gain a little, or may cost up to ``loss``.
        """
        law = (self.work.objective, WORTH, LOWEST_QUALITY, LARGEST_STRETCH**2, 0.0, -loss if loss > 0.0 else GAIN)
        if loss != self.loss:
            self.loss = loss
            self.failed[:] = 0
        for tile in self.tiles:
            for first, last in ((tile.first, tile.last), (tile.spare.start, tile.spare.stop)):
                _cleanup_kernels.seed_queue(
                    first, last, self.patch, self.topo, self._marks(tile), tile.queue, self.queued, self.visits,
                    tile.tops,
                )  # fmt: skip
        waiting = list(self.tiles)
        total = max(1, sum(int(tile.tops[4]) for tile in waiting))
        done = np.zeros(len(self.tiles), dtype=np.int64)
        share = 0.0
        while waiting:
            left = sum(int(tile.tops[4]) for tile in waiting) / total
            part = SubMonitor(monitor, share, max(share, 1.0 - left))
            share = part.stop

            def visit(first: int, last: int, waiting: list[_Tile] = waiting) -> None:
                for tile in waiting[first:last]:
                    done[tile.number] += self._clean(tile, limit, tries, law)

            run_chunks(visit, len(waiting), chunk=1, threads=self.work.options.threads, monitor=part,
                       message="cleaning up")  # fmt: skip
            waiting = [tile for tile in waiting if tile.tops[4] > 0]
        return int(done.sum())

    def _marks(self, tile: _Tile) -> tuple[Any, ...]:
        return self.zone, tile.number, *self.seen, self.awake, self.failed

    def _clean(self, tile: _Tile, limit: int, tries: int, law: tuple[Any, ...]) -> int:
        work = self.work
        aims = (work.size.sampler, work.sizes, work.inv, work.hint, work.bound, work.scale**2)
        return _cleanup_kernels.clean_tile(
            BUDGET, FEW_VISITS if law[5] < 0.0 else MOST_VISITS, limit, tries, self.patch, self.topo,
            self._marks(tile), aims, work.rails, law, tile.room, tile.tops, tile.queue, self.queued, self.visits,
        )  # fmt: skip

    def rescue(self, nodes: NDArray[np.integer], demand: float, stretch: float) -> int:
        """Try every operation at some nodes until one leaves no quality below ``demand``; return how many stood.

        ``stretch`` is the longest edge over the target size that it may leave. The cleaner must be ``whole``.
        """
        law = (self.work.objective, 0.0, 0.0, stretch**2, demand, 0.0)
        tile = self.tiles[0]
        tile.queue[: len(nodes)], self.queued[nodes] = nodes, True
        tile.tops[3:5] = 0, len(nodes)
        done = 0
        while tile.tops[4] > 0:
            done += self._clean(tile, DEGENERATE // 2, MOST_CANDIDATES - 1, law)
        return done


def _links(work: Workspace) -> NDArray[np.int32]:
    """Return the neighbours of each node along inner lines, a row a node, -1 where there are fewer.

    Clean-up neither moves a node off its line nor takes one away, so these edges stay what they are.
    """
    alive = work.xy[work.count > 0]
    pairs = line_pairs(work.domain, work.xy, work.curve, work.fixed, float(np.ptp(alive, axis=0).max()))
    one, other = np.vstack([pairs, pairs[:, ::-1]]).T
    order = np.argsort(one, kind="stable")
    one, other = one[order], other[order]
    place = np.arange(len(one)) - np.searchsorted(one, one)
    links = np.full((len(work.xy), int(place.max(initial=0)) + 1), -1, dtype=np.int32)
    links[one, place] = other
    return links


def cleaned(
    mesh: QuadMesh,
    domain: Domain,
    size: SizeField,
    options: SmoothOptions | None = None,
    monitor: Monitor = SILENT,
) -> QuadMesh:
    """Return the mesh with fewer irregular nodes.

    Parameters
    ----------
    mesh : QuadMesh
        A raw mesh.
    domain : Domain
        The domain it was made for; every boundary node and constrained edge is kept.
    size : SizeField
        Target sizes, up to a common factor, which operations must not stray from.
    options : SmoothOptions, optional
        ``objective``, ``rounds`` and ``threads`` are used.
    monitor : Monitor
        Told of progress.

    Raises
    ------
    InputError
        If the mesh is empty or does not belong to the domain.
    Cancelled
        If the monitor says so.
    """
    options = options or SmoothOptions()
    work = Workspace(mesh, domain, size, options)
    work.aim()
    clean_fast(work, SubMonitor(monitor, 0.0, 0.2))
    clean_wide(work, options.rounds, SubMonitor(monitor, 0.2, 1.0))
    return work.result()


def clean_fast(work: Workspace, monitor: Monitor = SILENT) -> None:
    """Apply operations that lower the valence energy, the strongest first."""
    cleaner = Cleaner(work)
    cleaner.run(-3, 4, SubMonitor(monitor, 0.0, 0.3))
    cleaner.run(-1, 6, SubMonitor(monitor, 0.3, 1.0))
    work.compact()


def rescue(work: Workspace, below: float) -> int:
    """Change the connectivity around elements whose quality lies below ``below``, inverted ones above all.

    Untangling moves nodes only; an inner node with two elements, or a flat boundary node with one, leaves an element
    that no move makes valid. Returns how many elements are still inverted.
    """
    for demand, stretch in RESCUES:
        rows = work.below(min(below, demand))
        if not len(rows):
            break
        done = Cleaner(work, whole=True).rescue(np.unique(work.quads[rows]), demand, stretch)
        work.compact()
        if done:
            work.sweep_around(work.below(below))
            work.lift(work.options.floor)
    return len(work.below(0.0))


def clean_wide(work: Workspace, rounds: int, monitor: Monitor = SILENT) -> None:
    """Apply operations that do not raise the valence energy, with three sweeps after each round.

    What these leave are pairs of irregular nodes that no single operation brings nearer to one another without a loss
    of shape. In every round but the last they may move at one: where they meet others they vanish, and the next round
    makes good what was lost.
    """
    for n in range(rounds):
        part = SubMonitor(monitor, n / rounds, (n + 1) / rounds)
        cleaner = Cleaner(work, shift=n % 2 == 0)
        cleaner.run(-1, TRIES, SubMonitor(part, 0.0, 0.1))
        cleaner.run(0, TRIES, SubMonitor(part, 0.1, 0.5))
        if n < rounds - 1:
            cleaner.run(0, TRIES, SubMonitor(part, 0.5, 0.8), loss=LOSS)
        work.compact()
        work.sweep(3, SubMonitor(part, 0.8, 1.0))
