"""VTK's XML data sets: ``.vtu`` meshes, ``.vtp`` surfaces, ``.vti`` images; and ``.vtu`` out, every bit kept."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files._vtk_xml import Document, data_array
from sizeviz.files.guard import check_nodes, one_line
from sizeviz.files.raw import Cells, RawGrid, RawMesh, grouped
from sizeviz.files.text import indices, numbers, whole

if TYPE_CHECKING:
    from collections.abc import Callable
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

VTK_CELLS: dict[int, str] = {
    1: "vertex",
    2: "polyvertex",
    3: "line",
    4: "polyline",
    5: "triangle",
    6: "triangle strip",
    7: "polygon",
    8: "pixel",
    9: "quad",
    10: "tetra",
    12: "hexahedron",
    13: "wedge",
    14: "pyramid",
    22: "triangle6",
    23: "quad8",
    28: "quad9",
}
"""VTK's numbers of the cell types; lines of many points and the like are named for messages only."""

POLY_SECTIONS = (("Verts", 2), ("Lines", 4), ("Polys", 7), ("Strips", 6))
"""The lists of a surface in the order of its cell arrays, and the cell type of each."""

_CODES = {name: code for code, name in VTK_CELLS.items()}


def parse(data: bytes) -> RawMesh | RawGrid:
    """Return what a .vtu, .vtp or .vti file holds.

    Raises
    ------
    InputError
        If the file is corrupt, compressed by LZ4, split into pieces, or another kind of data set.
    """
    document = Document(data)
    readers: dict[str, Callable[[Document], RawMesh | RawGrid]] = {
        "UnstructuredGrid": _unstructured,
        "PolyData": _poly_data,
        "ImageData": _image_data,
    }
    if document.kind not in readers:
        raise InputError(f"it holds a {one_line(document.kind, 40)}; {', '.join(readers)} are supported")
    return readers[document.kind](document)


def written(raw: RawMesh) -> list[bytes]:
    """Return the parts of a .vtu file with float64 kept to the bit."""
    n_cells = sum(len(block.rows) for block in raw.cells)
    corners = np.concatenate([np.full(len(block.rows), block.rows.shape[1], dtype=np.int64) for block in raw.cells])
    kinds = np.concatenate([np.full(len(block.rows), _CODES[block.kind], dtype=np.uint8) for block in raw.cells])
    joined = np.concatenate([block.rows.ravel() for block in raw.cells])
    small = joined.astype(np.int32) if len(raw.points) < 2**31 else joined
    return [
        b'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        b'header_type="UInt64">\n<UnstructuredGrid>\n',
        *_section("FieldData", raw.field_data, b' NumberOfTuples="%d" '),
        f'<Piece NumberOfPoints="{len(raw.points)}" NumberOfCells="{n_cells}">\n'.encode(),
        *_section("PointData", raw.point_data),
        *_section("CellData", raw.cell_data),
        *[b"<Points>\n", data_array(raw.points, "Points"), b"</Points>\n<Cells>\n"],
        data_array(small, "connectivity"),
        data_array(np.cumsum(corners), "offsets"),
        data_array(kinds, "types"),
        b"</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
    ]


def _section(name: str, arrays: Any, tuples: bytes = b"") -> list[bytes]:
    if not arrays:
        return []
    written_arrays = [data_array(np.asarray(values), label) for label, values in arrays.items()]
    if tuples:  # a field array says how many rows it has
        written_arrays = [
            element.replace(b"<DataArray ", b"<DataArray" + tuples % len(values), 1)
            for element, values in zip(written_arrays, arrays.values(), strict=True)
        ]
    return [f"<{name}>\n".encode(), *written_arrays, f"</{name}>\n".encode()]


def _unstructured(document: Document) -> RawMesh:
    piece = document.sole_piece()
    points = _points(document, piece)
    cells = piece.find("Cells")
    if cells is None:
        raise InputError("it holds no Cells; the file is cut or corrupt")
    count = _count(piece, "NumberOfCells")
    offsets, kinds = document.named(cells, "offsets", count), document.named(cells, "types", count)
    joined = _connectivity(document, cells, offsets)
    blocks = grouped(joined, np.concatenate([[0], offsets]), kinds, VTK_CELLS)
    field = document.arrays(document.body.find("FieldData") if document.body is not None else None)
    return RawMesh(points, blocks, *_data(document, piece, len(points), count), field)


def _poly_data(document: Document) -> RawMesh:
    piece = document.sole_piece()
    points = _points(document, piece)
    cells: list[Cells] = []
    count = 0
    for section, code in POLY_SECTIONS:
        element, own = piece.find(section), _count(piece, f"NumberOf{section}", 0)
        if element is not None and own:
            offsets = document.named(element, "offsets", own)
            starts, kinds = np.concatenate([[0], offsets]), np.full(own, code)
            groups = grouped(_connectivity(document, element, offsets), starts, kinds, VTK_CELLS)
            cells += [Cells(group.kind, group.rows, group.index + count) for group in groups]
        count += own
    return RawMesh(points, tuple(cells), *_data(document, piece, len(points), count))


def _image_data(document: Document) -> RawGrid:
    body, piece = document.body, document.sole_piece()
    assert body is not None
    extent = _attribute(body, "WholeExtent", None, 6).astype(np.int64)
    own = _attribute(piece, "Extent", extent, 6).astype(np.int64)
    if (own != extent).any():
        raise InputError("its one piece does not cover the whole extent; export it whole")
    direction = _attribute(body, "Direction", np.eye(3).ravel(), 9)
    if not np.array_equal(direction, np.eye(3).ravel()):
        raise InputError("its axes are turned by a direction matrix; resample it along x, y, z")
    spacing = _attribute(body, "Spacing", np.ones(3), 3)
    origin = _attribute(body, "Origin", np.zeros(3), 3) + extent[0::2] * spacing
    nx, ny, nz = (int(n) for n in extent[1::2] - extent[0::2] + 1)
    for n in (nx, ny, nz):
        check_nodes(n, "points along an axis")
    n_cells = max(nx - 1, 1) * max(ny - 1, 1) * max(nz - 1, 1)
    return RawGrid((nx, ny, nz), origin, spacing, *_data(document, piece, nx * ny * nz, n_cells))


def _attribute(element: Element, name: str, default: NDArray[Any] | None, count: int) -> NDArray[Any]:
    text = element.get(name)
    if text is None:
        if default is None:
            raise InputError(f"{name} is missing; the file is cut or corrupt")
        return default
    parse_words = indices if name.endswith("Extent") else numbers
    return parse_words(text.encode(), name, count)


def _data(
    document: Document, piece: Element, n_points: int, n_cells: int
) -> tuple[dict[str, NDArray[Any]], dict[str, NDArray[Any]]]:
    """Return the arrays of points and of cells."""
    return document.arrays(piece.find("PointData"), n_points), document.arrays(piece.find("CellData"), n_cells)


def _count(piece: Element, name: str, default: int | None = None) -> int:
    text = piece.get(name)
    if text is None and default is not None:
        return default
    count = whole(text or "", name)
    check_nodes(count, name, 2**31)
    return count


def _points(document: Document, piece: Element) -> NDArray[np.float64]:
    count = _count(piece, "NumberOfPoints")
    check_nodes(count, "points")
    points = next(iter(document.arrays(piece.find("Points"), count).values()), None)
    if points is None or points.ndim != 2 or points.shape[1] != 3:
        raise InputError("it has no points with three coordinates; the file is cut or corrupt")
    return points.astype(np.float64)


def _connectivity(document: Document, section: Element, offsets: NDArray[np.int64]) -> NDArray[np.int64]:
    count = int(offsets[-1]) if len(offsets) else 0
    check_nodes(count, "corners of cells", 2**31)
    return document.named(section, "connectivity", count)
