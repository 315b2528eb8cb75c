"""What a pane shows and how: no data, only choices; not part of undo."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from sizeviz.conformity import Measure

Quantity = Literal["ratio", "quality", "size", "prescribed", "target", "error"]
"""What colours a pane: R(e), shape quality, element size, the user's field, the processed field, image error."""

RangeMode = Literal["auto", "fixed", "percentile"]
"""Where the ends of a colour bar come from."""

QUANTITIES: dict[Quantity, str] = {
    "ratio": "Size ratio R",
    "quality": "Shape quality",
    "size": "Element size",
    "prescribed": "Prescribed size h",
    "target": "Target size h*",
    "error": "Interpolation error",
}
"""The quantities in menu order, with the words that name them."""

FIELD_QUANTITIES: tuple[Quantity, ...] = ("prescribed", "target")
"""Quantities of a size field; the others belong to the mesh's elements."""


@dataclass(frozen=True, kw_only=True)
class ViewState:
    """How one pane shows one method of a study.

    Parameters
    ----------
    method : str
        Which run: 'none', 'gradient-limiting', 'size-preserving' or 'guaranteed'.
    color_by : Quantity
        What the colours mean.
    measure : {'mean-edge', 'sqrt-area', 'max-edge'}
        Which size of an element R and the size map use.
    cmap : str, optional
        Colour map; by default the quantity's own.
    range_mode : {'auto', 'fixed', 'percentile'}
        Where the ends of the bar come from.
    low, high : float, optional
        Ends of a fixed bar.
    percentile : float
        Share of the values, in percent, cut off at either end of a 'percentile' bar.
    log : bool, optional
        Whether the bar is logarithmic; by default as suits the quantity. R always is, on either side of 1.
    classes : int
        Flat steps of the bar, 0 for continuous.
    edges : bool
        Whether element edges are drawn.
    outline_failing : bool
        Whether elements with R > 1 are outlined where the colours are about size (R or size itself).
    dark : bool
        Dark ground instead of light.

    Raises
    ------
    InputError
        If the quantity is unknown, or a fixed bar lacks an end.
    """

    method: str = "size-preserving"
    color_by: Quantity = "ratio"
    measure: Measure = "mean-edge"
    cmap: str | None = None
    range_mode: RangeMode = "auto"
    low: float | None = None
    high: float | None = None
    percentile: float = 1.0
    log: bool | None = None
    classes: int = 0
    edges: bool = False
    outline_failing: bool = True
    dark: bool = False

    def __post_init__(self) -> None:
        if self.color_by not in QUANTITIES:
            raise InputError(f"cannot colour by {self.color_by!r}; choose one of {', '.join(QUANTITIES)}")
        if self.range_mode == "fixed" and (self.low is None or self.high is None):
            raise InputError("a fixed colour range needs both ends; give low and high")

    def with_changes(self, **changes: Any) -> ViewState:
        """Return the state with some choices replaced."""
        return replace(self, **changes)
