"""One safeguarded Newton step for one node against the elements around it.

The elements around a node are gathered into the rows of ``star``: the positions of the next, opposite and previous
corner seen from the node, 1 / target^2, and 1 / (longest edge allowed)^2 or 0 where there is no limit.
``law`` is (objective, weight of the edge term).
"""

from __future__ import annotations

import math

from sizeviz.improvement._curve_kernels import curve_frame, curve_shift
from sizeviz.improvement._energy_kernels import (
    corner_terms,
    corner_values,
    delta_squared,
    edge_terms,
    edge_value,
)
from sizeviz.improvement._jit import compiled

ARMIJO = 1e-4
HALVINGS = 8
REACH = 0.5
"""Longest step, over the target size."""
SETTLED = 1e-7
"""A step shorter than this, over the longest, is not taken."""
STAR_COLUMNS = 8


@compiled
def gather(v, patch, inv, bound, star):
    """Copy the elements around node v into ``star``; ``patch`` is (xy, quads, ring, count). Return their number."""
    xy, quads, ring, count = patch
    m = count[v]
    for j in range(m):
        q, k = ring[v, j] >> 2, ring[v, j] & 3
        n, o, p = quads[q, (k + 1) & 3], quads[q, (k + 2) & 3], quads[q, (k + 3) & 3]
        star[j, 0], star[j, 1] = xy[n, 0], xy[n, 1]
        star[j, 2], star[j, 3] = xy[o, 0], xy[o, 1]
        star[j, 4], star[j, 5] = xy[p, 0], xy[p, 1]
        star[j, 6], star[j, 7] = inv[q], bound[q]
    return m


@compiled
def star_terms(star, m, x, y, law, delta2):
    """Return value, gradient and Hessian of the objective with the node at (x, y), and the smallest sigma there."""
    f = gx = gy = xx = yx = yy = 0.0
    low = math.inf
    for j in range(m):
        ax, ay, bx, by = star[j, 0] - x, star[j, 1] - y, star[j, 4] - x, star[j, 5] - y
        t = corner_terms(ax, ay, bx, by, star[j, 2] - x, star[j, 3] - y, star[j, 6], law[0], delta2)
        f, gx, gy, xx, yx, yy = f + t[0], gx + t[1], gy + t[2], xx + t[3], yx + t[4], yy + t[5]
        low = min(low, t[6])
        if law[1] > 0.0 and star[j, 7] > 0.0:
            e = edge_terms(ax, ay, star[j, 7], law[1])
            f, gx, gy, xx, yx, yy = f + e[0], gx + e[1], gy + e[2], xx + e[3], yx + e[4], yy + e[5]
            e = edge_terms(bx, by, star[j, 7], law[1])
            f, gx, gy, xx, yx, yy = f + e[0], gx + e[1], gy + e[2], xx + e[3], yx + e[4], yy + e[5]
    return f, gx, gy, xx, yx, yy, low


@compiled
def star_value(star, m, x, y, law, delta2):
    """Return the objective with the node at (x, y), and the smallest sigma there."""
    f, low = 0.0, math.inf
    for j in range(m):
        ax, ay, bx, by = star[j, 0] - x, star[j, 1] - y, star[j, 4] - x, star[j, 5] - y
        part, least = corner_values(ax, ay, bx, by, star[j, 2] - x, star[j, 3] - y, star[j, 6], law[0], delta2)
        f, low = f + part, min(low, least)
        if law[1] > 0.0 and star[j, 7] > 0.0:
            f += edge_value(ax, ay, star[j, 7], law[1]) + edge_value(bx, by, star[j, 7], law[1])
    return f, low


@compiled
def regular_terms(star, m, x, y, law):
    """Return what ``star_terms`` does with the delta that the smallest sigma asks for, and that delta squared."""
    t = star_terms(star, m, x, y, law, 0.0)
    delta2 = delta_squared(t[6])
    if delta2 > 0.0:
        t = star_terms(star, m, x, y, law, delta2)
    return t, delta2


@compiled
def direction(gx, gy, xx, yx, yy):
    """Return the Newton direction, its Hessian shifted where it is not safely positive definite."""
    half, gap = 0.5 * (xx + yy), 0.5 * (xx - yy)
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
    length, reach = math.sqrt(dx * dx + dy * dy), REACH / math.sqrt(star[0, 6])
    if not length > SETTLED * reach:
        return 0.0
    if length > reach:
        dx, dy = dx * reach / length, dy * reach / length
    slope = ARMIJO * (gx * dx + gy * dy)
    t = 1.0
    for _ in range(HALVINGS):
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
    reach = REACH / math.sqrt(star[0, 6])
    step = reach if bend == 0.0 else min(reach, abs(slope) / abs(bend))
    if not step > SETTLED * reach:
        return 0.0
    if slope > 0.0:
        step = -step
    for _ in range(HALVINGS):
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
