"""A catalogue of planar domains, from a square to a coastline with islands: for examples, tests and sweeps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.geometry import Domain

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

SAMPLES = 256
"""Vertices that a full circle is sampled at; its sagitta is then 7.5e-5 of the radius."""


def shape(name: str) -> Domain:
    """Return a domain of the catalogue; all of them lie in the unit square.

    Raises
    ------
    InputError
        If there is no shape of that name.
    """
    try:
        return SHAPES[name]()
    except KeyError:
        raise InputError(f"there is no shape {name!r}; choose one of {', '.join(SHAPES)}") from None


def circle(
    x: float, y: float, rx: float, ry: float | None = None, turn: float = 0.0, samples: int = SAMPLES
) -> NDArray[np.float64]:
    """Return a sampled ellipse, ``(samples, 2)``, counter-clockwise; ``turn`` is its tilt in radians."""
    t = 2 * np.pi * np.arange(samples) / samples
    across, along = rx * np.cos(t), (rx if ry is None else ry) * np.sin(t)
    c, s = np.cos(turn), np.sin(turn)
    return np.column_stack([x + c * across - s * along, y + s * across + c * along])


def _wavy(centre: tuple[float, float], radius: float, waves: NDArray[np.float64], samples: int) -> NDArray[np.float64]:
    """Return a closed curve whose radius is modulated by harmonics; ``waves`` holds order, amplitude, phase."""
    t = 2 * np.pi * np.arange(samples) / samples
    r = radius * (1 + (waves[:, 1, None] * np.cos(waves[:, 0, None] * t + waves[:, 2, None])).sum(axis=0))
    return np.column_stack([centre[0] + r * np.cos(t), centre[1] + r * np.sin(t)])


def _disk() -> Domain:
    return Domain(circle(0.5, 0.5, 0.5), label="disk")


def _annulus() -> Domain:
    return Domain(circle(0.5, 0.5, 0.5), (circle(0.5, 0.5, 0.2),), label="annulus")


def _eccentric() -> Domain:
    # the narrowest place between the circles is 0.02 wide
    return Domain(circle(0.5, 0.5, 0.5), (circle(0.68, 0.5, 0.3),), label="eccentric annulus")


def _plate() -> Domain:
    holes = tuple(circle(x, y, 0.11) for x in (0.25, 0.75) for y in (0.25, 0.75))
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    return Domain(square, (*holes, circle(0.5, 0.5, 0.07, 0.12, 0.6)), label="plate with five holes")


def _ell() -> Domain:
    return Domain(np.array([[0, 0], [1, 0], [1, 0.4], [0.4, 0.4], [0.4, 1], [0, 1]], dtype=float), label="L")


def _tee() -> Domain:
    rows = [[0.35, 0], [0.65, 0], [0.65, 0.65], [1, 0.65], [1, 1], [0, 1], [0, 0.65], [0.35, 0.65]]
    return Domain(np.array(rows, dtype=float), label="T")


def _triangle() -> Domain:
    return Domain(np.array([[0.05, 0.05], [0.95, 0.2], [0.35, 0.95]]), label="triangle")


def _star() -> Domain:
    t = np.pi / 2 + np.pi * np.arange(10) / 5
    r = np.where(np.arange(10) % 2 == 0, 0.5, 0.2)
    return Domain(np.column_stack([0.5 + r * np.cos(t), 0.5 + r * np.sin(t)]), label="star")


def _gear() -> Domain:
    t = 2 * np.pi * (np.arange(48) - 0.5) / 48
    r = np.where((np.arange(48) // 2) % 2 == 0, 0.5, 0.4)
    teeth = np.column_stack([0.5 + r * np.cos(t), 0.5 + r * np.sin(t)])
    return Domain(teeth, (circle(0.5, 0.5, 0.15),), label="gear")


def _slot() -> Domain:
    left, right = np.pi / 2 + np.pi * np.arange(65) / 64, -np.pi / 2 + np.pi * np.arange(65) / 64
    ends = [(0.3, left), (0.7, right)]
    rounded = np.vstack([np.column_stack([x + 0.04 * np.cos(t), 0.5 + 0.04 * np.sin(t)]) for x, t in ends])
    return Domain(np.array([[0, 0.2], [1, 0.2], [1, 0.8], [0, 0.8]]), (rounded,), label="plate with a slot")


def _aerofoil() -> Domain:
    """Return a channel around a NACA 0012 section at 8 degrees, chord 0.4, sharp trailing edge."""
    s = 0.5 * (1 - np.cos(np.pi * np.arange(81) / 80))
    half = 0.6 * (0.2969 * np.sqrt(s) - 0.126 * s - 0.3516 * s**2 + 0.2843 * s**3 - 0.1036 * s**4)
    upper, lower = np.column_stack([s, half])[::-1], np.column_stack([s, -half])[1:-1]
    section = 0.4 * np.vstack([upper, lower])
    turn = np.deg2rad(-8.0)
    c, sn = np.cos(turn), np.sin(turn)
    section = section @ np.array([[c, sn], [-sn, c]]) + [0.3, 0.53]
    return Domain(np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float), (section,), label="aerofoil in a channel")


def _comb() -> Domain:
    """Return a comb with five teeth; its gaps are 0.02 wide."""
    rows = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.8]]
    for k in range(4, 0, -1):
        x = 0.2 * k
        rows += [[x + 0.01, 0.8], [x + 0.01, 0.2], [x - 0.01, 0.2], [x - 0.01, 0.8]]
    rows.append([0.0, 0.8])
    return Domain(np.array(rows), label="comb with thin gaps")


def _spiral() -> Domain:
    t = np.linspace(0.0, 4.0 * np.pi, 400)
    inner, outer = 0.06 + 0.028 * t, 0.06 + 0.028 * t + 0.08
    turn = np.column_stack([np.cos(t), np.sin(t)])
    band = np.vstack([outer[:, None] * turn, (inner[:, None] * turn)[::-1]])
    return Domain(0.5 + band, label="spiral channel")


def _wedge() -> Domain:
    """Return a kite with a corner of 15 degrees."""
    half = np.deg2rad(7.5)
    tip = np.array([[0.0, 0.5], [0.85 * np.cos(half), 0.5 - 0.85 * np.sin(half)], [1.0, 0.5]])
    return Domain(np.vstack([tip, [[0.85 * np.cos(half), 0.5 + 0.85 * np.sin(half)]]]), label="wedge of 15 degrees")


def _lines() -> Domain:
    lines = (np.array([[0.2, 0.25], [0.5, 0.6], [0.8, 0.65]]), np.array([[0.25, 0.8], [0.45, 0.85]]))
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    points = np.array([[0.7, 0.3], [0.15, 0.55]])
    return Domain(square, lines=lines, fixed_points=points, label="square with lines and points")


def _regions() -> Domain:
    """Return a square of five regions: a disk, a curved layer across, and a wall from the layer to the top."""
    x = np.linspace(0.0, 1.0, 101)
    layer = np.column_stack([x, 0.55 + 0.08 * np.sin(2 * np.pi * x)])
    disk = circle(0.35, 0.25, 0.15)
    wall = np.array([[0.6, layer[60, 1]], [0.7, 1.0]])
    notch = np.array([[0.0, 0.75], [0.2, 0.75], [0.2, 1.0]])
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    return Domain(square, lines=(layer, np.vstack([disk, disk[:1]]), wall, notch), label="square of five regions")


def _coastline() -> Domain:
    """Return a bay-ridden coast with four islands, drawn from fixed harmonics."""
    rng = np.random.default_rng(5)

    def waves(orders: range, amplitude: float) -> NDArray[np.float64]:
        order = np.array(orders, dtype=float)
        return np.column_stack(
            [order, amplitude / order * rng.uniform(0.4, 1.0, len(order)), rng.uniform(0, 6.28, len(order))]
        )

    shore = _wavy((0.5, 0.5), 0.4, waves(range(2, 16), 0.22), 700)
    centres = (((0.42, 0.6), 0.05), ((0.6, 0.62), 0.035), ((0.55, 0.4), 0.06), ((0.38, 0.42), 0.025))
    islands = tuple(_wavy(centre, radius, waves(range(2, 9), 0.3), 160) for centre, radius in centres)
    return Domain(shore, islands, label="coastline with islands")


SHAPES: dict[str, Callable[[], Domain]] = {
    "square": Domain.unit_square,
    "triangle": _triangle,
    "L": _ell,
    "T": _tee,
    "star": _star,
    "wedge": _wedge,
    "disk": _disk,
    "annulus": _annulus,
    "eccentric": _eccentric,
    "plate": _plate,
    "slot": _slot,
    "gear": _gear,
    "aerofoil": _aerofoil,
    "comb": _comb,
    "spiral": _spiral,
    "lines": _lines,
    "regions": _regions,
    "coastline": _coastline,
}
"""What ``shape`` knows, by name."""
