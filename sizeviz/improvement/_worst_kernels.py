"""A max-min pass: nodes of the worst elements move to where the worst element around them is best."""

from __future__ import annotations

import math

import numpy as np

from sizeviz.improvement._curve_kernels import curve_frame, curve_shift
from sizeviz.improvement._jit import allocating, compiled
from sizeviz.improvement._star_kernels import BOUND, INV, N_X, N_Y, O_X, O_Y, P_X, P_Y, gather, lane, star_size

DIRECTIONS = 8
COARSEST = 0.32
"""First step of the search, over the target size; it is halved until nothing gets better."""
HALVINGS = 6


@compiled
def corner_ratio(ax, ay, bx, by):
    """Return (|a|^2 + |b|^2) / det(a, b), infinite where the corner is not convex."""
    d = ax * by - ay * bx
    if d <= 0.0:
        return math.inf
    return (ax * ax + ay * ay + bx * bx + by * by) / d


@compiled
def star_quality(star, m, x, y, share):
    """Return the worst shape quality around a node at (x, y) and the largest edge^2 there, over what is allowed.

    Allowed is target^2 / ``share``, and the limit of the element where it has one.
    """
    worst, longest = 1.0, 0.0
    for j in range(m):
        i = lane(j)
        nx, ny, ox, oy = star[i + N_X], star[i + N_Y], star[i + O_X], star[i + O_Y]
        px, py = star[i + P_X], star[i + P_Y]
        total = corner_ratio(nx - x, ny - y, px - x, py - y)
        total += corner_ratio(ox - nx, oy - ny, x - nx, y - ny)
        total += corner_ratio(px - ox, py - oy, nx - ox, ny - oy)
        total += corner_ratio(x - px, y - py, ox - px, oy - py)
        worst = min(worst, 8.0 / total)
        edge = max((nx - x) ** 2 + (ny - y) ** 2, (px - x) ** 2 + (py - y) ** 2)
        longest = max(longest, edge * max(share * star[i + INV], star[i + BOUND]))
    return worst, longest


@compiled
def lift_free(v, xy, star, m, share):
    """Search the eight directions, halving the step, for a better place of an inner node."""
    x, y = xy[v, 0], xy[v, 1]
    best, longest = star_quality(star, m, x, y, share)
    limit = max(1.0, longest)
    step = COARSEST / math.sqrt(star[INV])
    for _ in range(HALVINGS):
        px, py = x, y
        for k in range(DIRECTIONS):
            angle = 2.0 * math.pi * k / DIRECTIONS
            tx, ty = x + step * math.cos(angle), y + step * math.sin(angle)
            worst, longest = star_quality(star, m, tx, ty, share)
            if worst > best and longest <= limit:
                best, px, py = worst, tx, ty
        if px == x and py == y:
            step *= 0.5
        x, y = px, py
    xy[v, 0], xy[v, 1] = x, y


@compiled
def lift_sliding(v, xy, star, m, share, curves, c, station):
    """Search both ways along its curve, halving the step, for a better place of a boundary node."""
    best, longest = star_quality(star, m, xy[v, 0], xy[v, 1], share)
    limit = max(1.0, longest)
    step = COARSEST / math.sqrt(star[INV])
    for _ in range(HALVINGS):
        moved = False
        for sign in (-1.0, 1.0):
            there = curve_shift(curves, c, station[v], sign * step)
            x, y, _, _ = curve_frame(curves, c, there)
            worst, longest = star_quality(star, m, x, y, share)
            if worst > best and longest <= limit:
                best, moved = worst, True
                xy[v, 0], xy[v, 1], station[v] = x, y, there
                break
        if not moved:
            step *= 0.5


@compiled
def quad_quality(q, xy, quads):
    """Return the shape quality of an element."""
    total = 0.0
    for k in range(4):
        v, w, p = quads[q, k], quads[q, (k + 1) & 3], quads[q, (k + 3) & 3]
        total += corner_ratio(xy[w, 0] - xy[v, 0], xy[w, 1] - xy[v, 1], xy[p, 0] - xy[v, 0], xy[p, 1] - xy[v, 1])
    return 8.0 / total


@allocating
def lift_worst(floor, limit, passes, patch, inv, bound, rails):
    """Raise elements whose quality is below ``floor``; return how many remain below.

    An edge may grow to ``sqrt(limit)`` times its target and to the limit of its elements, or stay as long
    as it was.
    """
    xy, quads, ring, count = patch
    star = np.empty(star_size(ring.shape[1]))
    watched = np.ones(len(quads), np.bool_)
    left = 0
    for turn in range(passes + 1):
        left = 0
        for q in range(len(quads)):
            if not watched[q]:
                continue
            if quads[q, 0] < 0 or quad_quality(q, xy, quads) >= floor:
                # nothing to do here until one of its nodes moves
                watched[q] = False
                continue
            left += 1
            if turn == passes:
                continue
            for k in range(4):
                v = quads[q, k]
                m = gather(v, patch, inv, bound, star)
                kind = rails[1][v]
                if kind == -1:
                    lift_free(v, xy, star, m, 1.0 / limit)
                elif kind >= 0:
                    lift_sliding(v, xy, star, m, 1.0 / limit, rails[0], kind, rails[2])
                for j in range(count[v]):
                    watched[ring[v, j] >> 2] = True
        if left == 0:
            break
    return left


@compiled
def qualities(rows, xy, quads, out):
    """Write the shape quality of some elements to their places in ``out``."""
    for i in range(len(rows)):
        out[rows[i]] = quad_quality(rows[i], xy, quads)
