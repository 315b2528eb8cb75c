"""Where a size field comes from, and what its meshes are judged against."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sizeviz.files import Image
    from sizeviz.geometry import Domain
    from sizeviz.sizing import SizeField, SizeFunction


@dataclasses.dataclass(frozen=True, eq=False)
class Source:
    """A size field with the domain it is meant for.

    Parameters
    ----------
    name : str
        Short name: an example's, a file's, or ``formula``.
    label : str
        One line of plain words for tables and pictures.
    domain : Domain
        What is to be meshed.
    field : SizeField
        The prescribed sizes, piecewise linear.
    reference : SizeFunction
        What R(e) is measured against: the field itself, or the formula that it approximates.
    image : Image, optional
        The picture that the sizes were derived from, over the same plane, for interpolation errors.
    provenance : mapping
        Plain values that say how to get the source again.
    """

    name: str
    label: str
    domain: Domain
    field: SizeField
    reference: SizeFunction
    image: Image | None = None
    provenance: Mapping[str, Any] = dataclasses.field(default_factory=dict)
