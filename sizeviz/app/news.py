"""What the controller tells the widgets, as plain values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sizeviz.scene.view import FIELD_QUANTITIES

if TYPE_CHECKING:
    from sizeviz.scene.subject import Subject
    from sizeviz.scene.view import Quantity


@dataclass(frozen=True)
class Notice:
    """A message that asks for no answer: level 'info', 'warning' or 'error', a line, details to copy."""

    level: str
    text: str
    details: str = ""


@dataclass(frozen=True, eq=False)
class Displayed:
    """What a pane shows of a method: the newest results, or the last good ones, marked stale.

    Parameters
    ----------
    subject : Subject
        The results.
    stale : bool
        Whether the mesh and its judgement are older than the study.
    target_stale : bool
        Whether the processed field is.
    """

    subject: Subject
    stale: bool
    target_stale: bool = False

    def is_stale(self, quantity: Quantity) -> bool:
        """Return whether colours that mean a quantity tell of something older; the prescribed field never is."""
        if quantity in FIELD_QUANTITIES:
            return quantity == "target" and self.target_stale
        return self.stale
