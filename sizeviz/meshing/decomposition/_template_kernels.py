"""The case table: how a loop of six nodes becomes two, three or four quadrilaterals, and one of four becomes one.

With b boundary nodes and m nodes inside there are (b - 2) / 2 + m quadrilaterals. A loop of six has eleven cases:
a chord between opposite nodes (3), a node inside joined to every other node (2), two nodes inside, one behind each
of two neighbours (6). Each is laid out and the one whose elements are best is kept.
"""

import math

import numpy as np
from numba import njit

from sizeviz.meshing.decomposition._loop_kernels import worst_corner

N_CASES = 11

SIZE_WEIGHT = 0.15
"""How much a case loses when its number of elements is e times what the field asks for."""

INNER_P, INNER_Q = 6, 7
"""The places, in a case's table, of the nodes inside."""


def _case_table():
    """Return the places of each element's corners, ``(11, 4, 4)``; rows that a case does not have are -1."""
    table = np.full((N_CASES, 4, 4), -1, dtype=np.int8)
    for k in range(3):
        table[k, :2] = [k, k + 1, k + 2, k + 3], [k + 3, (k + 4) % 6, (k + 5) % 6, k]
    for k in range(2):
        table[3 + k, :3] = [[(k + c) % 6, (k + c + 1) % 6, (k + c + 2) % 6, INNER_P] for c in (0, 2, 4)]
    for k in range(6):
        a, b, c, d, e, f = ((k + c) % 6 for c in range(6))
        table[5 + k] = [a, b, INNER_P, f], [b, c, INNER_Q, INNER_P], [c, d, e, INNER_Q], [f, INNER_P, INNER_Q, e]
    return table


CASES = _case_table()


@njit(nogil=True, cache=True)
def inner_nodes(case):
    """Return the number of nodes inside, 0 to 2."""
    return 0 if case < 3 else (1 if case < 5 else 2)


@njit(nogil=True, cache=True)
def lay_out(case, spot):
    """Set rows 6 and 7 of ``spot`` (8, 2), the nodes inside, from rows 0 to 5, the loop."""
    for d in range(2):
        if case < 3:
            continue
        if case < 5:
            k = case - 3
            spot[INNER_P, d] = (spot[k, d] + spot[k + 2, d] + spot[k + 4, d]) / 3.0
        else:
            k = case - 5
            a = spot[(k + 1) % 6, d] + spot[(k + 5) % 6, d]
            b = spot[(k + 2) % 6, d] + spot[(k + 4) % 6, d]
            spot[INNER_P, d] = (3.0 * a + b) / 8.0  # each the mean of its three neighbours
            spot[INNER_Q, d] = (a + 3.0 * b) / 8.0


@njit(nogil=True, cache=True)
def case_score(case, spot, demand):
    """Return how good a case is: its worst element, half its mean, and how well the number of elements fits."""
    lay_out(case, spot)
    worst, total, count = 1.0, 0.0, 2 + inner_nodes(case)
    for e in range(count):
        row = CASES[case, e]
        q = worst_corner(spot[row[0]], spot[row[1]], spot[row[2]], spot[row[3]])
        worst = min(worst, q)
        total += q
    return worst + 0.5 * total / count - SIZE_WEIGHT * abs(math.log(count / demand)), worst


@njit(nogil=True, cache=True)
def best_case(spot, demand):
    """Return the best of the eleven cases and the quality of its worst corner; ``spot`` holds its layout."""
    best, kept, kept_worst = -np.inf, 0, -1.0
    for case in range(N_CASES):
        score, worst = case_score(case, spot, demand)
        if score > best:
            best, kept, kept_worst = score, case, worst
    lay_out(kept, spot)
    return kept, kept_worst
