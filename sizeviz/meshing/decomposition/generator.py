"""All-quadrilateral meshes by splitting loops again and again with straight chords.

Sarrate, Huerta (2000), "Efficient unstructured quadrilateral mesh generation", International Journal for Numerical
Methods in Engineering 49, 1327-1350: the mesher of Ruiz-Girones, Roca, Sarrate (2013).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import MeshingError
from sizeviz.geometry import QuadMesh
from sizeviz.meshing.checks import verify
from sizeviz.meshing.decomposition import _split_kernels as kernels
from sizeviz.meshing.decomposition.cuts import joined
from sizeviz.meshing.decomposition.doublets import without_doublets
from sizeviz.meshing.decomposition.regions import regions
from sizeviz.meshing.frontal.boundary import outline
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import Domain
    from sizeviz.meshing.options import MeshOptions
    from sizeviz.sizing import SizeField

BUDGET = 150_000
"""Pairs of nodes looked at between two steps of the monitor: about 30 ms."""


@dataclass(frozen=True)
class Decomposition:
    """The recursive decomposition as a generator; it has no randomness and uses one thread."""

    name: str = "decomposition"

    def generate(self, domain: Domain, size: SizeField, options: MeshOptions, monitor: Monitor = SILENT) -> QuadMesh:
        """Return a raw mesh: quadrilaterals only, doublets removed, not yet smoothed.

        Parameters
        ----------
        domain : Domain
            Holes, inner lines and inner points are joined to the loop around them by cuts.
        size : SizeField
            Sets the nodes on the boundary and on every chord.
        options : MeshOptions
            ``scale`` and ``max_elements`` are used.
        monitor : Monitor
            Told the share of the area that is done.

        Raises
        ------
        MeshingError
            If the mesh would be larger than ``max_elements``, the domain's loops cross each other, or what came of it
            is no mesh of the domain.
        Cancelled
            If the monitor says so.
        """
        monitor.step(0.0, "splitting loops")
        edge = outline(domain, size, options.scale)
        points, loops = edge.points, []
        for region in regions(edge.points, edge.edges, edge.bounding):
            points, loop = joined(points, region.loops, size, options.scale)
            loops.append(loop)
        work = _Work(points, loops)
        work.run(size, options, domain.area, monitor)
        kept = np.zeros(len(work.points), dtype=bool)
        kept[: len(edge.points)] = True
        points, quads, used = without_doublets(work.points, work.quads, kept)
        curve, fixed = np.full(len(used), -1, dtype=np.int32), np.zeros(len(used), dtype=bool)
        curve[: len(edge.points)], fixed[: len(edge.points)] = edge.curve, edge.fixed
        mesh = QuadMesh(points, quads, curve[used], fixed[used])
        verify(mesh, edge.edges, edge.bounding, edge.area)
        return mesh


class _Work:
    """The arrays that the kernel fills, made larger whenever it asks."""

    def __init__(self, points: NDArray[np.float64], loops: list[NDArray[np.int32]]) -> None:
        n, entries = len(points), sum(len(loop) for loop in loops)
        self._points, self._quads = np.empty((2 * n + 4096, 2)), np.empty((2 * n + 4096, 4), dtype=np.int32)
        self._stack = np.empty(2 * entries + 4096, dtype=np.int32)
        self._heads = np.zeros(2 * len(loops) + 512, dtype=np.int64)
        self._state, self._area = np.zeros(kernels.STATE_SIZE, dtype=np.int64), np.zeros(1)
        self._points[:n] = points
        self._stack[:entries] = np.concatenate(loops)
        self._heads[1 : len(loops) + 1] = np.cumsum([len(loop) for loop in loops])
        self._state[[kernels.N_LOOPS, kernels.TOP, kernels.N_POINTS]] = len(loops), entries, n

    @property
    def points(self) -> NDArray[np.float64]:
        return self._points[: self._state[kernels.N_POINTS]]

    @property
    def quads(self) -> NDArray[np.int32]:
        return self._quads[: self._state[kernels.N_QUADS]]

    def run(self, size: SizeField, options: MeshOptions, area: float, monitor: Monitor) -> None:
        """Work until no loop is left."""
        reason = kernels.PAUSED
        while reason != kernels.DONE:
            reason = kernels.decompose(
                BUDGET, size.sampler, options.scale, self._stack, self._heads, self._points, self._quads, self._state,
                self._area,
            )  # fmt: skip
            if len(self.quads) > options.max_elements:
                raise MeshingError(
                    f"the mesh passes {options.max_elements} elements; raise the sizes, the mesh scale or max_elements"
                )
            if reason == kernels.STUCK:
                raise MeshingError("decomposition: a loop cannot be split; do the domain's loops cross or touch?")
            if reason == kernels.FULL:
                self._points, self._quads = _doubled(self._points), _doubled(self._quads)
                self._stack, self._heads = _doubled(self._stack), _doubled(self._heads)
            monitor.step(min(float(self._area[0]) / area, 1.0), "splitting loops")


def _doubled(array: NDArray[Any]) -> NDArray[Any]:
    larger = np.empty((2 * len(array), *array.shape[1:]), dtype=array.dtype)
    larger[: len(array)] = array
    return larger
