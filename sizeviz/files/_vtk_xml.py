"""VTK's XML files: the tree, and its arrays in every encoding that VTK writes.

Format: VTK file formats, https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

import base64
import lzma
import re
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import MAX_BYTES, check_available, inflated, one_line
from sizeviz.files.text import numbers, whole

if TYPE_CHECKING:
    from collections.abc import Iterable

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
_MAX_COMPONENTS = 1000
_COMPRESSORS = (None, "vtkZLibDataCompressor", "vtkLZMADataCompressor")


def parsed_xml(data: bytes) -> ElementTree.Element:
    """Return the root of an XML text that declares no entities of its own.

    Raises
    ------
    InputError
        If it is not well-formed, or has a document type, through which small files can grow without bound.
    """
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data or b"<!D" in data[:200].replace(b"\0", b""):
        raise InputError("it declares a document type or entities, which are not read; remove that declaration")
    try:
        return ElementTree.fromstring(data)
    except ElementTree.ParseError as error:
        raise InputError(f"its XML is not well-formed ({one_line(error)}); check or export it again") from None


def data_array(array: NDArray[Any], name: str) -> bytes:
    """Return a ``DataArray`` element, in base64 after an 8-byte length; rows of an ``(N, k)`` array are vectors."""
    little = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
    raw = little.tobytes()
    width = f'NumberOfComponents="{int(np.prod(array.shape[1:]))}" ' if array.ndim > 1 else ""
    head = f'<DataArray type="{_NAMES[little.dtype.str[1:]]}" Name="{escaped(name)}" {width}format="binary">'
    return head.encode() + base64.b64encode(len(raw).to_bytes(8, "little") + raw) + b"</DataArray>\n"


def escaped(text: str) -> str:
    """Return the text as an XML attribute may hold it."""
    for plain, code in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;")):
        text = text.replace(plain, code)
    return one_line(text)


class Document:
    """A parsed file, which decodes its arrays when asked.

    Parameters
    ----------
    data : bytes
        The whole file.

    Raises
    ------
    InputError
        If it is not a VTK XML file, or uses a compressor that is not read.
    """

    def __init__(self, data: bytes) -> None:
        self._appended, self._is_raw = b"", False
        found = _APPENDED.search(data)
        if found:
            stop = data.rfind(b"</AppendedData")
            self._appended, self._is_raw = data[found.end() : stop], found.group(1).lower() == b"raw"
            data = data[: found.start()] + b"</VTKFile>"
        root = parsed_xml(data)
        if root.tag != "VTKFile":
            raise InputError(f"its root is {one_line(root.tag, 40)!r}, not VTKFile; export it again from VTK")
        self.kind = root.get("type", "")
        self.body = root.find(self.kind) if self.kind.isalnum() else None
        if self.body is None:
            raise InputError(f"it holds no {one_line(self.kind, 40) or 'data set'}; the file is cut or corrupt")
        self._order = ">" if root.get("byte_order") == "BigEndian" else "<"
        width = root.get("header_type", "UInt32")
        if width not in ("UInt32", "UInt64"):
            raise InputError(f"its header type is {one_line(width, 40)!r}; UInt32 and UInt64 are supported")
        self._header = np.dtype(self._order + TYPES[width])
        self._compressor = root.get("compressor")
        if self._compressor not in _COMPRESSORS:
            raise InputError(f"it is compressed by {one_line(self._compressor, 40)}; save it again with zlib")
        self._budget = MAX_BYTES

    def sole_piece(self) -> ElementTree.Element:
        """Return the one piece of the data set.

        Raises
        ------
        InputError
            If there is none, or several.
        """
        pieces = [] if self.body is None else self.body.findall("Piece")
        if len(pieces) != 1:
            raise InputError(f"it has {len(pieces)} pieces; exactly one is supported: merge them when exporting")
        return pieces[0]

    def arrays(self, section: ElementTree.Element | None, rows: int | None = None) -> dict[str, NDArray[Any]]:
        """Return the number arrays of a section such as ``PointData`` by name, vectors as rows.

        Parameters
        ----------
        section : Element, optional
            The section; none gives no arrays.
        rows : int, optional
            How many rows each must have: asked before anything is unpacked.

        Raises
        ------
        InputError
            If an array is corrupt.
        """
        found: Iterable[ElementTree.Element] = () if section is None else section.findall("DataArray")
        return {e.get("Name") or f"array {k}": self._array(e, rows) for k, e in enumerate(found)}

    def named(self, section: ElementTree.Element, name: str, rows: int) -> NDArray[np.int64]:
        """Return a list of whole numbers of a known length.

        Raises
        ------
        InputError
            If it is missing or corrupt.
        """
        element = next((e for e in section.findall("DataArray") if e.get("Name") == name), None)
        if element is None:
            raise InputError(f"its {section.tag} have no {name}; the file is cut or corrupt")
        values = self._array(element, rows)
        if values.ndim != 1 or values.dtype.kind not in "iu":
            raise InputError(f"its {name} are not a list of whole numbers; the file is corrupt")
        return values.astype(np.int64)

    def _array(self, element: ElementTree.Element, rows: int | None) -> NDArray[Any]:
        name, kind = one_line(element.get("Name"), 40), element.get("type", "")
        if kind not in TYPES:
            raise InputError(f"array {name!r} is of type {one_line(kind, 40)!r}, which is not read; export it again")
        components = whole(element.get("NumberOfComponents") or "1", f"components of {name!r}")
        if not 1 <= components <= _MAX_COMPONENTS:
            raise InputError(f"array {name!r} has {components} components; the file is corrupt")
        count = None if rows is None else rows * components
        flat = self._values(element, np.dtype(self._order + TYPES[kind]), count, f"array {name!r}")
        if len(flat) % components or (count is not None and len(flat) != count):
            raise InputError(f"array {name!r} has {len(flat)} values for {rows} rows of {components}; it is corrupt")
        flat = flat.reshape(-1, components) if components > 1 else flat
        return flat.astype(flat.dtype.newbyteorder("="), copy=False)

    def _values(self, element: ElementTree.Element, dtype: np.dtype[Any], count: int | None, what: str) -> NDArray[Any]:
        encoding, text = element.get("format", "ascii"), (element.text or "").strip().encode()
        if encoding == "ascii":
            return numbers(text, what, count, np.float64 if dtype.kind == "f" else np.int64).astype(dtype)
        if encoding == "binary":
            data, is_raw = text, False
        elif encoding == "appended":
            offset = whole(element.get("offset") or "", f"offset of {what}")
            check_available(offset, len(self._appended), what)
            data, is_raw = self._appended[offset:], self._is_raw
        else:
            raise InputError(f"{what} has the unknown format {one_line(encoding, 40)!r}")
        most = self._budget if count is None else min(count * dtype.itemsize, self._budget)
        content = self._decoded(data, is_raw, most, what)
        self._budget -= len(content)
        return np.frombuffer(content, dtype, len(content) // dtype.itemsize)

    def _decoded(self, data: bytes, is_raw: bool, most: int, what: str) -> bytes:
        """Return the bytes of one array that begins ``data``, at most so many; what follows it belongs to others."""
        width = self._header.itemsize
        first = self._numbers(data, 1, is_raw, what)[0]
        if self._compressor is not None:
            return self._unpacked(data, first, is_raw, most, what)
        check_available(first, most, what)
        return _taken(data, width + first, is_raw, what)[width:]

    def _unpacked(self, data: bytes, n_blocks: int, is_raw: bool, most: int, what: str) -> bytes:
        width = self._header.itemsize
        check_available(n_blocks * width, len(data), what)
        _, size, last, *packed_sizes = self._numbers(data, 3 + n_blocks, is_raw, what)
        sizes = [size] * n_blocks
        if n_blocks and last:
            sizes[-1] = last
        if sum(sizes) > most:
            raise InputError(
                f"{what} unpacks to {sum(sizes)} bytes, more than the {most} expected; the file is corrupt"
            )
        # The header is encoded by itself in base64, padding included.
        start = (3 + n_blocks) * width if is_raw else 4 * -(-((3 + n_blocks) * width) // 3)
        packed = _taken(data[start:], sum(packed_sizes), is_raw, what)
        parts: list[bytes] = []
        at = 0
        for announced, length in zip(sizes, packed_sizes, strict=True):
            parts.append(self._block(packed[at : at + length], announced))
            at += length
        return b"".join(parts)

    def _block(self, packed: bytes, limit: int) -> bytes:
        if self._compressor == "vtkZLibDataCompressor":
            return inflated(packed, limit)
        content = lzma.LZMADecompressor(memlimit=2**28).decompress(packed, limit + 1)
        if len(content) > limit:
            raise InputError("a compressed block is larger than announced; the file is corrupt")
        return content

    def _numbers(self, data: bytes, count: int, is_raw: bool, what: str) -> list[int]:
        taken = _taken(data, count * self._header.itemsize, is_raw, what)
        return [int(value) for value in np.frombuffer(taken, self._header, count)]


def _taken(data: bytes, count: int, is_raw: bool, what: str) -> bytes:
    """Return the first ``count`` bytes that ``data`` stands for."""
    check_available(count, len(data), what)
    taken = data[:count] if is_raw else base64.b64decode(data[: 4 * -(-count // 3)])[:count]
    check_available(count, len(taken), what)
    return taken
