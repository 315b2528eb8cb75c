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
    """Process the field, mesh, smooth and judge; size preserving comes with the guarantee unless --no-guarantee.

    Writes mesh.vtu, picture.png and report.json, and prints the table.
    """
    from sizeviz.cli.session import carried_out

    asked = options or PipelineOptions()
    carried_out(source, out, asked, (method_run(method, asked),), comparison=False)


def method_run(method: MethodName, options: PipelineOptions) -> str:
    """Return the method, or the guaranteed one where that is meant.

    Raises
    ------
    InputError
        If the guarantee is asked for where it cannot be given.
    """
    from sizeviz.errors import InputError
    from sizeviz.study import GUARANTEED

    if method != "size-preserving" or not options.smooth:
        if options.guarantee:
            why = "it needs smoothing" if method == "size-preserving" else f"not with {method}"
            raise InputError(f"--guarantee goes with --method size-preserving and --smooth, {why}; leave it out")
        return method
    return method if options.guarantee is False else GUARANTEED
