"""Time of the packing of nodes for the ring of section 5.1, a node, at three sizes."""

from __future__ import annotations

import time

import numpy as np

from sizeviz.geometry import Domain
from sizeviz.meshing import MeshOptions
from sizeviz.meshing.frontal.boundary import outline
from sizeviz.meshing.frontal.packing import packed, seeded
from sizeviz.meshing.frontal.region import region_arrays
from sizeviz.sizing import BackgroundMesh, SizeField


def ring(m: float, n: int = 1025) -> SizeField:
    """Return the ring's preserved field with its smallest size m, on a grid of n x n nodes."""
    background = BackgroundMesh.unit_square_grid(n, n)
    s = np.abs(np.hypot(*(background.points - 0.5).T) - 0.2575)
    return SizeField(background, np.minimum(0.25, np.maximum(m, (s + m) / 3)), "ring")


def main() -> None:
    domain = Domain.unit_square()
    print(f"{'nodes':>10} {'seeds s':>9} {'packing s':>10} {'ns/node':>9}")
    for scale in (4.0, 1.0, 0.25):
        size, options = ring(1e-3), MeshOptions(scale=scale)
        times = []
        for _ in range(3):
            rim = outline(domain, size, scale)
            region = region_arrays(domain, rim)
            t0 = time.process_time()
            seeds = seeded(region, size, options)
            t1 = time.process_time()
            nodes = packed(rim, region, seeds, size, options)
            times.append((t1 - t0, time.process_time() - t1))
        seeding, packing = (min(column) for column in zip(*times, strict=True))
        print(f"{len(nodes):>10} {seeding:>9.3f} {packing:>10.3f} {1e9 * (seeding + packing) / len(nodes):>9.0f}")


if __name__ == "__main__":
    main()
