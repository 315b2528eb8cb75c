"""Distortion of the corners around one node: value, gradient and Hessian in the node's position.

A corner with edges e1, e2 and target size s has N = (|e1|^2 + |e2|^2) / s^2 and sigma = det(e1, e2) / s^2; its
distortion is N g(h(sigma)), which is 1 for a square of the target size. Shape x size of eq. (7), Ruiz-Girones,
Roca, Sarrate (2013), https://doi.org/10.1007/978-3-319-02335-9. sigma is affine or bilinear and N quadratic in the
moving node, so that the chain rule needs only g, g', g'' of a scalar.
"""

from __future__ import annotations

import math

from sizeviz.improvement._jit import compiled

RECIPROCAL = 0
PAPER = 1
SHAPE = 2

BARRIER = 1e-2
"""Where a corner's sigma falls below this, delta of the untangling begins."""


@compiled
def profile(h, objective):
    """Return g, g', g'' of one objective at h > 0."""
    r = 1.0 / h
    if objective == RECIPROCAL:
        r2 = r * r
        return 0.25 + 0.25 * r2, -0.5 * r2 * r, 1.5 * r2 * r2
    if objective == SHAPE:
        return 0.5 * r, -0.5 * r * r, r * r * r
    rise, fall = math.exp(1.0 - h), math.exp(1.0 - r)
    m = h * h * rise + fall  # 2 h mu(h)
    m1 = (2.0 * h - h * h) * rise + fall * r * r
    m2 = (2.0 - 4.0 * h + h * h) * rise + fall * (r - 2.0) * r * r * r
    inverse = 1.0 / max(m, 1e-300)
    return inverse, -m1 * inverse * inverse, (2.0 * m1 * m1 * inverse - m2) * inverse * inverse


@compiled
def regular(sigma, root, delta2):
    """Return h(sigma) = (sigma + root)/2 with root = sqrt(sigma^2 + 4 delta^2), without cancellation."""
    if sigma >= 0.0:
        return 0.5 * (sigma + root)
    return 2.0 * delta2 / (root - sigma)


@compiled
def value(sigma, objective, delta2):
    """Return g(h(sigma)), infinite where a barrier (delta = 0) is crossed."""
    h = sigma
    if delta2 > 0.0:
        h = regular(sigma, math.sqrt(sigma * sigma + 4.0 * delta2), delta2)
    if h <= 0.0:
        return math.inf
    r = 1.0 / h
    if objective == RECIPROCAL:
        return 0.25 + 0.25 * r * r
    if objective == SHAPE:
        return 0.5 * r
    return profile(h, objective)[0]


@compiled
def derivatives(sigma, objective, delta2):
    """Return g(h(sigma)) and its first two derivatives in sigma; h(sigma) = (sigma + sqrt(sigma^2 + 4 delta^2))/2."""
    if delta2 <= 0.0:
        return profile(sigma, objective)
    root = math.sqrt(sigma * sigma + 4.0 * delta2)
    h = regular(sigma, root, delta2)
    g, g1, g2 = profile(h, objective)
    h1 = h / root
    h2 = 2.0 * delta2 / (root * root * root)
    return g, g1 * h1, g2 * h1 * h1 + g1 * h2


@compiled
def delta_squared(sigma_min):
    """Return delta^2 for a star whose smallest sigma is given: 0 where it is safely valid."""
    if sigma_min >= BARRIER:
        return 0.0
    return BARRIER * (BARRIER - sigma_min)


@compiled
def term(n, nx, ny, nn, sigma, sx, sy, objective, delta2):
    """Return value, gradient (x, y) and Hessian (xx, xy, yy) of n g(h(sigma)); the Hessian of n is nn times 1."""
    g, g1, g2 = derivatives(sigma, objective, delta2)
    curve = n * g2
    slope = n * g1
    return (
        n * g,
        nx * g + slope * sx,
        ny * g + slope * sy,
        nn * g + 2.0 * g1 * nx * sx + curve * sx * sx,
        g1 * (nx * sy + ny * sx) + curve * sx * sy,
        nn * g + 2.0 * g1 * ny * sy + curve * sy * sy,
    )


@compiled
def corner_terms(ax, ay, bx, by, cx, cy, inv, objective, delta2):
    """Return the sums of ``term`` over the three corners that a moving first corner changes, and their least sigma.

    a, c, b lead from the moving corner to the next, opposite and previous one; inv is 1 / target^2.
    """
    na, nb = (ax * ax + ay * ay) * inv, (bx * bx + by * by) * inv
    ux, uy, vx, vy = cx - ax, cy - ay, cx - bx, cy - by
    i2 = 2.0 * inv
    s0, s1, s3 = (ax * by - ay * bx) * inv, (ax * cy - ay * cx) * inv, (cx * by - cy * bx) * inv
    f0, gx0, gy0, xx0, xy0, yy0 = term(
        na + nb, -i2 * (ax + bx), -i2 * (ay + by), 2.0 * i2, s0, (ay - by) * inv, (bx - ax) * inv, objective, delta2,
    )  # fmt: skip
    f1, gx1, gy1, xx1, xy1, yy1 = term(
        na + (ux * ux + uy * uy) * inv, -i2 * ax, -i2 * ay, i2, s1, (ay - cy) * inv, (cx - ax) * inv, objective, delta2,
    )  # fmt: skip
    f3, gx3, gy3, xx3, xy3, yy3 = term(
        nb + (vx * vx + vy * vy) * inv, -i2 * bx, -i2 * by, i2, s3, (cy - by) * inv, (bx - cx) * inv, objective, delta2,
    )  # fmt: skip
    return (
        f0 + f1 + f3, gx0 + gx1 + gx3, gy0 + gy1 + gy3,
        xx0 + xx1 + xx3, xy0 + xy1 + xy3, yy0 + yy1 + yy3, min(s0, min(s1, s3)),
    )  # fmt: skip


@compiled
def corner_values(ax, ay, bx, by, cx, cy, inv, objective, delta2):
    """Return the value that ``corner_terms`` gives first, and the smallest sigma of the three corners."""
    na, nb = (ax * ax + ay * ay) * inv, (bx * bx + by * by) * inv
    ux, uy, vx, vy = cx - ax, cy - ay, cx - bx, cy - by
    s0 = (ax * by - ay * bx) * inv
    s1 = (ax * cy - ay * cx) * inv
    s3 = (cx * by - cy * bx) * inv
    low = min(s0, min(s1, s3))
    f = (na + nb) * value(s0, objective, delta2)
    f += (na + (ux * ux + uy * uy) * inv) * value(s1, objective, delta2)
    f += (nb + (vx * vx + vy * vy) * inv) * value(s3, objective, delta2)
    return f, low


@compiled
def edge_terms(ax, ay, bound, weight):
    """Return the six sums of weight max(0, |a|^2 bound - 1)^2 for an edge a that leads from the moving node."""
    excess = (ax * ax + ay * ay) * bound - 1.0
    if excess <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    ux, uy = -2.0 * bound * ax, -2.0 * bound * ay
    w2 = 2.0 * weight
    flat = w2 * excess * 2.0 * bound
    return (
        weight * excess * excess,
        w2 * excess * ux,
        w2 * excess * uy,
        flat + w2 * ux * ux,
        w2 * ux * uy,
        flat + w2 * uy * uy,
    )


@compiled
def edge_value(ax, ay, bound, weight):
    """Return the value that ``edge_terms`` gives first."""
    excess = (ax * ax + ay * ay) * bound - 1.0
    if excess <= 0.0:
        return 0.0
    return weight * excess * excess
