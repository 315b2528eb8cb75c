"""What the controller tells the widgets, as plain values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sizeviz.scene.subject import Subject


@dataclass(frozen=True)
class Notice:
    """A message that asks for no answer: level 'info', 'warning' or 'error', a line, details to copy."""

    level: str
    text: str
    details: str = ""


@dataclass(frozen=True, eq=False)
class Displayed:
    """What a pane shows of a method: the newest results, or the last good ones, marked stale."""

    subject: Subject
    stale: bool
