"""The two envelopes on one edge and one triangle, in closed form.

Size preserving minimises max(h(y), d/coefficient) with coefficient = alpha, gradient limiting h(y) + coefficient d
with coefficient = epsilon, where d = |x - y|. Both are convex on a triangle where h is linear.
"""

import math

import numpy as np

from sizeviz.sizing._tree_kernels import uncounted

LIMIT, PRESERVE = 0, 1
"""Which envelope: (min, +) or (min, max)."""

ROUNDING = 1e-13
"""Improvements below this share of a size are not looked for."""

LEAST, BASE, SLOPE_X, SLOPE_Y, SLOPE = range(5)
"""Columns of a block's bounds: h(y) is at least LEAST, and at least BASE + (SLOPE_X, SLOPE_Y) (y - centre)."""


@uncounted
def may_improve(kind, coefficient, least, d2, best):
    """Return whether sizes of at least ``least`` at squared distances of at least ``d2`` could beat ``best``."""
    if least >= best:
        return False
    if kind == PRESERVE:
        return d2 < (coefficient * best) ** 2
    return coefficient * coefficient * d2 < (best - least) ** 2


@uncounted
def block_may_improve(kind, coefficient, bounds, block, x, y, half_x, half_y, best):
    """Return whether a block could beat ``best`` at the origin.

    Two lower bounds are tried: the block's least size with its distance, and its bounding plane with the distance
    replaced by its projection n (y - x) on the direction n of the centre. The second is linear in y, so its least
    value over the box is known; its gap shrinks with the square of the block where the field is smooth.

    Parameters
    ----------
    bounds : (M, 5) float64
        Columns LEAST to SLOPE of every block.
    block : int
        The row.
    x, y, half_x, half_y : float
        The block's centre relative to the node asked about, and its half extents.
    """
    dx, dy = max(abs(x) - half_x, 0.0), max(abs(y) - half_y, 0.0)
    if not may_improve(kind, coefficient, bounds[block, LEAST], dx * dx + dy * dy, best):
        return False
    weight = coefficient
    if kind == PRESERVE:
        weight = bounds[block, SLOPE]
        best *= 1.0 + coefficient * weight
    distance = math.sqrt(x * x + y * y)
    pull = weight / distance if distance > 0.0 else 0.0
    slack = half_x * abs(bounds[block, SLOPE_X] + pull * x) + half_y * abs(bounds[block, SLOPE_Y] + pull * y)
    return bounds[block, BASE] + weight * distance - slack < best * (1.0 - ROUNDING)


@uncounted
def join_bounds(bounds, block, child, x, y, half_x, half_y):
    """Lower a block's plane, whose slope is set, until it lies below a child's over the child's box.

    ``x, y`` is the child's centre relative to the block's, ``half_x, half_y`` its half extents.
    """
    gx, gy = bounds[block, SLOPE_X], bounds[block, SLOPE_Y]
    room = half_x * abs(bounds[child, SLOPE_X] - gx) + half_y * abs(bounds[child, SLOPE_Y] - gy)
    bounds[block, BASE] = min(bounds[block, BASE], bounds[child, BASE] - gx * x - gy * y - room)
    bounds[block, LEAST] = min(bounds[block, LEAST], bounds[child, LEAST])


@uncounted
def start_bounds(bounds, block, slope_x, slope_y):
    """Set a block's slope and open its bounds."""
    bounds[block, LEAST] = np.inf
    bounds[block, BASE] = np.inf
    bounds[block, SLOPE_X], bounds[block, SLOPE_Y] = slope_x, slope_y
    bounds[block, SLOPE] = math.sqrt(slope_x * slope_x + slope_y * slope_y)


@uncounted
def plane_of(ux, uy, rise_u, vx, vy, rise_v):
    """Return the gradient of the linear function that rises by ``rise_u`` along u and ``rise_v`` along v."""
    det = ux * vy - uy * vx
    return (rise_u * vy - rise_v * uy) / det, (rise_v * ux - rise_u * vx) / det


@uncounted
def on_edge(kind, coefficient, ax, ay, ha, bx, by, hb, best):
    """Return the envelope of one edge at the origin, or ``best`` where that is lower.

    ``a`` and ``b`` are the edge's ends relative to the node asked about, ``ha`` and ``hb`` their sizes.
    """
    if min(ha, hb) >= best:
        return best
    ex, ey = bx - ax, by - ay
    length2 = ex * ex + ey * ey
    foot = -(ax * ex + ay * ey) / length2
    cross = ax * ey - ay * ex
    height2 = cross * cross / length2
    if not may_improve(kind, coefficient, min(ha, hb), height2, best):
        return best
    if kind == LIMIT:
        return min(best, _limited_on_edge(coefficient, ha, hb - ha, math.sqrt(length2), foot, math.sqrt(height2)))
    return min(best, _preserved_on_edge(coefficient, ha, hb - ha, length2, foot, height2))


@uncounted
def _limited_on_edge(epsilon, ha, rise, length, foot, height):
    """Minimise ha + rise s + epsilon |distance at s| over 0 <= s <= 1."""
    slope = rise / length
    if abs(slope) >= epsilon:
        s = 0.0 if rise > 0.0 else 1.0
    else:
        s = foot - slope * height / math.sqrt(epsilon * epsilon - slope * slope) / length
        s = min(max(s, 0.0), 1.0)
    along = (s - foot) * length
    return ha + rise * s + epsilon * math.sqrt(height * height + along * along)


@uncounted
def _preserved_on_edge(alpha, ha, rise, length2, foot, height2):
    """Minimise max(ha + rise s, distance at s / alpha) over 0 <= s <= 1."""
    near = min(max(foot, 0.0), 1.0)
    near_distance = math.sqrt(height2 + (near - foot) ** 2 * length2)
    if near_distance >= alpha * (ha + rise * near):
        return near_distance / alpha
    low = 0.0 if rise > 0.0 else 1.0
    if math.sqrt(height2 + (low - foot) ** 2 * length2) <= alpha * (ha + rise * low):
        return ha + rise * low
    # between the two the size falls and the distance grows: one crossing, a root of a u^2 - 2 b u - c with u = s - foot
    at_foot = ha + rise * foot
    a = length2 - (alpha * rise) ** 2
    b = alpha * alpha * at_foot * rise
    c = (alpha * at_foot) ** 2 - height2
    # b^2 + a c without the terms that cancel, of which only rounding would be left on a steep edge
    root = math.sqrt(max((alpha * at_foot) ** 2 * length2 - height2 * a, 0.0))
    q = b + root if b >= 0.0 else b - root
    first = _into(near, low, foot + (q / a if a != 0.0 else math.inf))
    second = _into(near, low, foot + (-c / q if q != 0.0 else math.inf))
    return min(
        max(ha + rise * first, math.sqrt(height2 + (first - foot) ** 2 * length2) / alpha),
        max(ha + rise * second, math.sqrt(height2 + (second - foot) ** 2 * length2) / alpha),
    )


@uncounted
def _into(one, other, s):
    """Return s, moved into the interval between two numbers."""
    return min(max(s, min(one, other)), max(one, other))


@uncounted
def on_triangle(kind, coefficient, ax, ay, ha, bx, by, hb, cx, cy, hc, best):
    """Return the envelope of one counter-clockwise triangle at the origin, or ``best`` where that is lower.

    The unconstrained minimum over the plane comes first: for size preserving it lies where the size equals
    distance / alpha on the line of steepest descent, for gradient limiting at the origin. It is a lower bound; if it
    is not in the triangle, the minimum lies on an edge that has it on its outer side: both functions are convex.
    """
    gx, gy = plane_of(bx - ax, by - ay, hb - ha, cx - ax, cy - ay, hc - ha)
    slope = math.sqrt(gx * gx + gy * gy)
    value = ha - gx * ax - gy * ay
    px, py = 0.0, 0.0
    if kind == PRESERVE:
        value /= 1.0 + coefficient * slope
        if slope > 0.0:
            px, py = -gx / slope * coefficient * value, -gy / slope * coefficient * value
    bounded = value > 0.0 if kind == PRESERVE else slope <= coefficient
    if bounded and value >= best * (1.0 - ROUNDING):
        return best
    beyond_a = not bounded or (bx - px) * (cy - py) - (by - py) * (cx - px) < 0.0
    beyond_b = not bounded or (cx - px) * (ay - py) - (cy - py) * (ax - px) < 0.0
    beyond_c = not bounded or (ax - px) * (by - py) - (ay - py) * (bx - px) < 0.0
    if not (beyond_a or beyond_b or beyond_c):
        return value
    if beyond_a:
        best = on_edge(kind, coefficient, bx, by, hb, cx, cy, hc, best)
    if beyond_b:
        best = on_edge(kind, coefficient, cx, cy, hc, ax, ay, ha, best)
    if beyond_c:
        best = on_edge(kind, coefficient, ax, ay, ha, bx, by, hb, best)
    return best
