"""VTK's legacy files, ``.vtk``: versions 1 to 5.1, ASCII and binary, in; binary out, every bit kept.

Format: https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any
from urllib.parse import quote, unquote

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import check_available, check_nodes, one_line
from sizeviz.files.raw import Cells, RawGrid, RawMesh, grouped
from sizeviz.files.text import numbers, whole
from sizeviz.files.vtk_xml import VTK_CELLS

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TYPES = {
    "unsigned_char": "u1",
    "char": "i1",
    "unsigned_short": "u2",
    "short": "i2",
    "unsigned_int": "u4",
    "int": "i4",
    "unsigned_long": "u8",
    "long": "i8",
    "vtkidtype": "i8",
    "vtktypeint64": "i8",
    "vtktypeuint64": "u8",
    "float": "f4",
    "double": "f8",
}
_LISTS = {"VERTICES": 2, "LINES": 4, "POLYGONS": 7, "TRIANGLE_STRIPS": 6}
_WIDTHS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6}
_NAMES = {code: name for name, code in _TYPES.items() if not name.startswith("vtk")}


class _Cursor:
    """A place in the file that moves on as lines and arrays are taken."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0
        self.is_binary = False
        self._ends: NDArray[np.int64] | None = None

    def line(self) -> list[str]:
        """Return the words of the next line that is not blank; none at the end."""
        while self.at < len(self.data):
            stop = self.data.find(b"\n", self.at)
            stop = len(self.data) if stop < 0 else stop
            words = self.data[self.at : min(stop, self.at + 4096)].decode("latin-1").split()
            self.at = stop + 1
            if words:
                return words
        return []

    def peeked(self) -> list[str]:
        """Return the words of the next line without taking it."""
        at, words = self.at, self.line()
        self.at = at
        return words

    def skip_metadata(self) -> None:
        """Go to the blank line that ends a METADATA block."""
        found = re.compile(rb"\n[ \t\r]*\n").search(self.data, self.at - 1)
        self.at = found.end() if found else len(self.data)

    def values(self, count: int, kind: str, what: str) -> NDArray[Any]:
        """Return the next ``count`` numbers of a VTK type."""
        if kind.lower() not in _TYPES:
            raise InputError(f"{what} are of type {one_line(kind, 40)!r}, which is not read; export the file again")
        dtype = np.dtype(_TYPES[kind.lower()])
        if not self.is_binary:
            return self._written_out(count, what, dtype)
        check_available(count * dtype.itemsize, len(self.data) - self.at, what)
        found = np.frombuffer(self.data, dtype.newbyteorder(">"), count, self.at).astype(dtype)
        self.at += count * dtype.itemsize
        return found

    def _written_out(self, count: int, what: str, dtype: np.dtype[Any]) -> NDArray[Any]:
        if count == 0:
            return np.empty(0, dtype)
        if self._ends is None:
            is_blank = np.frombuffer(self.data + b" ", dtype=np.uint8) <= 32
            self._ends = np.flatnonzero(is_blank[1:] & ~is_blank[:-1]) + 1
        last = int(np.searchsorted(self._ends, self.at, side="right")) + count - 1
        if count < 0 or last >= len(self._ends):
            raise InputError(f"{what}: {count} numbers are announced, but the file ends first; it is cut or corrupt")
        start, self.at = self.at, int(self._ends[last])
        text = self.data[start : self.at]
        return numbers(text, what, count, np.float64 if dtype.kind == "f" else np.int64).astype(dtype)


class _Legacy:
    """What was read so far."""

    def __init__(self, cursor: _Cursor) -> None:
        self.cursor = cursor
        self.points: NDArray[np.float64] | None = None
        self.shape: tuple[int, int, int] | None = None
        self.origin, self.spacing = np.zeros(3), np.ones(3)
        self.lists: list[tuple[NDArray[np.int64], NDArray[np.int64], int]] = []
        self.kinds: NDArray[np.int64] | None = None
        self.arrays: dict[str, dict[str, NDArray[Any]]] = {"POINT_DATA": {}, "CELL_DATA": {}, "": {}}
        self.target, self.count = "", 0

    def take(self, words: list[str]) -> None:
        """Read what a keyword line announces."""
        word = words[0].upper()
        if word in ("POINT_DATA", "CELL_DATA"):
            self.target, self.count = word, _count(words, 1)
        elif word == "POINTS":
            n = _count(words, 1)
            self.points = self.cursor.values(3 * n, _word(words, 2), "points").astype(np.float64).reshape(-1, 3)
        elif word == "DIMENSIONS":
            self.shape = (_count(words, 1), _count(words, 2), _count(words, 3))
        elif word in ("ORIGIN", "SPACING", "ASPECT_RATIO"):
            values = numbers(" ".join(words[1:]).encode(), word, 3)
            self.origin, self.spacing = (values, self.spacing) if word == "ORIGIN" else (self.origin, values)
        elif word == "CELLS" or word in _LISTS:
            self.lists.append((*self._corner_list(words), _LISTS.get(word, 0)))
        elif word == "CELL_TYPES":
            self.kinds = self.cursor.values(_count(words, 1), "int", "cell types").astype(np.int64)
        elif word == "METADATA":
            self.cursor.skip_metadata()
        else:
            self._take_array(word, words)

    def _corner_list(self, words: list[str]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return joined corners and starts, of the old layout or that of version 5.1."""
        n, size = _count(words, 1), _count(words, 2)
        following = self.cursor.peeked()
        if following and following[0].upper() == "OFFSETS":
            self.cursor.line()
            starts = self.cursor.values(n, _word(following, 1), "offsets").astype(np.int64)
            header = self.cursor.line()
            if not header or header[0].upper() != "CONNECTIVITY":
                raise InputError("offsets without connectivity; the file is cut or corrupt")
            return self.cursor.values(size, _word(header, 1), "connectivity").astype(np.int64), starts
        flat = self.cursor.values(size, "int", "cells").astype(np.int64)
        return _without_counts(flat, n)

    def _take_array(self, word: str, words: list[str]) -> None:
        if word == "SCALARS":
            width = whole(words[3], "components") if len(words) > 3 else 1
            following = self.cursor.peeked()
            if following and following[0].upper() == "LOOKUP_TABLE":
                self.cursor.line()
            self._store(_word(words, 1), width, self.count, _word(words, 2))
        elif word in _WIDTHS:
            self._store(_word(words, 1), _WIDTHS[word], self.count, _word(words, 2))
        elif word == "TEXTURE_COORDINATES":
            self._store(_word(words, 1), _count(words, 2), self.count, _word(words, 3))
        elif word == "COLOR_SCALARS":
            kind = "unsigned_char" if self.cursor.is_binary else "float"
            self._store(_word(words, 1), _count(words, 2), self.count, kind)
        elif word == "LOOKUP_TABLE":
            kind = "unsigned_char" if self.cursor.is_binary else "float"
            self.cursor.values(4 * _count(words, 2), kind, "lookup table")
        elif word == "FIELD":
            for _ in range(_count(words, 2)):
                head = self.cursor.line()
                if head and head[0].upper() == "METADATA":
                    self.cursor.skip_metadata()
                    head = self.cursor.line()
                self._store(_word(head, 0), _count(head, 1), _count(head, 2), _word(head, 3))
        else:
            raise InputError(f"{one_line(words[0], 40)!r} is no keyword of a VTK file; it is corrupt")

    def _store(self, name: str, width: int, count: int, kind: str) -> None:
        values = self.cursor.values(width * count, kind, f"array {one_line(name, 40)!r}")
        self.arrays[self.target][unquote(name)] = values.reshape(count, width) if width != 1 else values


def parse(data: bytes) -> RawMesh | RawGrid:
    """Return what a .vtk file holds: a mesh, a surface, or a grid of points.

    Raises
    ------
    InputError
        If the file is corrupt, or its data set is curvilinear.
    """
    cursor = _Cursor(data)
    if not data.startswith(b"# vtk DataFile"):
        raise InputError("it does not begin with '# vtk DataFile'; give a legacy VTK file")
    cursor.at = data.find(b"\n", max(data.find(b"\n"), 0) + 1) + 1
    mode = cursor.line()
    if not mode or mode[0].upper() not in ("ASCII", "BINARY"):
        raise InputError("its third line is neither ASCII nor BINARY; the file is corrupt")
    cursor.is_binary = mode[0].upper() == "BINARY"
    found = _Legacy(cursor)
    kind = ""
    while words := cursor.line():
        if words[0].upper() == "DATASET":
            kind = _word(words, 1).upper()
            if kind not in ("UNSTRUCTURED_GRID", "POLYDATA", "STRUCTURED_POINTS"):
                supported = "UNSTRUCTURED_GRID, POLYDATA and STRUCTURED_POINTS are supported"
                raise InputError(f"its data set is {one_line(kind, 40)}; {supported}")
        else:
            found.take(words)
    return _grid(found) if kind == "STRUCTURED_POINTS" else _mesh(found)


def written(raw: RawMesh) -> list[bytes]:
    """Return the parts of a binary .vtk file of version 4.2, which every reader knows."""
    n_cells = sum(len(block.rows) for block in raw.cells)
    size = sum(block.rows.size + len(block.rows) for block in raw.cells)
    codes = {name: code for code, name in VTK_CELLS.items()}
    counted = [
        np.column_stack([np.full(len(block.rows), block.rows.shape[1]), block.rows]).astype(">i4")
        for block in raw.cells
    ]
    kinds = [np.full(len(block.rows), codes[block.kind], dtype=">i4") for block in raw.cells]
    parts = [
        b"# vtk DataFile Version 4.2\nwritten by sizeviz\nBINARY\nDATASET UNSTRUCTURED_GRID\n",
        *_field("FieldData", raw.field_data),
        f"POINTS {len(raw.points)} double\n".encode(),
        raw.points.astype(">f8").tobytes(),
        f"\nCELLS {n_cells} {size}\n".encode(),
        *(rows.tobytes() for rows in counted),
        f"\nCELL_TYPES {n_cells}\n".encode(),
        *(rows.tobytes() for rows in kinds),
    ]
    for section, count, arrays in (
        ("POINT_DATA", len(raw.points), raw.point_data),
        ("CELL_DATA", n_cells, raw.cell_data),
    ):
        if arrays:
            parts += [f"\n{section} {count}\n".encode(), *_field("FieldData", arrays)]
    return parts


def _field(name: str, arrays: Any) -> list[bytes]:
    if not arrays:
        return []
    parts = [f"FIELD {name} {len(arrays)}\n".encode()]
    for label, given in arrays.items():
        values = np.asarray(given)
        width = 1 if values.ndim == 1 else values.shape[1]
        kind = _NAMES[values.dtype.str[1:]]
        head = f"{quote(label, safe='')} {width} {len(values)} {kind}\n"
        parts += [head.encode(), np.ascontiguousarray(values, values.dtype.newbyteorder(">")).tobytes(), b"\n"]
    return parts


def _mesh(found: _Legacy) -> RawMesh:
    if found.points is None:
        raise InputError("it holds no POINTS; the file is cut or corrupt")
    cells: list[Cells] = []
    count = 0
    for joined, starts, code in found.lists:
        kinds = np.full(len(starts) - 1, code) if code else found.kinds
        if kinds is None:
            raise InputError("its cells have no CELL_TYPES; the file is cut or corrupt")
        groups = grouped(joined, starts, kinds, VTK_CELLS)
        cells += [Cells(group.kind, group.rows, group.index + count) for group in groups]
        count += len(starts) - 1
    return RawMesh(found.points, tuple(cells), found.arrays["POINT_DATA"], found.arrays["CELL_DATA"], found.arrays[""])


def _grid(found: _Legacy) -> RawGrid:
    if found.shape is None:
        raise InputError("its grid has no DIMENSIONS; the file is cut or corrupt")
    return RawGrid(found.shape, found.origin, found.spacing, found.arrays["POINT_DATA"], found.arrays["CELL_DATA"])


def _without_counts(flat: NDArray[np.int64], n: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Turn the old layout, each cell after the number of its corners, into joined corners and starts."""
    if n == 0:
        return flat[:0], np.zeros(1, dtype=np.int64)
    width = int(flat[0]) + 1 if len(flat) else 0
    if width > 0 and len(flat) == n * width and (flat[::width] == width - 1).all():
        return flat.reshape(n, width)[:, 1:].ravel(), np.arange(n + 1) * (width - 1)
    if n > len(flat):
        raise InputError(f"it announces {n} cells in {len(flat)} numbers; the file is corrupt")
    heads = np.empty(n, dtype=np.int64)
    at = 0
    for k, _ in enumerate(heads):
        if not (0 <= at < len(flat) and flat[at] >= 0):
            raise InputError("its list of cells is shorter than announced; the file is corrupt")
        heads[k] = at
        at += int(flat[at]) + 1
    is_corner = np.ones(len(flat), dtype=bool)
    is_corner[heads] = False
    return flat[is_corner], np.concatenate([[0], np.cumsum(flat[heads])])


def _word(words: list[str], place: int) -> str:
    if place >= len(words):
        raise InputError(f"the line {one_line(' '.join(words), 60)!r} is cut short; the file is corrupt")
    return words[place]


def _count(words: list[str], place: int) -> int:
    count = whole(_word(words, place), f"a number after {one_line(words[0], 40)}")
    check_nodes(count, "values", 2**31)
    return count
