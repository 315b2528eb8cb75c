"""Section 2: sizes on a line, eq. (1), what both methods make of them, and the nodes of an advancing front."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.sizing.line import (
    LineField,
    advanced,
    limited_on_line,
    paper_valley,
    preserved_on_line,
    ratios_on_line,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

ALPHAS: tuple[float, ...] = (0.25, 0.5, 1.0, 2.0, 4.0)
"""What Figure 2(b) is drawn for."""


@dataclass(frozen=True, eq=False)
class LineExample:
    """The one-dimensional example.

    Parameters
    ----------
    alpha, epsilon : float
        Parameters of both methods; 1, as in the paper.
    x : (N,) float64
        Places from 0 to 1.
    sizes : dict of str to (N,) float64
        Sizes there by method: 'none', 'gradient-limiting', 'size-preserving'.
    nodes : dict of str to (K,) float64
        Nodes of the front, from 0 to 1.
    ratios : dict of str to (K - 1,) float64
        R of each element against eq. (1).
    by_alpha : dict of float to (N,) float64
        Preserved sizes for several alpha.
    """

    alpha: float
    epsilon: float
    x: NDArray[np.float64]
    sizes: dict[str, NDArray[np.float64]]
    nodes: dict[str, NDArray[np.float64]]
    ratios: dict[str, NDArray[np.float64]]
    by_alpha: dict[float, NDArray[np.float64]]


def line_example(alpha: float = 1.0, epsilon: float = 1.0, samples: int = 2001) -> LineExample:
    """Return the example of Figures 1 to 3."""
    given = paper_valley()
    x = np.union1d(np.linspace(0.0, 1.0, samples), _bends((alpha, *ALPHAS), epsilon))
    fields = {
        "none": given,
        "gradient-limiting": LineField(x, limited_on_line(given, epsilon, x)),
        "size-preserving": LineField(x, preserved_on_line(given, alpha, 1.0, x)),
    }
    nodes = {name: advanced(field, 0.0, 1.0) for name, field in fields.items()}
    return LineExample(
        alpha,
        epsilon,
        x,
        {name: field.at(x) for name, field in fields.items()},
        nodes,
        {name: ratios_on_line(given, at) for name, at in nodes.items()},
        {value: preserved_on_line(given, value, 1.0, x) for value in ALPHAS},
    )


def _bends(alphas: Sequence[float], epsilon: float) -> NDArray[np.float64]:
    """Return where the sizes of all methods bend: at these places they must be asked, to be linear between."""
    lowest, highest, slope, valley = 0.1, 0.5, 3.0, 0.75  # eq. (1)
    away = [(highest - lowest) / min(slope, epsilon), (highest - lowest) / slope, 0.0]
    for alpha in alphas:
        away += [alpha * lowest, (highest * (1.0 + alpha * slope) - lowest) / slope]
    at = np.concatenate([valley - np.array(away), valley + np.array(away)])
    return at[(at >= 0.0) & (at <= 1.0)]
