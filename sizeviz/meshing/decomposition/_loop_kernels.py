"""One loop at hand: its coordinates, its angles, and what a chord between two of its nodes can see.

A loop lists node indices, the region to be meshed on its left. It may pass a node twice, where a cut joins a hole
to the outer loop; the two passages are told apart by their place in the loop, and share the index.
"""

import math

import numpy as np
from numba import njit

TWO_PI = 2.0 * math.pi


@njit(nogil=True, cache=True)
def unpack(loop, n, points, xy, direction, angle, spacing):
    """Fill coordinates, the direction of each edge, the interior angle and the shorter edge at each node."""
    for i in range(n):
        xy[i, 0], xy[i, 1] = points[loop[i], 0], points[loop[i], 1]
    before = math.hypot(xy[0, 0] - xy[n - 1, 0], xy[0, 1] - xy[n - 1, 1])
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        dx, dy = xy[j, 0] - xy[i, 0], xy[j, 1] - xy[i, 1]
        length = math.hypot(dx, dy)
        direction[i] = math.atan2(dy, dx)
        spacing[i] = min(length, before)
        before = length
    for i in range(n):
        turn = direction[i] - direction[i - 1 if i > 0 else n - 1]
        if turn >= math.pi - 1e-9:  # a loop that turns right back goes around the tip of a cut
            turn -= TWO_PI
        elif turn < -math.pi - 1e-9:
            turn += TWO_PI
        angle[i] = math.pi - turn


@njit(nogil=True, cache=True)
def extent(n, xy):
    """Return the diagonal of the loop's bounding box, which stands for its diameter."""
    low_x, high_x, low_y, high_y = xy[0, 0], xy[0, 0], xy[0, 1], xy[0, 1]
    for i in range(1, n):
        low_x, high_x = min(low_x, xy[i, 0]), max(high_x, xy[i, 0])
        low_y, high_y = min(low_y, xy[i, 1]), max(high_y, xy[i, 1])
    return math.hypot(high_x - low_x, high_y - low_y)


@njit(nogil=True, cache=True)
def loop_area(n, xy):
    """Return the area on the left of the loop."""
    total = 0.0
    for i in range(1, n - 1):
        ax, ay = xy[i, 0] - xy[0, 0], xy[i, 1] - xy[0, 1]
        bx, by = xy[i + 1, 0] - xy[0, 0], xy[i + 1, 1] - xy[0, 1]
        total += ax * by - ay * bx
    return 0.5 * total


@njit(nogil=True, cache=True)
def angle_between(direction, chord):
    """Return the angle from an edge's direction counter-clockwise to a chord's, 0 to 2 pi."""
    turn = chord - direction
    if turn < 0.0:
        turn += TWO_PI
    if turn < 0.0:
        turn += TWO_PI
    elif turn >= TWO_PI:
        turn -= TWO_PI
    return turn


@njit(nogil=True, cache=True)
def clears(loop, n, xy, spacing, ax, ay, bx, by, first, last, clearance):
    """Whether the segment ab meets no edge of a loop and keeps clear of all its nodes but ``first`` and ``last``.

    Every other node must lie further from the segment than ``clearance`` times its shorter edge. That a chord leaves
    its ends into the region is for the caller to know.
    """
    ux, uy = bx - ax, by - ay
    length = math.hypot(ux, uy)
    ux, uy = ux / length, uy / length
    px, py = xy[n - 1, 0] - ax, xy[n - 1, 1] - ay
    along0, across0 = px * ux + py * uy, ux * py - uy * px
    end0 = loop[n - 1] == first or loop[n - 1] == last
    for k in range(n):
        px, py = xy[k, 0] - ax, xy[k, 1] - ay
        along, across = px * ux + py * uy, ux * py - uy * px
        end = loop[k] == first or loop[k] == last
        if not end:
            margin = clearance * spacing[k]
            if abs(across) <= margin and -margin < along < length + margin:
                return False
            if not end0 and (across > 0.0) != (across0 > 0.0):
                at = along0 + (along - along0) * across0 / (across0 - across)
                if 0.0 <= at <= length:
                    return False
        along0, across0, end0 = along, across, end
    return True


@njit(nogil=True, cache=True)
def corner_quality(ax, ay, bx, by, cx, cy):
    """Return 2 sigma / |S|^2 at corner b of a quadrilateral that passes a, b, c; 0 or less where it is not convex."""
    ux, uy, vx, vy = cx - bx, cy - by, ax - bx, ay - by
    total = ux * ux + uy * uy + vx * vx + vy * vy
    return 2.0 * (ux * vy - uy * vx) / total if total > 0.0 else 0.0


@njit(nogil=True, cache=True)
def worst_corner(p, q, r, s):
    """Return the least corner quality of a quadrilateral, 1 for a square; its corners are pairs of coordinates."""
    a = corner_quality(s[0], s[1], p[0], p[1], q[0], q[1])
    b = corner_quality(p[0], p[1], q[0], q[1], r[0], r[1])
    c = corner_quality(q[0], q[1], r[0], r[1], s[0], s[1])
    d = corner_quality(r[0], r[1], s[0], s[1], p[0], p[1])
    return min(min(a, b), min(c, d))


@njit(nogil=True, cache=True)
def work_arrays(n):
    """Return arrays for loops of up to n nodes: places, coordinates, directions, angles, shorter edges."""
    return np.empty(n, np.int32), np.empty((n, 2)), np.empty(n), np.empty(n), np.empty(n)
