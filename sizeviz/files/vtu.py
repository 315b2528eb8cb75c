"""Meshes and size fields as VTK unstructured grids, which ParaView, pyvista and meshio read."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files._vtu_xml import Document, encoded
from sizeviz.files.registry import MeshFile
from sizeviz.geometry import QuadMesh
from sizeviz.sizing import BackgroundMesh, SizeField

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from sizeviz.geometry import Domain

TRIANGLE, QUAD = 5, 9
"""VTK's numbers of the two cell types."""

SIZE_NAMES: tuple[str, ...] = ("size", "sizes", "size_target", "size_prescribed", "h")
"""Point arrays taken as sizes, the first that is there."""


def write_mesh(path: Path, content: MeshFile) -> None:
    """Write quadrilaterals with their cell and point arrays."""
    mesh = content.mesh
    _write(path, mesh.points, mesh.quads, QUAD, content.cell_data, content.point_data)


def write_field(path: Path, field: SizeField) -> None:
    """Write a field's triangles with its nodal sizes as the point array ``size``."""
    background = field.background
    _write(path, background.points, background.triangles, TRIANGLE, {}, {"size": field.sizes})


def read_mesh(path: Path) -> MeshFile:
    """Return the mesh in a file that holds quadrilaterals and nothing else.

    Raises
    ------
    InputError
        If the file is corrupt, not planar, or holds other cells.
    """
    document = Document(path)
    points, cells = _points(document), _cells(document, QUAD, "quadrilaterals")
    fixed = np.zeros(len(points), dtype=bool)
    if cells.max() >= len(points):
        raise document.corrupt("a cell names a point that does not exist")
    fixed[_boundary_nodes(cells)] = True
    mesh = QuadMesh(points, cells, np.full(len(points), -1, dtype=np.int32), fixed)
    return MeshFile(mesh, _scalars(document, "CellData", len(cells)), _scalars(document, "PointData", len(points)))


def read_field(path: Path, domain: Domain | None = None) -> SizeField:
    """Return the field in a file of triangles, or of quadrilaterals cut in two, with a point array of sizes.

    Raises
    ------
    InputError
        If the file is corrupt, not planar, or holds other cells or no sizes.
    """
    document = Document(path)
    points = _points(document)
    kinds = document.section("Cells").get("types", np.empty(0))
    if len(kinds) and (kinds == QUAD).all():
        quads = _cells(document, QUAD, "quadrilaterals")
        triangles = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    else:
        triangles = _cells(document, TRIANGLE, "triangles")
    arrays = _scalars(document, "PointData", len(points))
    name = next((name for name in SIZE_NAMES if name in arrays), None)
    if name is None and len(arrays) == 1:
        name = next(iter(arrays))
    if name is None:
        found = ", ".join(arrays) or "none"
        raise InputError(f"{path}: no point array of sizes (found: {found}); call it 'size'")
    background = BackgroundMesh(points, _counter_clockwise(triangles, points, path))
    return SizeField(background, arrays[name], label=path.name)


def _write(
    path: Path,
    points: NDArray[np.float64],
    cells: NDArray[np.int32],
    kind: int,
    cell_data: Mapping[str, NDArray[np.float64]],
    point_data: Mapping[str, NDArray[np.float64]],
) -> None:
    space = np.zeros((len(points), 3))
    space[:, :2] = points
    corners = cells.shape[1]
    with path.open("w", encoding="ascii") as file:
        file.write('<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" ')
        file.write('header_type="UInt64">\n<UnstructuredGrid>\n')
        file.write(f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">\n')
        file.writelines(_section("PointData", point_data))
        file.writelines(_section("CellData", cell_data))
        file.writelines(["<Points>\n", encoded(space, "Points", 3), "</Points>\n<Cells>\n"])
        file.write(encoded(cells.ravel(), "connectivity"))
        file.write(encoded(np.arange(corners, cells.size + 1, corners, dtype=np.int64), "offsets"))
        file.write(encoded(np.full(len(cells), kind, dtype=np.uint8), "types"))
        file.write("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")


def _section(name: str, arrays: Mapping[str, NDArray[np.float64]]) -> Iterator[str]:
    written = (encoded(np.asarray(array, dtype=np.float64), label) for label, array in arrays.items())
    return chain([f"<{name}>\n"], written, [f"</{name}>\n"])


def _points(document: Document) -> NDArray[np.float64]:
    points = next(iter(document.section("Points").values()), None)
    if points is None or points.ndim != 2 or points.shape[1] != 3:
        raise document.corrupt("no points with three coordinates")
    space = points.astype(np.float64)
    if not np.isfinite(space).all():
        raise InputError(f"{document.path}: a point is not finite; repair or remove it")
    if len(space) and np.ptp(space[:, 2]) > 1e-9 * max(float(np.ptp(space[:, :2])), 1e-300):
        raise InputError(f"{document.path}: the points do not lie in a plane z = const; only planar input is supported")
    return np.ascontiguousarray(space[:, :2])


def _cells(document: Document, kind: int, words: str) -> NDArray[np.int32]:
    arrays = document.section("Cells")
    try:
        joined, offsets, kinds = (np.asarray(arrays[name]) for name in ("connectivity", "offsets", "types"))
    except KeyError as problem:
        raise document.corrupt(f"no array {problem}") from problem
    if not len(kinds):
        raise InputError(f"{document.path}: holds no cell; write a mesh with at least one")
    if not (kinds == kind).all():
        raise InputError(f"{document.path}: holds cells other than {words}; only a mesh of {words} can be used here")
    corners = 4 if kind == QUAD else 3
    if not np.array_equal(offsets, corners * np.arange(1, len(kinds) + 1)) or len(joined) != corners * len(kinds):
        raise document.corrupt("cells and offsets disagree")
    if joined.min() < 0 or joined.max() > np.iinfo(np.int32).max:
        raise document.corrupt("a cell names a point that cannot exist")
    return joined.astype(np.int32).reshape(-1, corners)


def _scalars(document: Document, section: str, count: int) -> dict[str, NDArray[np.float64]]:
    arrays = {name: array for name, array in document.section(section).items() if array.ndim == 1}
    for name, array in arrays.items():
        if len(array) != count:
            raise document.corrupt(f"array {name!r} has {len(array)} values for {count} places")
    return {name: array.astype(np.float64) for name, array in arrays.items()}


def _boundary_nodes(quads: NDArray[np.int32]) -> NDArray[np.int32]:
    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    return np.unique(unique[counts == 1])


def _counter_clockwise(triangles: NDArray[np.int32], points: NDArray[np.float64], path: Path) -> NDArray[np.int32]:
    """Turn clockwise triangles; flat ones cannot carry a linear field."""
    if triangles.max() >= len(points):
        raise InputError(f"{path}: a cell names a point that does not exist; the connectivity is corrupt")
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    if (area == 0).any():
        raise InputError(f"{path}: triangle {int(np.argmax(area == 0))} has no area; remove it")
    return np.where((area < 0)[:, None], triangles[:, [0, 2, 1]], triangles)
