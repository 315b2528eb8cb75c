"""What a person sees while a command runs: progress on a terminal, nothing where the output goes elsewhere."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

from sizeviz.monitor import SILENT, Monitor
from sizeviz.progress_lines import ENVIRONMENT, LineMonitor

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.progress import Progress, TaskID


class BarMonitor:
    """A monitor that moves a bar of rich."""

    def __init__(self, progress: Progress, task: TaskID) -> None:
        self._progress, self._task = progress, task

    def step(self, fraction: float, message: str = "") -> None:
        """Move the bar, and say what is going on."""
        if message:
            self._progress.update(self._task, completed=fraction, description=message)
        else:
            self._progress.update(self._task, completed=fraction)


def on_terminal() -> bool:
    """Return whether a person is watching: both outputs go to a terminal."""
    return sys.stderr.isatty() and sys.stdout.isatty()


@contextmanager
def progress() -> Iterator[Monitor]:
    """Give a monitor: a bar that vanishes when the work ends, lines for a program that asked for them, or silence."""
    if os.environ.get(ENVIRONMENT):
        yield LineMonitor()
        return
    if not on_terminal():
        yield SILENT
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description:<36}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bars:
        yield BarMonitor(bars, bars.add_task("starting", total=1.0))


def notice(line: str) -> None:
    """Say a line on standard error: a warning, or what takes long only once."""
    print(f"sizeviz: {line}", file=sys.stderr, flush=True)


def warn_about_beta(beta: float) -> None:
    """Say what beta above 1 means; it is allowed, eq. (2) with a weaker bound."""
    if beta > 1.0:
        notice(f"warning: beta is {beta:g}, above 1: elements may be up to {beta:g} times the size of the field")
