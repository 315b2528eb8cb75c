"""``sizeviz run``: one pipeline from source to picture."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from sizeviz.cli.options import MethodName, OutArgument, PipelineOptions, SourceArgument


def run(
    source: SourceArgument,
    /,
    *,
    out: OutArgument,
    method: Annotated[MethodName, Parameter(help="What is done to the field before it is meshed.")] = "size-preserving",
    options: PipelineOptions | None = None,
) -> None:
    """Process the field, mesh, smooth and judge.

    Writes mesh.vtu, picture.png and report.json, and prints the table.
    """
    from sizeviz.cli.session import carried_out

    carried_out(source, out, options or PipelineOptions(), (method,), comparison=False)
