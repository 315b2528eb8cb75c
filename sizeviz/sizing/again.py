"""The same envelopes after a few sizes have changed, as under a brush: only what the change can reach is done again.

A node's envelope can change only where its old minimiser lies among the changed sizes, or where a changed size can beat
it. Either place is no further away than (h* - h) / epsilon for limiting and alpha h* / beta for preserving.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry.arrays import read_only
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sizing._envelope_kernels import LIMIT, PRESERVE
from sizeviz.sizing._tile_kernels import TILE
from sizeviz.sizing.envelopes import fill_tiles_of_grid, limited, preserved
from sizeviz.sizing.options import LimitOptions, PreserveOptions

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.sizing.field import SizeField

SLACK = 1e-9
"""Share by which a reach is raised, so that rounding never leaves a node out."""


def processed_again(
    field: SizeField,
    options: LimitOptions | PreserveOptions,
    before: SizeField,
    result: SizeField,
    threads: int | None = None,
    monitor: Monitor = SILENT,
) -> SizeField:
    """Return the limited or preserved field, given what the same options made of the sizes before.

    Parameters
    ----------
    field : SizeField
        The prescribed sizes.
    options : LimitOptions or PreserveOptions
        They say which of the two; the same as before.
    before, result : SizeField
        The sizes as they were, and what ``limited`` or ``preserved`` made of them.
    threads, monitor
        As for ``limited`` and ``preserved``.

    Raises
    ------
    Cancelled
        If the monitor says so.
    """
    alike = options.distance == "euclidean" and _alike(field, before, result)
    if isinstance(options, LimitOptions):
        if not alike:
            return limited(field, options, threads, monitor)
        kind, coefficient, scale = LIMIT, options.epsilon, 1.0
        message, words = "Limiting the gradient", "gradient limited"
    else:
        if not alike:
            return preserved(field, options, threads, monitor)
        kind, coefficient, scale = PRESERVE, options.alpha, options.beta
        message, words = "Preserving sizes", "size preserved"
    wanted = reached_tiles(field, before, result, kind, coefficient, scale)
    sizes = result.sizes.copy()
    if wanted.any():
        fill_tiles_of_grid(field, kind, coefficient, scale, wanted, sizes, threads, monitor, message)
    return field.with_sizes(read_only(sizes), f"{field.label}, {words}")


def reached_tiles(
    field: SizeField, before: SizeField, result: SizeField, kind: int, coefficient: float, scale: float
) -> NDArray[np.bool_]:
    """Return which tiles of 8 x 8 nodes of a grid the change from ``before`` to ``field`` can reach, (rows, columns).

    Parameters
    ----------
    field, before, result : SizeField
        Sizes now, sizes before, and the envelope of the latter.
    kind : int
        ``LIMIT`` or ``PRESERVE``.
    coefficient, scale : float
        Epsilon and 1, or alpha and beta.
    """
    grid = field.background.grid
    assert grid is not None
    shape = grid.ny, grid.nx
    now, then = field.sizes.reshape(shape), before.sizes.reshape(shape)
    envelope = result.sizes.reshape(shape) / scale
    differs = now != then
    rows, columns = np.flatnonzero(differs.any(axis=1)), np.flatnonzero(differs.any(axis=0))
    highest = _tile_maxima(envelope)
    if not len(rows):
        return np.zeros(highest.shape, dtype=np.bool_)
    # a node's size acts on the cells around it
    top, bottom = max(rows[0] - 1, 0), min(rows[-1] + 1, grid.ny - 1)
    left, right = max(columns[0] - 1, 0), min(columns[-1] + 1, grid.nx - 1)
    box = np.s_[top : bottom + 1, left : right + 1]
    least = min(now[box].min(), then[box].min())
    away_x = _gaps(highest.shape[1], grid.nx, left, right) * grid.dx
    away_y = _gaps(highest.shape[0], grid.ny, top, bottom) * grid.dy
    away = np.hypot(away_x[None, :], away_y[:, None])
    reach = (highest - least) / coefficient if kind == LIMIT else coefficient * highest
    return (away <= reach * (1.0 + SLACK)) & (highest * (1.0 + SLACK) >= least)


def _alike(field: SizeField, before: SizeField, result: SizeField) -> bool:
    background = field.background
    return background.grid is not None and before.background is background and result.background is background


def _tile_maxima(values: NDArray[np.float64]) -> NDArray[np.float64]:
    rows = np.maximum.reduceat(values, np.arange(0, values.shape[0], TILE), axis=0)
    maxima: NDArray[np.float64] = np.maximum.reduceat(rows, np.arange(0, values.shape[1], TILE), axis=1)
    return maxima


def _gaps(tiles: int, nodes: int, first: int, last: int) -> NDArray[np.int64]:
    """Return how many nodes lie between each tile of a row and the nodes from first to last, 0 where they meet."""
    begins = np.arange(tiles) * TILE
    ends = np.minimum(begins + TILE, nodes) - 1
    return np.maximum(np.maximum(begins - last, first - ends), 0)
