"""Time of a Delaunay triangulation a point, at three sizes, beside scipy's (Qhull)."""

from __future__ import annotations

import time

import numpy as np
from scipy.spatial import Delaunay

from sizeviz.geometry.delaunay import triangulated


def best(run, repeats: int = 3) -> float:
    times = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


def main() -> None:
    rng = np.random.default_rng(0)
    triangulated(rng.random((1000, 2)))
    print(f"{'points':>10} {'seconds':>9} {'ns/point':>9} {'scipy':>9}")
    for n in (67_000, 237_000, 1_000_000):
        points = rng.random((n, 2))
        ours = best(lambda p=points: triangulated(p))
        scipy = best(lambda p=points: Delaunay(p), 1)
        print(f"{n:>10} {ours:>9.3f} {1e9 * ours / n:>9.0f} {scipy:>9.3f}")


if __name__ == "__main__":
    main()
