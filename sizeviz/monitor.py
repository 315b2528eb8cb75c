"""How long work reports progress and learns that it should stop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


class Monitor(Protocol):
    """Anything with a ``step``: a progress bar, a window's job, or silence."""

    def step(self, fraction: float, message: str = "") -> None:
        """Say how much is done.

        Parameters
        ----------
        fraction : float
            Share of the work done, 0 to 1, never decreasing within one job.
        message : str
            What is going on, in the words of the user; empty keeps the last one.

        Raises
        ------
        Cancelled
            If the user has asked for the work to stop.
        """


class _Silent:
    """A monitor that reports nowhere and never cancels."""

    def step(self, fraction: float, message: str = "") -> None:
        """Do nothing."""


SILENT: Monitor = _Silent()


@dataclass(frozen=True)
class SubMonitor:
    """A share of another monitor's range, handed to one stage of a longer job.

    Parameters
    ----------
    parent : Monitor
        Where the stage's steps go.
    start, stop : float
        The stage's part of the parent's range, 0 <= start <= stop <= 1.
    """

    parent: Monitor
    start: float
    stop: float

    def step(self, fraction: float, message: str = "") -> None:
        """Pass the step on, scaled into the stage's part of the range."""
        share = min(max(fraction, 0.0), 1.0)
        self.parent.step(self.start + (self.stop - self.start) * share, message)
