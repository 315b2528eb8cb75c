"""``limit`` and ``preserve``: sizes that a mesh can follow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from sizeviz.compiled import prepared
from sizeviz.notebook import progress
from sizeviz.sizing import LimitOptions, PreserveOptions, SizeField, limited, preserved
from sizeviz.sources import Source

if TYPE_CHECKING:
    from sizeviz.monitor import Monitor


def limit(
    source: Source | SizeField,
    epsilon: float = 0.5,
    *,
    distance: Literal["euclidean", "edges"] = "euclidean",
    monitor: Monitor | None = None,
) -> SizeField:
    """Return the gradient-limited field: sizes that grow by at most ``epsilon`` per unit of distance, eq. (2).

    Parameters
    ----------
    source : Source or SizeField
        The sizes asked for.
    epsilon : float
        Largest slope, above 0.
    distance : {'euclidean', 'edges'}
        What the slope is measured over.
    monitor : Monitor, optional
        Told of progress.

    Raises
    ------
    InputError
        If a value is out of range.
    """
    options = LimitOptions(epsilon=epsilon, distance=distance)
    with progress(monitor) as bar:
        return limited(_field(source), options, monitor=prepared(bar))


def preserve(
    source: Source | SizeField,
    alpha: float = 2.0,
    beta: float = 1.0,
    *,
    distance: Literal["euclidean", "edges", "edges-as-printed"] = "euclidean",
    monitor: Monitor | None = None,
) -> SizeField:
    """Return the size-preserving field h*, Algorithm 1.

    Parameters
    ----------
    source : Source or SizeField
        The sizes asked for.
    alpha : float
        Radius of the ball that must hold no smaller size, in elements, above 0.
    beta : float
        Scale of the size asked for, above 0.
    distance : {'euclidean', 'edges', 'edges-as-printed'}
        What the ball is measured by.
    monitor : Monitor, optional
        Told of progress.

    Raises
    ------
    InputError
        If a value is out of range.
    """
    options = PreserveOptions(alpha=alpha, beta=beta, distance=distance)
    with progress(monitor) as bar:
        return preserved(_field(source), options, monitor=prepared(bar))


def _field(source: Source | SizeField) -> SizeField:
    return source.field if isinstance(source, Source) else source
