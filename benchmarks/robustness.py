"""Random fields on every shape of the catalogue, through the whole program: what happened, run by run.

    python benchmarks/robustness.py --runs 300 --out sweep.jsonl

Each run is one field on one shape, in plain mode and with the guarantee; each of the two is one line of JSON in the
file. A sweep that was broken off goes on where it ended, and with ``--minutes`` it ends by itself.
"""

from __future__ import annotations

import argparse
import faulthandler
import json
import time
import traceback
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely
from random_fields import BACKGROUNDS, KINDS, random_field

from sizeviz.conformity import boundary_nodes, judged
from sizeviz.geometry import Domain
from sizeviz.improvement import GuaranteeOptions, SmoothOptions, improved, tightened
from sizeviz.meshing import MeshOptions, generated
from sizeviz.meshing.checks import edges_of
from sizeviz.sizing import PreserveOptions
from sizeviz.sources.shapes import SHAPES, shape
from sizeviz.study.promise import promised

if TYPE_CHECKING:
    from sizeviz.geometry import QuadMesh
    from sizeviz.sizing import SizeField

LIMIT = 60.0
"""Seconds allowed for one run of one mode."""

MODES = ("plain", "guaranteed")


class OutOfTime(Exception):
    """A run took longer than allowed."""


class Deadline:
    """A monitor that ends a run that takes too long."""

    def __init__(self, limit: float) -> None:
        self.limit, self.end = limit, time.process_time() + limit

    def step(self, fraction: float, message: str = "") -> None:
        """Raise ``OutOfTime`` once the time is up."""
        if time.process_time() > self.end:
            raise OutOfTime(f"stopped after {self.limit:g} s at {fraction:.0%}: {message}")


@dataclass
class Outcome:
    """What one run of one mode came to; ``error`` is empty where it came to a mesh.

    ``area_error`` compares the elements' area with that inside the boundary nodes; ``domain_error`` with the domain's
    own, which a sampled curve's chords miss by a little; ``off`` is the boundary nodes' largest distance from the
    domain's outline. All three are relative, the last to the domain's width.
    """

    number: int
    mode: str
    domain: str
    kind: str
    background: str
    ratio: float
    alpha: float
    scale: float
    extent: float
    error: str = ""
    why: str = ""
    quads: int = 0
    ideal: float = 0.0
    rim: int = 0
    inverted: int = 0
    area_error: float = 0.0
    domain_error: float = 0.0
    off: float = 0.0
    polygon: bool = False
    lost: int = 0
    correct: float = 0.0
    worst: float = 0.0
    quality_min: float = 0.0
    quality_mean: float = 0.0
    seconds: float = 0.0
    same: bool | None = None

    @property
    def valid(self) -> bool:
        """Whether the mesh is one: nothing inverted, the area right, every constraint kept."""
        exact = self.area_error < 1e-9 and self.off < 1e-9 and (self.domain_error < 1e-9 or not self.polygon)
        return not self.error and self.inverted == 0 and exact and self.lost == 0

    @property
    def excess(self) -> float:
        """Elements over those that the field asks for."""
        return self.quads / self.ideal if self.ideal else 0.0

    @property
    def forced(self) -> bool:
        """Whether the elements along the boundary and inner lines make the difference to twice the ideal count."""
        return self.excess > 2.0 >= (self.quads - self.rim) / self.ideal


def main() -> None:
    """Run what is left of the sweep, row by row, and print its tables once it is complete."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--most", type=float, default=20_000, help="elements that a field may ask for")
    parser.add_argument("--modes", nargs="+", choices=MODES, default=list(MODES))
    parser.add_argument("--only", nargs="+", type=int, help="numbers of single runs, done whether or not they were")
    parser.add_argument("--limit", type=float, default=LIMIT, help="processor seconds allowed for a run of one mode")
    parser.add_argument("--share", default="1/1", help="such as 2/3: the second of three processes, each with its file")
    parser.add_argument("--minutes", type=float, default=1e9, help="begin no run after this time")
    parser.add_argument("--twice", type=int, default=0, help="do every so many runs again with two threads")
    parser.add_argument("--out", type=Path, default=Path("robustness.jsonl"))
    parser.add_argument("--table", nargs="+", type=Path, help="print the tables of these files, and run nothing")
    given = parser.parse_args()
    if given.table:
        print(table([row for path in given.table for row in read(path).values()], given.modes))
        return
    warm_up()
    end = time.perf_counter() + 60.0 * given.minutes
    done = read(given.out)
    part, parts = map(int, given.share.split("/"))
    numbers = given.only or range(part - 1, given.runs, parts)
    for number in numbers:
        modes = [mode for mode in given.modes if given.only or (number, mode) not in done]
        if modes and time.perf_counter() < end:
            twice = bool(given.twice) and number % given.twice == 0
            one_run(number, given.seed, given.most, modes, given.out, twice=twice, limit=given.limit)
    done = read(given.out)
    if len(done) >= len(numbers) * len(given.modes) or given.only:
        print(table(list(done.values()), given.modes))


def warm_up() -> None:
    """Compile, or load, what is compiled, so that no run's time holds it."""
    domain = shape("lines")
    for background in BACKGROUNDS:
        rng, options = np.random.default_rng(0), PreserveOptions()
        field, target, _ = random_field(
            "points", rng, domain, ratio=10.0, most=500, options=options, background=background
        )
        for mode in MODES:
            meshed(mode, domain, field, target, 0.9, 0, 1, np.inf)


def read(path: Path) -> dict[tuple[int, str], Outcome]:
    """Return the outcomes in a file by number and mode, the last of each."""
    known = {field.name for field in fields(Outcome)}
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    rows = [Outcome(**{k: v for k, v in json.loads(line).items() if k in known}) for line in lines]
    return {(row.number, row.mode): row for row in rows}


def one_run(
    number: int, seed: int, most: float, modes: list[str], out: Path, *, twice: bool, limit: float = LIMIT
) -> None:
    """Mesh one random field on one shape in every mode, and write what happened."""
    rng = np.random.default_rng([seed, number])
    name = list(SHAPES)[number % len(SHAPES)]
    kind, ratio = str(rng.choice(KINDS)), float(10.0 ** rng.uniform(0.0, 4.0))
    extent, shift = float(10.0 ** rng.uniform(-3.0, 3.0)), rng.uniform(-2.0, 2.0, 2)
    domain = moved(shape(name), extent, extent * shift)
    options = PreserveOptions(alpha=float(rng.choice([1.0, 2.0, 4.0])))
    background = str(rng.choice(BACKGROUNDS))
    count = most * 10.0 ** rng.uniform(-1.0, 0.0)
    field, target, asked = random_field(
        kind, rng, domain, ratio=ratio, most=count, options=options, background=background
    )
    ratio = float(field.sizes.max() / field.sizes.min())
    scale = float(rng.uniform(0.8, 0.95))
    for mode in modes:
        outcome = Outcome(
            number, mode, name, kind, background, round(ratio, 1), options.alpha,
            round(scale, 3) if mode == "plain" else 1.0, float(f"{extent:.3g}"), ideal=round(asked, 1),
        )  # fmt: skip
        write(out, replace(outcome, error="the process ended during this run"))
        faulthandler.dump_traceback_later(10 * LIMIT, exit=True)
        start = time.process_time()
        try:
            raw, mesh, why = meshed(mode, domain, field, target, scale, number, 1, limit)
            outcome.seconds = round(time.process_time() - start, 2)
            outcome.why = why
            measure(outcome, mesh, raw, domain, field)
            if twice:
                again = meshed(mode, domain, field, target, scale, number, 2, limit)[1]
                outcome.same = np.array_equal(again.points, mesh.points) and np.array_equal(again.quads, mesh.quads)
        except Exception as error:  # a sweep goes on, whatever one run does
            outcome.error = "".join(traceback.format_exception_only(error)).strip()
            outcome.seconds = round(time.process_time() - start, 2)
        faulthandler.cancel_dump_traceback_later()
        write(out, outcome)
        print(line(outcome), flush=True)


def moved(domain: Domain, extent: float, shift: np.ndarray) -> Domain:
    """Return the domain ``extent`` times as large, and elsewhere."""
    loops, lines = ([loop * extent + shift for loop in group] for group in (domain.loops, domain.lines))
    points = domain.fixed_points * extent + shift
    return Domain(loops[0], tuple(loops[1:]), domain.corners, tuple(lines), points, domain.label)


def meshed(
    mode: str,
    domain: Domain,
    field: SizeField,
    target: SizeField,
    scale: float,
    seed: int,
    threads: int,
    limit: float,
) -> tuple[QuadMesh, QuadMesh, str]:
    """Return the raw mesh, the finished one, and what the guarantee has to say where it does not hold."""
    monitor, smooth = Deadline(limit), SmoothOptions(threads=threads)
    if mode == "plain":
        raw = generated(domain, target, MeshOptions(scale=scale, seed=seed, threads=threads), monitor)
        return raw, improved(raw, domain, target, smooth, monitor), ""
    tight = tightened(field, target, monitor=monitor)
    raw = generated(domain, tight, MeshOptions(scale=1.0, seed=seed, threads=threads), monitor)
    meshing, options = MeshOptions(seed=seed, threads=threads), GuaranteeOptions(smooth=smooth)
    best = promised(domain, field, tight, raw, meshing, options, monitor)
    raw, mesh, report = best.raw, best.mesh, best.report
    return raw, mesh, "" if report.holds else report.verdict


def measure(outcome: Outcome, mesh: QuadMesh, raw: QuadMesh, domain: Domain, field: SizeField) -> None:
    """Enter what the finished mesh is like."""
    report = judged(mesh, field)
    outcome.quads, outcome.inverted = report.n_quads, report.n_inverted
    outcome.area_error = area_error(mesh)
    outcome.domain_error = abs(float(mesh.areas.sum()) - domain.area) / domain.area
    outcome.polygon = bool(np.array([len(curve.points) == 2 for curve in domain.curves if not curve.inner]).all())
    outcome.off = off_outline(mesh, domain)
    outcome.lost = lost_constraints(raw, mesh, domain)
    held = np.zeros(mesh.n_points, dtype=bool)
    held[boundary_nodes(mesh)], held[mesh.curve >= 0] = True, True
    outcome.rim = int(held[mesh.quads].any(axis=1).sum())
    outcome.correct, outcome.worst = report.correct_percent["max-edge"], report.max_ratio["max-edge"]
    quality = report.quality_summary
    outcome.quality_min, outcome.quality_mean = quality["min"], quality["mean"]


def area_error(mesh: QuadMesh) -> float:
    """Return by how much the elements' area differs, relatively, from that of the polygon of the boundary nodes."""
    edges, count = edges_of(mesh.quads)
    rings = shapely.get_parts(shapely.polygonize([shapely.linestrings(mesh.points[edges[count == 1]])]))
    inside = shapely.points(mesh.points[mesh.quads].mean(axis=1))
    tree = shapely.STRtree(rings)
    filled = np.unique(tree.query(inside, predicate="within")[1])
    area = float(shapely.area(rings[filled]).sum())
    return abs(float(mesh.areas.sum()) - area) / area


def off_outline(mesh: QuadMesh, domain: Domain) -> float:
    """Return how far a boundary node lies from the domain's outline, over the domain's width."""
    rings = shapely.multilinestrings([shapely.linearrings(loop) for loop in domain.loops])
    x0, y0, x1, y1 = domain.bounds
    away = shapely.distance(rings, shapely.points(mesh.points[boundary_nodes(mesh)]))
    return float(away.max()) / max(x1 - x0, y1 - y0)


def lost_constraints(raw: QuadMesh, mesh: QuadMesh, domain: Domain) -> int:
    """Return how many corners and fixed points are gone, plus how many inner lines are not covered by edges."""
    x0, y0, x1, y1 = domain.bounds
    near = 1e-9 * max(x1 - x0, y1 - y0)
    corners = [loop[marks] for loop, marks in zip(domain.loops, domain.corners, strict=True)]
    wanted = np.vstack([raw.points[raw.fixed], np.reshape(domain.fixed_points, (-1, 2)), *corners])
    distance = shapely.STRtree(shapely.points(mesh.points)).query_nearest(
        shapely.points(wanted), return_distance=True, all_matches=False
    )[1]
    lost = int((distance > near).sum())
    edges, _ = edges_of(mesh.quads)
    for curve in domain.curves:
        if curve.inner:
            path = shapely.LineString(np.vstack([curve.points, curve.points[:1]]) if curve.closed else curve.points)
            ends = shapely.distance(path, shapely.points(mesh.points)) < near
            on = edges[ends[edges].all(axis=1)]
            length = np.hypot(*(mesh.points[on[:, 1]] - mesh.points[on[:, 0]]).T)
            on = on[shapely.distance(path, shapely.points(mesh.points[on].mean(axis=1))) < 0.3 * length]
            # along the line, which a chord of a curve is shorter than
            at = shapely.line_locate_point(path, shapely.points(mesh.points[on]))
            step = np.abs(at[:, 1] - at[:, 0])
            loop = curve.closed or np.array_equal(curve.points[0], curve.points[-1])
            covered = (np.minimum(step, path.length - step) if loop else step).sum()
            lost += int(abs(covered - path.length) > 1e-6 * path.length)
    return lost


def write(path: Path, outcome: Outcome) -> None:
    """Add one line to the file."""
    with path.open("a", encoding="utf-8") as stream:
        stream.write(json.dumps(asdict(outcome)) + "\n")


def line(o: Outcome) -> str:
    """Return one outcome as a line for the terminal."""
    head = f"{o.number:>4} {o.mode:10} {o.domain:10} {o.kind:9} {o.background:9} {o.ratio:>7.0f}"
    if o.error:
        return f"{head} {o.error}"
    return (
        f"{head} {o.quads:>7} x{o.excess:<5.2f} inv {o.inverted} lost {o.lost} {o.correct:>7.3f}% R {o.worst:.3f} "
        f"q {o.quality_min:.3f} {o.quality_mean:.3f} {o.seconds:>6.2f} s{'' if o.valid else ' NOT VALID'}"
        f"{'' if o.same is not False else ' NOT THE SAME'}{' ' + o.why if o.why else ''}"
    )


def table(outcomes: list[Outcome], modes: list[str]) -> str:
    """Return what the runs came to, by mode and shape, as Markdown."""
    head = (
        "| domain | runs | valid | wholly correct | correct %, median | least | q min, median | least | "
        "q mean, median | count / ideal, median | above 2 × (not the boundary's) | slowest s |"
    )
    lines = []
    for mode in modes:
        mine = [o for o in outcomes if o.mode == mode]
        lines += [f"\n{mode}: {len(mine)} runs\n", head, "|---|" + "---|" * 11]
        names = [name for name in SHAPES if any(o.domain == name for o in mine)]
        lines += [_row(name, [o for o in mine if o.domain == name]) for name in names]
        lines.append(_row("**all**", mine))
        again = [o.same for o in mine if o.same is not None]
        if again:
            lines.append(
                f"\n{sum(again)} of {len(again)} runs gave bitwise the same mesh with one and with two threads."
            )
    return "\n".join(lines)


def _row(name: str, outcomes: list[Outcome]) -> str:
    made = [o for o in outcomes if not o.error]
    if not made:
        return f"| {name} | {len(outcomes)} | 0 | 0 |" + " |" * 8
    high = [o for o in made if o.excess > 2.0]
    cells = [
        name, len(outcomes), sum(o.valid for o in made), sum(o.correct == 100.0 for o in made),
        f"{np.median([o.correct for o in made]):.2f}", f"{min(o.correct for o in made):.2f}",
        f"{np.median([o.quality_min for o in made]):.3f}", f"{min(o.quality_min for o in made):.3f}",
        f"{np.median([o.quality_mean for o in made]):.3f}", f"{np.median([o.excess for o in made]):.2f}",
        f"{len(high)} ({sum(not o.forced for o in high)})", f"{max(o.seconds for o in outcomes):.1f}",
    ]  # fmt: skip
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


if __name__ == "__main__":
    main()
