"""Nodes inside a domain, at the distance that the size field asks for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import MeshingError
from sizeviz.meshing.frontal import _hash_kernels as hashing
from sizeviz.meshing.frontal import _packing_kernels as kernels
from sizeviz.meshing.frontal import _seed_kernels as seeding
from sizeviz.meshing.frontal.boundary import SLACK
from sizeviz.monitor import SILENT, Monitor
from sizeviz.threads import run_chunks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.meshing.frontal.boundary import Outline
    from sizeviz.meshing.frontal.region import RegionArrays
    from sizeviz.meshing.options import MeshOptions
    from sizeviz.sizing import SizeField

CHUNK = 20_000
"""Points accepted, or quadtree leaves made, between two steps of the monitor: 20 to 40 ms."""

SMALLEST = 16_000
"""Seeds from which the domain is packed in parts, side by side."""

AROUND = 24
"""Triangles of the outline that are asked, before a square of the quadtree is split, whether it is outside."""

SAMPLED = 16
"""Every so manieth seed says where the cuts between parts lie."""

STEEPEST = 1.5
"""Slopes above this are treated as this: sizes that jump cannot be followed by a packing."""


PLATEAU_SHARE = 0.01
"""A size that this share of all elements has, on flat ground, is a plateau with a lattice of its own."""

JITTER = 1e-7
"""Inner points move by up to this share of their size: points on one circle would cost exact arithmetic later."""


@dataclass(frozen=True, eq=False)
class Seeds:
    """Where a front may start: the leaves of a quadtree, and how many elements they ask for.

    Parameters
    ----------
    rows : (K, 3) float64
        Centre and size of each leaf inside the domain.
    asked : float
        Number of elements, the integral of 1 / (scale · size)².
    """

    rows: NDArray[np.float64]
    asked: float


def frame_angle(outline: Outline) -> float:
    """Return the direction, in radians modulo a quarter turn, that most of the boundary runs along; 0 if none."""
    step = outline.points[outline.edges[:, 1]] - outline.points[outline.edges[:, 0]]
    length = np.hypot(*step.T)
    mean = (length * np.exp(4j * np.arctan2(step[:, 1], step[:, 0]))).sum() / length.sum()
    angle = np.angle(mean) / 4
    return float(angle) if abs(mean) > 0.3 and abs(angle) > 1e-9 else 0.0


def steepest(size: SizeField) -> float:
    """Return the largest slope of the field, no more than ``STEEPEST``."""
    background = size.background
    return float(min(seeding.largest_slope(background.points, background.triangles, size.sizes), STEEPEST))


def plateaus(region: RegionArrays, size: SizeField, scale: float) -> NDArray[np.float64]:
    """Return the sizes that the field keeps to over wide areas, smallest first, and the lattices for them.

    Parameters
    ----------
    region : tuple
        ``region_arrays`` of the domain; in a rectangle the lattices fit its sides.
    size : SizeField
        Sizes.
    scale : float
        Element size asked for relative to the field.

    Returns
    -------
    (P, 5) float64
        Element size; spacing along both axes of the frame; origin.
    """
    background = size.background
    values, counts = np.zeros(1024), np.zeros(1024)
    rest = seeding.flat_sizes(background.points, background.triangles, size.sizes, values, counts)
    kept = scale * np.sort(values[counts > PLATEAU_SHARE * (counts.sum() + rest)])
    box, out = region[0], np.empty((len(kept), 5))
    out[:, 0] = out[:, 1] = out[:, 2] = kept
    out[:, 3:] = box[:2]
    if not len(region[2]):
        for k in range(2):
            side = box[2 + k] - box[k]
            out[:, 1 + k] = side / np.maximum(np.ceil(side / kept - SLACK), 1.0)
    return out


def seeded(region: RegionArrays, size: SizeField, options: MeshOptions, monitor: Monitor = SILENT) -> Seeds:
    """Return the leaves of a quadtree over the domain, each no larger than the size at its centre.

    Parameters
    ----------
    region : tuple
        ``region_arrays`` of the domain.
    size : SizeField
        Sizes.
    options : MeshOptions
        Scale, and the seed that shifts the quadtree.
    monitor : Monitor
        Progress and cancel.

    Raises
    ------
    MeshingError
        If the leaves ask for more than ``options.max_elements``.
    """
    box = region[0]
    side = 1.01 * float(max(box[2] - box[0], box[3] - box[1]))
    shift = np.random.default_rng(options.seed).uniform(-0.004, 0.004, 2) * side if options.seed else np.zeros(2)
    stack = np.empty((seeding.STACK, 3))
    stack[0] = (*(0.5 * (box[:2] + box[2:]) + shift), side)
    depth, asked, slope = 1, 0.0, steepest(size)
    hints, around, rows = np.zeros(2, dtype=np.int64), np.empty(AROUND, dtype=np.int64), []
    while depth:
        out = np.empty((CHUNK, 3))
        depth, count, more = seeding.leaves(
            CHUNK, size.sampler, region, options.scale, slope, stack, depth, out, hints, around
        )
        rows.append(out[:count])
        asked += more
        if asked > options.max_elements:
            raise MeshingError(
                f"{size.label}: at mesh scale {options.scale:g} it asks for more than {options.max_elements} elements; "
                "raise the smallest size, the mesh scale or the limit (--max-elements)"
            )
        monitor.step(1.0 - stack[:depth, 2].max(initial=0.0) / side, "counting elements")
    return Seeds(np.vstack(rows), asked)


def packed(
    rim: Outline,
    region: RegionArrays,
    seeds: Seeds,
    size: SizeField,
    options: MeshOptions,
    monitor: Monitor = SILENT,
) -> NDArray[np.float64]:
    """Return nodes ``(N, 2)``, those of the outline first, that lie about a size apart everywhere.

    Parameters
    ----------
    rim : Outline
        Nodes that must exist.
    region, seeds
        ``region_arrays`` of the domain, ``seeded`` in it.
    size : SizeField
        Sizes.
    options : MeshOptions
        Its scale.
    monitor : Monitor
        Progress and cancel.
    """
    at_rim = _rim_sizes(rim, size, options.scale)
    flats = plateaus(region, size, options.scale)
    setting = _setting(rim, at_rim, region, seeds, size, options)
    boxes = _parts(seeds.rows)
    x, y = seeds.rows[:, 0], seeds.rows[:, 1]
    fronts = []
    for left, bottom, right, top in boxes:
        rows = seeds.rows[(x >= left) & (x < right) & (y >= bottom) & (y < top)]
        confined = np.concatenate([setting, [left, bottom, right, top]])
        front = _Front(
            confined, region, rows, size, flats, int(1.3 * seeds.asked * len(rows) / max(len(x), 1)) + len(rim.points)
        )
        front.begin(rim, at_rim)
        fronts.append(front)
    expected = 1.3 * seeds.asked + len(rim.points) * len(fronts)
    _advance(fronts, expected, options.threads, monitor)
    n_rim = len(rim.points)
    accepted = [front.points[n_rim : front.n_points] for front in fronts]
    if len(fronts) > 1:
        accepted.append(_between(fronts, n_rim, size, expected, monitor))
    inner = np.vstack(accepted)
    jitter = np.random.default_rng(options.seed).uniform(-JITTER, JITTER, (len(inner), 2))
    return np.vstack([rim.points, inner[:, :2] + inner[:, kernels.SIZE, None] * jitter])


def _between(
    fronts: list[_Front], n_rim: int, size: SizeField, expected: float, monitor: Monitor
) -> NDArray[np.float64]:
    """Return the points that fill what fronts have left free along the cuts between them."""
    one = fronts[0]
    whole = one.setting.copy()
    whole[kernels.LEFT :] = -np.inf, -np.inf, np.inf, np.inf
    last = _Front(whole, one.region, np.empty((0, 3)), size, one.plateaus, 0)
    for k, front in enumerate(fronts):
        last.take_over(front, n_rim if k else 0)
    known = last.n_points
    _advance([last], expected, 1, monitor)
    return last.points[known : last.n_points]


def _setting(
    rim: Outline,
    at_rim: NDArray[np.float64],
    region: RegionArrays,
    seeds: Seeds,
    size: SizeField,
    options: MeshOptions,
) -> NDArray[np.float64]:
    """Return the numbers that all fronts share, in the order that the kernels name them."""
    finest = float(min(at_rim.min(), seeds.rows[:, 2].min(initial=np.inf)))
    reach = 0.5 * kernels.CLOSE * np.sqrt(2.0) * steepest(size)
    ratio = min((1.0 + reach) / max(1.0 - reach, 0.25), 4.0)
    corner = region[0][:2] - 1e-3 * float((region[0][2:] - region[0][:2]).max())
    return np.array([options.scale, *corner, frame_angle(rim), ratio, float(np.log2(finest))])


def _parts(rows: NDArray[np.float64]) -> list[tuple[float, float, float, float]]:
    """Return the boxes (left, bottom, right, top) of the parts that are packed side by side: four, or one if small.

    They do not depend on the number of threads, so that the mesh does not either.
    """
    low, high = -np.inf, np.inf
    if len(rows) < SMALLEST:
        return [(low, low, high, high)]
    x, y = rows[::SAMPLED, 0], rows[::SAMPLED, 1]
    middle = float(np.median(x))
    left, right = float(np.median(y[x < middle])), float(np.median(y[x >= middle]))
    return [
        (low, low, middle, left), (low, left, middle, high), (middle, low, high, right), (middle, right, high, high),
    ]  # fmt: skip


def _advance(fronts: list[_Front], expected: float, threads: int | None, monitor: Monitor) -> None:
    """Advance fronts that know nothing of each other until none can go on."""
    waiting = list(fronts)
    while waiting:
        full = np.zeros(len(waiting), dtype=bool)

        def step(first: int, stop: int, waiting: list[_Front] = waiting, full: NDArray[np.bool_] = full) -> None:
            for k in range(first, stop):
                full[k] = waiting[k].advanced()

        run_chunks(step, len(waiting), chunk=1, threads=threads)
        monitor.step(min(sum(front.n_points for front in fronts) / expected, 1.0), "placing nodes")
        waiting = [front for front, done in zip(waiting, full, strict=True) if not done]


class _Front:
    """The arrays that the packing kernels work on, grown between two calls."""

    def __init__(
        self,
        setting: NDArray[np.float64],
        region: RegionArrays,
        rows: NDArray[np.float64],
        size: SizeField,
        flats: NDArray[np.float64],
        expected: int,
    ) -> None:
        self.setting, self.region, self.sampler, self.plateaus = setting, region, size.sampler, flats
        ordered, starts = seeding.by_bucket(rows, setting[kernels.LOG_FINEST])
        self.seeds = (ordered, starts, starts[:-1].copy())
        capacity = expected + 2 * CHUNK
        self.state = np.zeros(kernels.STATE_SIZE, dtype=np.int64)
        self.state[kernels.FREE] = -1
        self.points = np.empty((capacity, kernels.POINT_COLUMNS))
        self.chain, self.layers = np.empty(capacity, dtype=np.int32), np.empty(capacity, dtype=np.uint8)
        self.queue, self.links = np.empty((capacity, 4)), np.empty((capacity, kernels.LINK_COLUMNS), dtype=np.int32)
        self.heads = np.full(kernels.N_BUCKETS + 1, -1, dtype=np.int32)
        self.tails = np.full(kernels.N_BUCKETS + 1, -1, dtype=np.int32)
        self.keys, self.values = hashing.rehashed(np.empty(0, np.uint64), np.empty(0, np.int32), 1 << 12)
        self.cells = np.empty(0, dtype=np.int32)

    @property
    def n_points(self) -> int:
        """Points accepted so far."""
        return int(self.state[kernels.N_POINTS])

    def begin(self, rim: Outline, at_rim: NDArray[np.float64]) -> None:
        """Accept the outline's nodes, then let those on the boundary propose the first layer."""
        self._reserve(len(rim.points))
        kernels.begin(rim.points, at_rim, _turns(rim, self.setting[kernels.ANGLE]), *self._arrays())

    def take_over(self, other: _Front, first: int) -> None:
        """Accept a front's points near its cuts, from the ``first`` on, and take up the proposals it has parked."""
        self._reserve(other.n_points)
        given = other._arrays()
        kernels.take_over(given[2], given[3], given[5], given[6], first, *self._arrays()[2:])

    def advanced(self) -> bool:
        """Accept about ``CHUNK`` more points; return whether the domain is full."""
        self._reserve(CHUNK)
        return bool(kernels.advance(CHUNK, *self._arrays(), self.seeds, self.plateaus))

    def _arrays(self) -> tuple[object, ...]:
        table = (self.keys, self.values, self.cells)
        packing = (self.points, self.chain, self.layers)
        queue = (self.queue, self.links, self.heads, self.tails)
        return self.sampler, self.region, self.state, self.setting, table, packing, queue

    def _reserve(self, more: int) -> None:
        """Make room for ``more`` points, the blocks they may open and the proposals they make."""
        self.points = _grown(self.points, self.n_points + more)
        self.chain, self.layers = _grown(self.chain, self.n_points + more), _grown(self.layers, self.n_points + more)
        queued = int(self.state[kernels.N_QUEUED]) + 4 * more
        self.queue, self.links = _grown(self.queue, queued), _grown(self.links, queued)
        blocks = int(self.state[kernels.N_BLOCKS]) + more
        self.cells = _grown(self.cells, blocks * hashing.CELLS)
        while len(self.keys) < 2 * blocks:
            self.keys, self.values = hashing.rehashed(self.keys, self.values, 2 * len(self.keys))


def _grown(array: NDArray[Any], needed: int) -> NDArray[Any]:
    """Return the array, or a copy of it in one at least half as long again."""
    if len(array) >= needed:
        return array
    longer = np.empty((max(needed, 3 * len(array) // 2), *array.shape[1:]), dtype=array.dtype)
    longer[: len(array)] = array
    return longer


def _rim_sizes(rim: Outline, size: SizeField, scale: float) -> NDArray[np.float64]:
    """Return the spacing at each node of the outline: of its edges, or of the field where that is smaller."""
    total, count = np.zeros(len(rim.points)), np.zeros(len(rim.points))
    for k in range(2):
        np.add.at(total, rim.edges[:, k], rim.lengths)
        np.add.at(count, rim.edges[:, k], 1.0)
    asked = scale * size.at(rim.points)
    return np.where(count > 0, np.minimum(total / np.maximum(count, 1.0), asked), asked)


def _turns(rim: Outline, angle: float) -> NDArray[np.float64]:
    """Return how far the frame at each node is turned from the common one so that it follows the outline."""
    step = rim.points[rim.edges[:, 1]] - rim.points[rim.edges[:, 0]]
    direction = np.exp(4j * (np.arctan2(step[:, 1], step[:, 0]) - angle))
    mean = np.zeros(len(rim.points), dtype=np.complex128)
    for k in range(2):
        np.add.at(mean, rim.edges[:, k], direction)
    turn = np.angle(mean) / 4
    return np.where(np.abs(turn) > 1e-9, turn, 0.0)
