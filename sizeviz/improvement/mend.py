"""Operations on the connectivity where moves alone leave elements too large or badly shaped."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.improvement import _mend_kernels
from sizeviz.improvement.cleanup import SPARE, Cleaner
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.improvement._conform import Judge
    from sizeviz.improvement._workspace import Workspace

BUDGET = 64
"""Nodes visited between two looks at the monitor."""
LARGEST_CHANGE, SMALL_CHANGE = 8, 4
"""Change of valence energy that an operation may bring; the split of a regular node brings 4."""
HOPE = 0.3
"""Demerit over that before which raising the qualities around an operation seldom makes good."""


class Mender:
    """Tries operations around the elements that a judge finds wrong or too badly shaped.

    The workspace is lengthened, and must be compacted when all is done.

    Parameters
    ----------
    work : Workspace
        Whose connectivity is changed.
    judge : Judge
        Of the workspace.
    """

    def __init__(self, work: Workspace, judge: Judge) -> None:
        self.work, self.judge = work, judge
        self._begin()

    def _begin(self) -> None:
        self.cleaner = Cleaner(self.work, whole=True)
        self.judge.lengthen()

    def mend(
        self,
        nodes: NDArray[np.integer],
        floor: float,
        lowest: float,
        every: bool,
        monitor: Monitor = SILENT,
        *,
        quick: bool = False,
    ) -> int:
        """Apply, at each node that has a wrong or bad element, the operation that helps most; return how many stood.

        Parameters
        ----------
        nodes : (N,) int
            Where to try.
        floor : float
            Shape quality asked for.
        lowest : float
            Shape quality that no operation may go below, unless it was lower before.
        every : bool
            Whether all operations are tried; otherwise only those that insert an element.
        monitor : Monitor
            Told of progress.
        quick : bool
            Whether to leave out the operations that seldom stand.
        """
        work, judge = self.work, self.judge
        if self.cleaner.tiles[0].tops[:2].min() < SPARE:
            self._begin()
        cleaner = self.cleaner
        tile = cleaner.tiles[0]
        judge.limit(judge.alive, _mend_kernels.HELD)
        aims = (work.size.sampler, work.sizes, work.inv, work.hint, work.bound, work.scale**2)
        marks = (cleaner.zone, tile.number, *cleaner.seen)
        law = (work.objective, _mend_kernels.EDGE_WEIGHT)
        changed, failed = np.zeros(len(work.xy), dtype=np.bool_), np.zeros(len(work.quads), dtype=np.int16)
        change, goal = LARGEST_CHANGE, (floor, lowest, np.inf)
        if quick:
            change, goal = SMALL_CHANGE, (floor, lowest, HOPE)
        which = _mend_kernels.ALL if every else _mend_kernels.SPLITS
        listed = np.ascontiguousarray(nodes, dtype=np.int64)
        done = 0
        for first in range(0, len(listed), BUDGET):
            monitor.step(first / len(listed), "mending elements")
            done += _mend_kernels.mend(
                listed, first, min(first + BUDGET, len(listed)), which, change, work.patch, cleaner.topo, marks,
                aims, work.rails, law, judge.field.searcher, judge.share, goal,
                (changed, failed), tile.room, tile.tops,
            )  # fmt: skip
        if done:
            dead = work.quads[:, 0] < 0
            judge.ratio[dead], judge.quality[dead], judge.seen[dead] = 0.0, 1.0, np.inf
            judge.look(judge.touched(np.flatnonzero(changed & (work.count > 0))))
        return done
