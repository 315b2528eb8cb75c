"""What the window remembers from one time to the next: layout, theme, recent sources."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from platformdirs import user_state_path
from qtpy.QtCore import QSettings

RECENT = 10
"""How many recent sources are remembered."""


class Settings:
    """Remembered choices.

    Parameters
    ----------
    path : str, optional
        An ini file to keep them in, autosaves beside it; the platform's own places by default.
    """

    def __init__(self, path: str | None = None) -> None:
        self.autosaves = user_state_path("sizeviz") / "autosave" if path is None else Path(path).parent / "autosave"
        self._store = QSettings("sizeviz", "sizeviz") if path is None else QSettings(path, QSettings.Format.IniFormat)

    @property
    def theme(self) -> str:
        """Name of the theme."""
        return str(self._store.value("theme", "light"))

    @theme.setter
    def theme(self, name: str) -> None:
        self._store.setValue("theme", name)

    @property
    def recent(self) -> list[str]:
        """Recent sources, the newest first."""
        value = self._store.value("recent", [])
        return [value] if isinstance(value, str) else list(value or [])

    def remember_source(self, spec: str) -> None:
        """Put a source at the head of the recent ones."""
        others = [other for other in self.recent if other != spec]
        self._store.setValue("recent", [spec, *others][:RECENT])

    def save_layout(self, window: Any) -> None:
        """Remember size, place and docks."""
        self._store.setValue("geometry", window.saveGeometry())
        self._store.setValue("state", window.saveState())
        self._store.sync()

    def restore_layout(self, window: Any) -> bool:
        """Bring size, place and docks back; return whether there was anything to bring back."""
        geometry, state = self._store.value("geometry"), self._store.value("state")
        if geometry is None or state is None:
            return False
        return bool(window.restoreGeometry(geometry)) and bool(window.restoreState(state))
