"""The default mesher: quadrilaterals only, topology, area, boundary and sizes kept, on many domains."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sizeviz.errors import Cancelled, InputError, MeshingError
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.geometry.domain import signed_area
from sizeviz.meshing import GENERATORS, MeshOptions, generated
from sizeviz.meshing.checks import edges_of
from sizeviz.sizing import BackgroundMesh, Grid, SizeField


def field(sizes: str, n: int = 129) -> SizeField:
    """Return one of three fields on [-2, 2] x [-2, 2]."""
    background = BackgroundMesh.regular(Grid(-2.0, -2.0, 4 / (n - 1), 4 / (n - 1), n, n))
    x, y = background.points.T
    values = {
        "constant": 0.08 + 0 * x,
        "graded": 0.03 + 0.15 * np.abs(x),
        "point": np.minimum(0.2, 0.01 + 0.4 * np.hypot(x - 0.3, y - 0.2)),
    }
    return SizeField(background, values[sizes], sizes)


def ring_field(m: float = 2e-3, n: int = 513) -> SizeField:
    background = BackgroundMesh.unit_square_grid(n, n)
    s = np.abs(np.hypot(*(background.points - 0.5).T) - 0.2575)
    return SizeField(background, np.minimum(0.25, np.maximum(m, (s + m) / 3)))


def circle(n: int, radius: float = 1.0, x: float = 0.0, y: float = 0.0) -> NDArray[np.float64]:
    angle = 2 * np.pi * np.arange(n) / n
    return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)])


def star(points: int, inner: float) -> NDArray[np.float64]:
    angle = np.pi * np.arange(2 * points) / points
    radius = np.where(np.arange(2 * points) % 2 == 0, 1.0, inner)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
DOMAINS = {
    "square": Domain(SQUARE),
    "L": Domain([[0, 0], [1, 0], [1, 0.4], [0.4, 0.4], [0.4, 1], [0, 1]]),
    "T": Domain([[0, 0], [1, 0], [1, 0.3], [0.65, 0.3], [0.65, 1], [0.35, 1], [0.35, 0.3], [0, 0.3]]),
    "star": Domain(star(7, 0.35)),
    "needle": Domain([[0, 0], [1, -0.03], [1, 0.03]]),
    "slot": Domain([[0, 0], [1, 0], [1, 1], [0.51, 1], [0.5, 0.1], [0.49, 1], [0, 1]]),
    "turned": Domain(circle(4)),
    "disc": Domain(circle(120)),
    "holes": Domain(SQUARE, (circle(60, 0.2, -0.4, -0.4), circle(4, 0.25, 0.4, 0.4), circle(3, 0.2, 0.5, -0.5))),
    "gap": Domain(SQUARE, (circle(60, 0.2, -0.205), circle(60, 0.2, 0.205))),
    "line": Domain(SQUARE, lines=(np.array([[-0.6, -0.5], [0.6, 0.3]]),)),
    "regions": Domain(SQUARE, lines=(np.array([[0.0, -1.0], [0.1, 1.0]]), np.array([[-1.0, 0.0], [1.0, 0.1]]))),
    "points": Domain(SQUARE, fixed_points=np.array([[0.31, 0.47], [-0.2, 0.1]])),
}


def outer_edges(mesh: QuadMesh) -> NDArray[np.int32]:
    edges, count = edges_of(mesh.quads)
    return edges[count == 1]


def check(mesh: QuadMesh, domain: Domain) -> None:
    """Conforming, oriented, Euler's relation, boundary nodes on their curves, corners and fixed points kept."""
    edges, count = edges_of(mesh.quads)
    assert set(count.tolist()) <= {1, 2}
    directed = np.stack([mesh.quads, np.roll(mesh.quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    assert len(np.unique(directed, axis=0)) == len(directed)
    assert mesh.n_points - len(edges) + mesh.n_quads == 1 - len(domain.holes)
    assert len(np.unique(mesh.quads)) == mesh.n_points
    rim = np.unique(outer_edges(mesh))
    on_boundary = np.array([not curve.inner for curve in domain.curves])
    assert np.array_equal(rim, np.flatnonzero((mesh.curve >= 0) & on_boundary[mesh.curve]))
    for index, curve in enumerate(domain.curves):
        path = shapely.LineString(np.vstack([curve.points, curve.points[:1]]) if curve.closed else curve.points)
        assert shapely.distance(shapely.points(mesh.points[mesh.curve == index]), path).max(initial=0.0) < 1e-12
    for loop, corners in zip(domain.loops, domain.corners, strict=True):
        for point in loop[corners]:
            assert (mesh.fixed & (mesh.points == point).all(axis=1)).sum() == 1
    for point in domain.fixed_points:
        assert (mesh.fixed & (mesh.points == point).all(axis=1)).sum() == 1


@pytest.mark.parametrize("preset", ["direct", "fast"])
@pytest.mark.parametrize("sizes", ["constant", "graded", "point"])
@pytest.mark.parametrize("name", DOMAINS)
def test_every_domain_becomes_quadrilaterals_only(name: str, sizes: str, preset: str) -> None:
    domain = DOMAINS[name]
    mesh = generated(domain, field(sizes), MeshOptions(scale=1.0, preset=preset))
    check(mesh, domain)
    if name not in ("disc", "holes", "gap"):  # polygons, not samples of curves
        assert mesh.areas.sum() == pytest.approx(domain.area, rel=1e-9)


@settings(max_examples=25, deadline=None)
@given(st.integers(4, 24), st.integers(0, 100_000))
def test_random_simple_polygons(corners: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (corners, 2))
    loop = points[np.argsort(np.arctan2(*(points - points.mean(axis=0)).T))]
    if not shapely.Polygon(loop).is_valid or abs(signed_area(loop)) < 0.1:
        return
    domain = Domain(loop, corners=(np.ones(corners, dtype=bool),))
    mesh = generated(domain, field("graded"), MeshOptions(scale=1.0))
    check(mesh, domain)
    assert mesh.areas.sum() == pytest.approx(domain.area, rel=1e-9)


def test_an_inner_line_is_a_chain_of_edges() -> None:
    domain = DOMAINS["line"]
    mesh = generated(domain, field("constant"), MeshOptions(scale=1.0))
    on_line = np.flatnonzero(mesh.curve == len(domain.curves) - 1)
    edges, _ = edges_of(mesh.quads)
    along = np.isin(edges, on_line).all(axis=1)
    assert along.sum() == len(on_line) - 1
    length = np.hypot(*(mesh.points[edges[along, 0]] - mesh.points[edges[along, 1]]).T).sum()
    assert length == pytest.approx(np.hypot(1.2, 0.8))


def test_a_plateau_becomes_a_lattice() -> None:
    background = BackgroundMesh.unit_square_grid(3, 3)
    mesh = generated(Domain.unit_square(), SizeField(background, np.full(9, 0.05)), MeshOptions(scale=1.0))
    assert mesh.n_quads == 400
    assert np.allclose(mesh.areas, 0.0025)


@pytest.mark.parametrize("preset", ["direct", "fast"])
def test_sizes_are_followed(preset: str) -> None:
    size = ring_field()
    mesh = generated(Domain.unit_square(), size, MeshOptions(scale=1.0, preset=preset))
    corner = mesh.points[mesh.quads]
    edge = np.hypot(*np.moveaxis(corner - np.roll(corner, 1, axis=1), -1, 0)).mean(axis=1)
    ratio = edge / size.at(corner.mean(axis=1))
    assert 0.85 < np.median(ratio) < 1.1
    assert np.quantile(ratio, 0.99) < 1.6
    assert np.quantile(ratio, 0.01) > 0.5
    x, y = np.meshgrid((np.arange(3000) + 0.5) / 3000, (np.arange(3000) + 0.5) / 3000)
    asked = (1 / size.at(np.column_stack([x.ravel(), y.ravel()])) ** 2).mean()
    assert 0.9 < mesh.n_quads / asked < 1.15


def test_same_seed_same_mesh_another_seed_another_mesh() -> None:
    size, domain = ring_field(5e-3), Domain.unit_square()
    one, two = (generated(domain, size, MeshOptions(seed=3, threads=k)) for k in (1, 2))
    other = generated(domain, size, MeshOptions(seed=4))
    assert np.array_equal(one.points, two.points)
    assert np.array_equal(one.quads, two.quads)
    assert one.points.shape != other.points.shape or not np.array_equal(one.points, other.points)


def test_twice_the_domain_and_the_sizes_is_twice_the_mesh() -> None:
    size = ring_field(5e-3)
    background = size.background
    assert background.grid is not None
    doubled = SizeField(
        BackgroundMesh.regular(Grid(0.0, 0.0, 2 * background.grid.dx, 2 * background.grid.dy, 513, 513)), 2 * size.sizes
    )
    one = generated(Domain.unit_square(), size)
    two = generated(Domain.rectangle(0, 0, 2, 2), doubled)
    assert np.array_equal(one.quads, two.quads)
    assert np.allclose(2 * one.points, two.points, rtol=0, atol=1e-12)


def test_a_jump_in_size_does_not_break_it() -> None:
    background = BackgroundMesh.unit_square_grid(101, 101)
    size = SizeField(background, np.where(background.points[:, 0] < 0.5, 0.004, 0.1))
    mesh = generated(Domain.unit_square(), size, MeshOptions(scale=1.0))
    check(mesh, Domain.unit_square())
    assert mesh.areas.sum() == pytest.approx(1.0, rel=1e-9)


def test_too_many_elements_are_refused_before_meshing() -> None:
    background = BackgroundMesh.unit_square_grid(3, 3)
    size = SizeField(background, np.full(9, 1e-3))
    with pytest.raises(MeshingError, match="elements, more than 1000; raise"):
        generated(Domain.unit_square(), size, MeshOptions(max_elements=1000))


def test_cancel_ends_it() -> None:
    class Stop:
        def __init__(self) -> None:
            self.calls = 0

        def step(self, fraction: float, message: str = "") -> None:
            assert 0.0 <= fraction <= 1.0
            self.calls += 1
            if self.calls > 3:
                raise Cancelled

    with pytest.raises(Cancelled):
        generated(Domain.unit_square(), ring_field(), monitor=Stop())


def test_an_outline_that_crosses_itself_is_refused() -> None:
    bow = Domain([[0, 0], [1, 1], [1, 0], [0, 0.9]])
    with pytest.raises((InputError, MeshingError), match=r"crosses|no valid mesh"):
        generated(bow, field("constant"))


def test_options_and_names_are_checked() -> None:
    assert GENERATORS["frontal"].name == "frontal"
    with pytest.raises(InputError, match="not known; choose one of"):
        generated(Domain.unit_square(), field("constant"), MeshOptions(mesher="nothing"))
    for bad in ({"scale": 0.0}, {"scale": float("nan")}, {"seed": -1}, {"max_elements": 0}, {"threads": 0}):
        with pytest.raises(InputError):
            MeshOptions(**bad)
