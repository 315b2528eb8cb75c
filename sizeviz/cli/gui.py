"""``sizeviz gui``, and ``sizeviz`` alone: the window."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from sizeviz.cli.values import Place


def gui(
    *files: Annotated[str, Parameter(help="An example, a file, or expr:FORMULA; the first one is opened.")],
    grab: Annotated[Place | None, Parameter(help="Run to the end, save what the window shows, and leave.")] = None,
) -> int:
    """Open the window: load or paint a size field, run, compare side by side."""
    from sizeviz.app import main

    return main(list(files), None if grab is None else str(grab))


def window() -> int:
    """Open the window with its gallery."""
    return gui()
