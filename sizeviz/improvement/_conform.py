"""R and quality of the elements of a workspace, and moves that are taken back where they make either worse."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.improvement import _look_kernels
from sizeviz.improvement._workspace import longer
from sizeviz.sizing import SizeField
from sizeviz.sizing.analytic import AnalyticSize
from sizeviz.threads import run_chunks

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sizeviz.improvement._workspace import Workspace
    from sizeviz.sizing.analytic import SizeFunction

TOLERANCE = 1e-9
"""R up to 1 plus this counts as correct."""
NEAR = 0.97
"""R as estimated above which a formula's own minimum is looked for."""
SAFE = 0.9
"""The same for the last look, which must not miss an element, where the field's error is not known."""
DOUBT = 3.0
"""Where it is, the last look takes so many times as much for possible."""
CHUNK = 8192
"""Elements judged in one go."""
MOVED = 0.1
"""Share of its longest edge that an element may move before a formula's minimum over it is looked for again."""


class Judge:
    """Longest edges against the smallest size over each element, exact for the reference.

    A formula's minimum is dear. Its ratio to that of the piecewise-linear field is kept with each element, and serves
    as an estimate until the element has moved by ``MOVED`` of its size; ``verify`` trusts no estimate.

    Parameters
    ----------
    work : Workspace
        Whose elements are judged, where they are now; elements whose first node is -1 are dead.
    reference : SizeFunction
        What they are judged against.

    Raises
    ------
    InputError
        If the reference is neither a size field nor a formula with one.
    """

    def __init__(self, work: Workspace, reference: SizeFunction) -> None:
        self.work, self.reference = work, reference
        field = reference.field if isinstance(reference, AnalyticSize) else reference
        if not isinstance(field, SizeField):
            raise InputError(f"{field.label}: only a size field or a formula can be guaranteed")
        self.field, self.exact = field, field is reference
        n = len(work.quads)
        self.least, self.ratio, self.quality = np.empty(n), np.zeros(n), np.ones(n)
        self.share = np.ones(n)
        self.seen = np.full((n, 4, 2), np.inf)
        self.known = np.full((0 if self.exact else n, 4, 2), np.inf)
        self.look(self.alive)

    @property
    def alive(self) -> NDArray[np.int64]:
        """Elements that are not dead."""
        return np.flatnonzero(self.work.quads[:, 0] >= 0)

    def lengthen(self) -> None:
        """Make room for the elements that the workspace has been lengthened by."""
        more = len(self.work.quads) - len(self.least)
        for name, value in (("least", 1.0), ("ratio", 0.0), ("quality", 1.0), ("share", 1.0)):
            setattr(self, name, longer(getattr(self, name), more, value))
        nowhere = np.full((more, 4, 2), np.inf)
        self.seen = np.concatenate([self.seen, nowhere])
        if not self.exact:
            self.known = np.concatenate([self.known, nowhere])

    def look(self, rows: NDArray[np.int64], near: float = NEAR, moved: float = MOVED) -> None:
        """Judge again those of some elements that are no longer where they were.

        A formula's own minimum is looked for only where R comes ``near`` to 1 and they ``moved``.
        """
        work, searcher = self.work, self.field.searcher

        def some(first: int, last: int) -> None:
            _look_kernels.look(
                first, last, rows, work.xy, work.quads, searcher, self.share, self.seen, self.least, self.ratio,
                self.quality,
            )  # fmt: skip

        run_chunks(some, len(rows), chunk=CHUNK, threads=work.options.threads)
        if self.exact:
            return
        rows = rows[self.ratio[rows] > near]
        away = np.abs(work.xy[work.quads[rows]] - self.known[rows]).max(axis=(1, 2))
        self._look_closely(rows[away > moved * self.ratio[rows] * self.least[rows]])

    def _look_closely(self, rows: NDArray[np.int64]) -> None:
        work = self.work
        corners = work.xy[work.quads[rows]]
        own = np.arange(4 * len(rows), dtype=np.int32).reshape(-1, 4)
        least = self.reference.min_over(corners.reshape(-1, 2), own, threads=work.options.threads)
        found = least / self.least[rows]
        self.share[rows] *= found
        self.ratio[rows] /= found
        self.least[rows], self.known[rows] = least, corners

    def verify(self) -> None:
        """Judge every element that comes near to 1 by the reference itself, where it is now."""
        error = self.reference.error if isinstance(self.reference, AnalyticSize) else None
        self.look(self.alive, SAFE if error is None else max(SAFE, 1.0 / (1.0 + DOUBT * error)), 0.0)

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
        filled = np.arange(self.work.ring.shape[1]) < self.work.count[nodes, None]
        rows = self.work.ring[nodes][filled] >> 2
        mark = np.zeros(len(self.work.quads), dtype=bool)
        mark[rows] = True
        return np.flatnonzero(mark)

    def rings(self, rows: NDArray[np.int64], count: int) -> NDArray[np.integer]:
        """Return the nodes of some elements and of ``count`` rings of elements around them."""
        nodes = np.unique(self.work.quads[rows])
        for _ in range(count):
            nodes = np.unique(self.work.quads[self.touched(nodes)])
        return nodes
