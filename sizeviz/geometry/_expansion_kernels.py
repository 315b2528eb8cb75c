"""Exact arithmetic on floating-point expansions: sums of doubles that do not overlap.

Shewchuk (1997), "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates",
Discrete & Computational Geometry 18, DOI 10.1007/PL00009321. Components run from the smallest to the largest.
Exact as long as no product over- or underflows (magnitudes between about 1e-70 and 1e70 for the incircle test).

``_nrt=False``: a kernel that makes no array need not count references, which costs more than some of its calls.
"""

from __future__ import annotations

import numpy as np
from numba import njit

_SPLITTER = 134217729.0  # 2**27 + 1


@njit(nogil=True, cache=True, _nrt=False)
def two_sum(a, b):
    """Return x, y with x + y = a + b exactly, x the rounded sum."""
    x = a + b
    bv = x - a
    return x, (a - (x - bv)) + (b - bv)


@njit(nogil=True, cache=True, _nrt=False)
def two_diff(a, b):
    """Return x, y with x + y = a - b exactly, x the rounded difference."""
    x = a - b
    bv = a - x
    return x, (a - (x + bv)) + (bv - b)


@njit(nogil=True, cache=True, _nrt=False)
def split(a):
    """Return the high and the low half of a double, 26 bits each."""
    c = _SPLITTER * a
    high = c - (c - a)
    return high, a - high


@njit(nogil=True, cache=True, _nrt=False)
def two_product(a, b):
    """Return x, y with x + y = a * b exactly, x the rounded product."""
    x = a * b
    ah, al = split(a)
    bh, bl = split(b)
    return x, al * bl - (((x - ah * bh) - al * bh) - ah * bl)


@njit(nogil=True, cache=True, _nrt=False)
def sign_of_sum(terms, count):
    """Return a number with the exact sign of the sum of the first ``count`` terms; ``terms`` is overwritten."""
    for i in range(1, count):
        q = terms[i]
        for j in range(i):
            q, terms[j] = two_sum(q, terms[j])
        terms[i] = q
    for i in range(count - 1, -1, -1):
        if terms[i] != 0.0:
            return terms[i]
    return 0.0


@njit(nogil=True, cache=True, _nrt=False)
def expansion_sum(e, ne, f, nf, out):
    """Write the sum of two expansions, without zeros, and return its length (FAST-EXPANSION-SUM)."""
    i = j = n = 0
    q = 0.0
    while i < ne or j < nf:
        take = j >= nf or (i < ne and abs(e[i]) <= abs(f[j]))
        term = e[i] if take else f[j]
        i, j = (i + 1, j) if take else (i, j + 1)
        q, tail = two_sum(q, term)
        if tail != 0.0:
            out[n] = tail
            n += 1
    if q != 0.0:
        out[n] = q
        n += 1
    return n


@njit(nogil=True, cache=True, _nrt=False)
def scaled_expansion(e, ne, b, out):
    """Write an expansion times a double, without zeros, and return its length (SCALE-EXPANSION)."""
    n = 0
    if ne == 0 or b == 0.0:
        return 0
    q, tail = two_product(e[0], b)
    if tail != 0.0:
        out[n] = tail
        n += 1
    for i in range(1, ne):
        high, low = two_product(e[i], b)
        total, tail = two_sum(q, low)
        if tail != 0.0:
            out[n] = tail
            n += 1
        q, tail = two_sum(high, total)
        if tail != 0.0:
            out[n] = tail
            n += 1
    if q != 0.0:
        out[n] = q
        n += 1
    return n


@njit(nogil=True, cache=True, _nrt=True)
def expansion_product(e, f):
    """Return the product of two expansions, without zeros."""
    size = 2 * len(e) * len(f) + 1
    total, other, part = np.empty(size), np.empty(size), np.empty(2 * len(e) + 1)
    n = 0
    for i in range(len(f)):
        m = scaled_expansion(e, len(e), f[i], part)
        n = expansion_sum(total, n, part, m, other)
        total, other = other, total
    return total[:n]


@njit(nogil=True, cache=True, _nrt=True)
def added(e, f):
    """Return the sum of two expansions, without zeros."""
    out = np.empty(len(e) + len(f) + 1)
    return out[: expansion_sum(e, len(e), f, len(f), out)]


@njit(nogil=True, cache=True, _nrt=True)
def difference(a, b):
    """Return a - b as an expansion of at most two components."""
    high, low = two_diff(a, b)
    out = np.empty(2)
    n = 0
    if low != 0.0:
        out[n] = low
        n += 1
    if high != 0.0:
        out[n] = high
        n += 1
    return out[:n]
