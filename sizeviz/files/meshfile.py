"""A mesh as a file holds it: elements, and named values beside them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from sizeviz.geometry import QuadMesh


@dataclass(frozen=True, eq=False)
class MeshFile:
    """A mesh and the arrays that came with it.

    Parameters
    ----------
    mesh : QuadMesh
        The elements. From files that sizeviz wrote, nodes know their curves; from others, boundary nodes are fixed.
    cell_data, point_data : mapping of str to (Q, ...) or (N, ...) arrays
        Named values.
    """

    mesh: QuadMesh
    cell_data: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    point_data: Mapping[str, NDArray[Any]] = field(default_factory=dict)
