"""The window: the only Qt code."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


def main(sources: Sequence[str] | str | None = None, grab: str | None = None) -> int:
    """Open the window; return the exit code.

    Parameters
    ----------
    sources : str or sequence of str, optional
        What to open: an example's name, a file or ``expr:FORMULA``; the first one counts.
    grab : str, optional
        Where to save what is seen once everything has run; the window is then closed.
    """
    from sizeviz.app.launch import launch

    given = [sources] if isinstance(sources, str) else list(sources or ())
    return launch(given[0] if given else None, grab)
