"""Size fields: piecewise-linear element sizes on a background mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.geometry.arrays import as_cells, as_points, as_sizes, read_only
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from sizeviz.sizing.background import BackgroundMesh


@dataclass(frozen=True, eq=False)
class SizeField:
    """Prescribed element sizes, linear on every triangle of a background mesh.

    Parameters
    ----------
    background : BackgroundMesh
        Where the sizes live.
    sizes : (V,) float64
        Size at each background node, in model units, finite and above 0.
    label : str
        What to call the field in messages and pictures.

    Raises
    ------
    InputError
        If a size is NaN, infinite, zero or negative, or their number is wrong.
    """

    background: BackgroundMesh
    sizes: NDArray[np.float64]
    label: str = "size field"

    def __post_init__(self) -> None:
        object.__setattr__(self, "sizes", as_sizes(self.sizes, len(self.background.points), self.label))

    def with_sizes(self, sizes: NDArray[np.float64], label: str | None = None) -> SizeField:
        """Return a field on the same background with other nodal sizes, ``(V,)``."""
        return replace(self, sizes=sizes, label=self.label if label is None else label)

    @cached_property
    def sampler(self) -> tuple[NDArray[Any], ...]:
        """What kernels hand to ``sizing._kernels.size_at``.

        Returns
        -------
        tuple
            ``(grid, sizes, cells, boxes, children)``, all read-only. ``grid`` is float64
            ``[x0, y0, dx, dy, nx, ny]``; on a triangulation nx is 0, and on a grid the last three are empty.
        """
        grid = self.background.grid
        if grid is not None:
            head = read_only(np.array([grid.x0, grid.y0, grid.dx, grid.dy, grid.nx, grid.ny], dtype=np.float64))
            no_children = read_only(np.empty((0, 2), dtype=np.int32))
            return head, self.sizes, read_only(np.empty((0, 12))), read_only(np.empty((0, 4))), no_children
        tree = self.background.tree
        cells = tree.cells(self.background.points, self.sizes)
        return read_only(np.zeros(6)), self.sizes, cells, tree.boxes, tree.children

    @cached_property
    def searcher(self) -> tuple[NDArray[Any], ...]:
        """What kernels hand to ``sizing._minimum_kernels.element_min``.

        Returns
        -------
        tuple
            The sampler's five arrays, then ``(shapes, lowest)``: the levels of a grid's pyramid or of the tree, and
            the least size of each block or under each node of the tree.
        """
        from sizeviz.sizing.pyramid import block_minima, pyramid

        grid = self.background.grid
        if grid is None:
            tree = self.background.tree
            return *self.sampler, tree.shapes, tree.lowest(self.sizes)
        return *self.sampler, pyramid(grid), block_minima(grid, self.sizes)

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the size at each of ``points`` (N, 2); outside the background that of its nearest point.

        Raises
        ------
        InputError
            If the points are not finite (N, 2) coordinates.
        """
        from sizeviz.sizing._kernels import sizes_at  # here, so that reading a field does not load numba

        where = as_points(points, self.label)
        sizes = np.empty(len(where))
        sizes_at(self.sampler, where, sizes, 0, len(where))
        return sizes

    def min_over(
        self,
        points: ArrayLike,
        quads: ArrayLike,
        threads: int | None = None,
        monitor: Monitor = SILENT,
    ) -> NDArray[np.float64]:
        """Return the least size over each quadrilateral, exact for the piecewise-linear field.

        Parameters
        ----------
        points : (P, 2) float64
            Nodes of the elements, in model units.
        quads : (Q, 4) int
            Corners of each element, in order.
        threads : int, optional
            Worker threads; every core by default.
        monitor : Monitor
            Told of progress; may cancel.

        Returns
        -------
        (Q,) float64
            Corners outside the background count with its nearest point, the rest of an element only inside it.
        """
        from sizeviz.sizing._minimum_kernels import elements_min
        from sizeviz.threads import run_chunks

        where = as_points(points, "elements")
        cells = as_cells(quads, 4, len(where), "elements")
        least = np.empty(len(cells))
        searcher = self.searcher

        def fill(start: int, stop: int) -> None:
            elements_min(searcher, where, cells, least, start, stop)

        run_chunks(fill, len(cells), chunk=32768, threads=threads, monitor=monitor, message="Finding smallest sizes")
        return least
