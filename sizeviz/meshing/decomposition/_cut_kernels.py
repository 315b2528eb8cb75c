"""Where a cut joins a hole to the loop around it."""

import math

import numpy as np
from numba import njit

from sizeviz.meshing.decomposition._choice_kernels import ANGLE_WEIGHT, LENGTH_WEIGHT, angle_cost
from sizeviz.meshing.decomposition._loop_kernels import clears


@njit(nogil=True, cache=True)
def _clear_of_all(ids, starts, xy, spacing, a, b, clearance):
    for k in range(len(starts) - 1):
        s, e = starts[k], starts[k + 1]
        if not clears(ids[s:e], e - s, xy[s:e], spacing[s:e], xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1],
                      ids[a], ids[b], clearance):  # fmt: skip
            return False
    return True


@njit(nogil=True, cache=True)
def best_cut(ids, starts, xy, direction, angle, spacing, diameter, stride, clearance):
    """Return the places, in loop 0 and in another loop, that the cheapest visible cut joins; -1 where there is none.

    Parameters
    ----------
    ids : (N,) int32
        Nodes of all loops, one loop after the other; row k of the other arrays belongs to ``ids[k]``.
    starts : (L + 1,) int64
        Where each loop begins.
    """
    best, kept_a, kept_b = np.inf, -1, -1
    for b in range(starts[1], len(ids)):
        for a in range(b % stride, starts[1], stride):
            dx, dy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
            cost = LENGTH_WEIGHT * math.sqrt(dx * dx + dy * dy) / diameter
            if cost >= best:
                continue
            cost += ANGLE_WEIGHT * angle_cost(a, b, math.atan2(dy, dx), direction, angle, 1e-9)
            if cost < best and _clear_of_all(ids, starts, xy, spacing, a, b, clearance):
                best, kept_a, kept_b = cost, a, b
    return kept_a, kept_b
