"""What smoothing and clean-up are asked to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from sizeviz.errors import InputError

Objective = Literal["reciprocal", "paper", "shape"]
"""Distortion that the smoother lowers: shape x (s + 1/s)/2, the paper's shape x 1/mu (eq. 7), or shape alone."""


@dataclass(frozen=True, kw_only=True)
class SmoothOptions:
    """Clean-up and smoothing of a raw mesh.

    Parameters
    ----------
    objective : {'reciprocal', 'paper', 'shape'}
        Distortion of a corner, 1 where it is ideal. 'paper' is eq. (7) of Ruiz-Girones, Roca and Sarrate (2013);
        'reciprocal', the default, replaces its 1/mu by (s + 1/s)/2, which has the same value and curvature at
        s = 1 and costs less; 'shape' ignores the sizes.
    sweeps : int
        Passes over all nodes at the end, 0 or more. Default 10.
    cleanup : bool
        Whether the connectivity may change. Default True.
    rounds : int
        Passes of wide clean-up, each followed by three sweeps, 0 or more. Default 1.
    floor : float
        Shape quality, 0 to 1, that the worst elements are raised to where moves can. Default 0.78.
    threads : int, optional
        Worker threads; every core by default. The result is bitwise the same for any number.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    objective: Objective = "reciprocal"
    sweeps: int = 10
    cleanup: bool = True
    rounds: int = 1
    floor: float = 0.78
    threads: int | None = None

    def __post_init__(self) -> None:
        if self.objective not in get_args(Objective):
            raise InputError(f"objective is {self.objective!r}; choose one of {', '.join(get_args(Objective))}")
        for name, value in (("sweeps", self.sweeps), ("rounds", self.rounds)):
            if not (isinstance(value, int) and value >= 0):
                raise InputError(f"{name} is {value}; it must be a whole number, 0 or more")
        if not 0.0 <= self.floor < 1.0:
            raise InputError(f"floor is {self.floor}; a quality floor lies in 0 to 1, such as 0.78")
        if self.threads is not None and self.threads < 1:
            raise InputError(f"threads is {self.threads}; give 1 or more, or none for every core")
