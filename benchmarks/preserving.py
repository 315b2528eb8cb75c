"""Time limiting and preserving by nodes of the background, at four sizes: ``python benchmarks/preserving.py``."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.sizing import BackgroundMesh, LimitOptions, PreserveOptions, SizeField, limited, preserved

if TYPE_CHECKING:
    from collections.abc import Callable

RUNS = 2
"""Runs of which the best counts; the largest size is run once."""

NODES = (257, 513, 1025, 2049)


def ring(nodes: int) -> SizeField:
    background = BackgroundMesh.unit_square_grid(nodes, nodes)
    offset = np.abs(np.hypot(*(background.points - 0.5).T) - 0.2575)
    return SizeField(background, np.minimum(0.25, offset + 0.25e-3), "ring")


def waves(nodes: int) -> SizeField:
    background = BackgroundMesh.unit_square_grid(nodes, nodes)
    x, y = background.points.T
    return SizeField(background, 0.02 + 0.012 * np.sin(17 * x + 3 * y) * np.cos(13 * y - 5 * x * x), "waves")


def best(make: Callable[[], object], runs: int) -> tuple[float, float]:
    """Return the least wall and processor seconds of several runs."""
    times = []
    for _ in range(runs):
        wall, own = time.perf_counter(), time.process_time()
        make()
        times.append((time.perf_counter() - wall, time.process_time() - own))
    return min(t[0] for t in times), min(t[1] for t in times)


def compile_kernels() -> None:
    small = ring(17)
    preserved(small, PreserveOptions())
    limited(small, LimitOptions())


def main() -> None:
    compile_kernels()
    for build, counts in ((ring, NODES), (waves, NODES[:-1])):
        for nodes in counts:
            field = build(nodes)
            for name, make in (
                ("preserved", lambda f=field: preserved(f, PreserveOptions())),
                ("limited", lambda f=field: limited(f, LimitOptions())),
            ):
                wall, own = best(make, 1 if nodes == NODES[-1] else RUNS)
                each = 1e9 * own / nodes**2
                print(
                    f"{field.label:6s} {nodes:5d}^2 {name:10s} {wall:7.3f} s wall, {each:6.0f} ns of processor a node"
                )


if __name__ == "__main__":
    main()
