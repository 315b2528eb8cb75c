"""Smoothing: seconds per node and sweep of a disturbed grid, at three sizes, for each objective.

Run as ``python benchmarks/smoothing.py``; the first pass compiles and is not timed.
"""

from __future__ import annotations

import time
from typing import get_args

import numpy as np

from sizeviz.geometry import Domain, QuadMesh
from sizeviz.improvement import Objective, SmoothOptions, smoothed
from sizeviz.sizing import BackgroundMesh, SizeField

SWEEPS = 10
SIDES = (30, 100, 300)


def disturbed(n: int) -> QuadMesh:
    """Return an n x n grid of the unit square whose inner nodes were moved at random."""
    ticks = np.arange(n + 1) / n
    x, y = (axis.ravel() for axis in np.meshgrid(ticks, ticks))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = np.column_stack([first, first + 1, first + n + 2, first + n + 1]).astype(np.int32)
    curve = np.select([y == 0, x == 1, y == 1, x == 0], [0, 1, 2, 3], -1)
    corner = np.isin(x, (0, 1)) & np.isin(y, (0, 1))
    shift = np.where(curve[:, None] < 0, np.random.default_rng(0).uniform(-0.4, 0.4, (len(x), 2)) / n, 0.0)
    return QuadMesh(np.column_stack([x, y]) + shift, quads, curve, corner)


def main() -> None:
    background = BackgroundMesh.unit_square_grid(513, 513)
    size = SizeField(background, 0.01 + 0.02 * background.points[:, 0])
    domain = Domain.unit_square()
    smoothed(disturbed(4), domain, size, SmoothOptions(sweeps=1))
    print(f"{'objective':12s} {'nodes':>8s} {'wall s':>8s} {'CPU ns / node / sweep':>24s}")
    for objective in get_args(Objective):
        for n in SIDES:
            mesh, options = disturbed(n), SmoothOptions(objective=objective, sweeps=SWEEPS)
            wall, cpu = time.perf_counter(), time.process_time()
            smoothed(mesh, domain, size, options)
            wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
            print(f"{objective:12s} {mesh.n_points:8d} {wall:8.3f} {1e9 * cpu / mesh.n_points / SWEEPS:24.0f}")


if __name__ == "__main__":
    main()
