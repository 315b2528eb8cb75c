"""``sizeviz compare``: gradient limiting beside size preserving, like with like."""

from __future__ import annotations

from sizeviz.cli.options import OutArgument, PipelineOptions, SourceArgument


def compare(source: SourceArgument, /, *, out: OutArgument, options: PipelineOptions | None = None) -> None:
    """Mesh by gradient limiting and by size preserving, and judge both against the same field.

    Writes mesh-gradient-limiting.vtu, mesh-size-preserving.vtu, compare.png and report.json, and prints the table.
    Both methods share one mesh scale, and epsilon is 1 / alpha unless it is given.
    """
    from sizeviz.cli.session import carried_out
    from sizeviz.study import COMPARED

    carried_out(source, out, options or PipelineOptions(), COMPARED, comparison=True)
