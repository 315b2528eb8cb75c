"""``load`` and ``paint``: sizes from anywhere, and strokes on them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import one_line
from sizeviz.geometry import Domain
from sizeviz.notebook import progress
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sources import Source
from sizeviz.sources import load as _load
from sizeviz.sources.approximation import approximated, shortfall
from sizeviz.sources.painting import Brush, Stroke, StrokeShape, painted, stroke_weights

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from sizeviz.monitor import Monitor

    Function = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


def load(
    source: str | Path | Source | SizeField | ArrayLike | Function,
    domain: Domain | str | Path | None = None,
    *,
    image_size: Literal["curvature", "intensity"] = "curvature",
    monitor: Monitor | None = None,
) -> Source:
    """Return a source of sizes.

    Parameters
    ----------
    source : str, path-like, Source, SizeField, (ny, nx) array or callable
        An example's name, a file, ``expr:FORMULA``; a source or field as it is; sizes on a grid, row 0 at the smallest
        y; or a function of x and y, arrays of one shape, that returns the sizes.
    domain : Domain or path-like, optional
        What is to be meshed, or the file that outlines it; by default the source's own extent, the unit square for
        arrays and functions.
    image_size : {'curvature', 'intensity'}
        How a picture becomes sizes.
    monitor : Monitor, optional
        Told of progress; by default a bar in a notebook or on a terminal.

    Raises
    ------
    InputError
        If there is no such source, or its content cannot be used.
    """
    outline = _domain(domain)
    if isinstance(source, Source):
        return source if outline is None else replace(source, domain=outline)
    if isinstance(source, SizeField):
        return _of_field(source, outline or _bounds_of(source))
    if isinstance(source, str | Path):
        with progress(monitor) as bar:
            return _load(str(source), outline, image_size=image_size, monitor=bar)
    region = outline or Domain.unit_square()
    if callable(source):
        label = getattr(source, "__name__", "function")
        with progress(monitor) as bar:
            size = approximated(source, region, label, monitor=bar)
        words = label + shortfall(size)
        return Source("function", words, region, size.field, size, None, {"kind": "function", "error": size.error})
    return _of_field(_gridded(source, region), region)


def paint(
    source: Source,
    path: ArrayLike,
    *,
    size: float | None = None,
    factor: float | None = None,
    at_most: float | None = None,
    radius: float,
    hardness: float = 0.5,
    shape: StrokeShape = "freehand",
) -> Source:
    """Return a source after a stroke of the brush; R is then judged against what was painted.

    Parameters
    ----------
    source : Source
        What is painted on.
    path : (K, 2) array_like
        Where the brush goes, in model units.
    size, factor, at_most : float
        Exactly one of them: the size to set, the factor to multiply by, or the size not to exceed; above 0.
    radius : float
        Reach of the brush in model units, above 0.
    hardness : float
        Share of the radius with full effect, 0 to 1.
    shape : {'freehand', 'line', 'polygon'}
        Whether the path is the stroke, or outlines what it fills.

    Raises
    ------
    InputError
        If a value is out of range, not exactly one effect is given, or the stroke reaches no node.
    """
    effects = {"set": size, "multiply": factor, "at-most": at_most}
    given = [(mode, value) for mode, value in effects.items() if value is not None]
    if len(given) != 1:
        raise InputError(f"paint needs exactly one of size, factor and at_most; {len(given)} were given")
    mode, value = given[0]
    modes: dict[str, Literal["set", "multiply", "at-most"]] = {
        "set": "set",
        "multiply": "multiply",
        "at-most": "at-most",
    }
    stroke = Stroke(Brush(mode=modes[mode], radius=radius, value=value, hardness=hardness), np.asarray(path), shape)
    if not stroke_weights(source.field.background, stroke).any():
        raise InputError("the stroke reaches no node of the field; move it, widen the brush, or load a finer field")
    field = painted(source.field, stroke)
    strokes = int(source.provenance.get("strokes", 0)) + 1
    return replace(source, field=field, reference=field, provenance={**source.provenance, "strokes": strokes})


def _domain(domain: Domain | str | Path | None) -> Domain | None:
    from sizeviz.files import read_domain

    return read_domain(domain) if isinstance(domain, str | Path) else domain


def _of_field(field: SizeField, domain: Domain) -> Source:
    return Source("field", field.label, domain, field, field, None, {"kind": "values"})


def _bounds_of(field: SizeField) -> Domain:
    bounds = field.background.bounds
    return Domain.unit_square() if bounds == (0.0, 0.0, 1.0, 1.0) else Domain.rectangle(*bounds, label=field.label)


def _gridded(values: ArrayLike, domain: Domain) -> SizeField:
    """Return sizes on a grid over the domain's bounds."""
    from sizeviz.sizing import Grid

    try:
        given = np.asarray(values)
        sizes = given.astype(np.float64, casting="same_kind" if given.dtype.kind == "c" else "unsafe")
    except (TypeError, ValueError) as problem:
        raise InputError(
            f"sizes that are no rectangular array of real numbers ({one_line(problem, 80)}); give a grid (ny, nx)"
        ) from None
    if sizes.ndim != 2 or min(sizes.shape) < 2:
        raise InputError(
            f"sizes of shape {sizes.shape}: give a grid (ny, nx), at least 2 by 2, row 0 at the smallest y"
        )
    (x0, y0, x1, y1), (ny, nx) = domain.bounds, sizes.shape
    grid = Grid(x0, y0, (x1 - x0) / (nx - 1), (y1 - y0) / (ny - 1), nx, ny)
    return SizeField(BackgroundMesh.regular(grid), sizes.ravel(), "array")
