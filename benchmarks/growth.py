"""Time and memory a quadrilateral as meshes grow: the ring at ever smaller sizes, from the field to the last sweep.

    python benchmarks/growth.py --quads 100000 1000000

Each mesh is made in a process of its own, on one thread; times are processor time, memory is the largest resident set
less what the process held when everything was compiled and the field made.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from sizeviz.geometry import Domain
from sizeviz.improvement import GuaranteeOptions, SmoothOptions, improved, tightened
from sizeviz.meshing import MeshOptions, generated
from sizeviz.sizing import BackgroundMesh, PreserveOptions, SizeField, ideal_count, preserved
from sizeviz.study.promise import promised

MODES = ("raw", "plain", "guaranteed")
NODES = 1025


def main() -> None:
    """Measure every count asked for in every mode and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quads", nargs="+", type=int, default=[100_000, 1_000_000])
    parser.add_argument("--modes", nargs="+", choices=MODES, default=list(MODES))
    parser.add_argument("--one", action="store_true", help="measure in this process and print JSON")
    given = parser.parse_args()
    if given.one:
        print(json.dumps(measured(given.quads[0], given.modes[0])))
        return
    print("| mode | quads | s | µs a quad | times the first | bytes a quad | wrong (R > 1) |")
    print("|---|---|---|---|---|---|---|")
    for mode in given.modes:
        first = 0.0
        for count in given.quads:
            command = [sys.executable, __file__, "--one", "--quads", str(count), "--modes", mode]
            row = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
            each = 1e6 * row["seconds"] / row["quads"]
            first = first or each
            print(f"| {mode} | {row['quads']:,} | {row['seconds']:.1f} | {each:.1f} | {each / first:.2f} | "
                  f"{row['bytes'] / row['quads']:.0f} | {row['wrong']} |", flush=True)  # fmt: skip


def measured(count: int, mode: str) -> dict[str, float]:
    """Return seconds, bytes and quadrilaterals of one mesh of about so many."""
    made(*fields(0.1), mode)
    whole = ideal_count(fields(1.0)[1], Domain.unit_square())
    # the guarantee's elements are a little finer than h*, a plain mesh is made at scale 1
    field, target = fields(count / (1.08 * whole if mode == "guaranteed" else whole))
    Path("/proc/self/clear_refs").write_text("5")  # the largest resident set is counted from here
    before, start = memory("VmRSS"), time.process_time()
    quads, wrong = made(field, target, mode)
    seconds = time.process_time() - start
    return {"seconds": seconds, "bytes": memory("VmHWM") - before, "quads": quads, "wrong": wrong}


def fields(share: float) -> tuple[SizeField, SizeField]:
    """Return the ring's field and its preserved one, for ``share`` times as many elements as the paper's."""
    background = BackgroundMesh.unit_square_grid(NODES, NODES)
    away = np.abs(np.hypot(*(background.points - 0.5).T) - 0.2575)
    field = SizeField(background, np.minimum(0.25, 2.5e-4 + away), "ring")
    target = preserved(field, PreserveOptions())
    scale = share**-0.5
    return field.with_sizes(scale * field.sizes), target.with_sizes(scale * target.sizes)


def made(field: SizeField, target: SizeField, mode: str) -> tuple[int, int]:
    """Return how many elements a mesh has, and how many of them the guarantee leaves."""
    domain, smooth = Domain.unit_square(), SmoothOptions(threads=1)
    options = MeshOptions(scale=1.0, threads=1, max_elements=10_000_000)
    if mode != "guaranteed":
        mesh = generated(domain, target, options)
        return (mesh if mode == "raw" else improved(mesh, domain, target, smooth)).n_quads, 0
    tight = tightened(field, target)
    raw = generated(domain, tight, options)
    # as the pipeline does it: with the meshes made again where some elements cannot be repaired
    best = promised(domain, field, tight, raw, options, GuaranteeOptions(smooth=smooth))
    return best.mesh.n_quads, len(best.report.elements)


def memory(kind: str) -> int:
    """Return the resident set of this process now (VmRSS), or the largest so far (VmHWM), in bytes: Linux only."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return 1024 * int(next(line for line in lines if line.startswith(kind)).split()[1])


if __name__ == "__main__":
    main()
