"""What a mesher is asked to do."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from sizeviz.errors import InputError

Preset = Literal["direct", "fast"]
"""``direct`` packs nodes at the size itself; ``fast`` at twice the size, and splits every element in four."""


@dataclass(frozen=True, kw_only=True)
class MeshOptions:
    """How a raw all-quadrilateral mesh is made.

    Parameters
    ----------
    mesher : str
        Name of the generator, a key of ``GENERATORS``. Default ``frontal``.
    scale : float
        Element size asked for relative to the field (no unit), above 0. Default 0.87: with it the mesh of a
        preserved field conforms to more than 99 % of the sizes.
    seed : int
        Chooses one of many equally good meshes, 0 or above; the same seed gives the same mesh. Default 0.
    threads : int, optional
        Worker threads; every core by default. The mesh does not depend on it.
    preset : {'direct', 'fast'}
        Whether to place every node by the field, or to split a mesh of twice the size. Default ``direct``.
    max_elements : int
        Refuse to begin a mesh that would have more elements than this. Default 5 million.

    Raises
    ------
    InputError
        If a value is out of range.
    """

    mesher: str = "frontal"
    scale: float = 0.87
    seed: int = 0
    threads: int | None = None
    preset: Preset = "direct"
    max_elements: int = 5_000_000

    def __post_init__(self) -> None:
        if not (math.isfinite(self.scale) and self.scale > 0):
            raise InputError(f"mesh scale is {self.scale}; it must be a number above 0, such as 0.87")
        if self.seed < 0:
            raise InputError(f"seed is {self.seed}; it must be 0 or above")
        if self.threads is not None and self.threads < 1:
            raise InputError(f"threads is {self.threads}; at least 1 is needed")
        if self.preset not in ("direct", "fast"):
            raise InputError(f"preset is {self.preset!r}; choose 'direct' or 'fast'")
        if self.max_elements < 1:
            raise InputError(f"max_elements is {self.max_elements}; at least 1 is needed")
