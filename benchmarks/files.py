"""Time to write and read a large field and a large mesh, by format, and the size of the file.

python benchmarks/files.py [--nodes 500]
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

from sizeviz.files import read_field, read_mesh, write_field, write_mesh
from sizeviz.files.registry import FIELD_WRITERS, MESH_READERS, MESH_WRITERS
from sizeviz.geometry import QuadMesh
from sizeviz.sizing import BackgroundMesh, SizeField


def lattice(n: int) -> QuadMesh:
    points = BackgroundMesh.unit_square_grid(n, n).points
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.column_stack([corner, corner + 1, corner + n + 1, corner + n]).astype(np.int32)
    edge = (points % 1.0 == 0.0).any(axis=1)
    return QuadMesh(points, quads, np.full(n * n, -1, dtype=np.int32), edge)


def timed(name: str, write, read) -> None:
    start = time.process_time()
    path = write()
    wrote = time.process_time() - start
    start = time.process_time()
    if read is not None:
        read(path)
    took = f"{time.process_time() - start:8.2f} s" if read is not None else "         –"
    print(f"{name:12} written {wrote:6.2f} s  read {took}  {path.stat().st_size / 2**20:7.1f} MiB")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=int, default=500, help="nodes along each side")
    n = parser.parse_args().nodes
    field = SizeField(BackgroundMesh.unit_square_grid(n, n), 0.01 + np.random.default_rng(0).random(n * n))
    mesh = lattice(n)
    print(f"{n * n} nodes, {2 * (n - 1) ** 2} triangles, {(n - 1) ** 2} quadrilaterals; CPU time")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for suffix in FIELD_WRITERS:
            timed(f"field {suffix}", lambda s=suffix: write_field(folder / f"f{s}", field), read_field)
        for suffix in MESH_WRITERS:
            read = read_mesh if suffix in MESH_READERS else None
            timed(f"mesh {suffix}", lambda s=suffix: write_mesh(folder / f"m{s}", mesh), read)


if __name__ == "__main__":
    main()
