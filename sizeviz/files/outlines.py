"""From loops in a file to one domain: which loop is outer, which are holes, and what can be mended."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.convert import EXTREME, outer_edges, plane_points
from sizeviz.files.guard import check_nodes, one_line
from sizeviz.geometry import Domain
from sizeviz.geometry.domain import signed_area

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sizeviz.files.options import ReadOptions
    from sizeviz.files.raw import RawMesh

MAX_OUTLINE = 200_000
"""Most vertices of a domain's loops, lines and points together."""

MAX_LOOPS = 2_000
"""Most loops of a domain."""

_MAX_CROSSING = 500
_MOST_CROSSINGS = 20_000
MOST_NEAR = 10_000_000
"""Most pairs of segments whose boxes overlap: each is looked at, whether they cross or not."""

_TOGETHER = 64


def checked_coordinates(points: Any, what: str) -> NDArray[np.float64]:
    """Return points of two or more coordinates as ``(N, 2)``.

    Raises
    ------
    InputError
        If they are no numbers, not finite, or absurdly large or small.
    """
    try:
        array = np.array([(float(point[0]), float(point[1])) for point in points], dtype=np.float64).reshape(-1, 2)
    except (TypeError, ValueError, IndexError, KeyError, OverflowError):
        raise InputError(f"{what}: each point must be two numbers, x and y") from None
    if not np.isfinite(array).all() or (len(array) and np.abs(array).max() > EXTREME):
        raise InputError(
            f"{what}: a coordinate is not finite or beyond {EXTREME:g}; repair the file or change its unit"
        )
    return array


def domain_from_loops(loops: Sequence[NDArray[np.float64]], label: str, options: ReadOptions) -> Domain:
    """Return the domain between loops that may come in any order and direction.

    The largest loop is the outer one and the others are its holes; where they cross or nest deeper, the even-odd rule
    of drawings says what is inside.

    Raises
    ------
    InputError
        As ``domain_from_polygons``.
    """
    from shapely import Polygon

    check_nodes(sum(map(len, loops)), "vertices", MAX_OUTLINE)
    check_nodes(len(loops), "loops", MAX_LOOPS)
    rings = [ring for ring in map(closed, loops) if len(ring) >= 3]
    notes = _dropped(loops, rings)
    rings.sort(key=lambda ring: -abs(signed_area(ring)))
    if not rings:
        raise InputError("it holds no loop of three or more points; list the vertices of the outline in order")
    whole = Polygon(rings[0], rings[1:])
    if whole.is_valid and whole.area > 0:
        return Domain(rings[0], tuple(rings[1:]), label=one_line(label), notes=notes)
    check_nodes(len(rings), "loops that cross or nest", _MAX_CROSSING)
    _check_crossings(rings)
    inside = _mended(Polygon(rings[0]))
    for ring in rings[1:]:
        inside = inside.symmetric_difference(_mended(Polygon(ring)))
    notes += ("its loops cross themselves or each other, or nest: what an odd number of them encloses was kept",)
    return replace(domain_from_polygons([inside], (), (), label, options), notes=notes)


def domain_from_polygons(
    polygons: Sequence[Any],
    lines: Sequence[NDArray[np.float64]],
    points: Sequence[NDArray[np.float64]],
    label: str,
    options: ReadOptions,
) -> Domain:
    """Return the domain that shapely polygons make together, mended where they cross themselves or overlap.

    Edges that two of them share become inner lines, so that each stays a region of its own.

    Parameters
    ----------
    polygons : sequence of shapely Polygon or MultiPolygon
        Regions; those that overlap are joined.
    lines : sequence of (K, 2) float64
        Inner lines.
    points : sequence of (2,) float64
        Inner points.
    label : str
        What to call the domain.
    options : ReadOptions
        ``part`` chooses one of several separate regions.

    Raises
    ------
    InputError
        If nothing with an area is left, there are several separate regions and none is chosen, or a line or point
        lies outside.
    """
    from shapely import LineString, Point, unary_union

    check_nodes(sum(1 + len(getattr(polygon, "interiors", ())) for polygon in polygons), "loops", MAX_LOOPS)
    sole = polygons[0] if len(polygons) == 1 and polygons[0].is_valid else None
    # A sound polygon is taken as it is: joining could move where its loops begin.
    if sole is None:
        _check_crossings([ring for polygon in polygons for ring in _rings(polygon)])
    sound = [_mended(polygon) for polygon in polygons]
    whole = unary_union(sound) if sole is None else sole
    notes = []
    if any(not polygon.is_valid for polygon in polygons):
        notes.append("a polygon crosses or touches itself: what its loops enclose was kept")
    overlap = sum(polygon.area for polygon in sound) - whole.area
    if overlap > 1e-9 * whole.area:
        notes.append("polygons overlap: they were joined")
    regions = [part for part in getattr(whole, "geoms", [whole]) if part.geom_type == "Polygon" and part.area > 0]
    if not regions:
        raise InputError("it outlines no area; give at least one closed loop")
    regions.sort(key=lambda region: -region.area)
    part = options.part if options.part is not None else 1
    if part > len(regions) or (options.part is None and len(regions) > 1):
        n = len(regions)
        raise InputError(f"it holds {n} separate region(s); one domain is supported: choose a part from 1 to {n}")
    region = regions[part - 1]
    seams = _seams(sound, region) if overlap <= 1e-9 * whole.area and len(sound) > 1 else []
    if seams:
        notes.append(f"regions share edges: they are kept as {len(seams)} inner line(s)")
    for line in lines:
        if not (len(line) >= 2 and region.covers(LineString(line))):
            raise InputError("a line in it leaves the region; only lines inside can be kept as element edges")
    for point in points:
        if not region.covers(Point(point)):
            raise InputError(f"the point ({point[0]:g}, {point[1]:g}) lies outside the region; move or remove it")
    return Domain(
        _ring(region.exterior),
        tuple(_ring(hole) for hole in region.interiors),
        lines=(*lines, *seams),
        fixed_points=np.array(points).reshape(-1, 2),
        label=one_line(label),
        notes=tuple(notes),
    )


def _seams(polygons: Sequence[Any], region: Any) -> list[NDArray[np.float64]]:
    """Return the edges that polygons share within a region, joined to lines."""
    from shapely import line_merge, unary_union

    inner = unary_union([polygon.boundary for polygon in polygons]).difference(region.boundary).intersection(region)
    merged = line_merge(inner) if inner.geom_type == "MultiLineString" else inner
    parts = [part for part in getattr(merged, "geoms", [merged]) if part.geom_type == "LineString" and part.length > 0]
    return [np.asarray(part.coords, dtype=np.float64)[:, :2] for part in parts]


def _dropped(loops: Sequence[NDArray[np.float64]], kept: Sequence[NDArray[np.float64]]) -> tuple[str, ...]:
    """Return a note where loops without an area, or vertices that repeat others, were left out."""
    notes = []
    # that a loop's first vertex comes once more at its end is how most files close it: nothing to speak of
    usual = sum(len(loop) - int(len(loop) > 1 and np.array_equal(loop[0], loop[-1])) for loop in loops)
    small = len(loops) - len(kept)
    repeated = usual - sum(map(len, kept))
    if small:
        notes.append(f"{small} loop(s) of fewer than three vertices were left out")
    elif repeated:
        notes.append(f"{repeated} repeated vertices were left out")
    return tuple(notes)


def domain_of(raw: RawMesh, label: str, options: ReadOptions) -> Domain:
    """Return the domain that a plane mesh of triangles and quadrilaterals covers: its boundary edges, chained.

    Raises
    ------
    InputError
        If the mesh is not plane, has no such cells, or its boundary is no set of simple loops.
    """
    points = plane_points(raw.points)
    blocks = [rows for rows in (raw.rows("triangle"), raw.rows("quad")) if len(rows)]
    if not blocks:
        raise InputError("it holds no triangle or quadrilateral; give a plane mesh, or an outline")
    edges = outer_edges(blocks)
    loops = [points[loop] for loop in _chained(edges)]
    return domain_from_loops(loops, label, options)


def _chained(edges: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Join directed edges into closed loops of point numbers."""
    following = dict(edges.tolist())
    if len(following) != len(edges) or set(following) != set(following.values()):
        raise InputError(
            "its boundary branches or is open; repair the mesh: cells must share whole edges and run one way"
        )
    loops = []
    while following:
        start, at = following.popitem()
        loop = [start]
        while at != start:
            loop.append(at)
            at = following.pop(at)
        loops.append(np.array(loop))
    return loops


def closed(loop: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a loop without vertices that repeat the one before them, or the first at the end, ``(K, 2)``."""
    keep = (loop != np.roll(loop, 1, axis=0)).any(axis=1)
    return loop[keep]


def _rings(shape: Any) -> list[NDArray[np.float64]]:
    """Return the coordinates of every loop of a polygon or of several."""
    parts = [part for part in getattr(shape, "geoms", [shape]) if part.geom_type == "Polygon"]
    return [np.asarray(ring.coords)[:, :2] for part in parts for ring in (part.exterior, *part.interiors)]


def _check_crossings(rings: Sequence[NDArray[np.float64]]) -> None:
    """Raise InputError if segments meet so often that mending would take for ever: asked before it is begun."""
    import shapely

    ends = np.concatenate([np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings if len(ring)])
    segments = shapely.linestrings(ends)
    tree = shapely.STRtree(segments)
    met = near = 0
    for start in range(0, len(segments), _TOGETHER):
        some = segments[start : start + _TOGETHER]
        near += tree.query(some).shape[1]
        if near > MOST_NEAR:
            raise InputError("its loops run over each other too often to be mended; draw outlines that lie apart")
        met += tree.query(some, predicate="intersects").shape[1]
        if met > 5 * len(segments) + _MOST_CROSSINGS:  # each segment meets itself and its neighbours
            raise InputError("its loops cross each other too often to be mended; draw outlines that do not cross")


def _ring(ring: Any) -> NDArray[np.float64]:
    return closed(np.asarray(ring.coords, dtype=np.float64)[:-1, :2])


def _mended(polygon: Any) -> Any:
    from shapely import make_valid

    return polygon if polygon.is_valid else make_valid(polygon)
