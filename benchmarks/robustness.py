"""Random fields on every shape of the catalogue, through the whole program: what happened, run by run.

python benchmarks/robustness.py --runs 300 --seed 0 --out sweep.json
"""

from __future__ import annotations

import argparse
import json
import time
import traceback
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely
from random_fields import KINDS, random_field

from sizeviz.conformity import judged
from sizeviz.improvement import guaranteed, improved, tightened
from sizeviz.meshing import MeshOptions, generated
from sizeviz.meshing.checks import edges_of
from sizeviz.sizing import PreserveOptions, ideal_count, preserved
from sizeviz.sources.shapes import SHAPES, shape

if TYPE_CHECKING:
    from sizeviz.geometry import Domain, QuadMesh

LIMIT = 60.0
"""Seconds allowed for one run of one mode."""

MODES = ("plain", "guaranteed")


class OutOfTime(Exception):
    """A run took longer than ``LIMIT``."""


class Deadline:
    """A monitor that ends a run that takes too long."""

    def __init__(self) -> None:
        self.end = time.perf_counter() + LIMIT

    def step(self, fraction: float, message: str = "") -> None:
        """Raise ``OutOfTime`` once the time is up."""
        if time.perf_counter() > self.end:
            raise OutOfTime(f"stopped after {LIMIT:g} s at {fraction:.0%}: {message}")


@dataclass
class Outcome:
    """What one run of one mode came to; ``error`` is empty where it came to a mesh."""

    number: int
    mode: str
    domain: str
    kind: str
    ratio: float
    scale: float
    error: str = ""
    quads: int = 0
    excess: float = 0.0
    inverted: int = 0
    area_error: float = 0.0
    lost: int = 0
    correct: float = 0.0
    worst: float = 0.0
    quality_min: float = 0.0
    quality_mean: float = 0.0
    seconds: float = 0.0

    @property
    def valid(self) -> bool:
        """Whether the mesh is one: nothing inverted, the area right, every constraint kept."""
        return not self.error and self.inverted == 0 and self.area_error < 1e-9 and self.lost == 0


def main() -> None:
    """Run the sweep, print its table and write its rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--quick", action="store_true", help="40 runs on small meshes")
    parser.add_argument("--modes", nargs="+", choices=MODES, default=list(MODES))
    parser.add_argument("--out", type=Path, default=Path("robustness.json"))
    given = parser.parse_args()
    runs, limit = (min(given.runs, 40), 6_000) if given.quick else (given.runs, 60_000)
    print(f"{'run':>4} {'mode':10} {'domain':10} {'field':9} {'ratio':>6} {'quads':>7} {'x N*':>5} {'inv':>4} "
          f"{'lost':>4} {'correct':>8} {'max R':>6} {'q min':>6} {'q mean':>6} {'s':>6}")  # fmt: skip
    outcomes = []
    for number in range(runs):
        for outcome in one_run(number, given.seed, limit, given.modes):
            outcomes.append(outcome)
            print(line(outcome), flush=True)
    given.out.write_text(json.dumps([asdict(outcome) for outcome in outcomes], indent=1), encoding="utf-8")
    for mode in given.modes:
        print(summary(mode, [outcome for outcome in outcomes if outcome.mode == mode]))


def one_run(number: int, seed: int, most: int, modes: list[str]) -> list[Outcome]:
    """Mesh one random field on one shape in every mode."""
    rng = np.random.default_rng([seed, number])
    name = list(SHAPES)[number % len(SHAPES)]
    kind, ratio = str(rng.choice(KINDS)), float(10.0 ** rng.uniform(0.0, 4.0))
    domain = shape(name)
    field = random_field(kind, rng, domain, ratio=ratio, nodes=int(rng.choice([65, 129, 257])))
    options = PreserveOptions(alpha=float(rng.choice([1.0, 2.0, 4.0])))
    target = preserved(field, options)
    asked = ideal_count(target, domain)
    if asked > most:
        field = field.with_sizes(field.sizes * float(np.sqrt(asked / most)))
        target = preserved(field, options)
    scale = float(rng.uniform(0.8, 0.95))
    outcomes = []
    for mode in modes:
        outcome = Outcome(number, mode, name, kind, round(ratio, 1), round(scale, 3) if mode == "plain" else 1.0)
        start = time.perf_counter()
        try:
            monitor = Deadline()
            if mode == "plain":
                raw = generated(domain, target, MeshOptions(scale=scale, seed=number), monitor)
                mesh = improved(raw, domain, target, monitor=monitor)
            else:
                tight = tightened(field, target, monitor=monitor)
                raw = generated(domain, tight, MeshOptions(scale=1.0, seed=number), monitor)
                mesh, _ = guaranteed(raw, domain, tight, field, monitor=monitor)
            outcome.seconds = time.perf_counter() - start
            report = judged(mesh, field)
            outcome.quads, outcome.inverted = report.n_quads, report.n_inverted
            outcome.excess = report.n_quads / ideal_count(target, domain)
            outcome.area_error, outcome.lost = area_error(mesh), lost_constraints(raw, mesh, domain)
            outcome.correct, outcome.worst = report.correct_percent["max-edge"], report.max_ratio["max-edge"]
            quality = report.quality_summary
            outcome.quality_min, outcome.quality_mean = quality["min"], quality["mean"]
        except Exception as error:  # a sweep goes on, whatever one run does
            outcome.error = "".join(traceback.format_exception_only(error)).strip()
            outcome.seconds = time.perf_counter() - start
        outcomes.append(outcome)
    return outcomes


def area_error(mesh: QuadMesh) -> float:
    """Return by how much the elements' area differs, relatively, from that of the polygon of the boundary nodes."""
    edges, count = edges_of(mesh.quads)
    rings = shapely.get_parts(shapely.polygonize([shapely.linestrings(mesh.points[edges[count == 1]])]))
    inside = shapely.points(mesh.points[mesh.quads].mean(axis=1))
    tree = shapely.STRtree(rings)
    filled = np.unique(tree.query(inside, predicate="within")[1])
    area = float(shapely.area(rings[filled]).sum())
    return abs(float(mesh.areas.sum()) - area) / area


def lost_constraints(raw: QuadMesh, mesh: QuadMesh, domain: Domain) -> int:
    """Return how many fixed nodes are gone, plus how many inner lines are not covered by edges."""
    wanted = np.vstack([raw.points[raw.fixed], np.reshape(domain.fixed_points, (-1, 2))])
    distance = shapely.STRtree(shapely.points(mesh.points)).query_nearest(
        shapely.points(wanted), return_distance=True, all_matches=False
    )[1]
    lost = int((distance > 1e-9).sum())
    edges, _ = edges_of(mesh.quads)
    for curve in domain.curves:
        if curve.inner:
            path = shapely.LineString(np.vstack([curve.points, curve.points[:1]]) if curve.closed else curve.points)
            ends = shapely.distance(path, shapely.points(mesh.points)) < 1e-9
            on = edges[ends[edges].all(axis=1)]
            on = on[shapely.distance(path, shapely.points(mesh.points[on].mean(axis=1))) < 1e-3 * path.length]
            covered = np.hypot(*(mesh.points[on[:, 1]] - mesh.points[on[:, 0]]).T).sum()
            lost += int(covered < 0.99 * path.length)
    return lost


def line(o: Outcome) -> str:
    """Return one row of the table."""
    head = f"{o.number:>4} {o.mode:10} {o.domain:10} {o.kind:9} {o.ratio:>6.0f}"
    if o.error:
        return f"{head} {o.error}"
    return (
        f"{head} {o.quads:>7} {o.excess:>5.2f} {o.inverted:>4} {o.lost:>4} {o.correct:>7.3f}% {o.worst:>6.3f} "
        f"{o.quality_min:>6.3f} {o.quality_mean:>6.3f} {o.seconds:>6.2f}{'' if o.valid else '  NOT VALID'}"
    )


def summary(mode: str, outcomes: list[Outcome]) -> str:
    """Return what a mode's runs came to, in one line."""
    done = [o for o in outcomes if not o.error]
    if not done:
        return f"{mode}: no run came to a mesh"
    return (
        f"{mode}: {len(outcomes)} runs, {len(outcomes) - len(done)} ended early, {sum(o.valid for o in done)} valid, "
        f"{sum(o.correct == 100.0 for o in done)} wholly correct, "
        f"{sum(o.excess > 2.0 for o in done)} above 2 x the ideal count; "
        f"medians: quality min {np.median([o.quality_min for o in done]):.3f}, "
        f"mean {np.median([o.quality_mean for o in done]):.3f}, "
        f"count / ideal {np.median([o.excess for o in done]):.2f}; "
        f"slowest {max(o.seconds for o in outcomes):.1f} s"
    )


if __name__ == "__main__":
    main()
