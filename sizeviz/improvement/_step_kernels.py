"""One safeguarded Newton step for one node against the elements around it, as ``_star_kernels`` gathers them."""

from __future__ import annotations

import math

from sizeviz.improvement._curve_kernels import curve_frame, curve_shift
from sizeviz.improvement._energy_kernels import delta_squared
from sizeviz.improvement._jit import compiled, inlined
from sizeviz.improvement._star_kernels import INV, gather, star_terms, star_value

ARMIJO = 1e-4
SHORTEST = 0.005
"""A step that lowers nothing is halved until less than this share of it is left."""
REACH = 0.5
"""Longest step, over the target size."""
SETTLED = 1e-7
"""A step shorter than this, over the longest, is not taken."""
SURE = 0.02
"""A step shorter than this, over the longest, is taken without looking whether it lowers the objective."""
SAFE = 0.25
"""Smallest sigma at which that is allowed: an ideal corner has 1."""
STIRRED = 3e-5
"""Decrease of the objective, that of a move by a few thousandths of the target size, which the neighbours feel."""


@compiled
def regular_terms(star, m, x, y, law):
    """Return what ``star_terms`` does with the delta that the smallest sigma asks for, and that delta squared."""
    t = star_terms(star, m, x, y, law, 0.0)
    delta2 = delta_squared(t[6])
    if delta2 > 0.0:
        t = star_terms(star, m, x, y, law, delta2)
    return t, delta2


@inlined
def direction(gx, gy, xx, yx, yy):
    """Return the Newton direction, its Hessian shifted where it is not safely positive definite."""
    trace, det = xx + yy, xx * yy - yx * yx
    if trace > 0.0 and det > 2e-3 * trace * trace:
        scale = 1.0 / det
        return (yx * gy - yy * gx) * scale, (yx * gx - xx * gy) * scale
    half, gap = 0.5 * trace, 0.5 * (xx - yy)
    radius = math.sqrt(gap * gap + yx * yx)
    least, most = half - radius, max(abs(half - radius), abs(half + radius))
    if most <= 0.0:
        return 0.0, 0.0
    if least < 1e-3 * most:
        shift = 1e-3 * most - least if least > 0.0 else 0.1 * most - least
        xx, yy = xx + shift, yy + shift
    scale = 1.0 / (xx * yy - yx * yx)
    return (yx * gy - yy * gx) * scale, (yx * gx - xx * gy) * scale


@compiled
def free_step(v, xy, star, m, law):
    """Move an inner node by one Newton step that lowers the objective; return by how much."""
    x, y = xy[v, 0], xy[v, 1]
    (f, gx, gy, xx, yx, yy, low), delta2 = regular_terms(star, m, x, y, law)
    dx, dy = direction(gx, gy, xx, yx, yy)
    # how far the step goes, over the longest, squared
    far = (dx * dx + dy * dy) * star[INV] * (1.0 / (REACH * REACH))
    if not far > SETTLED * SETTLED:
        return 0.0
    if far < SURE * SURE and low > SAFE and not law[1] > 0.0:
        # so near that the quadratic model is as good as the objective
        xy[v, 0], xy[v, 1] = x + dx, y + dy
        return -0.5 * (gx * dx + gy * dy)
    if far > 1.0:
        shrink = 1.0 / math.sqrt(far)
        dx, dy, far = dx * shrink, dy * shrink, 1.0
    slope = ARMIJO * (gx * dx + gy * dy)
    t, shortest = 1.0, SHORTEST * far
    while t * far > shortest:
        trial, least = star_value(star, m, x + t * dx, y + t * dy, law, delta2)
        if trial <= f + t * slope and (least > 0.0 or low <= 0.0):
            xy[v, 0], xy[v, 1] = x + t * dx, y + t * dy
            return f - trial
        t *= 0.5
    return 0.0


@compiled
def slide_step(v, xy, star, m, law, curves, c, station):
    """Move a node along curve c by one Newton step that lowers the objective; return by how much."""
    s = station[v]
    x, y, tx, ty = curve_frame(curves, c, s)
    (f, gx, gy, xx, yx, yy, low), delta2 = regular_terms(star, m, x, y, law)
    slope = gx * tx + gy * ty
    bend = xx * tx * tx + 2.0 * yx * tx * ty + yy * ty * ty
    reach = REACH / math.sqrt(star[INV])
    step = reach if bend == 0.0 else min(reach, abs(slope) / abs(bend))
    if not step > SETTLED * reach:
        return 0.0
    if slope > 0.0:
        step = -step
    shortest = SHORTEST * abs(step)
    while abs(step) > shortest:
        there = curve_shift(curves, c, s, step)
        x, y, tx, ty = curve_frame(curves, c, there)
        trial, least = star_value(star, m, x, y, law, delta2)
        if trial < f and (least > 0.0 or low <= 0.0):
            xy[v, 0], xy[v, 1], station[v] = x, y, there
            return f - trial
        step *= 0.5
    return 0.0


@compiled
def node_step(v, patch, inv, bound, law, rails, star):
    """Take the step that node v is allowed and return the objective's decrease.

    ``rails`` is (curves, slide, station); slide is -1 for a free node, -2 for one that never moves, else its curve.
    """
    kind = rails[1][v]
    if kind < -1 or patch[3][v] == 0:
        return 0.0
    m = gather(v, patch, inv, bound, star)
    if kind == -1:
        return free_step(v, patch[0], star, m, law)
    return slide_step(v, patch[0], star, m, law, rails[0], kind, rails[2])


@compiled
def wake(v, patch, awake):
    """Mark node v and those of the elements around it, which have reason to move again."""
    _, quads, ring, count = patch
    for j in range(count[v]):
        q = ring[v, j] >> 2
        for k in range(4):
            awake[quads[q, k]] = True
