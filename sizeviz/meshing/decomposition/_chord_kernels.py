"""How many elements a chord asks for, and where its nodes go: the integral of 1/h along it."""

import math

from numba import njit

from sizeviz.sizing._kernels import size_at

STEP = 0.5
"""Length of one step of the integral, in element sizes."""


@njit(nogil=True, cache=True)
def _step_count(length, h0, h1):
    """Return the integral of 1/h over a step on which h is about linear, by Simpson's rule."""
    return length * (1.0 / h0 + 8.0 / (h0 + h1) + 1.0 / h1) / 6.0


@njit(nogil=True, cache=True)
def chord_count(sampler, scale, ax, ay, bx, by, hint):
    """Return the number of elements that the field asks for along a chord, and a hint for the next query."""
    length = math.hypot(bx - ax, by - ay)
    ux, uy = (bx - ax) / length, (by - ay) / length
    h0, hint = size_at(sampler, ax, ay, hint)
    at, total = 0.0, 0.0
    while at < length:
        step = min(STEP * scale * h0, length - at, 0.25 * length)
        if length - at - step < 0.1 * step:
            step = length - at
        at += step
        h1, hint = size_at(sampler, ax + ux * at, ay + uy * at, hint)
        total += _step_count(step, h0, h1)
        h0 = h1
        if step == 0.0:
            break
    return total / scale, hint


@njit(nogil=True, cache=True)
def with_parity(count, parity):
    """Return the number of edges of the given parity whose ratio to ``count`` is nearest to 1."""
    low = int(count)
    if low % 2 != parity:
        low -= 1
    if low < 1:
        return 1 if parity == 1 else 2
    return low if low * (low + 2) >= count * count else low + 2


@njit(nogil=True, cache=True)
def place(sampler, scale, ax, ay, bx, by, edges, points, first, hint):
    """Put ``edges - 1`` nodes on a chord, as many elements of the field between each two; return a hint."""
    count, hint = chord_count(sampler, scale, ax, ay, bx, by, hint)
    length = math.hypot(bx - ax, by - ay)
    ux, uy = (bx - ax) / length, (by - ay) / length
    h0, hint = size_at(sampler, ax, ay, hint)
    at, total, done = 0.0, 0.0, 1
    share = count / edges
    while done < edges and at < length:
        step = min(STEP * scale * h0, length - at, 0.25 * length)
        if length - at - step < 0.1 * step:
            step = length - at
        h1, hint = size_at(sampler, ax + ux * (at + step), ay + uy * (at + step), hint)
        gain = _step_count(step, h0, h1) / scale
        while done < edges and total + gain >= share * done:
            s = at + step * (share * done - total) / gain
            points[first + done - 1, 0] = ax + ux * s
            points[first + done - 1, 1] = ay + uy * s
            done += 1
        at += step
        total += gain
        h0 = h1
    return hint
