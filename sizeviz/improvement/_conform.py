"""R and quality of the elements of a workspace, and moves that are taken back where they make either worse."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.improvement import _worst_kernels

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sizeviz.improvement._workspace import Workspace
    from sizeviz.sizing.analytic import SizeFunction

TOLERANCE = 1e-9
"""R up to 1 plus this counts as correct."""


def longest_edges(points: NDArray[np.float64], quads: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return the longest edge of each element, ``(Q,)``."""
    corner = points[quads]
    edge = np.roll(corner, -1, axis=1) - corner
    return np.sqrt((edge**2).sum(axis=2).max(axis=1))


class Judge:
    """Longest edges against the smallest size over each element, exact for the reference.

    Parameters
    ----------
    work : Workspace
        Whose elements are judged, where they are now.
    reference : SizeFunction
        What they are judged against.
    """

    def __init__(self, work: Workspace, reference: SizeFunction) -> None:
        self.work, self.reference = work, reference
        self.least = np.empty(len(work.quads))
        self.ratio = np.empty(len(work.quads))
        self.quality = np.empty(len(work.quads))
        self.look(np.arange(len(work.quads)))

    def look(self, rows: NDArray[np.int64]) -> None:
        """Judge some elements again."""
        work = self.work
        quads = work.quads[rows]
        self.least[rows] = self.reference.min_over(work.xy, quads, threads=work.options.threads)
        self.ratio[rows] = longest_edges(work.xy, quads) / self.least[rows]
        _worst_kernels.qualities(rows, work.xy, work.quads, self.quality)

    @property
    def wrong(self) -> NDArray[np.int64]:
        """Elements with R above 1."""
        return np.flatnonzero(self.ratio > 1.0 + TOLERANCE)

    def limit(self, rows: NDArray[np.int64], slack: float) -> None:
        """Bound the edges of some elements by ``slack`` times the smallest size over them."""
        self.work.bound[rows] = 1.0 / (slack * self.least[rows]) ** 2

    def guarded(self, move: Callable[[], object], floor: float) -> None:
        """Make a move, and take back what makes an element wrong, or worse than it was and than ``floor``."""
        work = self.work
        xy, station = work.xy.copy(), work.station.copy()
        ratio, quality = np.maximum(self.ratio, 1.0), np.minimum(self.quality, floor)
        move()
        rows = self.touched(np.flatnonzero((work.xy != xy).any(axis=1)))
        while len(rows):
            self.look(rows)
            bad = rows[(self.ratio[rows] > ratio[rows] + TOLERANCE) | (self.quality[rows] < quality[rows])]
            nodes = np.unique(work.quads[bad])
            nodes = nodes[(work.xy[nodes] != xy[nodes]).any(axis=1)]
            work.xy[nodes], work.station[nodes] = xy[nodes], station[nodes]
            rows = self.touched(nodes)

    def touched(self, nodes: NDArray[np.integer]) -> NDArray[np.int64]:
        """Return the elements around some nodes."""
        mark = np.zeros(len(self.work.xy), dtype=bool)
        mark[nodes] = True
        return np.flatnonzero(mark[self.work.quads].any(axis=1))

    def rings(self, rows: NDArray[np.int64], count: int) -> NDArray[np.integer]:
        """Return the nodes of some elements and of ``count`` rings of elements around them."""
        nodes = np.unique(self.work.quads[rows])
        for _ in range(count):
            nodes = np.unique(self.work.quads[self.touched(nodes)])
        return nodes
