"""Which chord splits a loop best: the cost of Sarrate and Huerta, searched with bounds."""

import math

import numpy as np
from numba import njit

from sizeviz.meshing.decomposition._chord_kernels import chord_count, with_parity
from sizeviz.meshing.decomposition._loop_kernels import TWO_PI, angle_between, clears, worst_corner
from sizeviz.meshing.decomposition._template_kernels import best_case

ANGLE_WEIGHT, LENGTH_WEIGHT, FIT_WEIGHT = 0.5, 0.3, 0.2
"""Weights of the four angles, of the chord's length, and of how well whole elements fit it."""

BALANCE_WEIGHT = 0.05
"""Breaks ties: of chords equally good the one that halves the loop is taken, so that the recursion stays shallow."""

POOR = 0.5
"""A chord that leaves elements whose worst corner is below this costs extra."""

SMALLEST_ANGLE = 0.15
"""Angles, in radians, below which a chord is not considered while there is any other."""

HALF_PI = 0.5 * math.pi


@njit(nogil=True, cache=True)
def angle_cost(i, j, chord, direction, angle, least):
    """Return the deviation of a chord's four angles from pi/2 over 2 pi, or infinity where it leaves the loop."""
    a = angle_between(direction[i], chord)
    b = angle[i] - a
    if a <= least or b <= least:
        return np.inf
    c = angle_between(direction[j], chord + math.pi if chord <= 0.0 else chord - math.pi)
    d = angle[j] - c
    if c <= least or d <= least:
        return np.inf
    return (abs(a - HALF_PI) + abs(b - HALF_PI) + abs(c - HALF_PI) + abs(d - HALF_PI)) / TWO_PI


@njit(nogil=True, cache=True)
def _poor(worst):
    """Return what an element costs whose worst corner is not good: more than any angle where it is inverted."""
    return 0.0 if worst >= POOR else POOR - worst


@njit(nogil=True, cache=True)
def _part_cost(n, xy, i, across, edges):
    """Return what it costs that the part from place i across to the chord's end makes poor elements.

    Only parts of four and six nodes are looked at: nothing will be split there again.
    """
    total = across + edges
    if total == 4:
        return _poor(worst_corner(xy[i], xy[(i + 1) % n], xy[(i + 2) % n], xy[(i + 3) % n]))
    if total != 6:
        return 0.0
    spot = np.empty((8, 2))
    for k in range(across + 1):
        at = (i + k) % n
        spot[k, 0], spot[k, 1] = xy[at, 0], xy[at, 1]
    for k in range(1, edges):
        for d in range(2):
            spot[across + k, d] = spot[across, d] + (spot[0, d] - spot[across, d]) * k / edges
    _, worst = best_case(spot, 3.0)
    return _poor(worst)


@njit(nogil=True, cache=True)
def _try(i, j, across, loop, n, xy, direction, angle, spacing, diameter, sampler, scale, least, clearance, best, found):
    """Return the cost of a chord if it is below ``best``, else ``best``; its ends and edges go to ``found``."""
    if loop[i] == loop[j]:
        return best
    dx, dy = xy[j, 0] - xy[i, 0], xy[j, 1] - xy[i, 1]
    cost = LENGTH_WEIGHT * math.sqrt(dx * dx + dy * dy) / diameter + BALANCE_WEIGHT * abs(1.0 - 2.0 * across / n)
    if cost >= best:
        return best
    cost += ANGLE_WEIGHT * angle_cost(i, j, math.atan2(dy, dx), direction, angle, least)
    if cost >= best:
        return best
    count, hint = chord_count(sampler, scale, xy[i, 0], xy[i, 1], xy[j, 0], xy[j, 1], found[4])
    found[4] = hint
    edges = with_parity(count, across % 2)
    if edges + min(across, n - across) < 4 or (edges == 2 and min(across, n - across) == 2):
        return best
    cost += FIT_WEIGHT * min(abs(1.0 - count / edges), 1.0)
    if cost >= best:
        return best
    cost += _part_cost(n, xy, i, across, edges) + _part_cost(n, xy, j, n - across, edges)
    if cost >= best:
        return best
    if not clears(loop, n, xy, spacing, xy[i, 0], xy[i, 1], xy[j, 0], xy[j, 1], loop[i], loop[j], clearance):
        return best
    found[0], found[1], found[2], found[3] = i, j, edges, across
    return cost


@njit(nogil=True, cache=True)
def best_chord(loop, n, xy, direction, angle, spacing, diameter, sampler, scale, least, clearance, stride, found):
    """Search all pairs of every ``stride``-th node, middle first; return the cost, infinity if nothing is seen."""
    best = np.inf
    half = n // 2
    for back in range(0, half - 1, stride):
        across = half - back
        stop = n if across != n - across else half
        for i in range(0, stop, stride):
            j = i + across
            if j >= n:
                j -= n
            best = _try(i, j, across, loop, n, xy, direction, angle, spacing, diameter, sampler, scale,
                        least, clearance, best, found)  # fmt: skip
    return best


@njit(nogil=True, cache=True)
def refined_chord(
    loop, n, xy, direction, angle, spacing, diameter, sampler, scale, least, clearance, reach, best, found
):
    """Search the pairs within ``reach`` places of the best chord so far."""
    at, across = found[0], found[3]
    for shift in range(-reach, reach + 1):
        for more in range(-reach, reach + 1):
            span = across + more
            if 2 <= span <= n - 2:
                i = (at + shift) % n
                best = _try(i, (i + span) % n, span, loop, n, xy, direction, angle, spacing, diameter, sampler, scale,
                            least, clearance, best, found)  # fmt: skip
    return best
