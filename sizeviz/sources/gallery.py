"""The examples by name, and loading whatever a user names as a source."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from sizeviz.errors import InputError
from sizeviz.files import ReadOptions, read_field, read_image
from sizeviz.files.convert import raw_field
from sizeviz.files.outlines import domain_of
from sizeviz.geometry import Domain
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sources.analytic_examples import ring, valley
from sizeviz.sources.approximation import approximated, shortfall
from sizeviz.sources.formula import Formula
from sizeviz.sources.phantom import phantom
from sizeviz.sources.picture_examples import coast, mri, terrain
from sizeviz.sources.pictures import extent, size_from_curvature, size_from_intensity
from sizeviz.sources.source import Source

if TYPE_CHECKING:
    from collections.abc import Callable

    from sizeviz.files import Image
    from sizeviz.sizing import SizeField

PICTURES = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".gif", ".nii", ".gz", ".dcm"})
"""Suffixes of files that hold intensities rather than sizes."""

FORMULA = "expr:"
"""What a formula given as a source begins with."""


@dataclass(frozen=True)
class Example:
    """An entry of the gallery.

    Parameters
    ----------
    name : str
        What to type.
    label : str
        What it is, in one line.
    description : str
        What there is to see in it.
    build : callable
        Returns the source.
    """

    name: str
    label: str
    description: str
    build: Callable[[], Source]


_EXAMPLES = (
    Example(
        "ring",
        "Circular valley, sizes from 0.00025 to 0.25 (section 5.1)",
        "The paper's first test: sizes fall a thousandfold towards a circle. Gradient limiting misses the valley.",
        ring,
    ),
    Example(
        "valley",
        "Straight valley, sizes from 0.1 to 0.5 (equation 1)",
        "The paper's one-dimensional example drawn out over a square: few elements, each one to be seen.",
        valley,
    ),
    Example(
        "mri",
        "MRI slice of a head, sizes from its curvature (as section 5.2)",
        "Small elements where the image bends, on 513 x 513 nodes; the interpolation error shows what they are for.",
        mri,
    ),
    Example(
        "phantom",
        "Synthetic cardiac phantom, sizes from its curvature (as section 5.2)",
        "A drawn slice through a chest, of nobody: heart, lungs and fat with soft edges, on 513 x 513 nodes.",
        phantom,
    ),
    Example(
        "terrain",
        "Terrain at the Jacksboro fault, sizes from its curvature",
        "Ridges and valleys of a digital elevation model, in kilometres.",
        terrain,
    ),
    Example(
        "coast",
        "Coast, sizes growing with the distance from the shore",
        "A winding valley of small elements along a shore line, in kilometres.",
        coast,
    ),
)


def examples() -> tuple[Example, ...]:
    """Return the gallery."""
    return _EXAMPLES


def load(
    spec: str,
    domain: Domain | None = None,
    *,
    image_size: Literal["curvature", "intensity"] = "curvature",
    monitor: Monitor = SILENT,
) -> Source:
    """Return a source by an example's name, a file, or ``expr:`` and a formula in x and y.

    Parameters
    ----------
    spec : str
        What the user typed.
    domain : Domain, optional
        What to mesh instead of the source's own extent.
    image_size : {'curvature', 'intensity'}
        How a picture becomes sizes.
    monitor : Monitor
        Told of progress; may cancel.

    Raises
    ------
    InputError
        If there is no such example or file, or its content cannot be used.
    """
    if spec.startswith(FORMULA):
        return _from_formula(spec[len(FORMULA) :], domain or Domain.unit_square(), monitor)
    found = {example.name: example for example in _EXAMPLES}.get(spec)
    if found is not None:
        source = found.build()
        return source if domain is None else _over(source, domain, monitor)
    path = Path(spec)
    if not _exists(path):
        raise InputError(_unknown(spec))
    if path.suffix.lower() in PICTURES:
        return _from_picture(path, read_image(path), domain, image_size)
    return _from_field(path, read_field(path, domain), domain)


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # a name that is too long for any file
        return False


def _unknown(spec: str) -> str:
    names = [example.name for example in _EXAMPLES]
    near = difflib.get_close_matches(spec, names, n=1)
    hint = f"did you mean {near[0]}?" if near else f"examples are {', '.join(names)}; a formula begins with {FORMULA}"
    return f"source {spec[:200]!r}: there is no such example or file; {hint}"


def _from_formula(text: str, domain: Domain, monitor: Monitor) -> Source:
    formula = Formula(text.strip())
    size = approximated(formula, domain, "formula", monitor=monitor)
    provenance = {"kind": "formula", "formula": formula.text, "error": size.error}
    return Source("formula", formula.text + shortfall(size), domain, size.field, size, None, provenance)


def _over(source: Source, domain: Domain, monitor: Monitor) -> Source:
    """Return an example over another domain; its formula is approximated there anew."""
    formula = source.provenance.get("formula")
    if formula is None:
        return Source(
            source.name, source.label, domain, source.field, source.reference, source.image, source.provenance
        )
    size = approximated(Formula(str(formula)), domain, source.name, monitor=monitor)
    provenance = {**source.provenance, "error": size.error}
    return Source(source.name, source.label + shortfall(size), domain, size.field, size, source.image, provenance)


def _from_picture(path: Path, image: Image, domain: Domain | None, image_size: str) -> Source:
    if image_size not in ("curvature", "intensity"):
        raise InputError(f"a picture gives sizes by curvature or intensity, not by {image_size!r}")
    field = size_from_curvature(image) if image_size == "curvature" else size_from_intensity(image)
    provenance = {"kind": "picture", "path": str(path), "image_size": image_size}
    label = f"{path.name}, sizes from {image_size}"
    return Source(path.stem, label, domain or extent(image), field, field, image, provenance)


def _from_field(path: Path, field: SizeField, domain: Domain | None) -> Source:
    own = domain or _outline_of(field)
    return Source(path.stem, path.name, own, field, field, None, {"kind": "field", "path": str(path)})


def _outline_of(field: SizeField) -> Domain:
    """Return the domain that a field's background covers."""
    if field.background.grid is not None:
        bounds = field.background.bounds
        if bounds == (0.0, 0.0, 1.0, 1.0):
            return Domain.unit_square()
        return Domain.rectangle(*bounds, label=field.label)
    return domain_of(raw_field(field), field.label, ReadOptions())
