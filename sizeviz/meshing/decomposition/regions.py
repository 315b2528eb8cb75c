"""The regions that an outline's edges bound: cycles with the region on their left, grouped by what encloses what."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry.domain import signed_area

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Region:
    """A part of the domain without edges inside it.

    Parameters
    ----------
    loops : tuple of (K,) int32
        Nodes: the loop around it first, then those inside it, the region on the left of each. A line that ends
        inside is passed there and back; a point alone is a loop of one.
    """

    loops: tuple[NDArray[np.int32], ...]


def regions(points: NDArray[np.float64], edges: NDArray[np.int32], bounding: NDArray[np.bool_]) -> list[Region]:
    """Return the regions of a planar graph.

    Parameters
    ----------
    points : (N, 2) float64
        Nodes; those without edges are points that the mesh must hold.
    edges : (E, 2) int32
        Edges that meet at nodes only.
    bounding : (E,) bool
        Edges with the domain on their left only; the others have it on both sides.
    """
    cycles = _cycles(points, np.vstack([edges, edges[~bounding][:, ::-1]]))
    areas = np.array([signed_area(points[cycle]) for cycle in cycles])
    alone = np.setdiff1d(np.arange(len(points)), edges).astype(np.int32)
    around = [k for k in np.argsort(areas, kind="stable") if areas[k] > _rounding(points[cycles[k]])]
    inside: dict[int, list[NDArray[np.int32]]] = {int(k): [] for k in around}
    loose = [cycles[k] for k in range(len(cycles)) if k not in inside] + list(alone[:, None])
    for loop in loose:
        home = next((k for k in around if _encloses(points[cycles[k]], points[loop[0]])), None)
        if home is not None:
            inside[int(home)].append(loop)
    return [Region((cycles[k], *inside[k])) for k in sorted(inside)]


def _rounding(loop: NDArray[np.float64]) -> float:
    """Return the area below which a loop encloses nothing: a line passed there and back."""
    return 1e-12 * float(np.hypot(*np.ptp(loop, axis=0))) ** 2


def _cycles(points: NDArray[np.float64], halves: NDArray[np.int32]) -> list[NDArray[np.int32]]:
    """Return the closed walks that turn as far left as they can at every node."""
    leaving: dict[int, list[int]] = {}
    for k, tail in enumerate(halves[:, 0].tolist()):
        leaving.setdefault(tail, []).append(k)
    heading = np.arctan2(*(points[halves[:, 1]] - points[halves[:, 0]]).T[::-1])
    left = np.ones(len(halves), dtype=bool)
    cycles = []
    for start in range(len(halves)):
        cycle, k = [], start
        while left[k]:
            left[k] = False
            cycle.append(int(halves[k, 0]))
            k = _next(k, halves, heading, leaving[int(halves[k, 1])])
        if cycle:
            cycles.append(np.array(cycle, dtype=np.int32))
    return cycles


def _next(k: int, halves: NDArray[np.int32], heading: NDArray[np.float64], choices: Sequence[int]) -> int:
    """Return the edge that leaves next, clockwise from where edge k came from; straight back only if nothing else."""
    if len(choices) == 1:
        return choices[0]
    back = heading[k] + np.pi
    tail = halves[k, 0]
    return min(choices, key=lambda j: 7.0 if halves[j, 1] == tail else float((back - heading[j]) % (2 * np.pi)))


def _encloses(loop: NDArray[np.float64], point: NDArray[np.float64]) -> bool:
    """Whether a point lies inside a loop."""
    a, b = loop, np.roll(loop, -1, axis=0)
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[spans], b[spans]
    crossing = a[:, 0] + (point[1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return bool(np.count_nonzero(crossing > point[0]) % 2)
