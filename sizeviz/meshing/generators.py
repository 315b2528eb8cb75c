"""Raw all-quadrilateral meshes: the protocol of a generator, those there are, and the one call that runs them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from sizeviz.errors import InputError, MeshingError
from sizeviz.geometry.outline import require_kept_inside, require_simple
from sizeviz.meshing.decomposition import Decomposition
from sizeviz.meshing.frontal.generator import Frontal
from sizeviz.meshing.gmsh import GmshGenerator
from sizeviz.meshing.options import MeshOptions
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from sizeviz.geometry import Domain, QuadMesh
    from sizeviz.sizing import SizeField


class Generator(Protocol):
    """Anything that makes a raw all-quadrilateral mesh of a domain by a size field."""

    @property
    def name(self) -> str:
        """What the user calls it by."""

    def generate(self, domain: Domain, size: SizeField, options: MeshOptions, monitor: Monitor = SILENT) -> QuadMesh:
        """Return quadrilaterals only, not smoothed; see `generated`."""


_ALL: tuple[Generator, ...] = (Frontal(), Decomposition(), GmshGenerator())

GENERATORS: dict[str, Generator] = {generator.name: generator for generator in _ALL}
"""Generators by name."""


def generated(
    domain: Domain, size: SizeField, options: MeshOptions | None = None, monitor: Monitor = SILENT
) -> QuadMesh:
    """Return a raw all-quadrilateral mesh of a domain whose elements are as large as the field says.

    Parameters
    ----------
    domain : Domain
        What to mesh.
    size : SizeField
        Element sizes, already limited or preserved: sizes that jump cannot be followed.
    options : MeshOptions, optional
        Mesher, scale, seed, limit.
    monitor : Monitor
        Progress and cancel.

    Returns
    -------
    QuadMesh
        Quadrilaterals only; every edge belongs to at most two; the boundary and inner lines of the domain are kept
        as edges. Some elements may be concave: smoothing mends them.

    Raises
    ------
    InputError
        If there is no generator of that name, curves of the domain cross, or lines or points lie outside.
    MeshingError
        If the mesh would have more than ``options.max_elements`` elements, or no valid mesh was found.
    """
    chosen = options or MeshOptions()
    if chosen.mesher not in GENERATORS:
        raise InputError(f"mesher {chosen.mesher!r} is not known; choose one of {', '.join(sorted(GENERATORS))}")
    _refuse_too_many(domain, size, chosen)
    try:
        return GENERATORS[chosen.mesher].generate(domain, size, chosen, monitor)
    except (InputError, MeshingError):
        # a domain that makes no sense is looked into only where it did harm, as that takes a while for long outlines
        require_simple(domain)
        require_kept_inside(domain)
        raise


def _refuse_too_many(domain: Domain, size: SizeField, options: MeshOptions) -> None:
    """Raise MeshingError if even elements as large as the largest size were too many: asked before anything is laid."""
    least = domain.area / (options.scale * float(size.sizes.max())) ** 2
    if not least <= options.max_elements:
        raise MeshingError(
            f"{size.label}: at mesh scale {options.scale:g} it asks for at least {least:.3g} elements, more than "
            f"{options.max_elements}; raise the sizes, beta, the mesh scale or the limit (--max-elements)"
        )
