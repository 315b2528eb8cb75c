"""Predicates against exact rational arithmetic."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sizeviz.geometry.predicates import circle_sides, orientations


def exact_orientation(a, b, c) -> int:
    ax, ay, bx, by, cx, cy = (Fraction(float(v)) for p in (a, b, c) for v in p)
    det = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    return (det > 0) - (det < 0)


def exact_circle_side(a, b, c, d) -> int:
    rows = []
    for p in (a, b, c):
        x, y = (Fraction(float(p[k])) - Fraction(float(d[k])) for k in range(2))
        rows.append((x, y, x * x + y * y))
    (ax, ay, al), (bx, by, bl), (cx, cy, cl) = rows
    det = al * (bx * cy - cx * by) + bl * (cx * ay - ax * cy) + cl * (ax * by - bx * ay)
    return (det > 0) - (det < 0)


lattice = st.integers(-8, 8).map(lambda i: i / 7)
nudged = st.tuples(lattice, st.integers(-2, 2)).map(lambda t: float(t[0] + t[1] * np.spacing(max(abs(t[0]), 0.1))))
wild = st.floats(-1e6, 1e6, allow_nan=False, allow_subnormal=False).map(lambda v: 0.0 if abs(v) < 1e-30 else v)
coordinate = st.one_of(lattice, nudged, wild)
point = st.tuples(coordinate, coordinate)


@settings(max_examples=400, deadline=None)
@given(point, point, point)
def test_orientation_is_exact(a, b, c) -> None:
    assert orientations(a, b, c)[0] == exact_orientation(a, b, c)


@settings(max_examples=400, deadline=None)
@given(point, point, point, point)
def test_circle_side_is_exact(a, b, c, d) -> None:
    assert circle_sides(a, b, c, d)[0] == exact_circle_side(a, b, c, d)


@pytest.mark.parametrize("step", [1.0, 0.1, 1 / 3, 1e-9, 12345.678])
def test_near_cocircular_lattice_corners(step) -> None:
    """The corners of lattice squares, each moved by an ulp or not at all: the hardest calls there are."""
    rng = np.random.default_rng(1)
    corner = rng.integers(-50, 50, (500, 2)) * step
    square = corner[:, None, :] + np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * step
    square += rng.integers(-1, 2, square.shape) * np.spacing(np.maximum(np.abs(square), step))
    got = circle_sides(*square.transpose(1, 0, 2))
    assert got.tolist() == [exact_circle_side(*four) for four in square]
    assert len(set(got.tolist())) > 1


def test_points_on_a_line_through_far_places() -> None:
    """Collinear by construction (midpoints are exact), where rounded determinants are pure noise."""
    rng = np.random.default_rng(2)
    a = rng.integers(-(2**40), 2**40, (300, 2)).astype(float)
    b = rng.integers(-(2**40), 2**40, (300, 2)).astype(float)
    assert not orientations(a, b, (a + b) / 2).any()


def test_swapping_two_points_changes_the_sign() -> None:
    rng = np.random.default_rng(3)
    a, b, c, d = rng.random((4, 200, 2))
    assert np.array_equal(orientations(a, b, c), -orientations(b, a, c))
    assert np.array_equal(circle_sides(a, b, c, d), -circle_sides(b, a, c, d))
