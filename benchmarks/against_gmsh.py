"""Time and judge our mesher beside Gmsh's, on the paper's ring and the MRI slice, with the same h* for all.

Runs take turns, so that whatever else the machine does hits everyone alike; medians are compared. Each of our runs is
the whole way from the processed field to the smoothed mesh; of Gmsh's the meshing alone is counted, without its start,
the building of its view, or the return of the mesh. Compilation, and the computation of h*, are in neither.

    python benchmarks/against_gmsh.py [--runs 3] [--cases ring,mri] [--routes blossom,full-quad] [--no-lookup]

How much of Gmsh's time is looking up the field is estimated by a further run of the first route with the same sizes on
a regular grid, which Gmsh looks up by arithmetic (its Structured field), where the background is one.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import sys
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.compiled import compile_kernels
from sizeviz.conformity import judged
from sizeviz.geometry import QuadMesh
from sizeviz.improvement import SmoothOptions, improved
from sizeviz.meshing import MeshOptions, generated
from sizeviz.meshing.gmsh import GmshGenerator
from sizeviz.sizing import PreserveOptions, ideal_count, preserved
from sizeviz.sources import load
from sizeviz.study.report import versions
from sizeviz.threads import default_threads

if TYPE_CHECKING:
    from sizeviz.sizing import SizeField
    from sizeviz.sources import Source

ROUTES: dict[str, GmshGenerator] = {
    "blossom": GmshGenerator("Gmsh 8 + Blossom", algorithm=8, recombination=1),
    "full-quad": GmshGenerator("Gmsh 6 + full-quad Blossom", algorithm=6, recombination=3),
}
"""Gmsh's two best ways to quadrilaterals."""

MISSED = 3.0
"""A mesh whose largest R exceeds this has missed a valley, however fast it was."""


COUNTS = ("quads", "triangles")
"""Numbers that are whole."""


@dataclass
class Contender:
    """One program on one case.

    Parameters
    ----------
    name : str
        What the table calls it.
    seconds : list of float
        Time of each run.
    numbers : dict
        Judgement of the last mesh.
    """

    name: str
    seconds: list[float] = field(default_factory=list)
    numbers: dict[str, float] = field(default_factory=dict)

    @property
    def median(self) -> float:
        """Median time of a run."""
        return statistics.median(self.seconds)


def ours(source: Source, target: SizeField, options: MeshOptions) -> tuple[QuadMesh, float]:
    began = time.perf_counter()
    raw = generated(source.domain, target, options)
    mesh = improved(raw, source.domain, target, SmoothOptions())
    return mesh, time.perf_counter() - began


def theirs(route: GmshGenerator, source: Source, target: SizeField) -> tuple[QuadMesh, float, int]:
    """Return Gmsh's mesh at the very sizes of the field, its meshing time, and the triangles it left."""
    found = route.answer(source.domain, target, MeshOptions(scale=1.0))
    quads, left = found["quads"], len(found["triangles"])
    count = len(found["points"])
    mesh = QuadMesh(found["points"], quads, found["curve"], np.zeros(count, dtype=bool))
    return mesh, float(found["seconds"]), left


def judgement(mesh: QuadMesh, source: Source, target: SizeField, left: int = 0) -> dict[str, float]:
    report = judged(mesh, source.reference, ideal=ideal_count(target, source.domain))
    return {
        "quads": report.n_quads,
        "of ideal": report.n_quads / report.ideal_quads,
        "triangles": left,
        "correct % mean": report.correct_percent["mean-edge"],
        "√area": report.correct_percent["sqrt-area"],
        "longest": report.correct_percent["max-edge"],
        "max R mean": report.max_ratio["mean-edge"],
        "q min": report.quality_summary["min"],
        "q mean": report.quality_summary["mean"],
        "irregular %": report.irregular_percent,
    }


def contest(name: str, runs: int, routes: list[str]) -> tuple[Source, SizeField, list[Contender]]:
    """Run everyone in turn on one case."""
    source = load(name)
    target = preserved(source.field, PreserveOptions())
    presets = {"sizeviz": MeshOptions(), "sizeviz, fast preset": MeshOptions(preset="fast")}
    contenders = {key: Contender(key) for key in presets} | {key: Contender(ROUTES[key].name) for key in routes}
    for options in presets.values():
        # what is compiled on disk is still loaded by its first call
        ours(source, target, replace(options, scale=8.0))
    for _ in range(runs):
        for key, options in presets.items():
            mesh, seconds = ours(source, target, options)
            contenders[key].seconds.append(seconds)
            contenders[key].numbers = judgement(mesh, source, target)
        for key in routes:
            mesh, seconds, left = theirs(ROUTES[key], source, target)
            contenders[key].seconds.append(seconds)
            contenders[key].numbers = judgement(mesh, source, target, left)
    return source, target, list(contenders.values())


def lookup_share(source: Source, target: SizeField, route: GmshGenerator, seconds: float) -> float | None:
    """Return the share of Gmsh's time that goes into looking the field up in its view."""
    if target.background.grid is None:
        return None
    found = replace(route, structured=True).answer(source.domain, target, MeshOptions(scale=1.0))
    return 1.0 - float(found["seconds"]) / seconds


def print_case(name: str, contenders: list[Contender], share: float | None) -> None:
    keys = list(contenders[0].numbers)
    first = contenders[0].median
    print(f"\n### {name}\n")
    print("| | s, median | s, best | slower than sizeviz | " + " | ".join(keys) + " |")
    print("|---|" + "---|" * (len(keys) + 3))
    for one in contenders:
        cells = [f"{value:,.0f}" if key in COUNTS else f"{value:.4g}" for key, value in one.numbers.items()]
        times = f"{one.median:.2f} | {min(one.seconds):.2f} | {one.median / first:.1f} ×"
        print(f"| {one.name} | {times} | {' | '.join(cells)} |")
    if share is not None:
        print(f"\nOf Gmsh's time by its first route, {100 * share:.0f} % is looking up the field in the view.")
    for one in contenders:
        if one.numbers["max R mean"] > MISSED:
            print(f"\n{one.name} misses the valley: its largest R is {one.numbers['max R mean']:.1f}.")


def cpu() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--cases", default="ring,mri")
    parser.add_argument("--routes", default="blossom,full-quad")
    parser.add_argument("--no-lookup", action="store_true", help="skip the estimate of field look-up")
    arguments = parser.parse_args()
    routes = [route for route in arguments.routes.split(",") if route]
    compile_kernels()
    found = versions()
    print(f"{cpu()}, {default_threads()} cores; Python {found['python']}, numba {found['numba']}")
    for name in arguments.cases.split(","):
        source, target, contenders = contest(name, arguments.runs, routes)
        share = None
        if routes and not arguments.no_lookup:
            share = lookup_share(source, target, ROUTES[routes[0]], contenders[2].median)
        print_case(name, contenders, share)
    return 0


if __name__ == "__main__":
    sys.exit(main())
