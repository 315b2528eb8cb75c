"""Size fields: piecewise-linear element sizes on a background mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sizeviz.geometry.arrays import as_sizes

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sizeviz.sizing.background import BackgroundMesh


@dataclass(frozen=True, eq=False)
class SizeField:
    """Prescribed element sizes, linear on every triangle of a background mesh.

    Parameters
    ----------
    background : BackgroundMesh
        Where the sizes live.
    sizes : (V,) float64
        Size at each background node, in model units, finite and above 0.
    label : str
        What to call the field in messages and pictures.

    Raises
    ------
    InputError
        If a size is NaN, infinite, zero or negative, or their number is wrong.
    """

    background: BackgroundMesh
    sizes: NDArray[np.float64]
    label: str = "size field"

    def __post_init__(self) -> None:
        object.__setattr__(self, "sizes", as_sizes(self.sizes, len(self.background.points), self.label))

    def with_sizes(self, sizes: NDArray[np.float64], label: str | None = None) -> SizeField:
        """Return a field on the same background with other nodal sizes, ``(V,)``."""
        return replace(self, sizes=sizes, label=self.label if label is None else label)
