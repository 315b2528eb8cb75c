"""Gmsh meshes, ``.msh``: version 4.1 in ASCII and binary and 2.2 in ASCII in; 4.1 binary out, every bit kept.

Format: Gmsh reference manual, "MSH file format", https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import check_available, check_nodes, one_line
from sizeviz.files.raw import Cells, RawMesh
from sizeviz.files.text import numbers, whole

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

_KINDS: dict[int, tuple[str, int]] = {
    1: ("line", 2),
    2: ("triangle", 3),
    3: ("quad", 4),
    4: ("tetra", 4),
    5: ("hexahedron", 8),
    6: ("wedge", 6),
    7: ("pyramid", 5),
    8: ("line3", 3),
    9: ("triangle6", 6),
    10: ("quad9", 9),
    11: ("tetra10", 10),
    15: ("vertex", 1),
    16: ("quad8", 8),
}
"""Gmsh's numbers of the element types, and how many nodes each has."""

_CODES = {name: code for code, (name, _) in _KINDS.items()}
_SURFACE = 1
"""The number of the one surface that a written mesh belongs to."""


class _Stream:
    """The numbers of a section, one after the other, whether written out or binary."""

    def __init__(self, body: bytes, order: str, what: str) -> None:
        self.order, self.what, self.at = order, what, 0
        self.body = body
        self.flat: NDArray[np.float64] | None = None if order else numbers(body, what)

    def take(self, count: int, code: str) -> NDArray[Any]:
        """Return the next ``count`` numbers (-1: all that are left): ``i4``, ``u8`` or ``f8`` where they are binary."""
        if count < -1:
            raise InputError(f"{self.what} announce {count} numbers; the file is corrupt")
        if self.flat is not None:
            count = len(self.flat) - self.at if count == -1 else count
            check_available(count, len(self.flat) - self.at, self.what)
            found = self.flat[self.at : self.at + count]
            self.at += count
            return found if code == "f8" else _as_whole(found, self.what)
        dtype = np.dtype(self.order + code)
        count = (len(self.body) - self.at) // dtype.itemsize if count == -1 else count
        check_available(count * dtype.itemsize, len(self.body) - self.at, self.what)
        found = np.frombuffer(self.body, dtype, count, self.at)
        self.at += count * dtype.itemsize
        return found.astype(np.float64 if code == "f8" else np.int64)


@dataclass(frozen=True, eq=False)
class _Elements:
    """Elements of one type as they stand in the file."""

    code: int
    tags: NDArray[np.int64]
    nodes: NDArray[np.int64]


def parse(data: bytes) -> RawMesh:
    """Return the mesh in a .msh file, with its node and element data.

    Raises
    ------
    InputError
        If the file is corrupt, or of another version.
    """
    sections = dict(_sections(data))
    if b"MeshFormat" not in sections:
        raise InputError("it holds no $MeshFormat; give a Gmsh mesh file")
    version, order = _format(sections[b"MeshFormat"][0])
    for name in (b"Nodes", b"Elements"):
        if name not in sections:
            raise InputError(f"it holds no ${name.decode()}; the file is cut or corrupt")
    is_old = version == "2.2"
    node_stream = _Stream(sections[b"Nodes"][0], order, "$Nodes")
    element_stream = _Stream(sections[b"Elements"][0], order, "$Elements")
    tags, points = _old_nodes(node_stream) if is_old else _nodes(node_stream)
    blocks = _old_elements(element_stream) if is_old else _elements(element_stream)
    place = _Places(tags, "node")
    element_tags = np.concatenate([block.tags for block in blocks]) if blocks else np.empty(0, dtype=np.int64)
    node_data = dict(_data(body, order, place, "$NodeData") for body in sections.get(b"NodeData", []))
    element_place = _Places(element_tags, "element")
    element_data = dict(_data(body, order, element_place, "$ElementData") for body in sections.get(b"ElementData", []))
    return RawMesh(points, tuple(_cells(blocks, place)), node_data, element_data)


def written(raw: RawMesh) -> list[bytes]:
    """Return the parts of a binary .msh file of version 4.1."""
    n_points = len(raw.points)
    n_cells = sum(len(block.rows) for block in raw.cells)
    parts = [
        b"$MeshFormat\n4.1 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n$Nodes\n",
        struct.pack("<4Q3iQ", 1, n_points, 1, n_points, 2, _SURFACE, 0, n_points),
        np.arange(1, n_points + 1, dtype="<u8").tobytes(),
        raw.points.astype("<f8").tobytes(),
        b"\n$EndNodes\n$Elements\n",
        struct.pack("<4Q", len(raw.cells), n_cells, 1, n_cells),
    ]
    first = 1
    for block in raw.cells:
        rows = np.column_stack([np.arange(first, first + len(block.rows)), block.rows + 1]).astype("<u8")
        parts += [struct.pack("<3iQ", 2, _SURFACE, _CODES[block.kind], len(block.rows)), rows.tobytes()]
        first += len(block.rows)
    parts.append(b"\n$EndElements\n")
    parts += [_written_data("NodeData", name, values) for name, values in raw.point_data.items()]
    parts += [_written_data("ElementData", name, values) for name, values in raw.cell_data.items()]
    return parts


def _sections(data: bytes) -> Iterator[tuple[bytes, list[bytes]]]:
    """Yield each section's name and the bodies of all sections of that name."""
    found: dict[bytes, list[bytes]] = {}
    at = 0
    while (start := data.find(b"$", at)) >= 0:
        stop = data.find(b"\n", start)
        name = data[start + 1 : stop].strip()
        end = data.find(b"$End" + name, stop) if stop >= 0 and name.isalnum() else -1
        if end < 0:
            raise InputError(f"its section ${one_line(name.decode('latin-1'), 40)} does not end; the file is cut")
        found.setdefault(name, []).append(data[stop + 1 : end])
        at = end + len(name) + 4
    yield from found.items()


def _format(body: bytes) -> tuple[str, str]:
    """Return the version, and the byte order of binary numbers ('' where they are written out)."""
    line, _, rest = body.partition(b"\n")
    words = line.decode("latin-1").split()
    if len(words) != 3:
        raise InputError("its $MeshFormat is corrupt; save it again from Gmsh")
    version, is_binary, width = words
    if version not in ("4.1", "2.2") or (version == "2.2" and is_binary != "0"):
        found = f"{'binary ' if is_binary != '0' else ''}version {one_line(version, 20)}"
        raise InputError(f"it is of {found}; 4.1 and ASCII 2.2 are supported: save with Mesh.MshFileVersion=4.1")
    if is_binary == "0":
        return version, ""
    if width != "8" or rest[:4] not in (b"\1\0\0\0", b"\0\0\0\1"):
        raise InputError("its binary numbers have an unknown layout; save it again from Gmsh in ASCII")
    return version, "<" if rest[0] else ">"


def _nodes(stream: _Stream) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    n_blocks, n_nodes, _, _ = stream.take(4, "u8").tolist()
    check_nodes(n_nodes)
    tags, points = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))]
    for _ in _counted(n_blocks, stream):
        dimension, _, is_parametric = stream.take(3, "i4").tolist()
        n = int(stream.take(1, "u8")[0])
        check_nodes(n)
        tags.append(stream.take(n, "u8"))
        width = 3 + (min(max(dimension, 0), 3) if is_parametric else 0)
        points.append(stream.take(n * width, "f8").reshape(n, width)[:, :3])
    return np.concatenate(tags), np.ascontiguousarray(np.concatenate(points))


def _elements(stream: _Stream) -> list[_Elements]:
    n_blocks, n_elements, _, _ = stream.take(4, "u8").tolist()
    check_nodes(n_elements, "elements", 2**31)
    blocks = []
    for _ in _counted(n_blocks, stream):
        _, _, code = stream.take(3, "i4").tolist()
        n = int(stream.take(1, "u8")[0])
        check_nodes(n, "elements", 2**31)
        width = _width(code)
        rows = stream.take(n * (1 + width), "u8").reshape(n, 1 + width)
        blocks.append(_Elements(code, rows[:, 0], rows[:, 1:]))
    return blocks


def _old_nodes(stream: _Stream) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    n = int(stream.take(1, "u8")[0])
    check_nodes(n)
    rows = stream.take(4 * n, "f8").reshape(n, 4)
    return _as_whole(rows[:, 0], "node numbers"), np.ascontiguousarray(rows[:, 1:])


def _old_elements(stream: _Stream) -> list[_Elements]:
    """Return the elements of version 2.2, where each line has as many words as it likes."""
    n = int(stream.take(1, "u8")[0])
    check_available(3 * n, len(stream.body), stream.what)
    words = stream.take(-1, "u8").tolist()
    rows: dict[int, list[list[int]]] = {}
    at = 0
    for _ in range(n):
        tag, code, n_tags = words[at : at + 3]
        stop = at + 3 + n_tags + _width(code)
        if n_tags < 0 or stop > len(words):
            raise InputError("an element is cut short; the file is corrupt")
        rows.setdefault(code, []).append([tag, *words[at + 3 + n_tags : stop]])
        at = stop
    found = {code: np.array(listed, dtype=np.int64) for code, listed in rows.items()}
    return [_Elements(code, table[:, 0], table[:, 1:]) for code, table in found.items()]


def _counted(n: int, stream: _Stream) -> range:
    """Return the range of ``n`` things, each of which takes at least one number of the stream."""
    check_available(n, len(stream.body), f"blocks of {stream.what}")
    return range(n)


def _width(code: int) -> int:
    if code not in _KINDS:
        raise InputError(
            f"it holds elements of Gmsh's type {code}; plane linear triangles and quadrangles are supported"
        )
    return _KINDS[code][1]


class _Places:
    """Where a numbered thing stands in its array."""

    def __init__(self, tags: NDArray[np.int64], what: str) -> None:
        self.what, self.count = what, len(tags)
        self._order = np.argsort(tags, kind="stable")
        self._sorted = tags[self._order]
        if (np.diff(self._sorted) == 0).any():
            raise InputError(f"two {what}s have the same number; the file is corrupt")

    def of(self, tags: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the place of each number."""
        if self.count == 0 and tags.size:
            raise InputError(f"it names {self.what}s but holds none; the file is corrupt")
        at = np.minimum(np.searchsorted(self._sorted, tags), max(self.count - 1, 0))
        if tags.size and (self._sorted[at] != tags).any():
            missing = int(tags[self._sorted[at] != tags][0])
            raise InputError(f"{self.what} {missing} does not exist; the file is corrupt")
        places: NDArray[np.int64] = self._order[at]
        return places


def _cells(blocks: list[_Elements], place: _Places) -> Iterator[Cells]:
    start = 0
    joined: dict[int, list[Cells]] = {}
    for block in blocks:
        index = np.arange(start, start + len(block.tags))
        start += len(block.tags)
        joined.setdefault(block.code, []).append(Cells(_KINDS[block.code][0], place.of(block.nodes), index))
    for parts in joined.values():
        rows, index = np.concatenate([p.rows for p in parts]), np.concatenate([p.index for p in parts])
        yield Cells(parts[0].kind, rows, index)


def _data(body: bytes, order: str, place: _Places, what: str) -> tuple[str, NDArray[np.float64]]:
    """Return the name and the values of a data section, NaN where a node has none."""
    lines = _Lines(body)
    texts = [lines.text() for _ in range(lines.count(what))]
    for _ in range(lines.count(what)):
        lines.text()
    whole_tags = [whole(lines.text(), what) for _ in range(lines.count(what))]
    if len(whole_tags) < 3:
        raise InputError(f"{what} lacks its number of components; the file is corrupt")
    width, n = whole_tags[1], whole_tags[2]
    check_nodes(width, "components", 9)
    stream = _Stream(lines.rest(), order, what)
    check_available(n, len(stream.body), what)
    if order:
        dtype = np.dtype([("tag", order + "i4"), ("values", order + "f8", (width,))])
        check_available(n * dtype.itemsize, len(stream.body), what)
        rows = np.frombuffer(stream.body, dtype, n)
        tags, found = rows["tag"].astype(np.int64), rows["values"].astype(np.float64)
    else:
        table = stream.take(n * (1 + width), "f8").reshape(n, 1 + width)
        tags, found = _as_whole(table[:, 0], what), table[:, 1:]
    values = np.full((place.count, width), np.nan)
    values[place.of(tags)] = found
    name = (texts[0].strip().strip(b'"') if texts else b"").decode("utf-8", "replace") or "unnamed"
    return name, values[:, 0] if width == 1 else values


class _Lines:
    """The head of a data section, line by line."""

    def __init__(self, body: bytes) -> None:
        self._body, self._at = body, 0

    def text(self) -> bytes:
        stop = self._body.find(b"\n", self._at)
        if stop < 0:
            raise InputError("a data section is cut short; the file is corrupt")
        line = self._body[self._at : min(stop, self._at + 4096)]
        self._at = stop + 1
        return line

    def count(self, what: str) -> int:
        number = whole(self.text(), f"a number of tags of {what}")
        check_nodes(number, "tags", 1000)
        return number

    def rest(self) -> bytes:
        return self._body[self._at :]


def _written_data(section: str, name: str, values: NDArray[Any]) -> bytes:
    table = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
    width = table.shape[1]
    rows = np.empty(len(table), dtype=[("tag", "<i4"), ("values", "<f8", (width,))])
    rows["tag"], rows["values"] = np.arange(1, len(table) + 1), table
    label = one_line(name).replace('"', "'")
    head = f'${section}\n1\n"{label}"\n1\n0\n3\n0\n{width}\n{len(table)}\n'
    return head.encode() + rows.tobytes() + f"\n$End{section}\n".encode()


def _as_whole(values: NDArray[np.float64], what: str) -> NDArray[np.int64]:
    if values.size and not (np.isfinite(values).all() and np.abs(values).max() < 2**53):
        raise InputError(f"{what} hold a number that cannot count anything; the file is corrupt")
    return values.astype(np.int64)
