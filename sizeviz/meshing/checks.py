"""What every raw mesh must be before anyone sees it: quadrilaterals only, no hole, no overlap, the boundary kept."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import MeshingError
from sizeviz.meshing._checks_kernels import distinct_edges

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import QuadMesh

AREA_TOLERANCE = 1e-9
"""Relative difference between the area of the elements and that inside the boundary edges."""


def edges_of(cells: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return the distinct edges ``(E, 2)``, lower node first, sorted, and how many cells share each, ``(E,)``."""
    edges, count = distinct_edges(cells, int(cells.max(initial=-1)) + 1)
    return edges, count


def verify(mesh: QuadMesh, required: NDArray[np.int32], bounding: NDArray[np.bool_], area: float) -> None:
    """Check a mesh's topology and area.

    Parameters
    ----------
    mesh : QuadMesh
        The mesh.
    required : (E, 2) int32
        Edges that the mesh must have: the boundary's, and those along inner lines.
    bounding : (E,) bool
        Which of them lie on the boundary; no other edge may belong to one element only.
    area : float
        Area inside the boundary edges.

    Raises
    ------
    MeshingError
        If an edge is shared by more than two elements, an edge of the outline is missing, the mesh has another
        boundary, a node is not used, or the elements' area is not that inside the boundary.
    """
    edges, count = edges_of(mesh.quads)
    width = np.int64(mesh.n_points)
    keys = edges[:, 0].astype(np.int64) * width + edges[:, 1]
    wanted = np.sort(required, axis=1).astype(np.int64)
    wanted_keys = wanted[:, 0] * width + wanted[:, 1]
    faults = []
    if (count > 2).any():
        faults.append(f"{int((count > 2).sum())} edges are shared by more than two elements")
    place = np.minimum(np.searchsorted(keys, wanted_keys), len(keys) - 1)
    missing = int((keys[place] != wanted_keys).sum())
    if missing:
        faults.append(f"{missing} edges of the outline are missing")
    if not np.array_equal(np.sort(wanted_keys[bounding]), keys[count == 1]):
        faults.append("the mesh's boundary is not the outline")
    if not np.bincount(mesh.quads.ravel(), minlength=mesh.n_points).all():
        faults.append("a node belongs to no element")
    covered = float(mesh.areas.sum())
    if abs(covered - area) > AREA_TOLERANCE * abs(area):
        faults.append(f"the elements cover an area of {covered:.12g} instead of {area:.12g}")
    if faults:
        raise MeshingError(f"no valid mesh was found: {'; '.join(faults)}; try another seed or a smaller mesh scale")
