"""Triangles that a recombination left among quadrilaterals: walked towards each other until they merge.

A triangle and the quadrilateral next to it form a pentagon; cut anew, the triangle comes out on another side. Step by
step along the shortest way through quadrilaterals it reaches another triangle, and the two become one quadrilateral.
No node is added or moved; the elements along the way lose shape, which smoothing gives back.
"""

from __future__ import annotations

import itertools
from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import MeshingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

Edge = tuple[int, int]


def merged(points: NDArray[np.float64], triangles: NDArray[np.int32], quads: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return quadrilaterals alone that cover what triangles and quadrilaterals covered.

    Parameters
    ----------
    points : (N, 2) float64
        Nodes.
    triangles : (T, 3) int32
        What is left over, counter-clockwise; few, or this takes long.
    quads : (Q, 4) int32
        The rest.

    Returns
    -------
    (Q + T/2, 4) int32
        Counter-clockwise, though a few may not be convex.

    Raises
    ------
    MeshingError
        If the triangles are odd in number, or one can reach no other.
    """
    if not len(triangles):
        return quads
    if len(triangles) % 2:
        raise MeshingError(
            f"{len(triangles)} triangles are left over, an odd number, which no recombination can mend; "
            "try another --mesh-scale or another --mesher"
        )
    work = _Patchwork(points, triangles, quads)
    while work.triangles:
        work.join(next(iter(work.triangles)))
    return np.array([cell for cell in work.cells if cell], dtype=np.int32)


class _Patchwork:
    """Cells with the edges that each lies on."""

    def __init__(self, points: NDArray[np.float64], triangles: NDArray[np.int32], quads: NDArray[np.int32]) -> None:
        self.points = points
        self.cells: list[tuple[int, ...]] = [tuple(cell) for cell in [*quads.tolist(), *triangles.tolist()]]
        self.triangles = dict.fromkeys(range(len(quads), len(self.cells)))
        self.beside: dict[Edge, set[int]] = {}
        for k in range(len(self.cells)):
            self._enter(k)

    def join(self, start: int) -> None:
        """Walk one triangle to the nearest other one, and merge the two."""
        way = self._way(start)
        here = start
        for towards, beyond in itertools.pairwise(way[1:]):
            here = self._step(here, towards, beyond)
        last = way[-1]
        pentagon = self._union(here, last)
        self._replace((here, last), pentagon)

    def _way(self, start: int) -> list[int]:
        """Return the cells from one triangle to the nearest other, through quadrilaterals."""
        came: dict[int, int] = {start: start}
        queue = deque([start])
        while queue:
            cell = queue.popleft()
            if cell != start and cell in self.triangles:
                way = [cell]
                while way[-1] != start:
                    way.append(came[way[-1]])
                return way[::-1]
            for other in self._neighbours(cell):
                if other not in came:
                    came[other] = cell
                    queue.append(other)
        raise MeshingError("a triangle is left over that no other can be reached from; try another --mesher")

    def _step(self, triangle: int, quad: int, beyond: int) -> int:
        """Cut the pentagon of a triangle and a quadrilateral so that the triangle lies beside a third cell."""
        pentagon = self._union(triangle, quad)
        gate = next(edge for edge in _edges(self.cells[quad]) if beyond in self.beside[_key(edge)])
        options = []
        for k in range(5):
            ring = pentagon[k:] + pentagon[:k]
            corner, rest = ring[:3], (ring[0], *ring[2:])
            if _key(gate) in {_key(edge) for edge in _edges(corner)[:2]}:
                options.append((min(self._worst(corner), self._worst(rest)), corner, rest))
        _, corner, rest = max(options)
        for cell in (triangle, quad):
            self._leave(cell)
        self.cells[triangle], self.cells[quad] = corner, rest
        for cell in (triangle, quad):
            self._enter(cell)
        return triangle

    def _union(self, first: int, second: int) -> tuple[int, ...]:
        """Return the corners of two neighbours together, in order, without the edge between them."""
        a, b = self.cells[first], self.cells[second]
        shared = next(edge for edge in _edges(a) if edge[::-1] in _edges(b))
        i, j = a.index(shared[1]), b.index(shared[0])
        return a[i:] + a[:i] + (b[j:] + b[:j])[1:-1]

    def _replace(self, old: tuple[int, int], new: tuple[int, ...]) -> None:
        for cell in old:
            self._leave(cell)
            self.triangles.pop(cell, None)
            self.cells[cell] = ()
        self.cells[old[0]] = new
        self._enter(old[0])

    def _neighbours(self, cell: int) -> list[int]:
        return [other for edge in _edges(self.cells[cell]) for other in self.beside[_key(edge)] if other != cell]

    def _enter(self, cell: int) -> None:
        for edge in _edges(self.cells[cell]):
            self.beside.setdefault(_key(edge), set()).add(cell)

    def _leave(self, cell: int) -> None:
        for edge in _edges(self.cells[cell]):
            self.beside[_key(edge)].discard(cell)

    def _worst(self, cell: tuple[int, ...]) -> float:
        """Return the smallest sine-like corner of a cell, negative where it folds."""
        corner = self.points[list(cell)]
        ahead, behind = np.roll(corner, -1, axis=0) - corner, np.roll(corner, 1, axis=0) - corner
        cross = ahead[:, 0] * behind[:, 1] - ahead[:, 1] * behind[:, 0]
        return float((cross / (np.hypot(*ahead.T) * np.hypot(*behind.T))).min())


def _edges(cell: tuple[int, ...]) -> list[Edge]:
    return list(zip(cell, cell[1:] + cell[:1], strict=True))


def _key(edge: Edge) -> Edge:
    return min(edge), max(edge)
