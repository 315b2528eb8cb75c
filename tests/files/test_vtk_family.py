"""VTK's own files, in every encoding, read as VTK means them; and VTK reads ours."""

from __future__ import annotations

import struct
import zlib
from base64 import b64encode
from pathlib import Path

import numpy as np
import pytest
import pyvista
from files.reader_seeds import grid_field, quad_mesh, triangle_field, vtk_bytes, vtk_grid, vtk_image, vtk_surface

from sizeviz.errors import InputError
from sizeviz.files import ReadOptions, read_domain, read_field, read_image, read_mesh, write_field, write_mesh

XML_MODES = [(mode, packed) for mode in ("Ascii", "Binary", "Appended") for packed in ("None", "ZLib", "LZMA")]
LEGACY_MODES = ["Ascii42", "Binary42", "Ascii51", "Binary51"]
EXAMPLES = Path(pyvista.__file__).parent / "examples"


def rows(cells: np.ndarray) -> list[list[int]]:
    """Return cells in the order of their corners: VTK turns their list round when it extracts a surface."""
    return sorted(cells.tolist())


def close(mode: str) -> float:
    """Return the relative precision that an encoding keeps: VTK writes six digits of ours."""
    return 1e-5 if mode.startswith("Ascii") else 0.0


@pytest.mark.parametrize(("mode", "packed"), XML_MODES)
@pytest.mark.parametrize("suffix", [".vtu", ".vtp"])
def test_xml_fields(tmp_path: Path, suffix: str, mode: str, packed: str) -> None:
    grid = vtk_grid() if suffix == ".vtu" else vtk_surface(vtk_grid())
    (tmp_path / f"f{suffix}").write_bytes(vtk_bytes(grid, suffix, tmp_path, mode, packed))
    field, given = read_field(tmp_path / f"f{suffix}"), triangle_field()
    assert rows(field.background.triangles) == rows(given.background.triangles)
    assert np.allclose(field.background.points, given.background.points, rtol=1e-6)  # VTK keeps these as float32
    assert np.allclose(field.sizes, np.linspace(0.5, 1.5, 30), rtol=close(mode), atol=0)


@pytest.mark.parametrize("mode", LEGACY_MODES)
@pytest.mark.parametrize("as_surface", [False, True])
def test_legacy_fields(tmp_path: Path, mode: str, as_surface: bool) -> None:
    grid = vtk_surface(vtk_grid()) if as_surface else vtk_grid()
    (tmp_path / "f.vtk").write_bytes(vtk_bytes(grid, ".vtk", tmp_path, mode))
    field = read_field(tmp_path / "f.vtk")
    assert rows(field.background.triangles) == rows(triangle_field().background.triangles)
    assert np.allclose(field.sizes, np.linspace(0.5, 1.5, 30), rtol=close(mode), atol=0)


@pytest.mark.parametrize("mode", LEGACY_MODES)
def test_legacy_meshes_keep_the_arrays_of_their_quadrilaterals(tmp_path: Path, mode: str) -> None:
    (tmp_path / "m.vtk").write_bytes(vtk_bytes(vtk_grid(with_quads=True), ".vtk", tmp_path, mode))
    content = read_mesh(tmp_path / "m.vtk")
    assert np.array_equal(content.mesh.quads, quad_mesh().quads)
    assert np.array_equal(content.cell_data["ratio"], np.arange(1.0, 10.0)), "cell 0 is a line"
    assert np.array_equal(content.mesh.fixed, quad_mesh().curve == 0)


@pytest.mark.parametrize("suffix", [".vtu", ".vtp"])
def test_xml_meshes_keep_the_arrays_of_their_quadrilaterals(tmp_path: Path, suffix: str) -> None:
    grid = vtk_grid(with_quads=True)
    grid = vtk_surface(grid) if suffix == ".vtp" else grid
    (tmp_path / f"m{suffix}").write_bytes(vtk_bytes(grid, suffix, tmp_path))
    content = read_mesh(tmp_path / f"m{suffix}")
    ratio = dict(zip(map(tuple, content.mesh.quads.tolist()), content.cell_data["ratio"], strict=True))
    assert ratio == dict(zip(map(tuple, quad_mesh().quads.tolist()), np.arange(1.0, 10.0), strict=True))


@pytest.mark.parametrize("suffix", [".vti", ".vtk"])
@pytest.mark.parametrize("mode", ["Ascii", "Binary"])
def test_images_of_any_slice(tmp_path: Path, suffix: str, mode: str) -> None:
    mode += "42" if suffix == ".vtk" else ""
    path = tmp_path / f"i{suffix}"
    path.write_bytes(vtk_bytes(vtk_image(), suffix, tmp_path, mode))
    volume = np.arange(60.0).reshape(3, 4, 5) + 1  # z, y, x
    middle = read_image(path)
    assert np.array_equal(middle.values, volume[1])
    assert (middle.spacing, middle.origin) == ((0.5, 0.25), (1.0, 2.0))
    across_x = read_image(path, ReadOptions(axis="x", slice=4))
    assert np.array_equal(across_x.values, volume[:, :, 4])
    assert (across_x.spacing, across_x.origin) == ((0.25, 2.0), (2.0, 3.0))
    assert np.array_equal(read_image(path, ReadOptions(axis="y", slice=0)).values, volume[:, 0, :])
    with pytest.raises(InputError, match="slice 3 does not exist; z has slices 0 to 2"):
        read_image(path, ReadOptions(slice=3))
    field = read_field(path, options=ReadOptions(array="values", slice=2))
    assert field.background.grid is not None
    assert np.array_equal(field.sizes, volume[2].ravel())


def test_images_that_ship_with_pyvista() -> None:
    frog, channels = read_image(EXAMPLES / "frog_tissues.vti"), read_image(EXAMPLES / "channels.vti")
    volume = pyvista.read(EXAMPLES / "frog_tissues.vti")
    slices = volume.active_scalars.reshape(volume.dimensions[::-1])
    assert np.array_equal(frog.values, slices[len(slices) // 2])
    assert channels.shape == (250, 250)
    assert channels.origin == (0.5, 0.5), "the values belong to cells, so to their centres"


def test_a_flat_image_needs_no_choice_of_slice(tmp_path: Path) -> None:
    image = pyvista.ImageData(dimensions=(1, 4, 3))
    image.point_data["values"] = np.arange(1.0, 13.0)
    (tmp_path / "i.vti").write_bytes(vtk_bytes(image, ".vti", tmp_path))
    assert np.array_equal(read_image(tmp_path / "i.vti").values, np.arange(1.0, 13.0).reshape(3, 4))


@pytest.mark.parametrize("suffix", [".vtu", ".vtk"])
def test_vtk_reads_what_we_write(tmp_path: Path, suffix: str) -> None:
    mesh = quad_mesh()
    other = pyvista.read(write_mesh(tmp_path / f"m{suffix}", mesh, {"ratio": np.arange(9.0)}, {"h": np.arange(16.0)}))
    assert np.array_equal(np.asarray(other.points)[:, :2], mesh.points)
    assert np.array_equal(other.cells_dict[9], mesh.quads)
    assert np.array_equal(other.cell_data["ratio"], np.arange(9.0))
    assert np.array_equal(other.point_data["h"], np.arange(16.0))
    field = pyvista.read(write_field(tmp_path / f"f{suffix}", grid_field()))
    assert np.array_equal(field.point_data["size"], grid_field().sizes)


def refused(tmp_path: Path, grid: object, words: str, suffix: str = ".vtu") -> None:
    (tmp_path / f"x{suffix}").write_bytes(vtk_bytes(grid, suffix, tmp_path))
    with pytest.raises(InputError, match=words) as caught:
        read_field(tmp_path / f"x{suffix}")
    assert str(tmp_path / f"x{suffix}") in str(caught.value)


def test_what_is_not_plane_and_isotropic_is_refused_with_what_is_supported(tmp_path: Path) -> None:
    plane = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    tensor = pyvista.UnstructuredGrid([3, 0, 1, 2], [5], plane)
    tensor.point_data["size"] = np.tile(np.eye(3).ravel(), (3, 1))
    refused(tmp_path, tensor, "9 components a node: an anisotropic metric.*only isotropic sizes")
    tilted = pyvista.UnstructuredGrid([3, 0, 1, 2], [5], np.eye(3))
    tilted.point_data["size"] = np.ones(3)
    refused(tmp_path, tilted, "three-dimensional.*only plane meshes are supported")
    solid = pyvista.UnstructuredGrid([4, 0, 1, 2, 3], [10], np.vstack([plane, [[0, 0, 1.0]]]))
    solid.point_data["size"] = np.ones(4)
    refused(tmp_path, solid, r"1 tetra \(a volume mesh\).*plane linear triangles")
    curved = pyvista.UnstructuredGrid([6, 0, 1, 2, 3, 4, 5], [22], np.vstack([plane, plane / 2 + 0.1]))
    curved.point_data["size"] = np.ones(6)
    refused(tmp_path, curved, "1 triangle6; a size field is read from plane linear triangles and quadrilaterals only")
    per_cell = pyvista.UnstructuredGrid([3, 0, 1, 2], [5], plane)
    per_cell.cell_data["size"] = np.ones(1)
    refused(tmp_path, per_cell, "values per cell; sizes are needed at the nodes")
    two = pyvista.UnstructuredGrid([3, 0, 1, 2], [5], plane)
    two.point_data["a"], two.point_data["b"] = np.ones(3), np.full(3, 2.0)
    refused(tmp_path, two, r"no array of sizes at its nodes \(found: a, b\)")
    assert read_field(tmp_path / "x.vtu", options=ReadOptions(array="b")).sizes[0] == 2.0


def test_other_data_sets_are_named(tmp_path: Path) -> None:
    pyvista.RectilinearGrid(np.arange(3.0), np.arange(3.0), np.zeros(1)).save(tmp_path / "r.vtk")
    with pytest.raises(InputError, match="data set is RECTILINEAR_GRID; UNSTRUCTURED_GRID, POLYDATA"):
        read_field(tmp_path / "r.vtk")
    (tmp_path / "l.vtu").write_bytes(vtk_bytes(vtk_grid(), ".vtu", tmp_path, "Binary", "LZ4"))
    with pytest.raises(InputError, match="compressed by vtkLZ4DataCompressor; save it again with zlib"):
        read_field(tmp_path / "l.vtu")


def test_clockwise_triangles_are_turned_and_unused_nodes_left_out(tmp_path: Path) -> None:
    points = np.array([[9.0, 9, 1], [0, 0, 1], [0, 1, 1], [1, 0, 1]])
    grid = pyvista.UnstructuredGrid([3, 1, 2, 3], [5], points)
    grid.point_data["h"] = np.array([np.nan, 0.1, 0.2, 0.3])
    (tmp_path / "f.vtu").write_bytes(vtk_bytes(grid, ".vtu", tmp_path))
    field = read_field(tmp_path / "f.vtu")
    assert field.background.triangles.tolist() == [[0, 2, 1]]
    assert field.sizes.tolist() == [0.1, 0.2, 0.3]


def bomb(points: int, blocks: int, announced: int) -> bytes:
    """Return a .vtu of a few kilobytes whose coordinates unpack to ``blocks`` times 16 MiB."""
    packed = zlib.compress(b"\0" * 2**24, 9)
    head = struct.pack("<3Q", blocks, announced, 0) + struct.pack("<Q", len(packed)) * blocks
    body = b64encode(head) + b64encode(packed * blocks)
    return (
        b'<VTKFile type="UnstructuredGrid" header_type="UInt64" compressor="vtkZLibDataCompressor"><UnstructuredGrid>'
        b'<Piece NumberOfPoints="%d" NumberOfCells="1"><Points><DataArray type="Float64" NumberOfComponents="3" '
        b'format="binary">%s</DataArray></Points></Piece></UnstructuredGrid></VTKFile>' % (points, body)
    )


@pytest.mark.parametrize(
    ("points", "announced", "words"),
    [
        (10**9, 2**24, "1000000000 points; between 0 and"),
        (20_000_000, 2**24, "unpacks to 5368709120 bytes, more than the"),
        (1000, 2**24, "more than the 24000 expected"),
        (20_000_000, 1000, "unpacks to more than"),
    ],
)
def test_a_file_that_unpacks_to_gigabytes_is_refused(tmp_path: Path, points: int, announced: int, words: str) -> None:
    (tmp_path / "b.vtu").write_bytes(bomb(points, 320, announced))
    assert (tmp_path / "b.vtu").stat().st_size < 2**24
    with pytest.raises(InputError, match=words):
        read_field(tmp_path / "b.vtu")


@pytest.mark.parametrize(
    "text",
    [
        b"# vtk DataFile Version 3.0\nx\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 2000000000 double\n",
        b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 2000000000 double\n1 2 3\n",
        b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 60000 60000 1\nORIGIN 0 0 0\n"
        b"SPACING 1 1 1\nPOINT_DATA 2000000000\nSCALARS h double\nLOOKUP_TABLE default\n1\n",
    ],
)
def test_what_a_file_announces_is_not_allocated_before_it_is_there(tmp_path: Path, text: bytes) -> None:
    (tmp_path / "f.vtk").write_bytes(text)
    with pytest.raises(InputError, match="cut or corrupt"):
        read_field(tmp_path / "f.vtk")


def test_a_surface_is_a_domain_too(tmp_path: Path) -> None:
    (tmp_path / "m.vtp").write_bytes(vtk_bytes(vtk_surface(vtk_grid(with_quads=True)), ".vtp", tmp_path))
    assert read_domain(tmp_path / "m.vtp").area == pytest.approx(quad_mesh().areas.sum(), rel=1e-6)


def test_more_legacy_cells_than_numbers_are_refused_before_memory_is_asked_for(tmp_path: Path) -> None:
    text = "# vtk DataFile Version 4.2\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 double\n0 0 0\n"
    (tmp_path / "c.vtk").write_text(f"{text}CELLS 2147483648 2\n1 0\nCELL_TYPES 1\n1\n")
    with pytest.raises(InputError, match="it announces 2147483648 cells in 2 numbers"):
        read_field(tmp_path / "c.vtk")
