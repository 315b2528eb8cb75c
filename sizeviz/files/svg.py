"""Domains from SVG drawings: filled shapes by the even-odd rule, curves sampled to a tolerance, y turned upwards."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files._vtk_xml import parsed_xml
from sizeviz.files.guard import one_line
from sizeviz.files.outlines import checked_coordinates, domain_from_loops
from sizeviz.files.svg_path import subpaths

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from sizeviz.files.options import ReadOptions
    from sizeviz.geometry import Domain

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_TRANSFORM = re.compile(r"\s*,?\s*(\w+)\s*\(([^()]*)\)")
_HIDDEN = {"defs", "clipPath", "symbol", "mask", "pattern", "marker", "metadata", "script", "style", "text"}
_UNBOUNDED = 1e300


def parse(data: bytes, path: Path, options: ReadOptions) -> Domain:
    """Return the domain that a drawing's paths, polygons, rectangles, circles and ellipses outline.

    Every shape counts, whatever its colour; open ones are closed. Lines, texts, images and what is only defined for
    use elsewhere are left out. y grows upwards in the domain, so the drawing is turned over within its own box.

    Raises
    ------
    InputError
        If it is no SVG, holds no shape, or the shapes outline separate regions and none is chosen.
    """
    root = parsed_xml(data)
    if _name(root) != "svg":
        raise InputError(f"its root is {one_line(_name(root), 40)!r}, not svg")
    shapes = list(_shapes(root))
    rough = _sampled(shapes, _UNBOUNDED)
    if not rough:
        raise InputError("it holds no path, polygon, rectangle, circle or ellipse; convert other objects to paths")
    corners = checked_coordinates(np.concatenate(rough), "a path")
    low, high = corners.min(axis=0), corners.max(axis=0)
    tolerance = options.tolerance or 1e-4 * max(float(np.hypot(*(high - low))), 1e-60)
    fine = [checked_coordinates(loop, "a path") for loop in _sampled(shapes, tolerance)]
    box = _view_box(root)
    mirror = low[1] + high[1] if box is None else 2 * box[1] + box[3]
    return domain_from_loops([np.column_stack([loop[:, 0], mirror - loop[:, 1]]) for loop in fine], path.name, options)


def transformation(text: str | None) -> NDArray[np.float64]:
    """Return the matrix of a ``transform`` attribute, ``(2, 3)``.

    Raises
    ------
    InputError
        If it is not a list of SVG transforms.
    """
    whole = np.eye(3)
    position = 0
    text = (text or "").strip()
    while position < len(text):
        match = _TRANSFORM.match(text, position)
        if match is None:
            raise InputError(f"the transform {one_line(text, 60)!r} cannot be read")
        whole = whole @ _matrix(match.group(1), [float(v) for v in _NUMBER.findall(match.group(2))])
        position = match.end()
    return whole[:2]


def _matrix(name: str, v: list[float]) -> NDArray[np.float64]:
    matrix = np.eye(3)
    if name == "matrix" and len(v) == 6:
        matrix[:2] = np.array(v).reshape(3, 2).T
    elif name == "translate" and len(v) in (1, 2):
        matrix[:2, 2] = v[0], (v[1:] or [0.0])[0]
    elif name == "scale" and len(v) in (1, 2):
        matrix[0, 0], matrix[1, 1] = v[0], v[-1]
    elif name == "rotate" and len(v) in (1, 3):
        cos, sin = np.cos(np.deg2rad(v[0])), np.sin(np.deg2rad(v[0]))
        matrix[:2, :2] = [[cos, -sin], [sin, cos]]
        centre = np.array(v[1:] or [0.0, 0.0])
        matrix[:2, 2] = centre - matrix[:2, :2] @ centre
    elif name in ("skewX", "skewY") and len(v) == 1:
        matrix[(0, 1) if name == "skewX" else (1, 0)] = np.tan(np.deg2rad(v[0]))
    else:
        raise InputError(f"the transform {one_line(name, 20)!r} with {len(v)} numbers is unknown")
    return matrix


def _shapes(root: Element) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Yield each shape as path data and the matrix that places it."""
    waiting: list[tuple[Element, NDArray[np.float64]]] = [(root, np.eye(3)[:2])]
    while waiting:
        element, above = waiting.pop()
        name = _name(element)
        if name in _HIDDEN or _is_hidden(element):
            continue
        if name == "use":
            raise InputError("it draws by 'use', a reference to another shape; flatten the drawing first")
        placed = above @ np.vstack([transformation(element.get("transform")), [0.0, 0.0, 1.0]])
        path = _as_path(element, name)
        if path:
            yield path, placed
        waiting.extend((child, placed) for child in reversed(element))


def _is_hidden(element: Element) -> bool:
    style = (element.get("style") or "").replace(" ", "")
    return element.get("display") == "none" or "display:none" in style


def _as_path(element: Element, name: str) -> str:
    """Return a shape as path data; nothing for what is no shape."""
    if name == "path":
        return element.get("d") or ""
    if name in ("polygon", "polyline"):
        points = element.get("points") or ""
        return f"M{points}Z" if points.strip() else ""
    if name == "rect":
        x, y, w, h = (_length(element, key) for key in ("x", "y", "width", "height"))
        rx, ry = (element.get(key) for key in ("rx", "ry"))
        a, b = _length(element, "rx" if rx else "ry"), _length(element, "ry" if ry else "rx")
        a, b = min(a, w / 2), min(b, h / 2)
        if not (a > 0 and b > 0):
            return f"M{x!r},{y!r}h{w!r}v{h!r}h{-w!r}Z" if w > 0 and h > 0 else ""
        corner = f"a{a!r},{b!r} 0 0 1 "
        return (
            f"M{x + a!r},{y!r}h{w - 2 * a!r}{corner}{a!r},{b!r}v{h - 2 * b!r}{corner}{-a!r},{b!r}"
            f"h{2 * a - w!r}{corner}{-a!r},{-b!r}v{2 * b - h!r}{corner}{a!r},{-b!r}Z"
        )
    if name in ("circle", "ellipse"):
        keys = ("r", "r") if name == "circle" else ("rx", "ry")
        cx, cy, rx_, ry_ = (_length(element, key) for key in ("cx", "cy", *keys))
        half = f"a{rx_!r},{ry_!r} 0 1 1 "
        return f"M{cx - rx_!r},{cy!r}{half}{2 * rx_!r},0{half}{-2 * rx_!r},0Z" if rx_ > 0 and ry_ > 0 else ""
    return ""


def _length(element: Element, key: str) -> float:
    text = (element.get(key) or "0").strip()
    match = _NUMBER.match(text)
    if match is None or text[match.end() :].strip() not in ("", "px"):
        raise InputError(f"the length {key}={one_line(text, 40)!r} has a unit; only plain numbers and px are supported")
    return float(match.group())


def _sampled(shapes: list[tuple[str, NDArray[np.float64]]], tolerance: float) -> list[NDArray[np.float64]]:
    loops = []
    for path, placed in shapes:
        scale = float(np.linalg.norm(placed[:, :2], 2))
        for points in subpaths(path, tolerance / max(scale, 1e-300)):
            loops.append(np.column_stack([points.real, points.imag]) @ placed[:, :2].T + placed[:, 2])
    return loops


def _view_box(root: Element) -> list[float] | None:
    values = [float(v) for v in _NUMBER.findall(root.get("viewBox") or "")]
    return values if len(values) == 4 and values[3] > 0 else None


def _name(element: Element) -> str:
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
