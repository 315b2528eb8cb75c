"""Ratios, qualities and counts against shapes whose figures are known."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.conformity import MEASURES, element_sizes, irregular_fraction, judged, shape_quality
from sizeviz.errors import InputError
from sizeviz.sizing import BackgroundMesh, SizeField
from tests import fields, meshes


def constant(size: float) -> SizeField:
    return SizeField(BackgroundMesh.unit_square_grid(3, 3), np.full(9, size))


def test_sizes_of_a_rectangle():
    mesh = meshes.one([[0, 0], [3, 0], [3, 1], [0, 1]])
    assert [float(element_sizes(mesh, m)[0]) for m in MEASURES] == pytest.approx([2.0, np.sqrt(3.0), 3.0])
    with pytest.raises(InputError, match="mean-edge"):
        element_sizes(mesh, "volume")


@pytest.mark.parametrize(
    ("corners", "quality"),
    [
        ([[0, 0], [1, 0], [1, 1], [0, 1]], 1.0),
        ([[0, 0], [2, 0], [2, 1], [0, 1]], 2 * 2 / (1 + 4)),
        ([[0, 0], [1, 0], [1.5, np.sqrt(0.75)], [0.5, np.sqrt(0.75)]], np.sqrt(0.75)),
        ([[0, 0], [1, 0], [2, 0], [1, 1]], 0.0),
        ([[0, 0], [1, 0], [0.2, 0.2], [0, 1]], 0.0),
        ([[0, 0], [0, 1], [1, 1], [1, 0]], 0.0),
    ],
)
def test_quality_of_known_shapes(corners, quality):
    assert shape_quality(meshes.one(corners))[0] == pytest.approx(quality)


def test_quality_does_not_depend_on_place_turn_scale_or_first_corner():
    mesh = meshes.perturbed_grid(5, 0.3, 1)
    turn = 37.0 * np.array([[0.6, -0.8], [0.8, 0.6]])
    moved = meshes.quad_mesh(mesh.points @ turn.T + 5.0, np.roll(mesh.quads, 1, axis=1))
    np.testing.assert_allclose(shape_quality(moved), shape_quality(mesh), rtol=1e-11)


def test_irregular_nodes():
    assert irregular_fraction(meshes.square_grid(4, 3)) == 0.0
    assert irregular_fraction(meshes.star(4)) == 0.0
    assert irregular_fraction(meshes.star(5)) == 1.0
    assert irregular_fraction(meshes.square_grid(1, 1)) == 0.0


def test_an_element_of_exactly_the_size_asked_for_is_correct():
    mesh = meshes.square_grid(7, 7)
    report = judged(mesh, constant(1 / 7), ideal=49.0)
    assert report.correct_percent == dict.fromkeys(MEASURES, 100.0)
    assert report.efficiency == pytest.approx(1.0)
    above = judged(mesh, constant(1 / 7 / (1 + 1e-6)))
    assert above.correct_count == dict.fromkeys(MEASURES, 0)
    assert judged(mesh, constant(1 / 7 / 1.5), beta=1.5).max_ratio["max-edge"] == pytest.approx(1.0)
    with pytest.raises(InputError, match="beta"):
        judged(mesh, constant(0.1), beta=0.0)


def test_summary_counts_and_worst_elements():
    mesh = meshes.perturbed_grid(12, 0.9, 3)
    report = judged(mesh, fields.on_grid(9, 9, 4).with_sizes(np.linspace(0.05, 0.2, 81)))
    assert report.n_inverted == np.count_nonzero(report.quality == 0.0) > 0
    worst = report.worst(5, "ratio", "max-edge")
    np.testing.assert_array_equal(report.ratio("max-edge")[worst], np.sort(report.ratio("max-edge"))[::-1][:5])
    assert report.quality[report.worst(1, "quality")[0]] == report.quality_summary["min"]
    summary = report.summary()
    assert summary["n_quads"] == 144
    assert summary["max_ratio"]["max_edge"] == report.max_ratio["max-edge"]
    assert report.table()["correct faces"] == np.count_nonzero(report.ratio("mean-edge") <= 1 + 1e-9)


@pytest.mark.parametrize("name", fields.catalogue())
@pytest.mark.parametrize("scale", [0.01, 0.1, 0.5])
def test_minimum_over_elements_is_that_of_dense_samples(name, scale):
    field = fields.catalogue()[name]
    rng = np.random.default_rng(5)
    x0, y0, x1, y1 = field.background.bounds
    extent = np.array([x1 - x0, y1 - y0])
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + rng.uniform(-0.2, 0.2, (30, 4, 2))
    points = rng.random((30, 1, 2)) * (1 - 1.3 * scale) + scale * (corners + 0.2) * 0.9
    points = (points * extent + (x0, y0)).reshape(-1, 2)
    quads = np.arange(120).reshape(-1, 4)
    found = field.min_over(points, quads)
    u, v = (side.ravel() for side in np.meshgrid(np.linspace(0, 1, 61), np.linspace(0, 1, 61)))
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])
    for quad, least in zip(quads, found, strict=True):
        where = weights.T @ points[quad]
        if name == "frame":  # over the hole only the corners of an element count
            where = np.vstack([points[quad], where[(np.abs(where - 0.5) >= 0.125).any(axis=1)]])
        sampled = field.at(where).min()
        assert least <= sampled * (1 + 1e-12)
        # no sample is further than this from the minimum, and the field is no steeper than that
        reach = np.hypot(*np.ptp(points[quad], axis=0)) / 60
        assert least >= sampled - reach * steepest(field) - 1e-12


def steepest(field: SizeField) -> float:
    a, b, c = (field.background.points[field.background.triangles[:, k]] for k in range(3))
    frame = np.stack([b - a, c - a], axis=1)
    held = field.sizes[field.background.triangles]
    gradient = np.linalg.solve(frame, (held[:, 1:] - held[:, :1])[:, :, None])[:, :, 0]
    return float(np.hypot(*gradient.T).max())


def test_minimum_finds_a_single_node_a_crossing_and_both_backgrounds_agree():
    background = BackgroundMesh.unit_square_grid(5, 5)
    sizes = np.ones(25)
    sizes[12] = 0.1
    field = SizeField(background, sizes)
    points = np.array([[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6], [0.5, 0.1], [0.9, 0.5], [0.9, 0.6], [0.5, 0.75]])
    quads = np.array([[0, 1, 2, 3], [1, 5, 6, 2]])
    found = field.min_over(points, quads)
    # right of the node, the edge x = 0.6 comes closest on the horizontal line through it
    np.testing.assert_allclose(found, [0.1, 0.1 + 0.9 * 0.4], rtol=1e-14)
    np.testing.assert_allclose(fields.as_triangles(field).min_over(points, quads), found, rtol=1e-13)


def test_formula_minimum_over_the_ring():
    from sizeviz.sizing import AnalyticSize

    def ring(x, y):
        return fields.ring_sizes(np.column_stack([np.ravel(x), np.ravel(y)])).reshape(np.shape(x))

    size = AnalyticSize(ring, constant(0.1))
    mesh = meshes.square_grid(160, 160)
    low = mesh.points[mesh.quads].min(axis=1) - 0.5
    high = low + 1 / 160
    nearest = np.hypot(*np.maximum(np.maximum(low, -high), 0.0).T)
    furthest = np.hypot(*np.maximum(np.abs(low), np.abs(high)).T)
    offset = np.maximum(np.maximum(nearest - fields.RADIUS, fields.RADIUS - furthest), 0.0)
    wanted = np.minimum(0.25, offset + fields.LEAST)
    np.testing.assert_allclose(size.min_over(mesh.points, mesh.quads), wanted, rtol=2e-6)
