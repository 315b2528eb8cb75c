"""What gradient limiting and size preserving are asked to do."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from sizeviz.errors import InputError

LimitDistance = Literal["euclidean", "edges"]
"""How far apart two nodes are: straight, or along background edges."""

Distance = Literal["euclidean", "edges", "edges-as-printed"]
"""As ``LimitDistance``; along edges Algorithms 1 and 2 have line 18 mended or as printed."""


LEAST = 1e-6
"""Smallest alpha and beta; the largest is its reciprocal. What lies beyond is a slip, and would end in overflow."""


@dataclass(frozen=True, kw_only=True)
class LimitOptions:
    """Gradient limiting.

    Parameters
    ----------
    epsilon : float
        Largest slope of the limited field, size per unit of distance (no unit), above 0. Default 0.5.
    distance : {'euclidean', 'edges'}
        Distance that the slope is measured over.
    """

    epsilon: float = 0.5
    distance: LimitDistance = "euclidean"

    def __post_init__(self) -> None:
        _check_distance(self.distance, get_args(LimitDistance))
        if not (math.isfinite(self.epsilon) and self.epsilon > 0):
            raise InputError(f"epsilon is {self.epsilon}; the largest slope must be a number above 0, such as 0.5")


@dataclass(frozen=True, kw_only=True)
class PreserveOptions:
    """Size preserving, the paper's h*.

    Parameters
    ----------
    alpha : float
        Radius of the ball that must hold no smaller size, in elements, 1e-6 to 1e6. Default 2.
    beta : float
        Scale of the size asked for, 1e-6 to 1e6; more than 1 permits R > 1 on purpose. Default 1.
    distance : {'euclidean', 'edges', 'edges-as-printed'}
        Distance that the ball is measured by; the printed variant shows the paper's erratum.
    """

    alpha: float = 2.0
    beta: float = 1.0
    distance: Distance = "euclidean"

    def __post_init__(self) -> None:
        _check_distance(self.distance, get_args(Distance))
        for name, value, example in (("alpha", self.alpha, "2"), ("beta", self.beta, "1")):
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"{name} is {value}; it must be a number above 0, such as {example}")
            if not LEAST <= value <= 1.0 / LEAST:
                raise InputError(f"{name} is {value}; give {LEAST:g} to {1 / LEAST:g}, such as {example}")


def _check_distance(distance: str, known: tuple[str, ...]) -> None:
    if distance not in known:
        raise InputError(f"distance {distance!r} is unknown here; choose one of {', '.join(known)}")
