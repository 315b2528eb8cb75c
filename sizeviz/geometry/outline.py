"""Whether the loops of a domain make sense together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from sizeviz.geometry.domain import Domain

NEAR = 1e-9
"""What lies closer to the outline than this, over the domain's width, lies on it."""


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


def require_kept_inside(domain: Domain) -> None:
    """Raise unless every inner line and fixed point lies in the domain, and no line runs along the outline.

    Raises
    ------
    InputError
        Naming the first line or point that does not.
    """
    from shapely import LineString, Point, Polygon

    x0, y0, x1, y1 = domain.bounds
    near = NEAR * max(x1 - x0, y1 - y0)
    inside = Polygon(domain.outer, domain.holes)
    wider, rim = inside.buffer(near), inside.boundary.buffer(near)
    for k, line in enumerate(domain.lines):
        path = LineString(line)
        if not wider.covers(path):
            raise InputError(f"{domain.label}: inner line {k} leaves the domain; cut it off at the outline")
        if path.intersection(rim).length > 0.01 * path.length:
            raise InputError(f"{domain.label}: inner line {k} runs along the outline; leave that part of it out")
    for k, (x, y) in enumerate(domain.fixed_points):
        if not wider.covers(Point(x, y)):
            raise InputError(f"{domain.label}: fixed point {k} at ({x:g}, {y:g}) lies outside; move it in or drop it")


def _place(explanation: str) -> str:
    """Return such as " near (0.5, 0.25)" from shapely's words, which end in the place in brackets."""
    _, bracket, place = explanation.partition("[")
    return f" near ({', '.join(place.rstrip(']').split())})" if bracket else ""
