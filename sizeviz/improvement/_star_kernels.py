"""The elements around one node, and the objective over them.

They are gathered into the lanes of ``star``, four to a group of ``GROUP`` numbers: the positions of the next, opposite
and previous corner seen from the node, 1 / target^2, and 1 / (longest edge allowed)^2 or 0 where there is no limit.
A group is worked on as a whole, which compiles to vector instructions; lanes beyond the last element repeat it, with
weight 0. ``law`` is (objective, weight of the edge term).
"""

from __future__ import annotations

import math

from sizeviz.improvement._energy_kernels import (
    RECIPROCAL,
    corner_terms,
    corner_values,
    edge_terms,
    edge_value,
)
from sizeviz.improvement._jit import compiled, inlined

GROUP = 64
"""Numbers of a group: 9 for each of 4 lanes, then 7 results for each."""
N_X, N_Y, O_X, O_Y, P_X, P_Y, INV, WEIGHT, BOUND = 0, 4, 8, 12, 16, 20, 24, 28, 32
"""Where the first lane of each number begins; WEIGHT is INV, but 0 in lanes without an element."""
VALUE, G_X, G_Y, H_XX, H_YY, H_YX, LOW = 36, 40, 44, 48, 52, 56, 60


@compiled
def star_size(valence):
    """Return the length of a ``star`` for nodes with that many elements."""
    return GROUP * ((valence + 3) // 4)


@inlined
def lane(j):
    """Return the place of element j of a star."""
    return ((j >> 2) << 6) + (j & 3)


@inlined
def gather(v, patch, inv, bound, star):
    """Copy the elements around node v into ``star``; ``patch`` is (xy, quads, ring, count). Return their number."""
    xy, quads, ring, count = patch
    m = count[v]
    for j in range(m):
        q, k = ring[v, j] >> 2, ring[v, j] & 3
        n, o, p = quads[q, (k + 1) & 3], quads[q, (k + 2) & 3], quads[q, (k + 3) & 3]
        i = lane(j)
        star[i + N_X], star[i + N_Y] = xy[n, 0], xy[n, 1]
        star[i + O_X], star[i + O_Y] = xy[o, 0], xy[o, 1]
        star[i + P_X], star[i + P_Y] = xy[p, 0], xy[p, 1]
        star[i + INV], star[i + WEIGHT], star[i + BOUND] = inv[q], inv[q], bound[q]
    for j in range(m, (m + 3) & ~3):
        i, last = lane(j), lane(m - 1)
        for k in range(9):
            star[i + 4 * k] = star[last + 4 * k]
        star[i + WEIGHT] = 0.0
    return m


@inlined
def group_terms(star, first, x, y):
    """Write the results of the lanes of a group for the reciprocal objective without delta and edge term.

    Of each element three corners change: the node's own (0), the next one's (1) and the previous one's (3). A corner
    adds n g with g = (1 + 1 / sigma^2) / 4. No call and no branch: this is where most of the time goes.
    """
    for j in range(4):
        i = first + j
        inv, weight = star[i + INV], star[i + WEIGHT]
        ax, ay, bx, by = star[i + N_X] - x, star[i + N_Y] - y, star[i + P_X] - x, star[i + P_Y] - y
        cx, cy = star[i + O_X] - x, star[i + O_Y] - y
        ux, uy, vx, vy = cx - ax, cy - ay, cx - bx, cy - by
        a2, b2 = ax * ax + ay * ay, bx * bx + by * by
        n0, n1, n3 = (a2 + b2) * weight, (a2 + ux * ux + uy * uy) * weight, (b2 + vx * vx + vy * vy) * weight
        s0, s1, s3 = (ax * by - ay * bx) * inv, (ax * cy - ay * cx) * inv, (cx * by - cy * bx) * inv
        r0, r1, r3 = 1.0 / s0, 1.0 / s1, 1.0 / s3
        q0, q1, q3 = r0 * r0, r1 * r1, r3 * r3
        # g, and its first derivative and n times the second
        g0, g1, g3 = 0.25 + 0.25 * q0, 0.25 + 0.25 * q1, 0.25 + 0.25 * q3
        d0, d1, d3 = -0.5 * q0 * r0, -0.5 * q1 * r1, -0.5 * q3 * r3
        e0, e1, e3 = 1.5 * n0 * q0 * q0, 1.5 * n1 * q1 * q1, 1.5 * n3 * q3 * q3
        # the gradients of n over -2, and of sigma
        m0x, m0y, m1x, m1y = (ax + bx) * weight, (ay + by) * weight, ax * weight, ay * weight
        m3x, m3y = bx * weight, by * weight
        t0x, t0y, t1x, t1y = (ay - by) * inv, (bx - ax) * inv, -uy * inv, ux * inv
        t3x, t3y = vy * inv, -vx * inv
        k0, k1, k3 = n0 * d0, n1 * d1, n3 * d3
        flat = weight * (4.0 * g0 + 2.0 * g1 + 2.0 * g3)
        star[i + VALUE] = n0 * g0 + n1 * g1 + n3 * g3
        star[i + G_X] = k0 * t0x + k1 * t1x + k3 * t3x - 2.0 * (m0x * g0 + m1x * g1 + m3x * g3)
        star[i + G_Y] = k0 * t0y + k1 * t1y + k3 * t3y - 2.0 * (m0y * g0 + m1y * g1 + m3y * g3)
        cross = d0 * m0x * t0x + d1 * m1x * t1x + d3 * m3x * t3x
        star[i + H_XX] = flat - 4.0 * cross + e0 * t0x * t0x + e1 * t1x * t1x + e3 * t3x * t3x
        cross = d0 * m0y * t0y + d1 * m1y * t1y + d3 * m3y * t3y
        star[i + H_YY] = flat - 4.0 * cross + e0 * t0y * t0y + e1 * t1y * t1y + e3 * t3y * t3y
        cross = d0 * (m0x * t0y + m0y * t0x) + d1 * (m1x * t1y + m1y * t1x) + d3 * (m3x * t3y + m3y * t3x)
        star[i + H_YX] = e0 * t0x * t0y + e1 * t1x * t1y + e3 * t3x * t3y - 2.0 * cross
        star[i + LOW] = min(s0, min(s1, s3))


@compiled
def plain_terms(star, m, x, y):
    """Return what ``star_terms`` does for the reciprocal objective without delta and edge term."""
    f = gx = gy = xx = yx = yy = 0.0
    low = math.inf
    for first in range(0, GROUP * ((m + 3) >> 2), GROUP):
        group_terms(star, first, x, y)
        for i in range(first, first + 4):
            f, gx, gy = f + star[i + VALUE], gx + star[i + G_X], gy + star[i + G_Y]
            xx, yx, yy = xx + star[i + H_XX], yx + star[i + H_YX], yy + star[i + H_YY]
            low = min(low, star[i + LOW])
    return f, gx, gy, xx, yx, yy, low


@compiled
def star_terms(star, m, x, y, law, delta2):
    """Return value, gradient and Hessian of the objective with the node at (x, y), and the smallest sigma there."""
    f = gx = gy = xx = yx = yy = 0.0
    low = math.inf
    if law[0] == RECIPROCAL and delta2 <= 0.0:
        f, gx, gy, xx, yx, yy, low = plain_terms(star, m, x, y)
    else:
        for j in range(m):
            i = lane(j)
            ax, ay, bx, by = star[i + N_X] - x, star[i + N_Y] - y, star[i + P_X] - x, star[i + P_Y] - y
            t = corner_terms(ax, ay, bx, by, star[i + O_X] - x, star[i + O_Y] - y, star[i + INV], law[0], delta2)
            f, gx, gy, xx, yx, yy = f + t[0], gx + t[1], gy + t[2], xx + t[3], yx + t[4], yy + t[5]
            low = min(low, t[6])
    if law[1] > 0.0:
        for j in range(m):
            i = lane(j)
            if star[i + BOUND] > 0.0:
                for k in (N_X, P_X):
                    e = edge_terms(star[i + k] - x, star[i + k + 4] - y, star[i + BOUND], law[1])
                    f, gx, gy, xx, yx, yy = f + e[0], gx + e[1], gy + e[2], xx + e[3], yx + e[4], yy + e[5]
    return f, gx, gy, xx, yx, yy, low


@inlined
def group_values(star, first, x, y):
    """Write value and smallest sigma of the lanes of a group, as ``group_terms`` does."""
    for j in range(4):
        i = first + j
        inv = star[i + INV]
        ax, ay, bx, by = star[i + N_X] - x, star[i + N_Y] - y, star[i + P_X] - x, star[i + P_Y] - y
        cx, cy = star[i + O_X] - x, star[i + O_Y] - y
        ux, uy, vx, vy = cx - ax, cy - ay, cx - bx, cy - by
        a2, b2 = ax * ax + ay * ay, bx * bx + by * by
        s0, s1, s3 = (ax * by - ay * bx) * inv, (ax * cy - ay * cx) * inv, (cx * by - cy * bx) * inv
        r0, r1, r3 = 1.0 / s0, 1.0 / s1, 1.0 / s3
        part = (a2 + b2) * (0.25 + 0.25 * r0 * r0)
        part += (a2 + ux * ux + uy * uy) * (0.25 + 0.25 * r1 * r1)
        part += (b2 + vx * vx + vy * vy) * (0.25 + 0.25 * r3 * r3)
        star[i + VALUE] = part * star[i + WEIGHT]
        star[i + LOW] = min(s0, min(s1, s3))


@compiled
def plain_value(star, m, x, y):
    """Return what ``star_value`` does for the reciprocal objective without delta and edge term."""
    f, low = 0.0, math.inf
    for first in range(0, GROUP * ((m + 3) >> 2), GROUP):
        group_values(star, first, x, y)
        for i in range(first, first + 4):
            f, low = f + star[i + VALUE], min(low, star[i + LOW])
    return f if low > 0.0 else math.inf, low


@compiled
def star_value(star, m, x, y, law, delta2):
    """Return the objective with the node at (x, y), and the smallest sigma there."""
    f, low = 0.0, math.inf
    if law[0] == RECIPROCAL and delta2 <= 0.0:
        f, low = plain_value(star, m, x, y)
    else:
        for j in range(m):
            i = lane(j)
            ax, ay, bx, by = star[i + N_X] - x, star[i + N_Y] - y, star[i + P_X] - x, star[i + P_Y] - y
            c = corner_values(ax, ay, bx, by, star[i + O_X] - x, star[i + O_Y] - y, star[i + INV], law[0], delta2)
            f, low = f + c[0], min(low, c[1])
    if law[1] > 0.0:
        for j in range(m):
            i = lane(j)
            if star[i + BOUND] > 0.0:
                for k in (N_X, P_X):
                    f += edge_value(star[i + k] - x, star[i + k + 4] - y, star[i + BOUND], law[1])
    return f, low
