"""Clean-up and smoothing of raw meshes of the ring at three scales: seconds, irregular nodes, quality.

Run as ``python benchmarks/cleanup.py``; the first pass compiles and is not timed.
"""

from __future__ import annotations

import time

from sizeviz.conformity import irregular_fraction, shape_quality
from sizeviz.improvement import improved
from sizeviz.meshing import MeshOptions, generated
from sizeviz.sizing import PreserveOptions, preserved
from sizeviz.sources import load

SCALES = (2.6, 1.5, 0.87)


def main() -> None:
    source = load("ring")
    size = preserved(source.field, PreserveOptions())
    improved(generated(source.domain, size, MeshOptions(scale=6.0)), source.domain, size)
    print(f"{'quads':>8s} {'wall s':>8s} {'CPU us / quad':>14s} {'irregular %':>16s} {'quality min / mean':>20s}")
    for scale in SCALES:
        raw = generated(source.domain, size, MeshOptions(scale=scale))
        wall, cpu = time.perf_counter(), time.process_time()
        mesh = improved(raw, source.domain, size)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        before, after = (100 * irregular_fraction(m) for m in (raw, mesh))
        quality = shape_quality(mesh)
        print(
            f"{mesh.n_quads:8d} {wall:8.2f} {1e6 * cpu / mesh.n_quads:14.1f} {before:8.1f} ->{after:5.1f} "
            f"{quality.min():13.3f} / {quality.mean():.3f}"
        )


if __name__ == "__main__":
    main()
