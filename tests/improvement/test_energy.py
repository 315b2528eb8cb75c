"""The objective: its value where a corner is ideal, and its derivatives against finite differences."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sizeviz.improvement import _energy_kernels as energy
from sizeviz.improvement import _star_kernels as stars

OBJECTIVES = [energy.RECIPROCAL, energy.PAPER, energy.SHAPE]


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_square_of_the_target_size_has_distortion_one(objective: int) -> None:
    assert 2.0 * energy.value(1.0, objective, 0.0) == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("sigma", [0.3, 0.7, 1.0, 1.6, 4.0])
def test_the_paper_s_profile_is_shape_over_mu(sigma: float) -> None:
    mu = 0.5 * math.e * (sigma * math.exp(-sigma) + math.exp(-1.0 / sigma) / sigma)
    assert energy.value(sigma, energy.PAPER, 0.0) == pytest.approx(1.0 / (2.0 * sigma * mu), rel=1e-13)


def test_the_cheaper_objective_has_the_paper_s_curvature_at_one() -> None:
    cheap, paper = (energy.derivatives(1.0, kind, 0.0) for kind in (energy.RECIPROCAL, energy.PAPER))
    assert cheap == pytest.approx(paper, rel=1e-12)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize(("sigma", "delta2"), [(0.4, 0.0), (1.3, 0.0), (0.2, 1e-2), (-0.1, 1e-2), (-2.0, 1e-2)])
def test_profile_derivatives_match_finite_differences(objective: int, sigma: float, delta2: float) -> None:
    step = 1e-5
    g, g1, g2 = energy.derivatives(sigma, objective, delta2)
    above, below = (energy.derivatives(sigma + s * step, objective, delta2) for s in (1, -1))
    assert g == pytest.approx(energy.value(sigma, objective, delta2), rel=1e-13)
    assert g1 == pytest.approx((above[0] - below[0]) / (2 * step), rel=1e-5, abs=1e-6)
    assert g2 == pytest.approx((above[1] - below[1]) / (2 * step), rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("seed", range(4))
def test_corner_derivatives_match_finite_differences(objective: int, seed: int) -> None:
    corner = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) + np.random.default_rng(seed).uniform(-0.2, 0.2, (3, 2))

    def at(x: float, y: float) -> tuple[float, ...]:
        (ax, ay), (cx, cy), (bx, by) = corner - [x, y]
        return energy.corner_terms(ax, ay, bx, by, cx, cy, 1.7, objective, 0.0)

    step = 1e-5
    f, gx, gy, xx, xy, yy, low = at(0.0, 0.0)
    (ax, ay), (cx, cy), (bx, by) = corner
    assert energy.corner_values(ax, ay, bx, by, cx, cy, 1.7, objective, 0.0) == pytest.approx((f, low), rel=1e-13)
    east, west, north, south = at(step, 0), at(-step, 0), at(0, step), at(0, -step)
    assert gx == pytest.approx((east[0] - west[0]) / (2 * step), rel=1e-6, abs=1e-6)
    assert gy == pytest.approx((north[0] - south[0]) / (2 * step), rel=1e-6, abs=1e-6)
    assert xx == pytest.approx((east[1] - west[1]) / (2 * step), rel=1e-5, abs=1e-5)
    assert xy == pytest.approx((north[1] - south[1]) / (2 * step), rel=1e-5, abs=1e-5)
    assert yy == pytest.approx((north[2] - south[2]) / (2 * step), rel=1e-5, abs=1e-5)


def test_edge_derivatives_match_finite_differences() -> None:
    step = 1e-6
    f, gx, gy, xx, _, _ = energy.edge_terms(1.0, 0.5, 1.3, 10.0)
    east, west = (energy.edge_terms(1.0 - s * step, 0.5, 1.3, 10.0) for s in (1, -1))
    assert f == pytest.approx(10.0 * (1.25 * 1.3 - 1.0) ** 2)
    assert gx == pytest.approx((east[0] - west[0]) / (2 * step), rel=1e-6)
    assert xx == pytest.approx((east[1] - west[1]) / (2 * step), rel=1e-5)
    assert gy == pytest.approx(0.5 * gx)
    assert energy.edge_value(0.1, 0.1, 1.3, 10.0) == 0.0


@pytest.mark.parametrize("valence", range(3, 10))
@pytest.mark.parametrize("weight", [0.0, 50.0])
def test_a_star_in_vector_lanes_is_the_sum_over_its_elements(valence: int, weight: float) -> None:
    # lanes that no element fills must add nothing
    rng = np.random.default_rng(valence)
    angle = 2.0 * np.pi * (np.arange(2 * valence) + rng.uniform(-0.2, 0.2, 2 * valence)) / (2 * valence)
    rim = np.column_stack([np.cos(angle), np.sin(angle)]) * np.tile([1.0, 1.3], valence)[:, None]
    xy = np.vstack([rim, [[0.05, -0.03]]])
    v, j = 2 * valence, np.arange(valence)
    quads = np.column_stack([np.full(valence, v), 2 * j, 2 * j + 1, (2 * j + 2) % v]).astype(np.int32)
    ring = np.zeros((v + 1, valence + 4), dtype=np.int32)
    ring[v, :valence] = 4 * j
    count = np.append(np.zeros(v), valence).astype(np.int32)
    inv, bound = rng.uniform(0.8, 1.2, valence), rng.uniform(0.5, 1.5, valence)
    star = np.full(stars.star_size(ring.shape[1]), np.nan)
    m = stars.gather(v, (xy, quads, ring, count), inv, bound, star)
    x, y = xy[v]
    expected = np.zeros(6)
    low = math.inf
    for q in range(valence):
        (ax, ay), (cx, cy), (bx, by) = xy[quads[q, 1:]] - xy[v]
        terms = energy.corner_terms(ax, ay, bx, by, cx, cy, inv[q], energy.RECIPROCAL, 0.0)
        expected += terms[:6]
        low = min(low, terms[6])
        for ex, ey in ((ax, ay), (bx, by)):
            if weight:
                expected += energy.edge_terms(ex, ey, bound[q], weight)
    found = stars.star_terms(star, m, x, y, (energy.RECIPROCAL, weight), 0.0)
    assert found[:6] == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert found[6] == pytest.approx(low, rel=1e-13)
    value = stars.star_value(star, m, x, y, (energy.RECIPROCAL, weight), 0.0)
    assert value == pytest.approx((expected[0], low), rel=1e-12)
