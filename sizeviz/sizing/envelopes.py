"""Gradient limiting and size preserving: both are lower envelopes of the prescribed field.

With straight distances they are exact for the piecewise-linear field, not only for its nodal values:
limiting gives min over y of h(y) + epsilon |x - y|, preserving gives beta min over y of max(h(y), |x - y| / alpha),
the greatest size whose ball of alpha elements holds no smaller one (eqs. (5), (6) and Algorithm 1 of Ruiz-Gironés,
Roca, Sarrate, 22nd International Meshing Roundtable, 2013, DOI 10.1007/978-3-319-02335-9).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry.arrays import read_only
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sizing._envelope_kernels import LIMIT, PRESERVE
from sizeviz.sizing._grid_kernels import block_bounds
from sizeviz.sizing._mesh_kernels import envelope_nodes, tree_bounds
from sizeviz.sizing._tile_kernels import TILE, envelope_corners, envelope_tiles
from sizeviz.sizing.edges import limited_by_edges, preserved_by_edges
from sizeviz.sizing.pyramid import pyramid
from sizeviz.threads import run_chunks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.sizing.field import SizeField
    from sizeviz.sizing.options import LimitOptions, PreserveOptions

NODES_A_CHUNK = 16384
"""Nodes done between two steps of the monitor: 10 to 50 ms."""


def limited(
    field: SizeField, options: LimitOptions, threads: int | None = None, monitor: Monitor = SILENT
) -> SizeField:
    """Return the largest field below this one whose slope nowhere exceeds epsilon.

    Parameters
    ----------
    field : SizeField
        The prescribed sizes.
    options : LimitOptions
        Slope and kind of distance.
    threads : int, optional
        Worker threads; every core by default. The result does not depend on it.
    monitor : Monitor
        Told of progress; may cancel.

    Returns
    -------
    SizeField
        On the same background. Its slope between any two nodes is at most epsilon.

    Raises
    ------
    Cancelled
        If the monitor says so.
    """
    label = f"{field.label}, gradient limited"
    if options.distance == "euclidean":
        return field.with_sizes(_envelope(field, LIMIT, options.epsilon, 1.0, threads, monitor), label)
    return field.with_sizes(limited_by_edges(field, options.epsilon, monitor), label)


def preserved(
    field: SizeField, options: PreserveOptions, threads: int | None = None, monitor: Monitor = SILENT
) -> SizeField:
    """Return the paper's h*: the largest field whose elements respect this one.

    Parameters
    ----------
    field : SizeField
        The prescribed sizes.
    options : PreserveOptions
        alpha, beta and kind of distance.
    threads : int, optional
        Worker threads; every core by default. The result does not depend on it.
    monitor : Monitor
        Told of progress; may cancel.

    Returns
    -------
    SizeField
        On the same background. Its slope between any two nodes is at most beta / alpha: every term of the
        minimum has that slope at most, and so has the minimum.

    Raises
    ------
    Cancelled
        If the monitor says so.
    """
    label = f"{field.label}, size preserved"
    if options.distance == "euclidean":
        return field.with_sizes(_envelope(field, PRESERVE, options.alpha, options.beta, threads, monitor), label)
    printed = options.distance == "edges-as-printed"
    sizes = preserved_by_edges(field, options.alpha, options.beta, printed, threads, monitor)
    return field.with_sizes(sizes, label)


def _envelope(
    field: SizeField, kind: int, coefficient: float, scale: float, threads: int | None, monitor: Monitor
) -> NDArray[np.float64]:
    message = "Limiting the gradient" if kind == LIMIT else "Preserving sizes"
    monitor.step(0.0, message)
    fill = _over_grid if field.background.grid is not None else _over_triangles
    return read_only(fill(field, kind, coefficient, scale, threads, monitor, message))


def _over_grid(
    field: SizeField, kind: int, coefficient: float, scale: float, threads: int | None, monitor: Monitor, message: str
) -> NDArray[np.float64]:
    grid = field.background.grid
    assert grid is not None
    wanted = np.ones((-(-grid.ny // TILE), -(-grid.nx // TILE)), dtype=np.bool_)
    out = np.empty(len(field.sizes))
    fill_tiles_of_grid(field, kind, coefficient, scale, wanted, out, threads, monitor, message)
    return out


def fill_tiles_of_grid(
    field: SizeField,
    kind: int,
    coefficient: float,
    scale: float,
    wanted: NDArray[np.bool_],
    out: NDArray[np.float64],
    threads: int | None,
    monitor: Monitor,
    message: str,
) -> None:
    """Write the envelope of a field on a grid into ``out`` (V,), in the tiles of 8 x 8 nodes that are wanted."""
    head, sizes = field.sampler[:2]
    grid = field.background.grid
    assert grid is not None
    shapes = pyramid(grid)
    bounds = block_bounds(head, sizes, shapes)
    rows, columns = wanted.shape
    corners = np.empty((rows + 1, columns + 1, 3))

    def find_corners(start: int, stop: int) -> None:
        envelope_corners(kind, coefficient, head, sizes, shapes, bounds, wanted, corners, start, stop)

    def fill_tiles(start: int, stop: int) -> None:
        envelope_tiles(kind, coefficient, scale, head, sizes, shapes, bounds, wanted, corners, out, start, stop)

    chunk = max(1, NODES_A_CHUNK // (8 * (columns + 1)))
    first, second = SubMonitor(monitor, 0.0, 0.1), SubMonitor(monitor, 0.1, 1.0)
    run_chunks(find_corners, rows + 1, chunk=chunk, threads=threads, monitor=first, message=message)
    chunk = max(1, NODES_A_CHUNK // (TILE * grid.nx))
    run_chunks(fill_tiles, rows, chunk=chunk, threads=threads, monitor=second, message=message)


def _over_triangles(
    field: SizeField, kind: int, coefficient: float, scale: float, threads: int | None, monitor: Monitor, message: str
) -> NDArray[np.float64]:
    _, sizes, cells, boxes, children = field.sampler
    out = np.empty(len(sizes))
    bounds = tree_bounds(cells, boxes, children)
    points, order = field.background.points, _nodes_along(field)

    def fill(start: int, stop: int) -> None:
        envelope_nodes(kind, coefficient, scale, points, sizes, order, cells, boxes, children, bounds, out, start, stop)

    run_chunks(fill, len(order), chunk=NODES_A_CHUNK // 4, threads=threads, monitor=monitor, message=message)
    return out


def _nodes_along(field: SizeField) -> NDArray[np.int64]:
    """Return the nodes in the order of the tree's triangles, so that one node's result helps the next."""
    corners = field.background.tree.triangles.ravel()
    first = np.full(len(field.sizes), len(corners), dtype=np.int64)
    np.minimum.at(first, corners, np.arange(len(corners)))
    return np.argsort(first, kind="stable")
