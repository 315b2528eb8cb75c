"""Where things are saved: the dialog, and a suffix where none was typed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from qtpy.QtWidgets import QFileDialog

if TYPE_CHECKING:
    from collections.abc import Iterable

    from qtpy.QtWidgets import QWidget


def ask_place(parent: QWidget, title: str, name: str, kinds: str) -> str:
    """Return where to save, empty if nowhere.

    Parameters
    ----------
    parent : QWidget
        Over which the dialog opens.
    title : str
        What is saved.
    name : str
        The name that is offered; its suffix is taken where none is typed.
    kinds : str
        The dialog's filter.
    """
    path, _ = QFileDialog.getSaveFileName(parent, title, name, kinds)
    return with_suffix(str(path), Path(name).suffix)


def with_suffix(path: str, suffix: str) -> str:
    """Return a path with a suffix where it has none; nothing stays nothing."""
    return path if not path or Path(path).suffix else f"{path}{suffix}"


def kinds(words: str, suffixes: Iterable[str]) -> str:
    """Return a dialog's filter for files of some suffixes."""
    return f"{words} ({' '.join(f'*{suffix}' for suffix in suffixes)})"
