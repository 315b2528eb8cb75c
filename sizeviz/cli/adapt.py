"""``sizeviz adapt``: the adaptive process, Algorithm 3."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from sizeviz.cli.options import MethodName, OutArgument, PipelineOptions, SourceArgument
from sizeviz.cli.values import Whole

if TYPE_CHECKING:
    from sizeviz.study.evolution import Evolution


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class ProcessOptions:
    """How the adaptive process goes on.

    Parameters
    ----------
    iterations
        Give up after this many meshes.
    limit
        Converged when no element's R against the given field is above this; with --guarantee at most 1, by the
        longest edge.
    cells
        Elements along the longer side of the uniform mesh to start from.
    background
        Where on the previous mesh the field is asked: at its nodes, as the paper says, or refined, also at the
        middle of every edge and element.
    """

    iterations: Whole = 50
    limit: float = 1.1
    cells: Whole = 80
    background: Literal["refined", "nodes"] = "refined"


def adapt(
    source: SourceArgument,
    /,
    *,
    out: OutArgument,
    method: Annotated[MethodName, Parameter(help="What is done to the sizes on each background.")] = "size-preserving",
    options: PipelineOptions | None = None,
    process: ProcessOptions | None = None,
) -> None:
    """Mesh again and again, each mesh the background of the next, until one keeps the field; plain unless --guarantee.

    Writes mesh-000.vtu (uniform), mesh-001.vtu, ..., evolution.json, and evolution.png and .svg, the largest R of each
    iteration. A process that was stopped is taken up where it was left.
    """
    from sizeviz.cli.options import loaded, study_options
    from sizeviz.cli.terminal import progress, warn_about_beta
    from sizeviz.scene.figures.sheet import save_evolution
    from sizeviz.study.adaptive import AdaptOptions, adapted

    options, process = options or PipelineOptions(), process or ProcessOptions()
    asked = AdaptOptions(
        method=_method_run(method, options),
        study=study_options(options, comparable=True),
        sampling=process.background,
        cells=process.cells,
        limit=process.limit,
        iterations=process.iterations,
        measure=options.measure,
    )
    warn_about_beta(options.beta)
    with progress() as monitor:
        evolution = adapted(loaded(source, options), asked, out, monitor)
    save_evolution(evolution, out)
    _print(evolution, asked.method)


def _method_run(method: MethodName, options: PipelineOptions) -> str:
    """Return the method, or the guaranteed one where that was typed.

    Raises
    ------
    InputError
        If the guarantee is asked for where it cannot be given.
    """
    from sizeviz.errors import InputError
    from sizeviz.study import GUARANTEED

    if not options.guarantee:
        return method
    if method != "size-preserving" or not options.smooth:
        raise InputError("--guarantee goes with --method size-preserving and --smooth; leave it out")
    return GUARANTEED


def _print(evolution: Evolution, method: str) -> None:
    """Print a line an iteration, and the verdict in words."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from sizeviz.cli.tables import TITLES, console

    table = Table(title=f"{evolution.source} · {TITLES[method]}", box=SIMPLE_HEAD, title_justify="left")
    heads = ("iteration", "elements", "max R, background", "max R, field", "R ≤ 1, field", "quality min / mean", "s")
    for head in heads:
        table.add_column(head, justify="right")
    for row in evolution.iterations:
        table.add_row(
            str(row.number),
            f"{row.n_quads:,}",
            f"{row.background_ratio:.3f}",
            f"{row.analytic_ratio:.3f}",
            f"{int(row.analytic_correct * 1000) / 1000:.3f} %",
            f"{row.quality_min:.3f} / {row.quality_mean:.3f}",
            f"{row.seconds:.1f}",
        )
    out = console()
    out.print(table)
    count = len(evolution.iterations) - 1
    if evolution.converged:
        out.print(f"converged in {count} iteration{'s' * (count != 1)}: no R above {evolution.limit:g}")
    else:
        largest = evolution.iterations[-1].analytic_ratio
        out.print(f"not converged in {count} iterations: the largest R is {largest:.3f}, above {evolution.limit:g}")
