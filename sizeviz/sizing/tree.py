"""A bounding-box tree over the triangles of a background mesh, for point location and branch and bound."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import read_only
from sizeviz.sizing._tree_kernels import FANOUT, bound_boxes, bound_sizes, hilbert_keys, link_neighbours

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class TriangleTree:
    """Triangles in the order of a Hilbert curve, four to a leaf, four children to every inner node.

    Leaves come first, the root last; node ``k`` holds triangles or nodes ``children[k, 0]`` to ``children[k, 1]``.

    Parameters
    ----------
    triangles : (T, 3) int32
        The background's triangles, reordered, counter-clockwise, without those of no area.
    neighbours : (T, 3) int32
        The triangle across the edge opposite each corner, -1 where there is none.
    boxes : (M, 4) float64
        Smallest x and y, largest x and y under each tree node.
    children : (M, 2) int32
        First and one past the last child.
    """

    triangles: NDArray[np.int32]
    neighbours: NDArray[np.int32]
    boxes: NDArray[np.float64]
    children: NDArray[np.int32]

    @property
    def n_leaves(self) -> int:
        """Number of leaves; node numbers below it are leaves."""
        return -(-len(self.triangles) // FANOUT)

    @property
    def shapes(self) -> NDArray[np.int64]:
        """Number of nodes, 1, and first node of each level, ``(L, 3)``, leaves first: the columns of ``pyramid``."""
        counts = [self.n_leaves]
        while counts[-1] > 1:
            counts.append(-(-counts[-1] // FANOUT))
        first = np.concatenate([[0], np.cumsum(counts[:-1])])
        return read_only(np.column_stack([counts, np.ones(len(counts)), first]).astype(np.int64))

    def cells(self, points: NDArray[np.float64], sizes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return all that interpolation needs, triangle by triangle, so that a query touches one row.

        Returns
        -------
        (T, 12) float64
            x and y of the three corners, their sizes, and the numbers of the neighbours across the opposite edges.
        """
        corners = points[self.triangles].reshape(-1, 6)
        return read_only(np.column_stack([corners, sizes[self.triangles], self.neighbours]))

    def lowest(self, sizes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the smallest nodal size under every tree node, ``(M,)``."""
        return read_only(bound_sizes(sizes, self.triangles, self.children, self.n_leaves))


def tree_over(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> TriangleTree:
    """Return the tree over some triangles.

    Raises
    ------
    InputError
        If no triangle has an area.
    """
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    turned = np.where((area < 0)[:, None], triangles[:, ::-1], triangles)[area != 0]
    if not len(turned):
        raise InputError("background mesh: no triangle has an area; check points and triangles")
    ordered = read_only(turned[np.argsort(hilbert_keys(points, turned), kind="stable")])
    children = _children(len(ordered))
    boxes = bound_boxes(points, ordered, children, -(-len(ordered) // FANOUT))
    neighbours = link_neighbours(ordered, len(points))
    return TriangleTree(ordered, read_only(neighbours), read_only(boxes), children)


def _children(count: int) -> NDArray[np.int32]:
    """Return the child ranges of every node of a tree over ``count`` triangles, ``(M, 2)`` int32."""
    levels, first = [], 0
    while True:
        n_nodes = -(-count // FANOUT)
        starts = first + FANOUT * np.arange(n_nodes)
        levels.append(np.column_stack([starts, np.minimum(starts + FANOUT, first + count)]))
        if n_nodes == 1:
            break
        first = 0 if len(levels) == 1 else first + count
        count = n_nodes
    return read_only(np.vstack(levels).astype(np.int32))
