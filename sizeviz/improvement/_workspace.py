"""The working copy of a mesh that smoothing and clean-up change in place."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry.arrays import read_only
from sizeviz.geometry.quadmesh import QuadMesh
from sizeviz.improvement import _curve_kernels, _energy_kernels, _mesh_kernels, _sweep_kernels, _worst_kernels
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.threads import run_chunks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry.domain import Domain
    from sizeviz.improvement.options import SmoothOptions
    from sizeviz.sizing import SizeField

OBJECTIVES = {
    "reciprocal": _energy_kernels.RECIPROCAL,
    "paper": _energy_kernels.PAPER,
    "shape": _energy_kernels.SHAPE,
}
BLOCK = 512
"""Consecutive nodes of the Hilbert order that one thread moves in one go."""
AIMED = 3
"""Sweeps from one look at the targets to the next."""
LIFTS = 12
"""Passes over the worst elements."""
LARGEST_STRETCH = 1.4
"""Longest edge over target size that raising the worst elements may leave, unless it was longer."""
SPARE_CORNERS = 4
"""Columns of the adjacency table beyond the largest valence found."""
FREE, STUCK = -1, -2
"""Values of ``slide`` that are not curves: a node free to move, and one that never does."""


class Workspace:
    """Arrays of a mesh, its nodes in Hilbert order, with adjacency, blocks and targets.

    Parameters
    ----------
    mesh : QuadMesh
        What to begin from; it is not changed.
    domain : Domain
        Whose curves the boundary nodes slide along.
    size : SizeField
        The target sizes, up to a common factor.
    options : SmoothOptions
        Which objective, how many threads.

    Raises
    ------
    InputError
        If the mesh names a curve that the domain does not have, or has no element.
    """

    def __init__(self, mesh: QuadMesh, domain: Domain, size: SizeField, options: SmoothOptions) -> None:
        if mesh.n_quads == 0:
            raise InputError("quad mesh: it has no element; mesh the domain first")
        self.domain, self.size, self.options = domain, size, options
        self.objective = OBJECTIVES[options.objective]
        self.weight = 0.0
        self.curves = curve_arrays(domain)
        self.scale = 1.0
        self._adopt(mesh)

    def _adopt(self, mesh: QuadMesh) -> None:
        self.order = np.argsort(_mesh_kernels.hilbert_keys(mesh.points), kind="stable")
        rank = np.empty(len(self.order), dtype=np.int32)
        rank[self.order] = np.arange(len(self.order), dtype=np.int32)
        self.xy = mesh.points[self.order]
        self.curve = mesh.curve[self.order]
        self.fixed = mesh.fixed[self.order]
        quads = rank[mesh.quads]
        self.quads = quads[_mesh_kernels.order_by_lowest(quads, len(rank))]
        self.hint = np.full(len(self.quads), -1, dtype=np.int32)
        self.sizes = np.ones(len(self.quads))
        self.inv = np.ones(len(self.quads))
        self.bound = np.zeros(len(self.quads))
        self._link()
        self._place()

    def _link(self) -> None:
        """Build the adjacency table and the blocks."""
        self.count = np.zeros(len(self.xy), dtype=np.int32)
        _mesh_kernels.corner_counts(self.quads, self.count)
        self.ring = np.zeros((len(self.xy), int(self.count.max()) + SPARE_CORNERS), dtype=np.int32)
        _mesh_kernels.fill_rings(self.quads, self.ring, self.count)
        colour = np.empty(-(-len(self.xy) // BLOCK), dtype=np.int64)
        n_colours = _mesh_kernels.colour_blocks(BLOCK, self.quads, colour)
        self.phases = [np.flatnonzero(colour == c) for c in range(n_colours)]
        self.gain = np.zeros(len(colour))

    def _place(self) -> None:
        """Find every boundary node on its curve; pin those at a bend of it, which sliding would cut off."""
        self.slide = np.where(self.curve >= 0, self.curve, FREE).astype(np.int32)
        self.station = np.zeros(len(self.xy))
        if self.curve.max(initial=-1) >= len(self.curves[3]):
            raise InputError(f"quad mesh: it names curve {self.curve.max()}, but {self.domain.label} has only "
                             f"{len(self.curves[3])}; hand over the domain it was made for")  # fmt: skip
        nodes = np.flatnonzero((self.curve >= 0) & ~self.fixed)
        off = np.zeros(len(self.xy))
        _curve_kernels.project_nodes(self.curves, nodes, self.slide, self.xy, self.station, off)
        self.slide[nodes[_at_bends(self.curves, self.curve[nodes], self.station[nodes])]] = STUCK
        self.slide[self.fixed] = STUCK

    @property
    def patch(self) -> tuple[NDArray[Any], ...]:
        """Positions, elements and adjacency, as kernels take them."""
        return self.xy, self.quads, self.ring, self.count

    @property
    def rails(self) -> tuple[Any, ...]:
        """Curves, and where on which of them each node is, as kernels take them."""
        return self.curves, self.slide, self.station

    def lengthen(self, nodes: int, quads: int) -> None:
        """Add dead nodes and elements at the end of every array."""
        self.xy = np.concatenate([self.xy, np.zeros((nodes, 2))])
        for name, value in (("count", 0), ("curve", -1), ("fixed", False), ("slide", FREE), ("station", 0.0)):
            setattr(self, name, longer(getattr(self, name), nodes, value))
        self.ring = np.concatenate([self.ring, np.zeros((nodes, self.ring.shape[1]), dtype=np.int32)])
        self.quads = np.concatenate([self.quads, np.full((quads, 4), -1, dtype=np.int32)])
        for name, value in (("hint", 0), ("sizes", 1.0), ("inv", 1.0), ("bound", 0.0)):
            setattr(self, name, longer(getattr(self, name), quads, value))

    def compact(self) -> None:
        """Drop dead nodes and elements and put the rest back in Hilbert order."""
        self._adopt(self.result())
        self.aim()

    def aim(self) -> None:
        """Look up the target of every element and the target scale c."""
        run_chunks(self._look_up, len(self.quads), chunk=16384, threads=self.options.threads)
        self.scale = _sweep_kernels.scale_targets(self.xy, self.quads, self.sizes, self.inv)

    def _look_up(self, first: int, last: int) -> None:
        _sweep_kernels.centre_sizes(first, last, self.xy, self.quads, self.size.sampler, self.hint, self.sizes)

    def sweep(self, count: int = 1, monitor: Monitor = SILENT, message: str = "smoothing") -> float:
        """Move every node ``count`` times, those that have settled less often; return the last sweep's decrease."""
        law = (self.objective, self.weight)
        awake = np.ones(len(self.xy), dtype=np.bool_)
        for n in range(count):
            if n % AIMED == 0:
                self.aim()
            for p, blocks in enumerate(self.phases):
                part = SubMonitor(monitor, (n + p / len(self.phases)) / count, (n + (p + 1) / len(self.phases)) / count)
                kernel = partial(self._sweep_part, blocks=blocks, law=law, awake=awake)
                run_chunks(kernel, len(blocks), chunk=16, threads=self.options.threads, monitor=part, message=message)
        return float(self.gain.sum())

    def _sweep_part(
        self, first: int, last: int, blocks: NDArray[np.int64], law: tuple[int, float], awake: NDArray[np.bool_]
    ) -> None:
        _sweep_kernels.sweep_blocks(
            first, last, blocks, BLOCK, self.patch, self.inv, self.bound, law, self.rails, awake, self.gain,
        )  # fmt: skip

    def sweep_some(self, nodes: NDArray[np.integer]) -> float:
        """Move the nodes of a list once; return the objective's decrease."""
        law = (self.objective, self.weight)
        return float(_sweep_kernels.sweep_nodes(nodes, self.patch, self.inv, self.bound, law, self.rails))

    def below(self, quality: float) -> NDArray[np.int64]:
        """Return the elements whose shape quality is ``quality`` or less: at 0 those that are not convex."""
        rows = np.arange(len(self.quads))
        found = np.empty(len(self.quads))
        _worst_kernels.qualities(rows, self.xy, self.quads, found)
        return np.flatnonzero(found <= quality)

    def sweep_around(self, rows: NDArray[np.int64], rings: int = 3, count: int = 6) -> None:
        """Move the nodes within some rings of elements ``count`` times."""
        near = np.zeros(len(self.xy), dtype=bool)
        near[self.quads[rows]] = True
        for _ in range(rings):
            near[self.quads[near[self.quads].any(axis=1)]] = True
        nodes = np.flatnonzero(near)
        for _ in range(count):
            self.sweep_some(nodes)

    def lift(self, floor: float) -> int:
        """Move the nodes of elements whose quality is below ``floor``; return how many remain below."""
        self.aim()
        return _worst_kernels.lift_worst(
            floor, LARGEST_STRETCH**2, LIFTS, self.patch, self.inv, self.bound, self.rails
        )  # fmt: skip

    def moved(self, mesh: QuadMesh) -> QuadMesh:
        """Return the mesh the workspace was made of, with its nodes where they are now."""
        points = np.empty_like(self.xy)
        points[self.order] = self.xy
        return mesh.with_points(points)

    def result(self) -> QuadMesh:
        """Return the mesh as it is now, without dead elements and nodes."""
        alive = self.count > 0
        rank = np.cumsum(alive, dtype=np.int32) - 1
        quads = self.quads[self.quads[:, 0] >= 0]
        return QuadMesh(self.xy[alive], read_only(rank[quads].astype(np.int32)), self.curve[alive], self.fixed[alive])


def longer(array: NDArray[Any], more: int, value: float) -> NDArray[Any]:
    """Return the array with ``more`` entries of ``value`` at its end."""
    return np.concatenate([array, np.full(more, value, dtype=array.dtype)])


def curve_arrays(domain: Domain) -> tuple[Any, ...]:
    """Return the curves of a domain as the arrays that ``_curve_kernels`` names."""
    closed = [np.vstack([c.points, c.points[:1]]) if c.closed else c.points for c in domain.curves]
    start = np.concatenate([[0], np.cumsum([len(points) for points in closed])]).astype(np.int64)
    return (
        np.vstack(closed),
        np.concatenate([c.stations for c in domain.curves]),
        start,
        np.array([c.closed for c in domain.curves]),
    )


def _at_bends(curves: tuple[Any, ...], of: NDArray[np.int32], station: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Say which nodes sit at a vertex where their curve turns; sliding them would change the area."""
    vertices, stations, start, closed = curves
    out = np.zeros(len(of), dtype=bool)
    for c in np.unique(of):
        rows = slice(start[c], start[c + 1])
        mine = of == c
        edge = np.diff(vertices[rows], axis=0)
        after, before = edge, np.roll(edge, 1, axis=0)
        turn = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
        bend = turn > 1e-12 * np.hypot(*before.T) * np.hypot(*after.T)
        bend[0] &= closed[c]
        at = stations[rows][:-1][bend]
        total = stations[rows][-1]
        ends = np.concatenate([at, at[:1] + total]) if closed[c] and bend[0] else at
        if not len(ends):
            continue
        near = np.searchsorted(ends, station[mine])
        gap = np.minimum(
            np.abs(ends[np.minimum(near, len(ends) - 1)] - station[mine]), np.abs(ends[near - 1] - station[mine])
        )
        out[mine] = gap <= 1e-9 * total
    return out
