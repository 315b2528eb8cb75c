"""What element sizes are judged against: a size field, or a formula that a field only approximates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from sizeviz.geometry.arrays import as_cells, as_points
from sizeviz.monitor import SILENT, Monitor
from sizeviz.threads import run_chunks

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from sizeviz.sizing.field import SizeField

SAMPLES = 9
"""Samples along each side of an element to begin with."""

ROUNDS = 20
"""Rounds of local search; each halves the step, so the last is 1e-7 of an element's side."""

SETTLED = 4
"""Rounds after which the search leaves an element whose least value stays at a corner."""


_AROUND = np.array([(i, j) for i in (-1.0, 0.0, 1.0) for j in (-1.0, 0.0, 1.0) if (i, j) != (0.0, 0.0)])


class SizeFunction(Protocol):
    """Anything that prescribes sizes: ``SizeField`` and ``AnalyticSize``."""

    @property
    def label(self) -> str:
        """What to call it in messages and pictures."""

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the size at each of ``points`` (N, 2)."""

    def min_over(
        self, points: ArrayLike, quads: ArrayLike, threads: int | None = None, monitor: Monitor = SILENT
    ) -> NDArray[np.float64]:
        """Return the least size over each of ``quads`` (Q, 4), corners in ``points`` (P, 2)."""


@dataclass(frozen=True, eq=False)
class AnalyticSize:
    """A formula, together with the piecewise-linear field that stands for it in meshing.

    Parameters
    ----------
    function : callable
        Takes x and y, arrays of one shape, and returns the size at each point.
    field : SizeField
        Approximates it.
    label : str
        What to call it in messages and pictures.
    error : float, optional
        Largest error of ``field`` that was found, relative to the formula; None where it was not looked for.
    """

    function: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
    field: SizeField
    label: str = "formula"
    error: float | None = None

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the formula's value at each of ``points`` (N, 2)."""
        where = as_points(points, self.label)
        return np.broadcast_to(self.function(where[:, 0], where[:, 1]), len(where)).astype(np.float64)

    def min_over(
        self, points: ArrayLike, quads: ArrayLike, threads: int | None = None, monitor: Monitor = SILENT
    ) -> NDArray[np.float64]:
        """Return the least value found over each quadrilateral, ``(Q,)``.

        The element is sampled at 9 x 9 points in its bilinear coordinates; from the best of them a pattern search
        halves its step until it is 1e-7 of a side. A valley or point narrower than an eighth of the element can
        be missed where the formula rises again between two samples; the value returned is never below the minimum.
        """
        where = as_points(points, "elements")
        cells = as_cells(quads, 4, len(where), "elements")
        least = np.empty(len(cells))

        def fill(start: int, stop: int) -> None:
            corners = where[cells[start:stop]]
            least[start:stop] = self._search(corners[:, :, 0], corners[:, :, 1])

        run_chunks(fill, len(cells), chunk=4096, threads=threads, monitor=monitor, message="Finding smallest sizes")
        return least

    def _search(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the least value over quadrilaterals with corner coordinates ``x`` and ``y``, both (Q, 4)."""
        side = np.linspace(0.0, 1.0, SAMPLES)
        u, v = (grid.ravel() for grid in np.meshgrid(side, side))
        values = self._value(x, y, u[None], v[None])
        best = values.argmin(axis=1)
        least, u, v = values.min(axis=1), u[best], v[best]
        step, still = 1.0 / (SAMPLES - 1), np.zeros(len(x), dtype=np.int64)
        active = np.flatnonzero(np.ptp(values, axis=1) > 0.0)
        for _ in range(ROUNDS):
            step *= 0.5
            moving = active
            for _ in range(2):  # two moves a step: a kink can run obliquely to both sides
                before = least[moving]
                self._move(x, y, u, v, least, moving, step)
                better = least[moving] < before
                still[moving[better]] = 0
                # from where nothing was better, nothing will be at the next move of the same step
                still[moving[~better]] += 2 if moving is active else 1
                moving = moving[better]
            cornered = (np.abs(u[active] - 0.5) == 0.5) & (np.abs(v[active] - 0.5) == 0.5)
            active = active[~(cornered & (still[active] >= 2 * SETTLED))]
        return least

    def _move(
        self,
        x: NDArray[np.float64],
        y: NDArray[np.float64],
        u: NDArray[np.float64],
        v: NDArray[np.float64],
        least: NDArray[np.float64],
        active: NDArray[np.intp],
        step: float,
    ) -> None:
        """Move the active elements' best places to the best of eight neighbours at a distance of ``step``."""
        near_u = np.clip(u[active, None] + step * _AROUND[:, 0], 0.0, 1.0)
        near_v = np.clip(v[active, None] + step * _AROUND[:, 1], 0.0, 1.0)
        values = self._value(x[active], y[active], near_u, near_v)
        pick = (np.arange(len(active)), values.argmin(axis=1))
        better = values[pick] < least[active]
        moved = active[better]
        u[moved], v[moved], least[moved] = near_u[pick][better], near_v[pick][better], values[pick][better]

    def _value(
        self, x: NDArray[np.float64], y: NDArray[np.float64], u: NDArray[np.float64], v: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the values at bilinear coordinates ``u, v``, (Q, K) or (1, K), of each quadrilateral, ``(Q, K)``."""
        weights = ((1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v)
        at_x, at_y = np.zeros(np.broadcast_shapes(u.shape, x[:, :1].shape)), np.zeros((1, 1))
        for k, weight in enumerate(weights):
            at_x = at_x + weight * x[:, k : k + 1]
            at_y = at_y + weight * y[:, k : k + 1]
        return np.broadcast_to(self.function(at_x, at_y), np.shape(at_x)).astype(np.float64)
