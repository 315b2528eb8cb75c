"""Gmsh's parsed post-processing views, ``.pos``: scalar triangles and quadrangles in, scalar triangles out.

Format: Gmsh reference manual, "Post-processing commands", View "name" { ST(x,y,z, ...){v, v, v}; ... };
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import one_line
from sizeviz.files.raw import Cells, RawMesh
from sizeviz.files.text import numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sizeviz.sizing import SizeField

_VIEW = re.compile(rb'View\s{0,99}"([^"\n]{0,4000})"\s{0,99}\{')
_ITEM = re.compile(rb"\b([SVT])([PLTQSHIY])(2?)\s{0,99}\(([^(){}]*)\)\s{0,99}\{([^(){}]*)\}")
_HEAD = re.compile(rb"\b([A-Z][A-Z0-9]{1,2})\s{0,99}\(")
_COMMENT = re.compile(rb"//[^\n]*|/\*.*?\*/", re.DOTALL)
_SHAPES = {b"T": ("triangle", 3), b"Q": ("quad", 4)}
_CHUNK = 100_000


def parse(data: bytes) -> RawMesh:
    """Return the scalar view in a .pos file; nodes at the same place are one, with the smallest value given there.

    Raises
    ------
    InputError
        If the file is corrupt, or holds vectors, tensors or anything but plane triangles and quadrangles.
    """
    if data.lstrip().startswith(b"$MeshFormat"):
        from sizeviz.files.gmsh_msh import parse as parse_msh

        return parse_msh(data)
    if b"/*" in data or b"//" in data:
        data = _COMMENT.sub(b" ", data)
    views = _VIEW.findall(data)
    if len(views) != 1:
        raise InputError(f'it holds {len(views)} views; exactly one View "name" {{ ... }} is supported')
    places: dict[bytes, list[bytes]] = {b"T": [], b"Q": []}
    values: dict[bytes, list[bytes]] = {b"T": [], b"Q": []}
    count = 0
    for found in _ITEM.finditer(data):
        rank, shape, order, where, what = found.groups()
        if rank != b"S" or shape not in _SHAPES or order:
            raise InputError(_refusal(rank, shape, order))
        places[shape].append(where)
        values[shape].append(what)
        count += 1
    if count != len(_HEAD.findall(data)):
        raise InputError("one of its elements is torn or unknown; the file is corrupt")
    return _merged([_block(shape, places[shape], values[shape]) for shape in _SHAPES if places[shape]])


def written(field: SizeField) -> Iterator[bytes]:
    """Yield the parts of a .pos file that Gmsh takes as a background mesh; numbers are written to the last bit."""
    points = [f"{x!r},{y!r},0" for x, y in field.background.points.tolist()]
    sizes = [repr(h) for h in field.sizes.tolist()]
    yield b'View "size" {\n'
    triangles = field.background.triangles
    for start in range(0, len(triangles), _CHUNK):
        yield "".join(
            f"ST({points[a]},{points[b]},{points[c]}){{{sizes[a]},{sizes[b]},{sizes[c]}}};\n"
            for a, b, c in triangles[start : start + _CHUNK].tolist()
        ).encode()
    yield b"};\n"


def _refusal(rank: bytes, shape: bytes, order: bytes) -> str:
    name = one_line((rank + shape + order).decode())
    if rank != b"S":
        kind = "vector" if rank == b"V" else "tensor (anisotropic)"
        return f"it holds {name} elements, a {kind} view; only isotropic scalar sizes are supported"
    if shape in (b"S", b"H", b"I", b"Y"):
        return f"it holds three-dimensional {name} elements; plane scalar triangles and quadrangles are supported"
    return f"it holds {name} elements; plane scalar triangles (ST) and quadrangles (SQ) are supported"


def _block(shape: bytes, where: list[bytes], what: list[bytes]) -> tuple[str, NDArray[np.float64], NDArray[np.float64]]:
    """Return the kind, the corners ``(M, k, 3)`` and their values ``(M, k)``."""
    kind, corners = _SHAPES[shape]
    n = len(where)
    xyz = numbers(b" ".join(where).replace(b",", b" "), f"corners of {kind}s", 3 * corners * n)
    joined = b" ".join(what).replace(b",", b" ")
    steps = {text.count(b",") + 1 for text in what}
    if steps != {corners}:
        raise InputError(f"a {kind} has {max(steps)} values; give one value a corner and one time step")
    return kind, xyz.reshape(n, corners, 3), numbers(joined, f"values of {kind}s", corners * n).reshape(n, corners)


def _merged(blocks: list[tuple[str, NDArray[np.float64], NDArray[np.float64]]]) -> RawMesh:
    if not blocks:
        raise InputError("its view is empty; export a scalar view of plane triangles")
    corners = np.concatenate([xyz.reshape(-1, 3) for _, xyz, _ in blocks])
    sizes = np.concatenate([values.ravel() for _, _, values in blocks])
    points, number = _distinct(corners)
    smallest = np.full(len(points), np.inf)
    np.minimum.at(smallest, number, sizes)
    cells, at, count = [], 0, 0
    for kind, xyz, _ in blocks:
        n, k = xyz.shape[:2]
        rows = number[at : at + n * k].reshape(n, k).astype(np.int64)
        cells.append(Cells(kind, rows, np.arange(count, count + n)))
        at, count = at + n * k, count + n
    return RawMesh(points, tuple(cells), {"size": smallest})


def _distinct(places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the distinct rows, and which of them each row is: numpy's ``unique`` over rows takes six times as long."""
    order = np.lexsort(places.T)
    in_order = places[order]
    is_new = np.concatenate([[True], (in_order[1:] != in_order[:-1]).any(axis=1)])
    number = np.empty(len(places), dtype=np.int64)
    number[order] = np.cumsum(is_new) - 1
    return in_order[is_new], number
