"""The container of a study file: a zip archive of JSON texts and NumPy arrays, nothing that could be executed."""

from __future__ import annotations

import json
import re
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.atomic import replacing
from sizeviz.files.guard import MAX_BYTES, load, one_line
from sizeviz.files.numpy_files import members, npy, read_npy
from sizeviz.geometry.arrays import read_only

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

STUDY, VIEW = "study.json", "view.json"
"""What was computed, and how it was looked at."""

MAX_JSON = 16 * 2**20
"""Most bytes of either text."""

_ARRAY = re.compile(r"arrays/(a\d{1,4})\.npy")
_KINDS = {"<f8": "numbers", "<i4": "whole numbers", "<i8": "long whole numbers", "|b1": "yes or no"}
_OLDEST = (1980, 1, 1, 0, 0, 0)
"""The date of every member, so that equal studies are equal files."""


class ArrayWriter:
    """Gives arrays their names; the same array is stored once."""

    def __init__(self) -> None:
        self.arrays: dict[str, NDArray[Any]] = {}
        self._names: dict[int, str] = {}

    def stored(self, array: NDArray[Any]) -> str:
        """Return the name under which an array will be found."""
        if id(array) not in self._names:
            name = f"a{len(self.arrays)}"
            self._names[id(array)], self.arrays[name] = name, array
        return self._names[id(array)]


class ArrayReader:
    """Hands out the arrays of a file by name.

    Parameters
    ----------
    arrays : mapping of str to bytes
        Each array as an .npy file.
    """

    def __init__(self, arrays: Mapping[str, bytes]) -> None:
        self._content = arrays
        self._read: dict[str, NDArray[Any]] = {}

    def array(self, name: str, dtype: str, what: str) -> NDArray[Any]:
        """Return an array of a type, read-only.

        Parameters
        ----------
        name : str
            Its name.
        dtype : {'<f8', '<i4', '<i8', '|b1'}
            The type it must have.
        what : str
            What it is, for messages.

        Raises
        ------
        InputError
            If it is missing, corrupt or of another type.
        """
        if name not in self._content:
            raise InputError(f"{what}: array {one_line(name, 20)} is missing; the file is cut or corrupt")
        if name not in self._read:
            self._read[name] = read_only(read_npy(self._content[name]))
        found = self._read[name]
        if found.dtype.str != dtype:
            raise InputError(
                f"{what}: expected {_KINDS[dtype]} ({dtype}), found {found.dtype.str}; the file is corrupt"
            )
        return found


def write_archive(
    path: str | Path, study: Mapping[str, Any], view: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]
) -> None:
    """Write the container, whole or not at all; equal content gives equal bytes.

    Raises
    ------
    InputError
        If the place cannot be written, or the view holds what JSON cannot.
    """
    texts = {STUDY: study, VIEW: view}
    try:
        encoded = {name: json.dumps(text, allow_nan=False, indent=1).encode() for name, text in texts.items()}
    except (TypeError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: the study holds what JSON cannot ({one_line(error)}); give plain values") from None
    for name, text in encoded.items():
        if len(text) > MAX_JSON:
            raise InputError(f"{path}: {name} would have {len(text)} bytes; at most {MAX_JSON} can be kept")
    with replacing(path) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, text in encoded.items():
            archive.writestr(zipfile.ZipInfo(name, _OLDEST), text, zipfile.ZIP_DEFLATED)
        for name, array in arrays.items():
            member = zipfile.ZipInfo(f"arrays/{name}.npy", _OLDEST)
            archive.writestr(member, npy(np.ascontiguousarray(array)), zipfile.ZIP_DEFLATED)


def read_archive(path: str | Path) -> tuple[dict[str, Any], dict[str, Any], ArrayReader]:
    """Return the study's text, the view's text and the arrays.

    Nothing is unpacked to the disk, and no name in the archive is used as a path.

    Raises
    ------
    InputError
        If the file is missing, corrupt, too large when unpacked, or holds a member that no study has.
    """
    texts: dict[str, bytes] = {}
    arrays: dict[str, bytes] = {}
    data = load(path)
    if data[:2] != b"PK":
        raise InputError("it is no sizeviz study; open it as a source instead")
    for name, content in members(data, MAX_BYTES):
        found = _ARRAY.fullmatch(name)
        kept, key = (arrays, found.group(1)) if found else (texts, name)
        if not found and name not in (STUDY, VIEW):
            raise InputError(f"it holds {one_line(name, 60)!r}, which belongs to no study; the file is corrupt")
        if key in kept:
            raise InputError(f"it holds {one_line(name, 60)!r} twice; the file is corrupt")
        kept[key] = content
    return _text(texts, STUDY), _text(texts, VIEW), ArrayReader(arrays)


def _text(texts: Mapping[str, bytes], name: str) -> dict[str, Any]:
    content = texts.get(name)
    if content is None:
        raise InputError(f"it holds no {name}; the file is cut, or no study")
    if len(content) > MAX_JSON:
        raise InputError(f"its {name} has {len(content)} bytes; at most {MAX_JSON} are read")
    try:
        tree = json.loads(content.decode("utf-8"), parse_constant=_refused)
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise InputError(f"its {name} is not JSON ({one_line(error)}); the file is corrupt") from None
    if not isinstance(tree, dict):
        raise InputError(f"its {name} is no JSON object; the file is corrupt")
    return tree


def _refused(constant: str) -> float:
    raise InputError(f"it holds the number {constant}; the file is corrupt")
