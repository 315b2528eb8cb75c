"""The decomposition mesher: uniform sizes, and the ring of Section 5.1 with its preserved sizes in closed form."""

from __future__ import annotations

import time

import numpy as np

from sizeviz import Domain, SizeField
from sizeviz.meshing import MeshOptions
from sizeviz.meshing.decomposition import Decomposition
from sizeviz.sizing import BackgroundMesh


def uniform() -> SizeField:
    return SizeField(BackgroundMesh.unit_square_grid(3, 3), np.full(9, 1 / 310))


def ring() -> SizeField:
    background = BackgroundMesh.unit_square_grid(2049, 2049)
    s = np.abs(np.hypot(*(background.points - 0.5).T) - 0.2575)
    return SizeField(background, np.minimum(0.25, np.maximum(2.5e-4, (s + 2.5e-4) / 3)))


def main() -> None:
    options = MeshOptions(mesher="decomposition", scale=1.0)
    for field in (uniform(), ring()):
        best, mesh = np.inf, Decomposition().generate(Domain.unit_square(), field, options)
        for _ in range(3):
            began = time.process_time()
            mesh = Decomposition().generate(Domain.unit_square(), field, options)
            best = min(best, time.process_time() - began)
        print(f"{mesh.n_quads:>9,} elements  {best:6.2f} s  {1e6 * best / mesh.n_quads:6.1f} us an element")


if __name__ == "__main__":
    main()
