"""Domains from GeoJSON (RFC 7946): polygons with holes, and lines and points to keep inside."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from sizeviz.errors import InputError
from sizeviz.files.guard import check_nodes, one_line
from sizeviz.files.outlines import MAX_OUTLINE, checked_coordinates, domain_from_polygons

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from sizeviz.files.options import ReadOptions
    from sizeviz.geometry import Domain

_PARTS = {"MultiPolygon": "Polygon", "MultiLineString": "LineString", "MultiPoint": "Point"}
_MAX_DEPTH = 50


def parse(data: bytes, path: Path, options: ReadOptions) -> Domain:
    """Return the domain that the polygons of a GeoJSON text make together.

    Lines inside become inner lines, points inside become fixed points; a third coordinate is left out, and longitude
    and latitude are taken as x and y.

    Raises
    ------
    InputError
        If it is no GeoJSON, has no polygon, or holds separate regions and none is chosen.
    """
    from shapely import Polygon

    try:
        tree = json.loads(data.decode("utf-8-sig"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"it is not JSON ({one_line(error)}); check or export it again") from None
    polygons, lines, points = [], [], []
    count = 0
    for kind, coordinates in _geometries(tree, 0):
        if kind == "Polygon":
            rings = [checked_coordinates(ring, "a polygon's ring") for ring in _listed(coordinates)]
            if any(len(ring) < 4 for ring in rings) or not rings:
                raise InputError("a polygon's ring has fewer than four points, the last being the first; mend it")
            polygons.append(Polygon(rings[0], rings[1:]))
            count += sum(map(len, rings))
        elif kind == "LineString":
            lines.append(checked_coordinates(_listed(coordinates), "a line"))
            count += len(lines[-1])
        else:
            points.append(checked_coordinates([coordinates], "a point")[0])
            count += 1
        check_nodes(count, "vertices", MAX_OUTLINE)
    if not polygons:
        raise InputError("it holds no Polygon or MultiPolygon; give the outline of the domain")
    return domain_from_polygons(polygons, lines, points, path.name, options)


def _geometries(tree: Any, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield each simple geometry's type and coordinates."""
    if not isinstance(tree, dict) or depth > _MAX_DEPTH:
        raise InputError("it is no GeoJSON object; it must hold a 'type'")
    kind = tree.get("type")
    if kind == "FeatureCollection":
        for feature in _listed(tree.get("features")):
            yield from _geometries(feature, depth + 1)
    elif kind == "Feature":
        if tree.get("geometry") is not None:
            yield from _geometries(tree["geometry"], depth + 1)
    elif kind == "GeometryCollection":
        for geometry in _listed(tree.get("geometries")):
            yield from _geometries(geometry, depth + 1)
    elif kind in _PARTS:
        for coordinates in _listed(tree.get("coordinates")):
            yield _PARTS[kind], coordinates
    elif kind in _PARTS.values():
        yield str(kind), tree.get("coordinates")
    else:
        raise InputError(
            f"its type {one_line(kind, 40)!r} is none of GeoJSON's; Polygon and MultiPolygon are supported"
        )


def _listed(value: Any) -> list[Any]:
    if not isinstance(value, list):
        raise InputError(f"a list of coordinates or features was expected, but it holds {one_line(value, 40)!r}")
    return value
