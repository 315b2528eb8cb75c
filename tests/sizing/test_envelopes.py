"""Limiting and preserving against brute force, closed forms and invariances."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_matrix, lil_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import Delaunay, cKDTree

from sizeviz.errors import Cancelled, InputError
from sizeviz.sizing import (
    BackgroundMesh,
    LimitOptions,
    PreserveOptions,
    SizeField,
    limited,
    minimum,
    preserved,
)
from sizeviz.sizing.edges import edge_graph
from tests import fields

CATALOGUE = fields.catalogue()
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def golden(function, low, high, rounds=64):
    """Minimise functions that are convex in one variable, elementwise."""
    for _ in range(rounds):
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        better = function(left) < function(right)
        low, high = np.where(better, low, left), np.where(better, right, high)
    return np.minimum(function(low), function(high))


def brute(field: SizeField, term, nodes) -> np.ndarray:
    """Minimise a convex term over every triangle by nested golden sections, for each node."""
    points, triangles = field.background.points, field.background.triangles
    centre = points[triangles].mean(axis=1)
    reach = np.hypot(*(points[triangles] - centre[:, None]).transpose(2, 0, 1)).max(axis=1)
    out = []
    for node in nodes:
        x = points[node]
        # triangles whose least size and distance cannot beat the nodal values are left out
        upper = term(field.sizes, np.hypot(*(points - x).T)).min()
        far = np.maximum(np.hypot(*(centre - x).T) - reach, 0.0)
        near = triangles[term(field.sizes[triangles].min(axis=1), far) <= upper * (1 + 1e-9)]
        a, b, c = (points[near[:, k]] for k in range(3))
        ha, hb, hc = (field.sizes[near[:, k]] for k in range(3))

        def across(s, x=x, a=a, b=b, c=c, ha=ha, hb=hb, hc=hc):
            p, q = a + s[:, None] * (b - a), a + s[:, None] * (c - a)
            hp, hq = ha + s * (hb - ha), ha + s * (hc - ha)

            def along(t):
                y = p + t[:, None] * (q - p)
                return term(hp + t * (hq - hp), np.hypot(*(y - x).T))

            ends = np.minimum(along(0 * s), along(0 * s + 1))
            return np.minimum(golden(along, np.zeros(len(a)), np.ones(len(a))), ends)

        zero = np.zeros(len(a))
        inner = golden(across, zero, zero + 1)
        out.append(min(inner.min(), across(zero).min(), across(zero + 1).min()))
    return np.array(out)


@pytest.mark.parametrize("name", CATALOGUE)
def test_agrees_with_brute_force_over_triangles(name):
    field = CATALOGUE[name]
    held = np.unique(field.background.triangles)
    nodes = np.random.default_rng(7).choice(held, 2)
    for alpha, beta in ((2.0, 1.0), (0.6, 0.85)):
        found = preserved(field, PreserveOptions(alpha=alpha, beta=beta)).sizes[nodes]
        wanted = beta * brute(field, lambda h, d, alpha=alpha: np.maximum(h, d / alpha), nodes)
        np.testing.assert_allclose(found, wanted, rtol=1e-12)
    for epsilon in (0.4,):
        found = limited(field, LimitOptions(epsilon=epsilon)).sizes[nodes]
        np.testing.assert_allclose(found, brute(field, lambda h, d, e=epsilon: h + e * d, nodes), rtol=1e-12)


@pytest.mark.parametrize("name", ["rough grid", "smooth grid", "flat cells", "plateau", "one cell"])
def test_grid_and_triangulation_agree(name):
    field = CATALOGUE[name]
    other = fields.as_triangles(field)
    np.testing.assert_allclose(
        preserved(field, PreserveOptions()).sizes, preserved(other, PreserveOptions()).sizes, rtol=2e-13
    )
    np.testing.assert_allclose(limited(field, LimitOptions()).sizes, limited(other, LimitOptions()).sizes, rtol=2e-13)


@pytest.mark.parametrize("name", CATALOGUE)
def test_slope_is_bounded_between_any_two_nodes(name):
    field = CATALOGUE[name]
    points = field.background.points[np.unique(field.background.triangles)]
    distance = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    for made, slope in (
        (preserved(field, PreserveOptions(alpha=1.5, beta=0.9)), 0.9 / 1.5),
        (limited(field, LimitOptions(epsilon=0.3)), 0.3),
    ):
        sizes = made.sizes[np.unique(field.background.triangles)]
        assert (np.abs(sizes[:, None] - sizes[None]) <= slope * distance * (1 + 1e-12) + 1e-13).all()
        assert (made.sizes <= field.sizes * (1 + 1e-15)).all()


def test_ring_has_its_closed_form():
    angle = 2 * np.pi * np.arange(720) / 720
    radii = fields.RADIUS + np.linspace(-0.2, 0.2, 161)  # nodes on the valley itself
    points = np.vstack([[[0.5 + r * np.cos(t), 0.5 + r * np.sin(t)] for t in angle] for r in radii])
    field = SizeField(BackgroundMesh(points, Delaunay(points).simplices), fields.ring_sizes(points))
    offset = fields.ring_offset(points)
    near = offset < 0.1
    wanted = np.maximum(fields.LEAST, (offset + fields.LEAST) / 3)
    found = preserved(field, PreserveOptions(alpha=2.0)).sizes
    # the polygon through the nodes of a circle leaves it by at most this much
    sagitta = fields.RADIUS * (1 - np.cos(np.pi / 720)) * 2
    assert np.abs(found - wanted)[near].max() < sagitta
    found = limited(field, LimitOptions(epsilon=0.5)).sizes
    assert np.abs(found - fields.LEAST - offset / 2)[near].max() < sagitta


def test_straight_valley_is_exact_on_a_grid():
    background = BackgroundMesh.unit_square_grid(65, 33)
    x = background.points[:, 0]
    field = SizeField(background, 0.01 + 0.8 * np.abs(x - 0.5))
    alpha = 2.0
    wanted = np.maximum(0.01, (0.01 + 0.8 * np.abs(x - 0.5)) / (1 + 0.8 * alpha))
    np.testing.assert_allclose(preserved(field, PreserveOptions(alpha=alpha)).sizes, wanted, rtol=1e-12)
    wanted = 0.01 + 0.5 * np.abs(x - 0.5)
    np.testing.assert_allclose(limited(field, LimitOptions(epsilon=0.5)).sizes, wanted, rtol=1e-12)


@pytest.mark.parametrize("name", CATALOGUE)
def test_limiting_along_edges_twice_changes_nothing(name):
    # (with straight distances the first result, linear again between nodes, can be steeper inside a triangle)
    options = LimitOptions(epsilon=0.4, distance="edges")
    once = limited(CATALOGUE[name], options)
    np.testing.assert_allclose(limited(once, options).sizes, once.sizes, rtol=1e-12)


@pytest.mark.parametrize("name", CATALOGUE)
def test_limiting_along_edges_is_dijkstra(name):
    field = CATALOGUE[name]
    start, ends, lengths = edge_graph(field.background)
    count = len(field.sizes)
    graph = csr_matrix((0.3 * lengths, ends, start), shape=(count, count)).tolil()
    joined = lil_matrix((count + 1, count + 1))
    joined[:count, :count] = graph
    joined[count, :count] = field.sizes
    wanted = dijkstra(joined.tocsr(), indices=count)[:count]
    found = limited(field, LimitOptions(epsilon=0.3, distance="edges")).sizes
    np.testing.assert_allclose(found, wanted, rtol=1e-12)


def test_edge_distances_overestimate_by_at_most_the_detour():
    field = fields.on_grid(31, 27, 21)
    points = field.background.points
    distance = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    exact = np.maximum(field.sizes, distance / 2.0).min(axis=1)  # over the nodes, which is all that edges reach
    ratio = preserved(field, PreserveOptions(distance="edges")).sizes / exact
    assert ratio.min() >= 1 - 1e-12
    assert ratio.max() <= np.sqrt(2.0) * (1 + 1e-12)
    printed = preserved(field, PreserveOptions(distance="edges-as-printed")).sizes / exact
    assert printed.min() < 0.95


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    scale=st.floats(1e-6, 1e6),
    angle=st.floats(0, 6.3),
    alpha=st.floats(0.2, 5),
    grid=st.booleans(),
)
def test_scaling_and_moving_the_plane_scales_and_moves_the_field(seed, scale, angle, alpha, grid):
    field = fields.on_grid(9, 7, seed) if grid else fields.on_triangles(50, seed, grading=1)
    turn = scale * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    background = field.background
    moved = SizeField(
        BackgroundMesh(background.points @ turn.T + scale * np.array([0.7, -0.4]), background.triangles),
        scale * field.sizes,
    )
    options = PreserveOptions(alpha=alpha)
    np.testing.assert_allclose(preserved(moved, options).sizes, scale * preserved(field, options).sizes, rtol=1e-8)
    slope = LimitOptions(epsilon=1 / alpha)
    np.testing.assert_allclose(limited(moved, slope).sizes, scale * limited(field, slope).sizes, rtol=1e-8)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), alpha=st.floats(0.2, 5))
def test_numbering_does_not_matter_and_bounds_hold(seed, alpha):
    field = fields.on_triangles(60, seed)
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(field.sizes))
    number = np.argsort(order)
    shuffled = SizeField(
        BackgroundMesh(field.background.points[order], number[rng.permutation(field.background.triangles)]),
        field.sizes[order],
    )
    made = preserved(field, PreserveOptions(alpha=alpha)).sizes
    np.testing.assert_allclose(preserved(shuffled, PreserveOptions(alpha=alpha)).sizes, made[order], rtol=1e-12)
    slope = limited(field, LimitOptions(epsilon=1 / alpha)).sizes
    assert (made <= slope * (1 + 1e-12)).all()
    assert (slope <= 2 * made * (1 + 1e-12)).all()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), share=st.floats(0.1, 1.0))
def test_smaller_sizes_give_smaller_fields_and_minima_commute(seed, share):
    field = fields.on_grid(11, 8, seed)
    rng = np.random.default_rng(seed)
    lower = field.with_sizes(field.sizes * np.where(rng.random(len(field.sizes)) < 0.3, share, 1.0))
    options = PreserveOptions(alpha=1.3)
    assert (preserved(lower, options).sizes <= preserved(field, options).sizes * (1 + 1e-13)).all()
    assert (limited(lower, LimitOptions()).sizes <= limited(field, LimitOptions()).sizes * (1 + 1e-13)).all()
    # Remark 1: the least of several fields respects each
    both = minimum([field, lower, field.with_sizes(np.full(len(field.sizes), 0.1))])
    np.testing.assert_array_equal(both.sizes, np.minimum(lower.sizes, 0.1))


def test_level_sets_are_dilated():
    field = fields.on_grid(41, 41, 11, spread=1.0)
    alpha, level = 1.7, 0.08
    made = preserved(field, PreserveOptions(alpha=alpha)).sizes
    points = field.background.points
    where = np.stack(np.meshgrid(np.linspace(-0.3, 0.7, 401), np.linspace(0.2, 1.2, 401)), axis=-1).reshape(-1, 2)
    low = where[field.at(where) <= level]
    distance = cKDTree(low).query(points)[0]
    spacing = np.hypot(1, 1) / 400
    clear = np.abs(distance - alpha * level) > spacing
    assert clear.mean() > 0.8
    np.testing.assert_array_equal((made <= level)[clear], (distance <= alpha * level)[clear])


def test_threads_do_not_change_a_bit():
    for field in (fields.on_grid(301, 211, 12), fields.on_triangles(9000, 13)):
        one = preserved(field, PreserveOptions(), threads=1).sizes
        np.testing.assert_array_equal(one, preserved(field, PreserveOptions(), threads=3).sizes)


def test_a_monitor_can_cancel_and_sees_progress_grow():
    class Stop:
        def __init__(self):
            self.seen = []

        def step(self, fraction, message=""):
            self.seen.append(fraction)
            if fraction > 0.3:
                raise Cancelled

    monitor = Stop()
    with pytest.raises(Cancelled):
        preserved(fields.on_grid(301, 301, 14), PreserveOptions(), monitor=monitor)
    assert monitor.seen == sorted(monitor.seen)
    assert monitor.seen[-1] < 1.0


@pytest.mark.parametrize(("nx", "ny"), [(2, 2), (3, 40), (8, 9), (9, 9), (17, 10), (33, 25)])
@pytest.mark.parametrize("spread", [0.05, 1.5])
def test_tiles_meet_at_every_size_of_grid(nx, ny, spread):
    field = fields.on_grid(nx, ny, nx * ny, width=0.4, height=1.1, spread=spread)
    other = fields.as_triangles(field)
    # on the steepest of these fields the rounding of the triangulation's points alone makes 3e-11
    for alpha in (0.5, 6.0):
        options = PreserveOptions(alpha=alpha)
        np.testing.assert_allclose(preserved(field, options).sizes, preserved(other, options).sizes, rtol=1e-9)
        slope = LimitOptions(epsilon=1 / alpha)
        np.testing.assert_allclose(limited(field, slope).sizes, limited(other, slope).sizes, rtol=1e-9)


def test_distances_that_do_nothing_are_refused():
    with pytest.raises(InputError, match="edges-as-printed"):
        LimitOptions(distance="edges-as-printed")
    with pytest.raises(InputError, match="choose one of"):
        PreserveOptions(distance="manhattan")
