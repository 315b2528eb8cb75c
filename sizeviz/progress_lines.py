"""Progress for other programs: one line a step on standard error, asked for by an environment variable."""

from __future__ import annotations

import sys
import time

ENVIRONMENT = "SIZEVIZ_PROGRESS"
"""Set in the environment, it makes commands write their progress as lines."""

PREFIX = "progress "
"""What such a line begins with; then follow the share done and words."""


class LineMonitor:
    """A monitor that writes at most ten lines a second."""

    def __init__(self) -> None:
        self._last, self._words = 0.0, ""

    def step(self, fraction: float, message: str = "") -> None:
        """Write how far the work is."""
        self._words = message or self._words
        now = time.monotonic()
        if now - self._last >= 0.1:
            self._last = now
            print(f"{PREFIX}{fraction:.4f} {self._words}", file=sys.stderr, flush=True)


def parsed_line(line: str) -> tuple[float, str] | None:
    """Return the share done and the words of a progress line, None for any other line."""
    if not line.startswith(PREFIX):
        return None
    share, _, words = line[len(PREFIX) :].strip().partition(" ")
    try:
        return float(share), words
    except ValueError:
        return None
