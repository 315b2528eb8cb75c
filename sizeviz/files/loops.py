"""Domains as lists of points: one x, y pair a line, loops parted by an empty line."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from sizeviz.errors import InputError
from sizeviz.files.guard import check_nodes, one_line
from sizeviz.files.outlines import MAX_LOOPS, MAX_OUTLINE, checked_coordinates
from sizeviz.geometry import Domain
from sizeviz.geometry.domain import signed_area
from sizeviz.geometry.outline import require_simple

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from sizeviz.files.options import ReadOptions

_BETWEEN = re.compile(r"[\s,;]+")
_HEADING = re.compile(r"[^\d]*")


def parse(data: bytes, path: Path, options: ReadOptions) -> Domain:
    """Return the domain in a text of loops.

    A line holds x and y, parted by a comma, a semicolon or blanks; ``#`` begins a comment; one heading line in words
    may come first. An empty line ends a loop; the largest loop is the outer one, the others are holes.

    Raises
    ------
    InputError
        If a line does not hold two finite numbers, or the loops cross themselves or each other.
    """
    try:
        lines = data.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise InputError("it is not a text file; write one x, y pair a line") from None
    check_nodes(len(lines), "lines", 2 * MAX_OUTLINE)
    loops = sorted(_loops(lines), key=lambda loop: -abs(signed_area(loop)))
    if not loops:
        raise InputError("it holds no point; write one x, y pair a line")
    check_nodes(len(loops), "loops", MAX_LOOPS)
    domain = Domain(loops[0], tuple(loops[1:]), label=one_line(path.name))
    require_simple(domain)
    return domain


def _loops(lines: list[str]) -> list[NDArray[np.float64]]:
    loops: list[list[tuple[float, float]]] = [[]]
    heading_allowed = True
    for number, line in enumerate(lines, 1):
        text = line.partition("#")[0].strip()
        if not text:
            if not line.strip() and loops[-1]:  # a comment alone does not end a loop
                loops.append([])
            continue
        point = _point(text)
        if point is not None:
            loops[-1].append(point)
        elif not (heading_allowed and _HEADING.fullmatch(text)):
            raise InputError(f"line {number} is {one_line(text, 60)!r}; it must hold two finite numbers, x and y")
        heading_allowed = False
    return [checked_coordinates(loop, "a loop") for loop in loops if loop]


def _point(text: str) -> tuple[float, float] | None:
    words = [word for word in _BETWEEN.split(text) if word]
    if len(words) != 2:
        return None
    try:
        x, y = float(words[0]), float(words[1])
    except ValueError:
        return None
    return (x, y) if math.isfinite(x) and math.isfinite(y) else None
