"""The recursion without recursion: a stack of loops, each taken off, split in two or turned into quadrilaterals."""

import numpy as np
from numba import njit

from sizeviz.meshing.decomposition._choice_kernels import SMALLEST_ANGLE, best_chord, refined_chord
from sizeviz.meshing.decomposition._chord_kernels import place
from sizeviz.meshing.decomposition._loop_kernels import extent, loop_area, unpack, work_arrays
from sizeviz.meshing.decomposition._template_kernels import CASES, best_case, inner_nodes
from sizeviz.sizing._kernels import size_at

N_LOOPS, TOP, N_POINTS, N_QUADS, HINT, STATE_SIZE = 0, 1, 2, 3, 4, 5
"""Slots of the state: loops on the stack, entries in it, nodes, quadrilaterals, the field's hint."""

DONE, PAUSED, FULL, STUCK = 0, 1, 2, 3
"""Why the kernel returned: nothing left, budget spent, arrays too small, a loop that no chord splits."""

LARGEST_SEARCH = 256
"""Loops longer than this are searched by every few nodes first, then around the best chord."""

MOST_DEMAND = 4.0
"""A loop of four or six that asks for more than this many times the elements it would get is split once more."""


@njit(nogil=True, cache=True)
def _demand(n, xy, area, sampler, scale, hint):
    """Return about how many elements the field asks for inside a small loop."""
    x, y = 0.0, 0.0
    for i in range(n):
        x += xy[i, 0] / n
        y += xy[i, 1] / n
    h, hint = size_at(sampler, x, y, hint)
    total = 1.0 / (h * h)
    for i in range(n):
        h, hint = size_at(sampler, 0.5 * (x + xy[i, 0]), 0.5 * (y + xy[i, 1]), hint)
        total += 1.0 / (h * h)
    return area * total / ((n + 1) * scale * scale), hint


@njit(nogil=True, cache=True)
def _finish(loop, n, xy, demand, points, quads, state):
    """Turn a loop of four or six nodes into quadrilaterals."""
    at, first = state[N_QUADS], state[N_POINTS]
    if n == 4:
        for c in range(4):
            quads[at, c] = loop[c]
        state[N_QUADS] += 1
        return
    spot = np.empty((8, 2))
    for k in range(6):
        spot[k, 0], spot[k, 1] = xy[k, 0], xy[k, 1]
    case, _ = best_case(spot, max(demand, 1.0))
    inside = inner_nodes(case)
    for m in range(inside):
        points[first + m, 0], points[first + m, 1] = spot[6 + m, 0], spot[6 + m, 1]
    for e in range(2 + inside):
        for c in range(4):
            k = CASES[case, e, c]
            quads[at + e, c] = loop[k] if k < 6 else first + k - 6
    state[N_QUADS] += 2 + inside
    state[N_POINTS] += inside


@njit(nogil=True, cache=True)
def _choose(loop, n, xy, direction, angle, spacing, sampler, scale, found):
    """Find the chord; the demands on its clearance and angles are dropped one by one until there is one."""
    diameter = extent(n, xy)
    stride = (n + LARGEST_SEARCH - 1) // LARGEST_SEARCH
    best = np.inf
    for attempt in range(3):
        least = SMALLEST_ANGLE if attempt < 2 else 1e-9
        clearance = 0.3 if attempt == 0 else 0.0
        best = best_chord(loop, n, xy, direction, angle, spacing, diameter, sampler, scale, least, clearance,
                          stride, found)  # fmt: skip
        if best < np.inf:
            break
    if best < np.inf and stride > 1:
        best = refined_chord(loop, n, xy, direction, angle, spacing, diameter, sampler, scale, least, clearance,
                             min(2 * stride, 64), best, found)  # fmt: skip
    return best


@njit(nogil=True, cache=True)
def _push_parts(loop, n, found, stack, heads, state, first):
    """Put the two parts on the stack; the chord's inner nodes are ``first`` and those after it, from end to end."""
    i, across, inner = found[0], found[3], found[2] - 1
    top = state[TOP]
    heads[state[N_LOOPS]] = top
    for k in range(across + 1):
        stack[top + k] = loop[(i + k) % n]
    top += across + 1
    for k in range(inner):
        stack[top + k] = first + inner - 1 - k
    top += inner
    heads[state[N_LOOPS] + 1] = top
    for k in range(n - across + 1):
        stack[top + k] = loop[(i + across + k) % n]
    top += n - across + 1
    for k in range(inner):
        stack[top + k] = first + k
    state[TOP] = top + inner
    state[N_LOOPS] += 2
    heads[state[N_LOOPS]] = state[TOP]


@njit(nogil=True, cache=True)
def _split(loop, n, xy, found, sampler, scale, stack, heads, points, state):
    """Put the chosen chord's nodes in place and push both parts."""
    i, j, edges = found[0], found[1], found[2]
    first = state[N_POINTS]
    state[HINT] = place(sampler, scale, xy[i, 0], xy[i, 1], xy[j, 0], xy[j, 1], edges, points, first, state[HINT])
    state[N_POINTS] += edges - 1
    _push_parts(loop, n, found, stack, heads, state, first)


@njit(nogil=True, cache=True)
def _take(start, state):
    """Take the topmost loop off the stack."""
    state[N_LOOPS] -= 1
    state[TOP] = start


@njit(nogil=True, cache=True)
def _one_loop(n, start, loop, xy, direction, angle, spacing, found, sampler, scale, stack, heads, points, quads, state,
              finished):  # fmt: skip
    """Finish or split the topmost loop; return DONE, or why it was left where it is."""
    if len(points) - state[N_POINTS] < 2 or len(quads) - state[N_QUADS] < 4:
        return FULL
    demand, area = 0.0, 0.0
    if n <= 6:
        area = loop_area(n, xy)
        demand, state[HINT] = _demand(n, xy, area, sampler, scale, state[HINT])
    if n > 6 or demand > MOST_DEMAND * (n // 2):
        found[4] = state[HINT]
        if _choose(loop, n, xy, direction, angle, spacing, sampler, scale, found) < np.inf:
            inner = found[2] - 1
            room = min(len(points) - state[N_POINTS] - inner, len(stack) - start - n - 2 - 2 * inner)
            if room < 0 or len(heads) < state[N_LOOPS] + 2:
                return FULL
            _take(start, state)
            _split(loop, n, xy, found, sampler, scale, stack, heads, points, state)
            return DONE
        if n > 6:
            return STUCK
    _take(start, state)
    _finish(loop, n, xy, demand, points, quads, state)
    finished[0] += area
    return DONE


@njit(nogil=True, cache=True)
def decompose(budget, sampler, scale, stack, heads, points, quads, state, finished):
    """Work on the stack until about ``budget`` node pairs have been looked at; return why it stopped."""
    room, spent = 256, 0
    loop, xy, direction, angle, spacing = work_arrays(room)
    found = np.zeros(5, dtype=np.int64)
    while state[N_LOOPS] > 0:
        if spent > budget:
            return PAUSED
        start = heads[state[N_LOOPS] - 1]
        n = state[TOP] - start
        if n > room:
            room = 2 * n
            loop, xy, direction, angle, spacing = work_arrays(room)
        for k in range(n):  # slices assigned to slices compile slowly
            loop[k] = stack[start + k]
        unpack(loop, n, points, xy, direction, angle, spacing)
        outcome = _one_loop(n, start, loop, xy, direction, angle, spacing, found, sampler, scale, stack, heads, points,
                            quads, state, finished)  # fmt: skip
        if outcome != DONE:
            return outcome
        spent += 20 + min(n, LARGEST_SEARCH) ** 2 // 2
    return DONE
