"""``sizeviz compare``: gradient limiting beside size preserving, like with like, and the guarantee below them."""

from __future__ import annotations

from sizeviz.cli.options import OutArgument, PipelineOptions, SourceArgument


def compare(source: SourceArgument, /, *, out: OutArgument, options: PipelineOptions | None = None) -> None:
    """Mesh by gradient limiting and by size preserving, and judge both against the same field.

    Writes mesh-gradient-limiting.vtu, mesh-size-preserving.vtu, with the guarantee mesh-guaranteed.vtu, compare.png
    and report.json, and prints the table. The two methods share one mesh scale, and epsilon is 1 / alpha unless it is
    given; the guaranteed mesh may look at the field at every step and is a row of its own.
    """
    from sizeviz.cli.session import carried_out
    from sizeviz.cli.single import method_run
    from sizeviz.study import COMPARED, GUARANTEED

    asked = options or PipelineOptions()
    promised = method_run("size-preserving", asked) == GUARANTEED
    carried_out(source, out, asked, (*COMPARED, GUARANTEED) if promised else COMPARED, comparison=True)
