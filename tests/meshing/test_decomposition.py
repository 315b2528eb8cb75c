"""The decomposition mesher: its parts against oracles, its meshes against what any mesh must be."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from shapely.geometry import LineString, Polygon

from sizeviz.errors import Cancelled, MeshingError
from sizeviz.geometry import Domain
from sizeviz.meshing.decomposition import Decomposition, _chord_kernels, _loop_kernels, _template_kernels
from sizeviz.meshing.decomposition.doublets import without_doublets
from sizeviz.meshing.decomposition.regions import regions
from sizeviz.meshing.frontal.boundary import outline
from sizeviz.meshing.options import MeshOptions
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sizing.background import Grid

SQUARE = Domain.unit_square()


def circle(x: float, y: float, r: float, n: int = 64) -> np.ndarray:
    t = np.arange(n) * (2 * np.pi / n)
    return np.column_stack([x + r * np.cos(t), y + r * np.sin(t)])


def star() -> Domain:
    k = np.arange(16)
    radius = np.where(k % 2, 0.4, 1.0)
    return Domain(np.column_stack([radius * np.cos(k * np.pi / 8), radius * np.sin(k * np.pi / 8)]))


DOMAINS = {
    "square": SQUARE,
    "disc": Domain(circle(0, 0, 1)),
    "L": Domain(np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2.0]])),
    "star": star(),
    "hole": Domain(SQUARE.outer, (circle(0.5, 0.5, 0.2),)),
    "four holes": Domain(SQUARE.outer, tuple(circle(x, y, 0.1) for x in (0.3, 0.7) for y in (0.3, 0.7))),
    "line and point": Domain(
        SQUARE.outer, lines=(np.array([[0.2, 0.2], [0.8, 0.6]]),), fixed_points=np.array([[0.2, 0.8]])
    ),
    "crossing lines": Domain(SQUARE.outer, lines=(np.array([[0, 0.3], [1, 0.6]]), np.array([[0.5, 0], [0.5, 1.0]]))),
}


def constant(domain: Domain, h: float) -> SizeField:
    x0, y0, x1, y1 = domain.bounds
    background = BackgroundMesh.regular(Grid(x0, y0, (x1 - x0) / 2, (y1 - y0) / 2, 3, 3))
    return SizeField(background, np.full(9, h))


def ring(m: float, nodes: int) -> SizeField:
    """The closed form of h* of the paper's section 5.1 for alpha = 2, with its valley as wide as the grid resolves."""
    background = BackgroundMesh.unit_square_grid(nodes, nodes)
    s = np.abs(np.hypot(*(background.points - 0.5).T) - 0.2575)
    return SizeField(background, np.minimum(0.25, np.maximum(m, (s + m) / 3)))


def mesh_of(domain: Domain, field: SizeField, scale: float = 1.0, **options: int):
    return Decomposition().generate(domain, field, MeshOptions(mesher="decomposition", scale=scale, **options))


def edges_of(quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    pairs = np.sort(np.vstack([quads[:, [k, (k + 1) % 4]] for k in range(4)]), axis=1)
    return np.unique(pairs, axis=0, return_counts=True)


def corner_qualities(mesh) -> np.ndarray:
    corner = mesh.points[mesh.quads]
    ahead, back = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    cross = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    return 2 * cross / ((ahead**2).sum(axis=2) + (back**2).sum(axis=2))


@pytest.mark.parametrize("name", DOMAINS)
@pytest.mark.parametrize("h", [0.3, 0.1, 0.03])
def test_meshes_are_valid(name, h):
    domain = DOMAINS[name]
    mesh = mesh_of(domain, constant(domain, h))
    border = outline(domain, constant(domain, h), 1.0)
    assert corner_qualities(mesh).min() > 0
    assert mesh.areas.sum() == pytest.approx(border.area, rel=1e-12)
    edges, count = edges_of(mesh.quads)
    assert count.max() == 2
    assert {tuple(e) for e in edges[count == 1].tolist()} == {
        tuple(sorted(e)) for e in border.edges[border.bounding].tolist()
    }
    assert {tuple(sorted(e)) for e in border.edges.tolist()} <= {tuple(e) for e in edges.tolist()}
    assert np.array_equal(mesh.points[: len(border.points)], border.points)
    assert np.array_equal(mesh.curve[: len(border.points)], border.curve)
    assert not mesh.fixed[len(border.points) :].any()
    assert np.array_equal(np.unique(mesh.quads), np.arange(mesh.n_points))


def test_a_square_becomes_squares():
    mesh = mesh_of(SQUARE, constant(SQUARE, 0.05))
    assert mesh.n_quads == 400
    assert corner_qualities(mesh).min() == pytest.approx(1.0)


def test_the_ring_follows_its_sizes():
    field = ring(4e-3, 1025)
    mesh = mesh_of(SQUARE, field)
    quality, areas = corner_qualities(mesh), mesh.areas
    sizes = field.at(mesh.points[mesh.quads].mean(axis=1))
    assert quality.min() > 0.1
    assert quality.mean() > 0.85
    assert np.median(np.sqrt(areas) / sizes) == pytest.approx(1.0, abs=0.15)
    assert (np.sqrt(areas) < 1.3 * sizes).mean() > 0.99


def test_no_doublet_is_left_inside():
    mesh = mesh_of(SQUARE, ring(8e-3, 513))
    inside = np.bincount(mesh.quads.ravel())[mesh.curve < 0]
    assert inside.min() >= 3


def test_the_same_mesh_again():
    one, two = (mesh_of(DOMAINS["hole"], constant(SQUARE, 0.06), threads=threads) for threads in (1, 2))
    assert np.array_equal(one.points, two.points)
    assert np.array_equal(one.quads, two.quads)


def test_smaller_scale_makes_more_elements():
    counts = [mesh_of(SQUARE, ring(2e-2, 257), scale).n_quads for scale in (1.0, 0.5)]
    assert counts[1] == pytest.approx(4 * counts[0], rel=0.25)


def test_too_many_elements_are_refused():
    with pytest.raises(MeshingError, match="max_elements"):
        mesh_of(SQUARE, constant(SQUARE, 0.01), max_elements=1000)


def test_the_monitor_rises_and_can_cancel():
    class Once:
        seen: list[float]

        def __init__(self, stop: float) -> None:
            self.seen, self.stop = [], stop

        def step(self, fraction: float, message: str = "") -> None:
            self.seen.append(fraction)
            if fraction > self.stop:
                raise Cancelled

    options = MeshOptions(mesher="decomposition", scale=1.0)
    whole = Once(2.0)
    Decomposition().generate(SQUARE, constant(SQUARE, 0.01), options, whole)
    assert whole.seen == sorted(whole.seen)
    assert whole.seen[-1] == pytest.approx(1.0)
    with pytest.raises(Cancelled):
        Decomposition().generate(SQUARE, constant(SQUARE, 0.01), options, Once(0.3))


@pytest.mark.parametrize("case", range(_template_kernels.N_CASES))
def test_each_case_fills_a_loop_of_six(case):
    inside = _template_kernels.inner_nodes(case)
    rows = _template_kernels.CASES[case, : 2 + inside].astype(int)
    assert rows.min() >= 0 and rows.max() < 6 + inside
    directed = [(row[k], row[(k + 1) % 4]) for row in rows for k in range(4)]
    assert len(set(directed)) == len(directed)
    alone = {e for e in directed if e[::-1] not in directed}
    assert alone == {(k, (k + 1) % 6) for k in range(6)}


def test_the_best_case_of_a_strip_is_rows_and_of_a_hexagon_has_a_middle():
    spot = np.zeros((8, 2))
    spot[:6] = [[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [0, 1]]
    case, worst = _template_kernels.best_case(spot, 2.0)
    assert case == 1 and worst == pytest.approx(1.0)
    t = np.arange(6) * np.pi / 3
    spot[:6] = np.column_stack([np.cos(t), np.sin(t)])
    case, worst = _template_kernels.best_case(spot, 3.0)
    assert case in (3, 4) and worst > 0.8
    assert spot[6] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_parity_is_kept_and_the_ratio_is_nearest():
    for count, parity in itertools.product(np.linspace(0.1, 12, 200), (0, 1)):
        edges = _chord_kernels.with_parity(count, parity)
        every = np.arange(2 - parity, 40, 2)
        error = np.abs(np.log(every / count))
        assert edges in every
        assert abs(np.log(edges / count)) <= error.min() + 1e-12


def test_nodes_on_a_chord_share_the_integral():
    field = ring(1e-2, 257)
    a, b, edges = np.array([0.05, 0.1]), np.array([0.9, 0.7]), 40
    s = np.linspace(0, 1, 200_001)
    h = field.at(a + np.outer(s, b - a))
    total = np.concatenate([[0], np.cumsum(np.hypot(*(b - a)) * np.diff(s) * (1 / h[1:] + 1 / h[:-1]) / 2)])
    count, _ = _chord_kernels.chord_count(field.sampler, 1.0, *a, *b, 0)
    assert count == pytest.approx(total[-1], rel=5e-3)
    inner = np.empty((edges - 1, 2))
    _chord_kernels.place(field.sampler, 1.0, *a, *b, edges, inner, 0, 0)
    at = np.hypot(*(inner - a).T) / np.hypot(*(b - a))
    shares = np.interp(at, s, total) / total[-1] * edges
    assert np.abs(shares - np.arange(1, edges)).max() < 0.1


def test_a_chord_is_seen_where_it_crosses_nothing():
    rng = np.random.default_rng(5)
    n = 14
    agreed = 0
    for _ in range(30):
        t = np.sort(rng.uniform(0, 2 * np.pi, n))
        points = rng.uniform(0.3, 1.0, n)[:, None] * np.column_stack([np.cos(t), np.sin(t)])
        polygon = Polygon(points)
        if (
            not polygon.is_valid
            or polygon.exterior.is_ccw is False
            or not polygon.contains(Polygon(circle(0, 0, 1e-3, 8)))
        ):
            continue
        _, xy, direction, angle, spacing = _loop_kernels.work_arrays(n)
        loop = np.arange(n, dtype=np.int32)
        _loop_kernels.unpack(loop, n, points, xy, direction, angle, spacing)
        assert angle.sum() == pytest.approx((n - 2) * np.pi)
        for i, j in itertools.combinations(range(n), 2):
            if j - i in (1, n - 1):
                continue
            chord = np.arctan2(*(points[j] - points[i])[::-1])
            leaves = _loop_kernels.angle_between(direction[i], chord) < angle[i]
            free = _loop_kernels.clears(loop, n, xy, spacing, *points[i], *points[j], i, j, 0.0)
            inside = polygon.covers(LineString([points[i], points[j]]))
            assert (leaves and free) == inside
            agreed += inside
    assert agreed > 100


def test_regions_of_lines_that_cross_and_a_hole():
    domain = Domain(
        SQUARE.outer, (circle(0.25, 0.75, 0.1),), lines=(np.array([[0, 0.5], [1, 0.5]]), np.array([[0.5, 0], [0.5, 1]]))
    )
    border = outline(domain, constant(domain, 0.1), 1.0)
    found = regions(border.points, border.edges, border.bounding)
    assert sorted(len(region.loops) for region in found) == [1, 1, 1, 2]
    for region in found:
        assert sum(len(loop) for loop in region.loops) % 2 == 0
        assert Polygon(border.points[region.loops[0]]).area == pytest.approx(0.25)


def test_a_doublet_is_merged_unless_its_node_must_stay():
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]])
    quads = np.array([[4, 3, 0, 1], [4, 1, 2, 3]], dtype=np.int32)
    kept = np.zeros(5, dtype=bool)
    _, merged, used = without_doublets(points, quads, kept)
    assert np.roll(merged[0], -int(merged[0].argmin())).tolist() == [0, 1, 2, 3]
    assert used.tolist() == [True] * 4 + [False]
    kept[4] = True
    assert len(without_doublets(points, quads, kept)[1]) == 2
