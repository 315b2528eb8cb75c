"""What a mesh file holds before anyone asks what it means: points in space, cells of any kind, arrays of any width."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import check_nodes, one_line

if TYPE_CHECKING:
    from numpy.typing import NDArray

Arrays = Mapping[str, "NDArray[Any]"]
"""Named arrays, one row an entity."""

CORNERS = {"vertex": 1, "line": 2, "triangle": 3, "quad": 4, "tetra": 4, "hexahedron": 8, "wedge": 6, "pyramid": 5}
"""The linear cells, and how many corners each has."""


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of one kind.

    Parameters
    ----------
    kind : str
        A name of ``CORNERS``, or another that messages can show, such as ``triangle6``.
    rows : (M, k) int64
        Indices of points.
    index : (M,) int64
        Where each cell stands among all cells of the file, and so in its cell arrays.
    """

    kind: str
    rows: NDArray[np.int64]
    index: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class RawMesh:
    """Points, cells and their arrays.

    Parameters
    ----------
    points : (N, 3) float64
        Coordinates; files of plane meshes have z = 0.
    cells : tuple of Cells
        At most one block of each kind.
    point_data, cell_data : mapping of str to (N, ...) or (M, ...) arrays
        Named values.
    field_data : mapping of str to arrays
        Values that belong to the whole file.

    Raises
    ------
    InputError
        If a cell names a point that does not exist, or an array does not fit.
    """

    points: NDArray[np.float64]
    cells: tuple[Cells, ...]
    point_data: Arrays = field(default_factory=dict)
    cell_data: Arrays = field(default_factory=dict)
    field_data: Arrays = field(default_factory=dict)

    def __post_init__(self) -> None:
        n_points, n_cells = len(self.points), sum(len(block.rows) for block in self.cells)
        check_nodes(n_points)
        for block in self.cells:
            if block.rows.size and (block.rows.min() < 0 or block.rows.max() >= n_points):
                raise InputError(f"a {block.kind} names a point outside 0..{n_points - 1}; the connectivity is corrupt")
        for count, arrays, what in ((n_points, self.point_data, "points"), (n_cells, self.cell_data, "cells")):
            for name, values in arrays.items():
                if len(values) != count:
                    raise InputError(f"array {one_line(name)!r} has {len(values)} rows for {count} {what}")

    def rows(self, kind: str) -> NDArray[np.int64]:
        """Return the cells of one kind, ``(M, k)``; none where there are none."""
        for block in self.cells:
            if block.kind == kind:
                return block.rows
        return np.empty((0, CORNERS[kind]), dtype=np.int64)


@dataclass(frozen=True, eq=False)
class RawGrid:
    """A regular grid of points, x running fastest, and its arrays.

    Parameters
    ----------
    shape : tuple of int
        Number of points along x, y, z.
    origin, spacing : (3,) float64
        The first point, and the steps.
    point_data, cell_data : mapping of str to arrays
        Named values.

    Raises
    ------
    InputError
        If there are too many points, a spacing is not above 0, or an array does not fit.
    """

    shape: tuple[int, int, int]
    origin: NDArray[np.float64]
    spacing: NDArray[np.float64]
    point_data: Arrays = field(default_factory=dict)
    cell_data: Arrays = field(default_factory=dict)

    def __post_init__(self) -> None:
        if min(self.shape) < 1:
            raise InputError(
                f"a grid of {' x '.join(map(str, self.shape))} points; there must be at least one each way"
            )
        count = self.shape[0] * self.shape[1] * self.shape[2]
        for name, values in self.point_data.items():
            if len(values) != count:
                raise InputError(f"array {one_line(name)!r} has {len(values)} rows for {count} points")
        steps = self.spacing[np.array(self.shape) > 1]
        if not (np.isfinite(self.origin).all() and np.isfinite(steps).all() and (steps > 0).all()):
            raise InputError(f"grid spacing {self.spacing.tolist()} must be finite and above 0")


def grouped(
    joined: NDArray[np.int64], starts: NDArray[np.int64], kinds: NDArray[Any], names: Mapping[int, str]
) -> tuple[Cells, ...]:
    """Sort the cells of a mixed list into blocks of one kind.

    Parameters
    ----------
    joined : (L,) int64
        The corners of all cells, one cell after the other.
    starts : (M + 1,) int64
        Where each cell begins in ``joined``, and the end of the last.
    kinds : (M,) ints
        The file's code of each cell's kind.
    names : mapping of int to str
        What the codes mean; others appear as ``cell type 22``.

    Raises
    ------
    InputError
        If starts do not grow within ``joined``, or a cell has too few or too many corners for its kind.
    """
    counts = np.diff(starts)
    if len(kinds) != len(counts):
        raise InputError(f"{len(kinds)} cell types are given for {len(counts)} cells")
    if len(counts) and (starts[0] < 0 or counts.min() < 0 or starts[-1] > len(joined)):
        raise InputError("the cells reach beyond their list of corners; the connectivity is corrupt")
    blocks: dict[str, list[Cells]] = {}
    for kind in np.unique(kinds):
        index = np.flatnonzero(kinds == kind)
        name = names.get(int(kind), f"cell type {int(kind)}")
        for count in np.unique(counts[index]):
            of_count = index[counts[index] == count]
            block = _block(name, int(count), joined, starts, of_count)
            blocks.setdefault(block.kind, []).append(block)
    return tuple(_joined(parts) for parts in blocks.values())


def _block(
    name: str, count: int, joined: NDArray[np.int64], starts: NDArray[np.int64], index: NDArray[np.int64]
) -> Cells:
    if name == "polygon" and count in (3, 4):
        name = {3: "triangle", 4: "quad"}[count]
    elif name == "polygon" or name not in {*CORNERS, "pixel"}:
        # Nothing here can use it: the message needs its name, not its corners.
        return Cells(name if name != "polygon" else f"polygon{count}", np.zeros((len(index), 0), np.int64), index)
    if count != {**CORNERS, "pixel": 4}[name]:
        raise InputError(f"a {name} has {count} corners; the connectivity is corrupt")
    rows = joined[starts[index][:, None] + np.arange(count)]
    if name == "pixel":  # its corners run row by row
        name, rows = "quad", rows[:, [0, 1, 3, 2]]
    return Cells(name, rows, index)


def _joined(parts: list[Cells]) -> Cells:
    if len(parts) == 1:
        return parts[0]
    rows, index = np.concatenate([p.rows for p in parts]), np.concatenate([p.index for p in parts])
    order = np.argsort(index, kind="stable")
    return Cells(parts[0].kind, rows[order], index[order])
