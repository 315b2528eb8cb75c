"""VTK files: what goes in comes out, by our reader and by others; what is corrupt is refused in one line."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.files import read_field, read_mesh, write_field, write_mesh
from sizeviz.geometry import QuadMesh
from sizeviz.sizing import BackgroundMesh, SizeField


def small_mesh(n: int = 5) -> QuadMesh:
    x, y = np.meshgrid(np.linspace(0.0, 1.0, n), np.linspace(0.0, 2.0, n))
    points = np.column_stack([x.ravel(), y.ravel()])
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.column_stack([corner, corner + 1, corner + n + 1, corner + n]).astype(np.int32)
    edge = (x.ravel() % 1.0 == 0.0) | (y.ravel() % 2.0 == 0.0)
    return QuadMesh(points, quads, np.full(n * n, -1, dtype=np.int32), edge)


def small_field() -> SizeField:
    background = BackgroundMesh.unit_square_grid(4, 3)
    return SizeField(background, np.linspace(0.1, 0.3, 12))


def test_mesh_and_arrays_come_back_bit_for_bit(tmp_path: Path) -> None:
    mesh = small_mesh()
    ratio, target = np.random.default_rng(0).random(16), np.random.default_rng(1).random(25)
    back = read_mesh(write_mesh(tmp_path / "m.vtu", mesh, {"ratio": ratio}, {"size_target": target}))
    assert np.array_equal(back.mesh.points, mesh.points)
    assert np.array_equal(back.mesh.quads, mesh.quads)
    assert np.array_equal(back.mesh.fixed, mesh.fixed), "boundary nodes are the fixed ones"
    assert np.array_equal(back.cell_data["ratio"], ratio)
    assert np.array_equal(back.point_data["size_target"], target)


def test_meshio_reads_what_we_write(tmp_path: Path) -> None:
    mesh, ratio = small_mesh(), np.arange(16.0)
    other = meshio.read(write_mesh(tmp_path / "m.vtu", mesh, {"ratio": ratio}))
    assert np.array_equal(other.points[:, :2], mesh.points)
    assert np.array_equal(other.cells_dict["quad"], mesh.quads)
    assert np.array_equal(other.cell_data["ratio"][0], ratio)


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended", "AppendedRaw"])
def test_every_encoding_of_vtk_is_read(tmp_path: Path, mode: str, compressed: bool) -> None:
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import VTK_TRIANGLE, vtkUnstructuredGrid
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    field = small_field()
    grid = vtkUnstructuredGrid()
    points = vtkPoints()
    points.SetDataTypeToDouble()
    for x, y in field.background.points:
        points.InsertNextPoint(x, y, 0.0)
    grid.SetPoints(points)
    for triangle in field.background.triangles.tolist():
        grid.InsertNextCell(VTK_TRIANGLE, 3, triangle)
    sizes = numpy_to_vtk(np.array(field.sizes), deep=True)
    sizes.SetName("size")
    grid.GetPointData().AddArray(sizes)
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(tmp_path / "f.vtu"))
    writer.SetInputData(grid)
    writer.SetEncodeAppendedData(mode == "Appended")
    getattr(writer, f"SetDataModeTo{mode.removesuffix('Raw')}")()
    if not compressed:
        writer.SetCompressorTypeToNone()
    assert writer.Write() == 1
    back = read_field(tmp_path / "f.vtu")
    assert np.allclose(back.sizes, field.sizes, rtol=1e-6 if mode == "Ascii" else 0, atol=0)
    assert np.array_equal(back.background.triangles, field.background.triangles)


def test_field_comes_back_with_triangles_turned_counter_clockwise(tmp_path: Path) -> None:
    field = small_field()
    turned = SizeField(BackgroundMesh(field.background.points, field.background.triangles[:, ::-1].copy()), field.sizes)
    back = read_field(write_field(tmp_path / "f.vtu", turned))
    assert np.array_equal(back.sizes, field.sizes)
    a, b, c = (back.background.points[back.background.triangles[:, k]] for k in range(3))
    assert (np.cross(np.c_[b - a, np.zeros(len(a))], np.c_[c - a, np.zeros(len(a))])[:, 2] > 0).all()


def test_quads_with_sizes_are_a_field_too(tmp_path: Path) -> None:
    mesh = small_mesh()
    sizes = 0.1 + mesh.points[:, 0]
    back = read_field(write_mesh(tmp_path / "m.vtu", mesh, {}, {"size_target": sizes}))
    assert len(back.background.triangles) == 2 * mesh.n_quads
    assert np.array_equal(back.sizes, sizes)


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda text: text[: len(text) // 2], "not well-formed"),
        (lambda text: text.replace("UnstructuredGrid", "PolyData"), "no triangle or quadrilateral"),
        (lambda text: text.replace("UnstructuredGrid", "RectilinearGrid"), "holds a RectilinearGrid"),
        (lambda text: text.replace("<Piece ", "<Pieces ").replace("</Piece>", "</Pieces>"), "has 0 pieces"),
        (lambda text: text.replace('format="binary">', 'format="binary">////', 1), "cut or corrupt"),
        (lambda text: text.replace('Name="types"', 'Name="kinds"'), "no types"),
        (lambda text: text.replace('type="Float64"', 'type="Text"'), "type 'Text'"),
        (lambda text: text.replace("PointData", "FieldData"), "no array of sizes"),
        (lambda text: '<!DOCTYPE x [<!ENTITY a "b">]>' + text.removeprefix('<?xml version="1.0"?>'), "entities"),
        (lambda text: "no XML at all", "not well-formed"),
    ],
)
def test_damaged_files_are_refused_by_name(tmp_path: Path, damage, words: str) -> None:
    path = write_field(tmp_path / "f.vtu", small_field())
    path.write_text(damage(path.read_text()))
    with pytest.raises(InputError, match=words) as caught:
        read_field(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_mesh_is_no_mesh_of_triangles(tmp_path: Path) -> None:
    path = write_field(tmp_path / "f.vtu", small_field())
    with pytest.raises(InputError, match="holds 12 triangles; a mesh is read from plane linear quadrilaterals only"):
        read_mesh(path)


@pytest.mark.parametrize("value", [np.nan, 0.0, -1.0, np.inf])
def test_sizes_that_make_no_sense_are_refused(tmp_path: Path, value: float) -> None:
    mesh = small_mesh()
    path = write_mesh(tmp_path / "m.vtu", mesh, {}, {"size": np.full(25, value)})
    with pytest.raises(InputError, match=r"m\.vtu.*25 of 25 sizes"):
        read_field(path)
