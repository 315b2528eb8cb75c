"""Medit and MMG: ``.mesh`` with its ``.sol`` of sizes, in ASCII, in and out.

Format: P. Frey (2001), "Medit: an interactive mesh visualization software", INRIA RT-0253; MMG reads the same.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import check_nodes, one_line
from sizeviz.files.raw import Cells, RawMesh
from sizeviz.files.text import numbers, whole

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

_KEYWORD = re.compile(rb"(?<!\S)(?!(?i:nan|inf|infinity)(?!\S))[A-Za-z]\S*")
_COMMENT = re.compile(rb"#[^\n]*")
_CELLS = {
    "Edges": ("line", 2),
    "Triangles": ("triangle", 3),
    "Quadrilaterals": ("quad", 4),
    "Tetrahedra": ("tetra", 4),
    "Hexahedra": ("hexahedron", 8),
    "Prisms": ("wedge", 6),
    "Pyramids": ("pyramid", 5),
}
_NAMES = {kind: name for name, (kind, _) in _CELLS.items()}
_CHUNK = 100_000


def parse_mesh(data: bytes) -> RawMesh:
    """Return the mesh in a .mesh file.

    Raises
    ------
    InputError
        If the file is corrupt or binary.
    """
    found = dict(_sections(data))
    dimension = _dimension(found)
    if "Vertices" not in found:
        raise InputError("it holds no Vertices; the file is cut or corrupt")
    vertices = _table(found["Vertices"], dimension + 1, "Vertices")
    points = np.zeros((len(vertices), 3))
    points[:, :dimension] = vertices[:, :dimension]
    cells: list[Cells] = []
    count = 0
    for name, (kind, corners) in _CELLS.items():
        if name in found:
            rows = _table(found[name], corners + 1, name)[:, :corners]
            if rows.size and not (np.abs(rows).max() < 2**53 and (rows == np.trunc(rows)).all()):
                raise InputError(f"{name} hold a number that names no vertex; the file is corrupt")
            cells.append(Cells(kind, rows.astype(np.int64) - 1, np.arange(count, count + len(rows))))
            count += len(rows)
    return RawMesh(points, tuple(cells))


def parse_solution(data: bytes, n_vertices: int) -> NDArray[np.float64]:
    """Return the sizes at the vertices from a .sol file, ``(V,)``.

    Raises
    ------
    InputError
        If the file is corrupt or binary, holds a metric tensor or several solutions, or fits another mesh.
    """
    found = dict(_sections(data))
    _dimension(found)
    if "SolAtVertices" not in found:
        raise InputError("it holds no SolAtVertices; sizes are needed at the vertices")
    words = found["SolAtVertices"].split(maxsplit=2)
    n = whole(words[0] if words else b"", "the number of solutions")
    n_fields = whole(words[1] if len(words) > 1 else b"", "the number of fields")
    rest = words[2] if len(words) > 2 else b""
    kind = whole(rest.split(maxsplit=1)[0] if rest.strip() else b"", "the type of the solution")
    if n_fields != 1 or kind != 1:
        what = (
            {2: "a vector", 3: "a metric tensor"}.get(kind, f"type {kind}") if n_fields == 1 else f"{n_fields} fields"
        )
        raise InputError(
            f"it holds {what}; only isotropic sizes, one number a vertex, are supported (anisotropic are not)"
        )
    if n != n_vertices:
        raise InputError(f"it holds {n} sizes for a mesh of {n_vertices} vertices; give the .sol of this mesh")
    sizes: NDArray[np.float64] = numbers(rest.split(maxsplit=1)[1] if n else b"", "sizes", n)
    return sizes


def written_mesh(raw: RawMesh) -> Iterator[bytes]:
    """Yield the parts of a plane .mesh file; coordinates are written to the last bit."""
    yield b"MeshVersionFormatted 2\nDimension 2\n\nVertices\n%d\n" % len(raw.points)
    for start in range(0, len(raw.points), _CHUNK):
        yield "".join(f"{x!r} {y!r} 0\n" for x, y in raw.points[start : start + _CHUNK, :2].tolist()).encode()
    for block in raw.cells:
        yield f"\n{_NAMES[block.kind]}\n{len(block.rows)}\n".encode()
        for start in range(0, len(block.rows), _CHUNK):
            rows = (block.rows[start : start + _CHUNK] + 1).tolist()
            yield "".join(" ".join(map(str, row)) + " 0\n" for row in rows).encode()
    yield b"\nEnd\n"


def written_solution(sizes: NDArray[np.float64]) -> Iterator[bytes]:
    """Yield the parts of a .sol file of isotropic sizes; numbers are written to the last bit."""
    yield b"MeshVersionFormatted 2\nDimension 2\n\nSolAtVertices\n%d\n1 1\n" % len(sizes)
    for start in range(0, len(sizes), _CHUNK):
        yield "".join(f"{h!r}\n" for h in sizes[start : start + _CHUNK].tolist()).encode()
    yield b"\nEnd\n"


def _sections(data: bytes) -> Iterator[tuple[str, bytes]]:
    """Yield each keyword with the numbers that follow it."""
    if b"\0" in data:
        raise InputError("it is a binary file (.meshb or .solb); convert it to ASCII")
    if b"#" in data:
        data = _COMMENT.sub(b"", data)
    before, start = None, 0
    for match in _KEYWORD.finditer(data):
        if before is not None:
            yield before, data[start : match.start()]
        before, start = match.group()[:80].decode("latin-1"), match.end()
        if before == "End":
            return
    if before is None:
        raise InputError("it holds no keyword such as Vertices; give an ASCII Medit file")
    yield before, data[start:]


def _dimension(found: dict[str, bytes]) -> int:
    if "MeshVersionFormatted" not in found:
        raise InputError("it does not begin with MeshVersionFormatted; give an ASCII Medit file")
    words = found.get("Dimension", b"").split()
    if words not in ([b"2"], [b"3"]):
        raise InputError(f"its Dimension is {one_line(words[:3], 60)}; 2 or 3 was expected")
    return int(words[0])


def _table(body: bytes, width: int, name: str) -> NDArray[Any]:
    """Return the rows that follow a keyword: first their number, then the values."""
    head = body.split(maxsplit=1)
    n = whole(head[0] if head else b"", f"the number of {name}")
    check_nodes(n, name, 2**31)
    values: NDArray[Any] = numbers(head[1] if len(head) > 1 else b"", name, n * width)
    return values.reshape(n, width)
