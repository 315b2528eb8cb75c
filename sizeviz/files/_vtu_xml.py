"""The XML of VTK's unstructured grids: arrays in, arrays out, in every encoding that VTK writes."""

from __future__ import annotations

import base64
import binascii
import re
import zlib
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

TYPES: dict[str, str] = {
    "Int8": "i1",
    "UInt8": "u1",
    "Int16": "i2",
    "UInt16": "u2",
    "Int32": "i4",
    "UInt32": "u4",
    "Int64": "i8",
    "UInt64": "u8",
    "Float32": "f4",
    "Float64": "f8",
}
"""VTK's names of number types, and numpy's."""

_NAMES = {code: name for name, code in TYPES.items()}
_APPENDED = re.compile(rb"<AppendedData\s+encoding\s*=\s*[\"'](raw|base64)[\"']\s*>\s*_", re.IGNORECASE)


def encoded(array: NDArray[np.generic], name: str, components: int = 1) -> str:
    """Return a ``DataArray`` element, in base64 after an 8-byte length."""
    little = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
    raw = little.tobytes()
    text = base64.b64encode(len(raw).to_bytes(8, "little") + raw).decode("ascii")
    kind = _NAMES[little.dtype.str[1:]]
    # Readers such as meshio take a declared single component for a column, so it is left out.
    shape = f' NumberOfComponents="{components}"' if components > 1 else ""
    return f'<DataArray type="{kind}" Name="{name}"{shape} format="binary">{text}</DataArray>\n'


class Document:
    """A parsed file: hands out the arrays of its one piece.

    Raises
    ------
    InputError
        If it is not an unstructured grid, or is torn.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        content = path.read_bytes()
        self._appended, self._raw = b"", False
        found = _APPENDED.search(content)
        if found:
            stop = content.rfind(b"</AppendedData")
            self._appended, self._raw = content[found.end() : stop], found.group(1).lower() == b"raw"
            content = content[: found.start()] + b"</VTKFile>"
        if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
            raise InputError(f"{path}: declares XML entities, which no VTK file needs; write it again with VTK")
        try:
            root = ElementTree.fromstring(content)
        except ElementTree.ParseError as problem:
            raise self.corrupt(str(problem)) from problem
        pieces = root.findall("./UnstructuredGrid/Piece")
        if root.get("type") != "UnstructuredGrid" or len(pieces) != 1:
            raise InputError(f"{path}: is not an unstructured grid of one piece; write it again as .vtu")
        self.piece = pieces[0]
        self._order = ">" if root.get("byte_order") == "BigEndian" else "<"
        self._header = np.dtype(self._order + TYPES.get(root.get("header_type", "UInt32"), "u4"))
        compressor = root.get("compressor")
        if compressor not in (None, "vtkZLibDataCompressor"):
            raise InputError(f"{path}: is compressed by {compressor}; write it again with zlib or uncompressed")
        self._compressed = compressor is not None

    def corrupt(self, why: str) -> InputError:
        """Return the error of a file that cannot be understood."""
        return InputError(f"{self.path}: is corrupt ({why}); write it again")

    def section(self, name: str) -> dict[str, NDArray[np.generic]]:
        """Return the arrays of a section such as ``PointData`` by name, vectors as rows."""
        section = self.piece.find(name)
        if section is None:
            return {}
        return {element.get("Name") or name: self._array(element) for element in section.findall("DataArray")}

    def _array(self, element: ElementTree.Element) -> NDArray[np.generic]:
        kind = element.get("type", "")
        if kind not in TYPES:
            raise self.corrupt(f"an array of type {kind!r}")
        try:
            components = int(element.get("NumberOfComponents") or 1)
            flat = self._values(element, np.dtype(self._order + TYPES[kind]))
            return flat.reshape(-1, components) if components > 1 else flat
        except (ValueError, TypeError, IndexError, zlib.error, binascii.Error, OverflowError, MemoryError) as problem:
            raise self.corrupt(f"array {element.get('Name')!r}: {problem}") from problem

    def _values(self, element: ElementTree.Element, dtype: np.dtype[np.generic]) -> NDArray[np.generic]:
        encoding = element.get("format", "ascii")
        if encoding == "ascii":
            return np.array((element.text or "").split(), dtype=dtype)
        if encoding == "binary":
            return np.frombuffer(self._decoded((element.text or "").strip().encode(), raw=False), dtype)
        if encoding == "appended":
            return np.frombuffer(self._decoded(self._appended[int(element.get("offset", "")) :], self._raw), dtype)
        raise ValueError(f"unknown format {encoding!r}")

    def _decoded(self, data: bytes, raw: bool) -> bytes:
        """Return the bytes of one array that begins ``data``; what follows it belongs to others."""
        width = self._header.itemsize
        if not self._compressed:
            length = self._numbers(data, 1, raw)[0]
            return _take(data, width + length, raw)[width:]
        blocks = self._numbers(data, 1, raw)[0]
        head = self._numbers(data, 3 + blocks, raw)
        sizes, most = head[3:], head[1]
        whole = (3 + blocks) * width
        # The header is encoded by itself in base64, padding included.
        start = whole if raw else 4 * -(-whole // 3)
        body = _take(data[start:], sum(sizes), raw)
        parts, at = [], 0
        for size in sizes:
            parts.append(zlib.decompressobj().decompress(body[at : at + size], most))
            at += size
        return b"".join(parts)

    def _numbers(self, data: bytes, count: int, raw: bool) -> list[int]:
        taken = _take(data, count * self._header.itemsize, raw)
        return [int(value) for value in np.frombuffer(taken, self._header, count)]


def _take(data: bytes, count: int, raw: bool) -> bytes:
    """Return the first ``count`` bytes that ``data`` stands for."""
    if count > len(data):
        raise ValueError(f"{count} bytes are announced, {len(data)} are there")
    taken = data[:count] if raw else base64.b64decode(data[: 4 * -(-count // 3)])[:count]
    if len(taken) != count:
        raise ValueError(f"{count} bytes are announced, {len(taken)} are there")
    return taken
