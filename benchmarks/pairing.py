"""Time of joining triangles to quadrilaterals, a triangle, at three sizes."""

from __future__ import annotations

import time

import numpy as np

from sizeviz.geometry.delaunay import hilbert_order, triangulated
from sizeviz.meshing.frontal.pairing import paired


def main() -> None:
    print(f"{'triangles':>10} {'seconds':>9} {'ns each':>9} {'left over':>10}")
    for n in (50_000, 200_000, 800_000):
        rng = np.random.default_rng(0)
        side = int(np.sqrt(n))
        grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)
        points = (grid + rng.uniform(-0.2, 0.2, grid.shape)) / side
        points = np.vstack([points, [[-1, -1], [2, -1], [2, 2], [-1, 2]]])
        mesh = triangulated(points[hilbert_order(points)])
        times, single = [], np.empty(0)
        for _ in range(3):
            start = time.process_time()
            _, single = paired(mesh)
            times.append(time.process_time() - start)
        t = len(mesh.triangles)
        print(f"{t:>10} {min(times):>9.3f} {1e9 * min(times) / t:>9.0f} {len(single):>10}")


if __name__ == "__main__":
    main()
