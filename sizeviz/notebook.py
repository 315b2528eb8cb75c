"""What notebooks need: progress in the cell that works, and results that show themselves."""

from __future__ import annotations

import base64
import sys
import tempfile
import time
import webbrowser
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sizeviz.files import replacing

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sizeviz.monitor import Monitor

UPDATES_A_SECOND = 8.0
"""How often a cell's progress is drawn at most."""


def in_notebook() -> bool:
    """Return whether this code runs in a cell of a notebook."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return shell is not None and hasattr(shell, "kernel")


@contextmanager
def progress(monitor: Monitor | None = None) -> Iterator[Monitor]:
    """Give the monitor handed in, else a bar in the cell or on the terminal, else silence."""
    if monitor is not None:
        yield monitor
        return
    if not in_notebook():
        from sizeviz.cli.terminal import progress as on_terminal

        with on_terminal() as bar:
            yield bar
        return
    cell = CellMonitor()
    try:
        yield cell
    finally:
        cell.close()


class CellMonitor:
    """A monitor that draws a bar in the cell that works; it vanishes when the work ends."""

    def __init__(self) -> None:
        from IPython.display import HTML, display

        self._html, self._last, self._words = HTML, 0.0, "starting"
        self._handle: Any = display(HTML(""), display_id=True)

    def step(self, fraction: float, message: str = "") -> None:
        """Move the bar, and say what is going on."""
        self._words = message or self._words
        now = time.monotonic()
        if now - self._last < 1.0 / UPDATES_A_SECOND:
            return
        self._last = now
        percent = round(100.0 * min(max(fraction, 0.0), 1.0))
        bar = f'<progress max="100" value="{percent}" style="width: 18em"></progress>'
        self._show(f"<div>{bar} {percent} % {escape(self._words)}</div>")

    def close(self) -> None:
        """Take the bar away."""
        self._show("")

    def _show(self, html: str) -> None:
        if self._handle is not None:
            self._handle.update(self._html(html))


@dataclass(frozen=True)
class Shown:
    """What ``show`` returns: a notebook displays it; elsewhere it can be opened in a browser, or saved.

    Parameters
    ----------
    title : str
        What it shows.
    page : str
        One whole HTML page.
    height : int
        Pixels that it takes in a notebook.
    """

    title: str
    page: str
    height: int = 820

    def save(self, path: str | Path) -> Path:
        """Write the page, whole or not at all, and return where.

        Raises
        ------
        InputError
            If the place cannot be written.
        """
        path = Path(path)
        with replacing(path) as part:
            part.write_text(self.page, encoding="utf-8")
        return path

    def open(self) -> Path:
        """Open the page in a browser, from a temporary file, and return where that is."""
        path = self.save(Path(tempfile.mkdtemp(prefix="sizeviz-")) / "shown.html")
        webbrowser.open(path.as_uri())
        return path

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self.height}px; border: 0"
        page, title = escape(self.page), escape(self.title)  # its scripts run, but cannot reach the notebook
        return f'<iframe srcdoc="{page}" sandbox="allow-scripts" style="{style}" title="{title}"></iframe>'

    def __repr__(self) -> str:
        return f"<Shown {self.title!r}: a notebook displays it; .open() shows it in a browser, .save(path) writes it>"


def picture_page(title: str, png: bytes) -> str:
    """Return a page that holds one picture."""
    data = base64.b64encode(png).decode("ascii")
    style = "margin: 0; background: #fff"
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title></head>'
        f'<body style="{style}"><img alt="{escape(title)}" style="max-width: 100%" src="data:image/png;base64,{data}">'
        "</body></html>"
    )
