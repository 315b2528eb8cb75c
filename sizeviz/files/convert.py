"""From what a file holds to what it means, and back: fields, meshes, images."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import check_nodes, one_line
from sizeviz.files.image import Image
from sizeviz.files.raw import Arrays, Cells, RawGrid, RawMesh
from sizeviz.geometry import QuadMesh
from sizeviz.sizing import BackgroundMesh, Grid, SizeField

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from sizeviz.files.options import ReadOptions

SIZE_NAMES = ("size", "sizes", "size_prescribed", "size_target", "h", "solution")
"""Point arrays taken as sizes, the first that is there."""

_LESSER = ("vertex", "polyvertex", "line", "polyline")
"""Cells that may stand beside the elements and are left out."""

_FLAT = 1e-9
"""How far points may leave their plane, relative to their extent."""

EXTREME = 1e60
"""Largest coordinate or size, and the inverse of the smallest size: beyond it products over- and underflow."""


def field_of(raw: RawMesh | RawGrid, label: str, options: ReadOptions) -> SizeField:
    """Return the size field in a file's nodes, triangles and quadrilaterals (cut in two) or grid.

    Raises
    ------
    InputError
        If the cells are not plane triangles or quadrilaterals, or there is no scalar array of valid sizes at nodes.
    """
    sizes = _sizes(raw, options.array)
    if isinstance(raw, RawGrid):
        plane, values = sliced(raw, sizes, options)
        return SizeField(BackgroundMesh.regular(plane), values.ravel(), label=label)
    _refuse_cells(raw, ("triangle", "quad"), "triangles and quadrilaterals", "a size field")
    points = plane_points(raw.points)
    triangles = np.concatenate([raw.rows("triangle"), _halved(raw.rows("quad"), points)])
    if not len(triangles):
        raise InputError("it holds no triangle or quadrilateral to carry the sizes; export the mesh with its elements")
    grid = _stored_grid(raw.field_data.get("grid"), points, triangles)
    if grid is not None:
        return SizeField(grid, sizes, label=label)
    triangles = _counter_clockwise(triangles, points)
    points, triangles, used = _compact(points, triangles)
    return SizeField(BackgroundMesh(points, triangles.astype(np.int32)), sizes[used], label=label)


def mesh_of(raw: RawMesh | RawGrid) -> tuple[QuadMesh, dict[str, NDArray[Any]], dict[str, NDArray[Any]]]:
    """Return the quad mesh in a file, its cell arrays and its point arrays.

    Nodes keep the ``curve`` and ``fixed`` that sizeviz wrote with them; in a file of others, boundary nodes are fixed.

    Raises
    ------
    InputError
        If the cells are anything but plane quadrilaterals (lines and points beside them are left out).
    """
    if isinstance(raw, RawGrid):
        raise InputError("it holds a grid of points, not a mesh; give a file of quadrilaterals")
    _refuse_cells(raw, ("quad",), "quadrilaterals", "a mesh")
    points, quads = plane_points(raw.points), raw.rows("quad")
    if not len(quads):
        raise InputError("it holds no quadrilateral; only all-quad meshes are supported")
    points, quads, used = _compact(points, quads)
    arrays = {name: values[used] for name, values in raw.point_data.items()}
    curve, fixed = arrays.pop("curve", None), arrays.pop("fixed", None)
    if curve is None or fixed is None or curve.ndim != 1 or fixed.ndim != 1:
        curve, fixed = np.full(len(points), -1), np.zeros(len(points), dtype=bool)
        fixed[outer_edges([quads])] = True
    index = next(block.index for block in raw.cells if block.kind == "quad")
    of_cells = {name: values[index] for name, values in raw.cell_data.items()}
    mesh = QuadMesh(points, quads.astype(np.int32), curve.astype(np.int32), fixed.astype(bool))
    return mesh, of_cells, arrays


def image_of(raw: RawMesh | RawGrid, label: str, options: ReadOptions) -> Image:
    """Return the image in a grid of points or of cells.

    Raises
    ------
    InputError
        If the file holds no grid, or no array of one number (or a colour) a pixel.
    """
    if isinstance(raw, RawMesh):
        raise InputError("it holds a mesh, not an image; give a grid of pixels such as .vti or .png")
    arrays = raw.point_data
    if not arrays and raw.cell_data:
        shape = tuple(max(n - 1, 1) for n in raw.shape)
        centre = raw.origin + 0.5 * raw.spacing * (np.array(raw.shape) > 1)
        raw = RawGrid((shape[0], shape[1], shape[2]), centre, raw.spacing, raw.cell_data)
    values = luminance(_chosen(raw.point_data, options.array, ("intensity", "values"), "intensities"))
    plane, pixels = sliced(raw, values, options)
    return Image(pixels, (plane.dx, plane.dy), (plane.x0, plane.y0), label)


def raw_field(field: SizeField) -> RawMesh:
    """Return a field as a file holds it: triangles, the point array ``size``, and the grid where it is one."""
    background = field.background
    grid = background.grid
    whole = {} if grid is None else {"grid": np.array([grid.x0, grid.y0, grid.dx, grid.dy, grid.nx, grid.ny])}
    block = _sole_block("triangle", background.triangles)
    return RawMesh(in_space(background.points), (block,), {"size": field.sizes}, {}, whole)


def raw_mesh(mesh: QuadMesh, cell_data: Arrays, point_data: Arrays) -> RawMesh:
    """Return a quad mesh as a file holds it, with ``curve`` and ``fixed`` among the point arrays."""
    own: dict[str, NDArray[Any]] = {"curve": mesh.curve, "fixed": mesh.fixed.astype(np.uint8)}
    arrays: dict[str, NDArray[Any]] = {**point_data, **own}
    return RawMesh(in_space(mesh.points), (_sole_block("quad", mesh.quads),), arrays, cell_data)


def in_space(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``(N, 2)`` points with z = 0, ``(N, 3)``."""
    return np.column_stack([points, np.zeros(len(points))])


def plane_points(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return x and y of points that lie in a plane of constant z, ``(N, 2)``.

    Raises
    ------
    InputError
        If they do not, or a coordinate is not finite or absurdly large.
    """
    if not len(points):
        raise InputError("it holds no point")
    if not np.isfinite(points).all() or np.abs(points).max() > EXTREME:
        raise InputError(f"a coordinate is not finite or beyond {EXTREME:g}; repair the file or change its unit")
    extent = np.ptp(points, axis=0)
    if extent[2] > _FLAT * max(extent[0], extent[1]):
        raise InputError("it is three-dimensional: its points do not share one z; only plane meshes are supported")
    return np.ascontiguousarray(points[:, :2])


def sliced(raw: RawGrid, values: NDArray[Any], options: ReadOptions) -> tuple[Grid, NDArray[np.float64]]:
    """Return the plane grid and its values ``(ny, nx)``: the grid itself, or one slice of a volume.

    Raises
    ------
    InputError
        If the slice does not exist, or the plane has fewer than 2 x 2 points.
    """
    volume = values.reshape(raw.shape[::-1])
    across = "xyz".index(options.axis)
    if min(raw.shape) == 1 and raw.shape[across] > 1:
        across = raw.shape.index(1)  # a plane already: nothing to choose
    depth = raw.shape[across]
    k = depth // 2 if options.slice is None else options.slice
    if k >= depth:
        raise InputError(f"slice {k} does not exist; {'xyz'[across]} has slices 0 to {depth - 1}")
    plane = np.take(volume, k, axis=2 - across)
    first, second = [axis for axis in range(3) if axis != across]
    check_nodes(plane.size)
    x0, y0 = float(raw.origin[first]), float(raw.origin[second])
    dx, dy = float(raw.spacing[first]), float(raw.spacing[second])
    grid = Grid(x0, y0, dx, dy, raw.shape[first], raw.shape[second])
    return grid, np.ascontiguousarray(plane, dtype=np.float64)


def luminance(values: NDArray[Any]) -> NDArray[Any]:
    """Return one number a pixel: grey as it is, colours by Rec. 709 luma, an alpha channel left out.

    Parameters
    ----------
    values : (..., k) array
        k = 1 (or no last axis) is grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha.
    """
    if values.ndim == 1:
        return values
    channels = values.shape[-1]
    if channels not in (1, 2, 3, 4):
        raise InputError(f"it has {channels} channels a pixel; grey, RGB and RGBA images are supported")
    if channels < 3:
        return values[..., 0]
    # Written by differences from green, so that grey stays what it is to the bit.
    green = values[..., 1].astype(np.float64)
    grey = 0.2126 * (values[..., 0] - green)
    grey += 0.0722 * (values[..., 2] - green)
    grey += green
    return grey


def outer_edges(blocks: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Return the edges that belong to one cell only, ``(E, 2)``, in the direction in which that cell runs.

    Parameters
    ----------
    blocks : list of (M, k) int64
        Cells of k corners each.
    """
    around = [np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2) for cells in blocks]
    edges = np.concatenate(around)
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, first, counts = np.unique(low * (int(high.max()) + 1) + high, return_index=True, return_counts=True)
    return edges[first[counts == 1]]


def _sole_block(kind: str, rows: NDArray[np.int32]) -> Cells:
    return Cells(kind, rows.astype(np.int64), np.arange(len(rows)))


def _chosen(arrays: Mapping[str, NDArray[Any]], name: str | None, usual: tuple[str, ...], what: str) -> NDArray[Any]:
    found = ", ".join(one_line(key, 40) for key in list(arrays)[:12]) or "none"
    if name is None:
        name = next((key for key in usual if key in arrays), next(iter(arrays)) if len(arrays) == 1 else None)
        if name is None:
            raise InputError(
                f"no array of {what} at its nodes (found: {found}); name one of them, or call it {usual[0]!r}"
            )
    if name not in arrays:
        raise InputError(f"it has no point array {name!r} (found: {found})")
    return arrays[name]


def _sizes(raw: RawMesh | RawGrid, name: str | None) -> NDArray[np.float64]:
    if not raw.point_data and raw.cell_data:
        raise InputError("it gives values per cell; sizes are needed at the nodes: convert cell data to point data")
    candidates = {k: v for k, v in raw.point_data.items() if k not in ("curve", "fixed")}
    if name is None and not set(SIZE_NAMES) & set(candidates):
        candidates = {k: v for k, v in candidates.items() if v.ndim == 1} or candidates
    values = _chosen(candidates, name, SIZE_NAMES, "sizes")
    if values.ndim > 1 and values.shape[1:] == (1,):
        values = values[:, 0]
    if values.ndim != 1:
        raise InputError(
            f"its sizes have {int(np.prod(values.shape[1:]))} components a node: an anisotropic metric or a vector; "
            "only isotropic sizes, one number a node, are supported"
        )
    sizes = values.astype(np.float64)
    with np.errstate(invalid="ignore"):
        if ((sizes > EXTREME) | ((sizes > 0) & (sizes < 1 / EXTREME))).any() and np.isfinite(sizes).all():
            raise InputError(f"a size is beyond {EXTREME:g} or below {1 / EXTREME:g}; change the model's unit")
    return sizes


def _refuse_cells(raw: RawMesh, wanted: tuple[str, ...], words: str, what: str) -> None:
    others = {block.kind: len(block.rows) for block in raw.cells if block.kind not in (*wanted, *_LESSER)}
    if others:
        found = ", ".join(f"{n} {one_line(kind, 40)}{'s' if n != 1 else ''}" for kind, n in others.items())
        space = " (a volume mesh)" if set(others) & {"tetra", "hexahedron", "wedge", "pyramid"} else ""
        raise InputError(f"it holds {found}{space}; {what} is read from plane linear {words} only")


def _halved(quads: NDArray[np.int64], points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Cut quadrilaterals along the diagonal from their first corner, or along the other where that one folds."""
    first, second = quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]
    folded = doubled_area(first, points) * doubled_area(second, points) <= 0
    cut = np.stack([first, second], axis=1)
    cut[folded, 0], cut[folded, 1] = quads[folded][:, [0, 1, 3]], quads[folded][:, [1, 2, 3]]
    return cut.reshape(-1, 3)


def doubled_area(triangles: NDArray[np.int64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return twice the signed area of each triangle, ``(T,)``."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area: NDArray[np.float64] = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    return area


def _counter_clockwise(triangles: NDArray[np.int64], points: NDArray[np.float64]) -> NDArray[np.int64]:
    area = doubled_area(triangles, points)
    if (area == 0).any():
        raise InputError(f"triangle {int(np.argmax(area == 0))} has no area; repair the background mesh")
    return np.where((area < 0)[:, None], triangles[:, [0, 2, 1]], triangles)


def _compact(
    points: NDArray[np.float64], cells: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Return points and cells without the points that no cell uses, and which points stay."""
    is_used = np.zeros(len(points), dtype=bool)
    is_used[cells] = True
    if is_used.all():
        return points, cells, np.arange(len(points))
    number = np.cumsum(is_used) - 1
    return points[is_used], number[cells], np.flatnonzero(is_used)


def _stored_grid(
    values: NDArray[Any] | None, points: NDArray[np.float64], triangles: NDArray[np.int64]
) -> BackgroundMesh | None:
    """Return the grid that a file claims its nodes to be, if they are."""
    if values is None or values.shape != (6,) or not np.isfinite(values).all() or np.abs(values).max() > EXTREME:
        return None
    nx, ny = int(values[4]), int(values[5])
    if min(nx, ny) < 2 or nx * ny != len(points) or min(values[2], values[3]) <= 0:
        return None
    x0, y0, dx, dy = map(float, values[:4])
    regular = BackgroundMesh.regular(Grid(x0, y0, dx, dy, nx, ny))
    same = np.array_equal(regular.points, points) and np.array_equal(regular.triangles, triangles)
    return regular if same else None
