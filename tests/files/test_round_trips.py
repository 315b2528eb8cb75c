"""What is written comes back: every bit where the format keeps bits, for fields and meshes of every kind."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest
from files.reader_seeds import grid_field, quad_mesh, triangle_field
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from sizeviz.errors import InputError
from sizeviz.files import read_domain, read_field, read_mesh, write_field, write_mesh
from sizeviz.files.registry import FIELD_WRITERS, MESH_READERS, MESH_WRITERS
from sizeviz.geometry import QuadMesh
from sizeviz.sizing import BackgroundMesh, Grid, SizeField

RANDOM = np.random.default_rng(5)


def scaled(field: SizeField, factor: float) -> SizeField:
    """Return a field of another length scale, whose numbers need all their digits."""
    background = BackgroundMesh(field.background.points * factor, field.background.triangles)
    return SizeField(background, field.sizes * factor)


def far_away() -> SizeField:
    """Return a field far from the origin, as of map coordinates, with sizes over nine decades."""
    grid = Grid(4_512_345.678, -812_345.1, 12.5, 0.1, 9, 4)
    return SizeField(BackgroundMesh.regular(grid), 10.0 ** RANDOM.uniform(-6, 3, 36))


FIELDS: dict[str, Callable[[], SizeField]] = {
    "grid": grid_field,
    "triangles": triangle_field,
    "tiny": lambda: scaled(triangle_field(), 1e-9 / 3),
    "huge": lambda: scaled(triangle_field(), 1e9 / 7),
    "far away": far_away,
    "one triangle": lambda: SizeField(
        BackgroundMesh(np.array([[0.0, 0.0], [1 / 3, 0.0], [0.1, 2 / 3]]), np.array([[0, 1, 2]], dtype=np.int32)),
        np.array([0.1, 0.2, 1 / 3]),
    ),
}


def same_field(a: SizeField, b: SizeField) -> bool:
    """Whether two fields are the same function, bit for bit, however their nodes are numbered."""
    order_a, order_b = np.lexsort(a.background.points.T), np.lexsort(b.background.points.T)
    if not np.array_equal(a.background.points[order_a], b.background.points[order_b]):
        return False
    names_a, names_b = np.argsort(order_a), np.argsort(order_b)
    cells_a, cells_b = (
        sorted(tuple(sorted(row)) for row in names[f.background.triangles].tolist())
        for names, f in ((names_a, a), (names_b, b))
    )
    return cells_a == cells_b and np.array_equal(a.sizes[order_a], b.sizes[order_b])


@pytest.mark.parametrize("suffix", sorted(set(FIELD_WRITERS) - {".npy"}))
@pytest.mark.parametrize("name", FIELDS)
def test_a_field_comes_back_bit_for_bit(tmp_path: Path, name: str, suffix: str) -> None:
    field = FIELDS[name]()
    back = read_field(write_field(tmp_path / f"f{suffix}", field))
    assert same_field(back, field)
    assert back.label == f"f{suffix}"


NUMBERS = st.floats(1e-50, 1e50) | st.floats(0.1, 10.0)


@pytest.mark.parametrize("suffix", sorted(set(FIELD_WRITERS) - {".npy"}))
@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(sizes=st.lists(NUMBERS, min_size=6, max_size=6), x0=st.floats(-1e6, 1e6), dx=NUMBERS, dy=NUMBERS)
def test_any_numbers_come_back(
    tmp_path: Path, suffix: str, sizes: list[float], x0: float, dx: float, dy: float
) -> None:
    x, y = x0 + dx * np.arange(3), -dy * np.arange(2)
    assume(len(set(x)) == 3 and 0.01 < dx / dy < 100)
    points = np.column_stack([np.tile(x, 2), np.repeat(y, 3)])
    triangles = np.array([[0, 4, 1], [0, 3, 4], [1, 5, 2], [1, 4, 5]], dtype=np.int32)
    field = SizeField(BackgroundMesh(points, triangles), np.array(sizes))
    assert same_field(read_field(write_field(tmp_path / f"f{suffix}", field)), field)


@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".npz"])
def test_a_grid_comes_back_as_a_grid(tmp_path: Path, suffix: str) -> None:
    back = read_field(write_field(tmp_path / f"f{suffix}", far_away()))
    assert back.background.grid == far_away().background.grid


def test_a_grid_that_was_tampered_with_is_a_triangulation(tmp_path: Path) -> None:
    path = write_field(tmp_path / "f.vtk", grid_field())
    x, elsewhere = np.array([-0.5], ">f8").tobytes(), np.array([-0.625], ">f8").tobytes()
    data = path.read_bytes()
    points = data.index(b"POINTS")
    path.write_bytes(data[:points] + data[points:].replace(x, elsewhere, 1))
    back = read_field(path)
    assert back.background.grid is None
    assert back.background.points[0, 0] == -0.625


def test_a_bare_array_keeps_its_sizes(tmp_path: Path) -> None:
    field = grid_field()
    x0, y0, x1, y1 = field.background.bounds
    from sizeviz.files import ReadOptions

    back = read_field(write_field(tmp_path / "f.npy", field), options=ReadOptions(extent=(x0, y0, x1, y1)))
    assert np.array_equal(back.sizes, field.sizes)
    assert np.allclose(back.background.points, field.background.points, rtol=0, atol=1e-15)


def test_files_are_the_same_for_the_same_field(tmp_path: Path) -> None:
    for suffix in FIELD_WRITERS:
        a, b = (write_field(tmp_path / f"{name}{suffix}", grid_field()).read_bytes() for name in "ab")
        assert a == b, suffix
    for suffix in (".vtu", ".vtk", ".msh", ".obj", ".mesh"):
        a, b = (write_mesh(tmp_path / f"{name}{suffix}", quad_mesh()).read_bytes() for name in "ab")
        assert a == b, suffix


MESHES: dict[str, Callable[[], QuadMesh]] = {
    "small": quad_mesh,
    "large": lambda: quad_mesh(60),
    "far away": lambda: quad_mesh().with_points(quad_mesh().points * 1e-3 / 7 + 12345.678),
}


@pytest.mark.parametrize("suffix", sorted(MESH_READERS.keys() & MESH_WRITERS.keys()))
@pytest.mark.parametrize("name", MESHES)
def test_a_mesh_comes_back_bit_for_bit(tmp_path: Path, name: str, suffix: str) -> None:
    mesh = MESHES[name]()
    ratio, target = RANDOM.random(mesh.n_quads), RANDOM.random(mesh.n_points)
    vectors = RANDOM.random((mesh.n_points, 3))
    points = {"size_target": target, 'a name, with <odd> "signs" & %': vectors}
    back = read_mesh(write_mesh(tmp_path / f"m{suffix}", mesh, {"ratio": ratio}, points))
    assert np.array_equal(back.mesh.points, mesh.points)
    assert np.array_equal(back.mesh.quads, mesh.quads)
    if suffix == ".mesh":  # a format without arrays: boundary nodes are fixed
        assert np.array_equal(back.mesh.fixed, mesh.curve == 0)
        assert (back.mesh.curve == -1).all()
        return
    assert np.array_equal(back.mesh.curve, mesh.curve)
    assert np.array_equal(back.mesh.fixed, mesh.fixed)
    assert np.array_equal(back.cell_data["ratio"], ratio)
    assert np.array_equal(back.point_data["size_target"], target)
    others = [values for label, values in back.point_data.items() if label.startswith("a name")]
    assert len(others) == 1 and np.array_equal(others[0], vectors)


@pytest.mark.parametrize("suffix", sorted(set(MESH_WRITERS) - {".mdpa", ".dat"}))
def test_meshio_reads_every_mesh_bit_for_bit(tmp_path: Path, suffix: str) -> None:
    mesh = quad_mesh(9)
    other = meshio.read(write_mesh(tmp_path / f"m{suffix}", mesh, {"ratio": np.arange(64.0)}, {"h": np.arange(81.0)}))
    assert np.array_equal(other.points[:, :2], mesh.points)
    assert np.array_equal(other.cells_dict["quad"], mesh.quads)
    if suffix in (".vtu", ".vtk", ".msh"):
        assert np.array_equal(other.cell_data["ratio"][0], np.arange(64.0))
        assert np.array_equal(other.point_data["h"], np.arange(81.0))


@pytest.mark.parametrize(("suffix", "kind"), [(".mdpa", "mdpa"), (".dat", "tecplot")])
def test_meshio_reads_meshes_whose_suffix_means_several_things(tmp_path: Path, suffix: str, kind: str) -> None:
    mesh = quad_mesh(9)
    other = meshio.read(write_mesh(tmp_path / f"m{suffix}", mesh), file_format=kind)
    assert np.array_equal(other.points[:, :2], mesh.points)
    assert np.array_equal(other.cells_dict["quad"], mesh.quads)


@pytest.mark.parametrize("suffix", sorted(MESH_READERS.keys() & MESH_WRITERS.keys()))
def test_the_outline_of_a_mesh_is_a_domain(tmp_path: Path, suffix: str) -> None:
    mesh = quad_mesh()
    domain = read_domain(write_mesh(tmp_path / f"m{suffix}", mesh))
    assert domain.area == pytest.approx(mesh.areas.sum(), rel=1e-14)
    assert not domain.holes
    assert len(domain.outer) == 12


def test_the_outline_of_a_mesh_with_a_hole(tmp_path: Path) -> None:
    mesh = quad_mesh(6)
    holed = QuadMesh(mesh.points, np.delete(mesh.quads, [12], axis=0), mesh.curve, mesh.fixed)
    domain = read_domain(write_mesh(tmp_path / "m.vtu", holed))
    assert [len(hole) for hole in domain.holes] == [4]
    assert domain.area == pytest.approx(holed.areas.sum(), rel=1e-14)


def test_a_mesh_whose_parts_touch_at_a_node_has_no_outline(tmp_path: Path) -> None:
    mesh = quad_mesh(3)
    pinched = QuadMesh(mesh.points, mesh.quads[[0, 3]], mesh.curve, mesh.fixed)
    with pytest.raises(InputError, match="branches or is open"):
        read_domain(write_mesh(tmp_path / "m.vtu", pinched))
