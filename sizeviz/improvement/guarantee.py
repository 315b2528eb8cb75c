"""The guarantee: R <= 1 by the longest edge on every element, or a report of what is left and why."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.improvement._conform import Judge
from sizeviz.improvement._workspace import STUCK, Workspace
from sizeviz.improvement.chain import begun, improve
from sizeviz.improvement.mend import Mender
from sizeviz.improvement.options import SmoothOptions
from sizeviz.monitor import SILENT, Monitor, SubMonitor

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry.domain import Domain
    from sizeviz.geometry.quadmesh import QuadMesh
    from sizeviz.sizing import SizeField
    from sizeviz.sizing.analytic import SizeFunction

SLACK = 0.97
"""Edges are held below this share of the smallest size, so that the last of them end below all of it."""
WEIGHT = 100.0
"""Weight of the edge term over the whole mesh."""
AWARE_SWEEPS = 12
EVERY = 2
"""Sweeps from one look at the smallest sizes to the next."""
FEW = 0.005
"""Share of wrong elements below which smoothing around them is cheaper than everywhere."""
REPAIRS = 4
"""Rounds of smoothing before elements are inserted where edges are still too long."""
RAISED_REPAIRS = 2
"""The same between two attempts to raise the worst elements, which more would squeeze again."""
MOST_REPAIRS = 8
"""Most rounds of it; the weight is then beyond what numbers can hold against the rest of the objective."""
PATIENCE = 3
"""Rounds without fewer wrong elements before the repair is given up."""
PURSUITS = 4
"""How often the whole repair is begun again, because the last, exact look found an element wrong."""
FINEST, LOWEST = 0.75, 0.5
"""Quality that an insertion must leave, in the first round and in the last."""
CLOSE = 0.93
LOOKS = 4
"""Elements with R below CLOSE are judged again after every LOOKS sweeps only."""
UNASKED = np.inf
"""R from which a formula's own minimum is looked for between two sweeps: what is known of it must do."""
LATTICE = 0.5
"""Share of elements with sizes that others have too from which a mesh is taken for a lattice."""
MORE_ROUNDS = 3
"""Rounds of wide clean-up over those of plain meshes: fewer irregular nodes leave more room for the repair."""
SAME = 1e-9
"""Relative difference up to which sizes are the same."""
FLAT = 1e-6
"""Shape quality of an element that counts as one without area at a corner."""
LARGEST_WEIGHT = 1e6


@dataclass(frozen=True, kw_only=True)
class GuaranteeOptions:
    """How hard the guarantee is pursued.

    Parameters
    ----------
    smooth : SmoothOptions
        The clean-up and smoothing before it.
    rounds : int
        Rounds of local repair, 0 or more. Default 16.
    polish : int
        Passes that raise the worst elements at the end, 0 or more. Default 3.

    hopeless : float
        Share of elements still wrong after smoothing, above 0, beyond which the repair is not begun. Default 1.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    smooth: SmoothOptions = field(default_factory=SmoothOptions)
    rounds: int = 16
    polish: int = 3
    hopeless: float = 1.0

    def __post_init__(self) -> None:
        for name, value in (("rounds", self.rounds), ("polish", self.polish)):
            if not (isinstance(value, int) and value >= 0):
                raise InputError(f"{name} is {value}; it must be a whole number, 0 or more")
        if not 0.0 < self.hopeless <= 1.0:
            raise InputError(f"hopeless is {self.hopeless}; it is a share of the elements, above 0 and at most 1")


@dataclass(frozen=True, eq=False)
class GuaranteeReport:
    """What the guarantee reached.

    Parameters
    ----------
    n_quads : int
        Elements of the mesh.
    elements : (K,) int64
        Elements whose R is still above 1, or that have a flat or reflex corner; empty where the guarantee holds.
    ratios : (K,) float64
        Their R by the longest edge.
    reasons : tuple of str
        Why each of them is left.
    """

    n_quads: int
    elements: NDArray[np.int64]
    ratios: NDArray[np.float64]
    reasons: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """Whether every element is correct."""
        return len(self.elements) == 0

    @property
    def verdict(self) -> str:
        """The outcome in one sentence."""
        if self.holds:
            return f"R <= 1 on all {self.n_quads} elements"
        return (
            f"{len(self.elements)} of {self.n_quads} elements are left, R at most {self.ratios.max():.3f}: "
            + "; ".join(f"{self.reasons.count(reason)} {reason}" for reason in sorted(set(self.reasons)))
        )


def guaranteed(
    mesh: QuadMesh,
    domain: Domain,
    tight: SizeField,
    reference: SizeFunction,
    options: GuaranteeOptions | None = None,
    monitor: Monitor = SILENT,
) -> tuple[QuadMesh, GuaranteeReport]:
    """Return a mesh whose elements are all correct by the longest edge, and a report where one is not.

    Parameters
    ----------
    mesh : QuadMesh
        A raw mesh generated for ``tight`` at its own sizes (mesh scale 1).
    domain : Domain
        The domain it was made for.
    tight : SizeField
        The tight field, ``tightened``.
    reference : SizeFunction
        The user's field.
    options : GuaranteeOptions, optional
        How hard to try.
    monitor : Monitor
        Told of progress.

    Raises
    ------
    InputError
        If the mesh is empty or does not belong to the domain.
    Cancelled
        If the monitor says so.
    """
    options = options or GuaranteeOptions()
    work = _prepared(mesh, domain, tight, options.smooth, SubMonitor(monitor, 0.0, 0.6))
    judge = Judge(work, reference)
    _aware(work, judge, SubMonitor(monitor, 0.6, 0.7))
    if len(judge.wrong) > options.hopeless * len(work.quads):
        return work.result(), _report(work, judge)
    mender = Mender(work, judge)
    floor = options.smooth.floor
    for n in range(PURSUITS):
        part = SubMonitor(monitor, 0.7 + 0.3 * n / PURSUITS, 0.7 + 0.3 * (n + 1) / PURSUITS)
        _conformed(work, judge, mender, options.rounds, part)
        _raised(judge, mender, floor, options.polish)
        left = len(judge.wrong)
        judge.verify()
        if left >= len(judge.wrong):
            break
    report = _report(work, judge)
    return work.result(), report


def _prepared(mesh: QuadMesh, domain: Domain, tight: SizeField, options: SmoothOptions, monitor: Monitor) -> Workspace:
    """Clean up and smooth; a mesh that is mostly lattice, which has few irregular nodes, in fewer rounds."""
    work = begun(mesh, domain, tight, options)
    work.aim()
    sizes = np.sort(work.sizes)
    lattice = (np.diff(sizes) <= SAME * sizes[:-1]).mean() >= LATTICE
    improve(work, options.rounds if lattice else MORE_ROUNDS * options.rounds, monitor)
    return work


def _aware(work: Workspace, judge: Judge, monitor: Monitor) -> None:
    """Smooth with the edges held below the smallest size, which is looked up again after every other sweep."""
    work.weight = WEIGHT
    everywhere = np.arange(len(work.quads))
    for n in range(0, AWARE_SWEEPS, EVERY):
        judge.limit(everywhere, SLACK)
        part = SubMonitor(monitor, n / AWARE_SWEEPS, (n + EVERY) / AWARE_SWEEPS)
        work.sweep(EVERY, part, "holding edges below the sizes")
        # far from its limit an element neither feels the edge term nor needs its smallest size looked up again
        judge.look(everywhere if n % LOOKS == LOOKS - EVERY else np.flatnonzero(judge.ratio > CLOSE), UNASKED)
        if len(judge.wrong) <= FEW * len(everywhere):
            break
    judge.look(everywhere)
    monitor.step(1.0)


def _conformed(work: Workspace, judge: Judge, mender: Mender, rounds: int, monitor: Monitor) -> None:
    """Repair by smoothing and, where that leaves edges too long, by operations."""
    fewest, stale = len(work.quads), 0
    for n in range(rounds):
        part = SubMonitor(monitor, n / rounds, (n + 1) / rounds)
        _repair(work, judge, min(REPAIRS + n, MOST_REPAIRS), part)
        wrong = judge.wrong
        fewest, stale = (len(wrong), 0) if len(wrong) < fewest else (fewest, stale + 1)
        if not len(wrong) or stale > PATIENCE:
            break
        # what an operation left a little too long would not call for another; it may be needed next to it
        nodes = judge.rings(wrong, min(n, 2))
        mender.mend(nodes, FINEST, max(LOWEST, FINEST - 0.05 * n), n > 1, part)


def _raised(judge: Judge, mender: Mender, floor: float, passes: int) -> None:
    """Raise the worst elements, first by moves, then by operations, and make no element wrong."""
    work = judge.work
    for n in range(passes + 1):
        judge.limit(judge.alive, 0.9999)
        judge.guarded(lambda: work.lift(floor), floor)
        low = np.flatnonzero(judge.quality < floor)
        if n == passes or not len(low):
            break
        quick = n == 0
        if not mender.mend(judge.rings(low, 1), floor, LOWEST, True, quick=quick) and not quick:
            break
        _repair(work, judge, RAISED_REPAIRS, SILENT)


def _repair(work: Workspace, judge: Judge, rounds: int, monitor: Monitor) -> None:
    """Smooth two rings around wrong elements with a growing weight."""
    work.weight = 2.0 * WEIGHT
    for n in range(rounds):
        wrong = judge.wrong
        monitor.step(n / rounds, f"repairing {len(wrong)} elements")
        if not len(wrong):
            break
        nodes = judge.rings(wrong, 2)
        rows = judge.touched(nodes)
        for _ in range(0, AWARE_SWEEPS, EVERY):
            judge.limit(rows, SLACK)
            for _ in range(EVERY):
                settled = work.sweep_some(nodes) < 1e-3
            judge.look(rows, UNASKED)
            if settled:
                break
        judge.look(rows)
        work.weight = min(3.0 * work.weight, LARGEST_WEIGHT)
    monitor.step(1.0)


def _report(work: Workspace, judge: Judge) -> GuaranteeReport:
    flat = np.flatnonzero(judge.quality <= FLAT)
    wrong = np.union1d(judge.wrong, flat)
    reasons = []
    for q in wrong:
        if judge.quality[q] <= FLAT:
            reasons.append("with a flat or reflex corner")
            continue
        corner = work.quads[q]
        edges = np.hypot(*(work.xy[np.roll(corner, -1)] - work.xy[corner]).T)
        k = int(np.argmax(edges))
        held = work.slide[corner[k]] == STUCK and work.slide[corner[(k + 1) % 4]] == STUCK
        reasons.append("with an edge between two fixed nodes" if held else "that no move could shorten")
    rank = np.cumsum(work.quads[:, 0] >= 0) - 1
    return GuaranteeReport(len(judge.alive), rank[wrong], judge.ratio[wrong], tuple(reasons))
