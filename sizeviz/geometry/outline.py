"""Whether the loops of a domain make sense together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from sizeviz.geometry.domain import Domain


def require_simple(domain: Domain) -> None:
    """Raise unless no loop crosses or touches itself or another, and every hole lies inside the outer loop.

    Raises
    ------
    InputError
        With the place of the first trouble.
    """
    from shapely import Polygon
    from shapely.validation import explain_validity

    for k, loop in enumerate(domain.loops):
        alone = Polygon(loop)
        if not alone.is_valid:
            which = "the outline" if k == 0 else f"hole {k}"
            raise InputError(
                f"{domain.label}: {which} crosses or touches itself{_place(explain_validity(alone))}; "
                "list its vertices in order, without crossings"
            )
    together = Polygon(domain.outer, domain.holes)
    if not together.is_valid:
        raise InputError(
            f"{domain.label}: the loops cross or touch each other, or a hole lies outside"
            f"{_place(explain_validity(together))}; move the holes apart and inside"
        )


def _place(explanation: str) -> str:
    """Return such as " near (0.5, 0.25)" from shapely's words, which end in the place in brackets."""
    _, bracket, place = explanation.partition("[")
    return f" near ({', '.join(place.rstrip(']').split())})" if bracket else ""
