"""Domains as lists of points: one x, y pair a line, loops parted by an empty line, the outer loop first."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry import Domain
from sizeviz.geometry.outline import require_simple

if TYPE_CHECKING:
    from pathlib import Path

_BETWEEN = re.compile(r"[\s,;]+")


def read_domain(path: Path) -> Domain:
    """Return the domain in a text file of loops.

    A line holds x and y, parted by a comma, a semicolon or blanks; ``#`` begins a comment; one heading line in words
    may come first. An empty line ends a loop; the first loop is the outer one, the others are holes.

    Raises
    ------
    InputError
        If a line does not hold two finite numbers, or the loops cross themselves or each other.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as problem:
        raise InputError(f"{path}: is not a text file; write one x, y pair a line") from problem
    loops = _loops(lines, path)
    if not loops:
        raise InputError(f"{path}: holds no point; write one x, y pair a line")
    domain = Domain(loops[0], tuple(loops[1:]), label=path.name)
    require_simple(domain)
    return domain


def _loops(lines: list[str], path: Path) -> list[np.ndarray[tuple[int, int], np.dtype[np.float64]]]:
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
        elif not (heading_allowed and re.fullmatch(r"[^\d]*", text)):
            raise InputError(f"{path}: line {number} is {text!r}; it must hold two finite numbers, x and y")
        heading_allowed = False
    return [np.array(loop) for loop in loops if loop]


def _point(text: str) -> tuple[float, float] | None:
    words = [word for word in _BETWEEN.split(text) if word]
    if len(words) != 2:
        return None
    try:
        x, y = float(words[0]), float(words[1])
    except ValueError:
        return None
    return (x, y) if np.isfinite(x) and np.isfinite(y) else None
