"""R and quality of the elements of a workspace, and moves that are taken back where they make either worse."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.improvement import _worst_kernels
from sizeviz.sizing.analytic import AnalyticSize

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sizeviz.improvement._workspace import Workspace
    from sizeviz.sizing.analytic import SizeFunction

TOLERANCE = 1e-9
"""R up to 1 plus this counts as correct."""
NEAR = 0.97
"""R against the piecewise-linear field above which a formula's own minimum is looked for: the two differ by less."""
FEW = 16
"""A list of nodes shorter than the mesh by this factor is not looked for in all elements."""
SAFE = 0.9
"""The same for the last look, which must not miss an element."""


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
        self.field = reference.field if isinstance(reference, AnalyticSize) else reference
        self.least = np.empty(len(work.quads))
        self.ratio = np.empty(len(work.quads))
        self.quality = np.empty(len(work.quads))
        self.look(np.arange(len(work.quads)))

    def look(self, rows: NDArray[np.int64], near: float = NEAR) -> None:
        """Judge some elements again; a formula's own minimum is dear, so only where R comes ``near`` to 1."""
        work = self.work
        self._measure(rows, self.field)
        if self.field is not self.reference:
            self._measure(rows[self.ratio[rows] > near], self.reference)
        _worst_kernels.qualities(rows, work.xy, work.quads, self.quality)

    def _measure(self, rows: NDArray[np.int64], size: SizeFunction) -> None:
        work, quads = self.work, self.work.quads[rows]
        self.least[rows] = size.min_over(work.xy, quads, threads=work.options.threads)
        self.ratio[rows] = longest_edges(work.xy, quads) / self.least[rows]

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
        if FEW * len(nodes) < len(self.work.xy):
            filled = np.arange(self.work.ring.shape[1]) < self.work.count[nodes, None]
            return np.unique(self.work.ring[nodes][filled] >> 2).astype(np.int64)
        mark = np.zeros(len(self.work.xy), dtype=bool)
        mark[nodes] = True
        return np.flatnonzero(mark[self.work.quads].any(axis=1))

    def rings(self, rows: NDArray[np.int64], count: int) -> NDArray[np.integer]:
        """Return the nodes of some elements and of ``count`` rings of elements around them."""
        nodes = np.unique(self.work.quads[rows])
        for _ in range(count):
            nodes = np.unique(self.work.quads[self.touched(nodes)])
        return nodes
