"""What every source gives: a domain, a size field on a background mesh, and the sizes that R is judged against."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sizeviz.files.image import Image
    from sizeviz.geometry import Domain
    from sizeviz.sizing import SizeField, SizeFunction


@dataclass(frozen=True, eq=False)
class Source:
    """A prescribed size field, ready for the pipeline.

    Parameters
    ----------
    name : str
        Short name: an example's, a file's stem.
    label : str
        What to call it in pictures and messages.
    domain : Domain
        The region to mesh.
    field : SizeField
        The prescribed sizes as a background mesh, which limiting and preserving work on.
    reference : SizeFunction
        What R(e) is measured against: the field itself, or the formula it was sampled from.
    image : Image, optional
        The picture behind the field, for the interpolation error of section 5.2; its pixels span the domain's box.
    provenance : mapping
        Where it came from, in words and plain numbers, for reports and study files.
    """

    name: str
    label: str
    domain: Domain
    field: SizeField
    reference: SizeFunction
    image: Image | None = None
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "provenance", MappingProxyType(dict(self.provenance)))
