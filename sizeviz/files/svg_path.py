"""SVG path data to points: every command of SVG 1.1 section 8.3, curves sampled to a tolerance."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import check_nodes, one_line

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TOKEN = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])|([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|([\s,]+)|(.)", re.DOTALL)
_ARGUMENTS = {"M": 2, "Z": 0, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7}
_MOST_TURN = np.deg2rad(12.0)
"""A sampled curve turns by less than this at each sample, well below what counts as a corner."""

_DOUBLINGS = 6
"""How often the samples are doubled to turn less; a cusp stays one however often."""

_MOST_STRETCH = 1e6
"""How much larger than the other radius, and than the distance of its ends, an arc's radius may be."""

_MAX_SAMPLES = 20_000
_MAX_COMMANDS = 500_000

Points = list["NDArray[np.complex128]"]


def subpaths(text: str, flatness: float) -> list[NDArray[np.complex128]]:
    """Return the subpaths of an SVG path, each as complex numbers x + iy, closed or not.

    Parameters
    ----------
    text : str
        The attribute ``d``.
    flatness : float
        How far a chord may lie from its curve, in the path's own units.

    Raises
    ------
    InputError
        If the text is not a path.
    """
    pen = _Pen(flatness)
    for command, arguments in _commands(text):
        pen.draw(command, arguments)
    return pen.finished()


def bezier(control: NDArray[np.complex128], flatness: float) -> NDArray[np.complex128]:
    """Return points along a Bezier curve after its first control point, evenly spaced in the parameter.

    Their number is Wang's bound (Wang 1984; Filip, Magedson, Markot 1986, DOI 10.1016/0167-8396(86)90005-1).
    """
    degree = len(control) - 1
    bend = float(np.abs(np.diff(control, 2)).max())
    n = int(np.clip(np.ceil(np.sqrt(degree * (degree - 1) * bend / (8.0 * flatness))), 1, _MAX_SAMPLES))
    points = _along(control, n)
    for _ in range(_DOUBLINGS):
        if (n == 1 and bend == 0) or largest_turn(points) < _MOST_TURN or 2 * n > _MAX_SAMPLES:
            break
        n *= 2
        points = _along(control, n)
    return points[1:]


def largest_turn(points: NDArray[np.complex128]) -> float:
    """Return the largest change of direction at an inner point of a polyline, in radians."""
    steps = np.diff(points)
    steps = steps[steps != 0]
    return float(np.abs(np.angle(steps[1:] * np.conj(steps[:-1]))).max(initial=0.0)) if len(steps) > 1 else np.pi


def _along(control: NDArray[np.complex128], n: int) -> NDArray[np.complex128]:
    """Return n + 1 points of a Bezier curve by de Casteljau's construction, its ends exactly."""
    t = np.arange(n + 1) / n
    rows = np.repeat(control[:, None], n + 1, axis=1)
    while len(rows) > 1:
        rows = (1.0 - t) * rows[:-1] + t * rows[1:]
    rows[0, 0], rows[0, -1] = control[0], control[-1]
    return rows[0]


def arc(
    start: complex, radii: tuple[float, float], tilt: float, large: bool, sweep: bool, stop: complex, flatness: float
) -> NDArray[np.complex128]:
    """Return points along an elliptic arc after its start (SVG 1.1, appendix F.6.5 and F.6.6).

    Parameters
    ----------
    start, stop : complex
        Its ends.
    radii : tuple of float
        Half axes; enlarged where they cannot reach.
    tilt : float
        Angle of the first axis, in degrees.
    large, sweep : bool
        Which of the four arcs.
    flatness : float
        How far a chord may lie from the arc.
    """
    rx, ry = abs(radii[0]), abs(radii[1])
    if rx == 0 or ry == 0 or start == stop:
        return np.array([stop])
    if not max(rx, ry) <= _MOST_STRETCH * min(rx, ry, abs(start - stop)):
        raise InputError(f"an arc of radii {rx:g} and {ry:g} is too long for its ends; draw it as a line")
    turn = np.exp(1j * np.deg2rad(tilt))
    half = (start - stop) / 2 / turn
    reach = np.hypot(half.real / rx, half.imag / ry)
    if reach > 1:
        rx, ry = rx * reach, ry * reach
    unit = complex(half.real / rx, half.imag / ry)
    height = np.sqrt(max(1.0 / max(abs(unit) ** 2, 1e-300) - 1.0, 0.0))
    centre = unit * height * 1j * (1 if large == sweep else -1)
    first, last = np.angle(unit - centre), np.angle(-unit - centre)
    if sweep:
        angle = (last - first) % (2 * np.pi)
    else:
        angle = -((first - last) % (2 * np.pi))
    step = 2 * np.arccos(max(1.0 - flatness / max(rx, ry), -1.0))
    n = int(np.clip(np.ceil(abs(angle) / min(max(step, 1e-6), _MOST_TURN)), 1, _MAX_SAMPLES))
    around = first + angle * np.arange(1, n + 1) / n
    middle = (start + stop) / 2 + turn * complex(centre.real * rx, centre.imag * ry)
    points: NDArray[np.complex128] = middle + turn * (rx * np.cos(around) + 1j * ry * np.sin(around))
    points[-1] = stop
    return points


class _Pen:
    """Where the path has come to."""

    def __init__(self, flatness: float) -> None:
        self._flatness = flatness
        self._done: Points = []
        self._parts: Points = []
        self._count = 0
        self.at = self._start = 0j
        self._mirror = 0j
        self._before = ""

    def draw(self, command: str, arguments: list[float]) -> None:
        """Carry out one command."""
        kind = command.upper()
        origin = self.at if command.islower() else 0j
        pairs = np.array(arguments[0::2]) + 1j * np.array(arguments[1::2]) + origin if kind in "MLCSQT" else None
        if kind == "M":
            assert pairs is not None
            self._lift()
            self.at = self._start = complex(pairs[0])
        elif kind == "Z":
            self._add(np.array([self._start]))
            self._lift()
        elif kind in "HV":
            self._add(np.array([self._straight(kind, arguments[0], origin)]))
        elif kind == "A":
            rx, ry, tilt, large, sweep, x, y = arguments
            stop = complex(x, y) + origin
            self._add(arc(self.at, (rx, ry), tilt, large != 0, sweep != 0, stop, self._flatness))
        elif pairs is not None:
            self._curve(kind, pairs)
        self._before = kind

    def finished(self) -> Points:
        """Return the subpaths drawn."""
        self._lift()
        return self._done

    def _straight(self, kind: str, value: float, origin: complex) -> complex:
        return complex(value + origin.real, self.at.imag) if kind == "H" else complex(self.at.real, value + origin.imag)

    def _curve(self, kind: str, pairs: NDArray[np.complex128]) -> None:
        if kind == "L":
            self._add(pairs)
            return
        if kind in "ST":
            related = "CS" if kind == "S" else "QT"
            first = 2 * self.at - self._mirror if self._before and self._before in related else self.at
            pairs = np.concatenate([[first], pairs])
        self._mirror = complex(pairs[-2])
        self._add(bezier(np.concatenate([[self.at], pairs]), self._flatness))

    def _add(self, points: NDArray[np.complex128]) -> None:
        if not self._parts:
            self._parts.append(np.array([self.at]))
        self._parts.append(points)
        self._count += len(points)
        check_nodes(self._count, "samples of curves", 1_000_000)
        self.at = complex(points[-1])

    def _lift(self) -> None:
        if self._parts:
            self._done.append(np.concatenate(self._parts))
        self._parts = []
        self.at = self._start


def _commands(text: str) -> list[tuple[str, list[float]]]:
    """Split path data into commands, each with the arguments of one repetition."""
    found: list[tuple[str, list[float]]] = []
    command, waiting = "", list[float]()
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        assert match is not None  # its last alternative is any character
        letter, number, _, other = match.groups()
        position = match.end()
        if command in "Aa" and command and number and len(waiting) in (3, 4) and number[0] in "01":
            number, position = number[0], match.start() + 1  # flags may be written without a blank after them
        if other or (letter and waiting) or (number and not command):
            raise InputError(f"its path data cannot be read at {one_line(text[match.start() : position + 20], 40)!r}")
        if letter:
            command = letter
            if letter in "Zz":
                found.append((letter, []))
        elif number:
            waiting.append(float(number))
            if command in "Zz":
                raise InputError("its path data have numbers after Z; the file is corrupt")
            if len(waiting) == _ARGUMENTS[command.upper()]:
                found.append((command, waiting))
                waiting = []
                command = {"M": "L", "m": "l"}.get(command, command)
        check_nodes(len(found), "path commands", _MAX_COMMANDS)
    if waiting:
        raise InputError("its path data end within a command; the file is cut or corrupt")
    if found and found[0][0] not in "Mm":
        raise InputError("its path data do not begin with M; the file is corrupt")
    return found
