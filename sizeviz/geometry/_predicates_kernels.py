"""Which side, which circle: predicates whose sign is always right.

A rounded determinant with a proved error bound answers nearly every call; the rest are answered exactly.
Shewchuk (1997), DOI 10.1007/PL00009321.

``_nrt=False``: a kernel that makes no array need not count references, which costs more than some of its calls.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from sizeviz.geometry._expansion_kernels import (
    added,
    difference,
    expansion_product,
    sign_of_sum,
    two_diff,
    two_product,
    two_sum,
)

_EPS = 2.0**-53
_ORIENT_BOUND = (3.0 + 16.0 * _EPS) * _EPS
_INCIRCLE_BOUND = (10.0 + 96.0 * _EPS) * _EPS


@njit(nogil=True, cache=True, _nrt=False)
def orient2d(ax, ay, bx, by, cx, cy):
    """Return a number above 0 where a, b, c turn left, below 0 where they turn right, 0 where collinear: exact."""
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    det = left - right
    bound = _ORIENT_BOUND * (abs(left) + abs(right))
    if det > bound or -det > bound or bound == 0.0:
        return det
    return _orient2d_exact(ax, ay, bx, by, cx, cy)


@njit(nogil=True, cache=True, _nrt=True)
def _orient2d_exact(ax, ay, bx, by, cx, cy):
    terms = np.empty(12)
    terms[0], terms[1] = two_product(ax, by)
    terms[2], terms[3] = two_product(-ay, bx)
    terms[4], terms[5] = two_product(bx, cy)
    terms[6], terms[7] = two_product(-by, cx)
    terms[8], terms[9] = two_product(cx, ay)
    terms[10], terms[11] = two_product(-cy, ax)
    return sign_of_sum(terms, 12)


@njit(nogil=True, cache=True, _nrt=False)
def incircle(ax, ay, bx, by, cx, cy, dx, dy):
    """Return a number above 0 where d lies inside the circle through a, b, c (turning left), 0 where on it: exact."""
    adx, ady = ax - dx, ay - dy
    bdx, bdy = bx - dx, by - dy
    cdx, cdy = cx - dx, cy - dy
    bc, cb = bdx * cdy, cdx * bdy
    ca, ac = cdx * ady, adx * cdy
    ab, ba = adx * bdy, bdx * ady
    alift = adx * adx + ady * ady
    blift = bdx * bdx + bdy * bdy
    clift = cdx * cdx + cdy * cdy
    det = alift * (bc - cb) + blift * (ca - ac) + clift * (ab - ba)
    size = (abs(bc) + abs(cb)) * alift + (abs(ca) + abs(ac)) * blift + (abs(ab) + abs(ba)) * clift
    bound = _INCIRCLE_BOUND * size
    if det > bound or -det > bound:
        return det
    return _incircle_short(ax, ay, bx, by, cx, cy, dx, dy)


@njit(nogil=True, cache=True, _nrt=False)
def _short_minor(px, py, qx, qy):
    """Return p x q, and the sum of the moduli of all that was rounded away."""
    left, e = two_product(px, qy)
    right, f = two_product(qx, py)
    minor, g = two_diff(left, right)
    return minor, abs(e) + abs(f) + abs(g)


@njit(nogil=True, cache=True, _nrt=False)
def _short_lift(px, py):
    """Return |p|^2, and the sum of the moduli of all that was rounded away."""
    xx, e = two_product(px, px)
    yy, f = two_product(py, py)
    lift, g = two_sum(xx, yy)
    return lift, abs(e) + abs(f) + abs(g)


@njit(nogil=True, cache=True, _nrt=True)
def _incircle_short(ax, ay, bx, by, cx, cy, dx, dy):
    """Decide points of few significant bits, such as those of a lattice, without any allocation of expansions."""
    adx, lost0 = two_diff(ax, dx)
    ady, lost1 = two_diff(ay, dy)
    bdx, lost2 = two_diff(bx, dx)
    bdy, lost3 = two_diff(by, dy)
    cdx, lost4 = two_diff(cx, dx)
    cdy, lost5 = two_diff(cy, dy)
    lost = abs(lost0) + abs(lost1) + abs(lost2) + abs(lost3) + abs(lost4) + abs(lost5)
    amin, e0 = _short_minor(bdx, bdy, cdx, cdy)
    bmin, e1 = _short_minor(cdx, cdy, adx, ady)
    cmin, e2 = _short_minor(adx, ady, bdx, bdy)
    alift, f0 = _short_lift(adx, ady)
    blift, f1 = _short_lift(bdx, bdy)
    clift, f2 = _short_lift(cdx, cdy)
    if lost + e0 + e1 + e2 + f0 + f1 + f2 != 0.0:
        return _incircle_exact(ax, ay, bx, by, cx, cy, dx, dy)
    p0, t0 = two_product(alift, amin)
    p1, t1 = two_product(blift, bmin)
    p2, t2 = two_product(clift, cmin)
    s, u = two_sum(p0, p1)
    s, v = two_sum(s, p2)
    if u == 0.0 and v == 0.0 and t0 == 0.0 and t1 == 0.0 and t2 == 0.0:
        return s
    terms = np.empty(6)
    terms[0], terms[1], terms[2], terms[3], terms[4], terms[5] = t0, t1, t2, v, u, s
    return sign_of_sum(terms, 6)


@njit(nogil=True, cache=True, _nrt=True)
def _exact_term(px, py, qx, qy, rx, ry):
    """Return |p|^2 (q x r) as an expansion."""
    minor = added(expansion_product(qx, ry), expansion_product(-rx, qy))
    lift = added(expansion_product(px, px), expansion_product(py, py))
    return expansion_product(lift, minor)


@njit(nogil=True, cache=True, _nrt=True)
def _incircle_exact(ax, ay, bx, by, cx, cy, dx, dy):
    adx, ady = difference(ax, dx), difference(ay, dy)
    bdx, bdy = difference(bx, dx), difference(by, dy)
    cdx, cdy = difference(cx, dx), difference(cy, dy)
    total = added(_exact_term(adx, ady, bdx, bdy, cdx, cdy), _exact_term(bdx, bdy, cdx, cdy, adx, ady))
    total = added(total, _exact_term(cdx, cdy, adx, ady, bdx, bdy))
    return total[-1] if len(total) else 0.0


@njit(nogil=True, cache=True, _nrt=True)
def orientations(a, b, c):
    """Return the sign of orient2d for each row."""
    out = np.empty(len(a), dtype=np.int8)
    for i in range(len(a)):
        out[i] = np.sign(orient2d(a[i, 0], a[i, 1], b[i, 0], b[i, 1], c[i, 0], c[i, 1]))
    return out


@njit(nogil=True, cache=True, _nrt=True)
def circle_sides(a, b, c, d):
    """Return the sign of incircle for each row."""
    out = np.empty(len(a), dtype=np.int8)
    for i in range(len(a)):
        out[i] = np.sign(incircle(a[i, 0], a[i, 1], b[i, 0], b[i, 1], c[i, 0], c[i, 1], d[i, 0], d[i, 1]))
    return out
