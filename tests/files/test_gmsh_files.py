"""Gmsh meshes with our fields, and its meshes come back."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from files.reader_seeds import MSH_TEXT, POS_TEXT

from sizeviz.conformity import judged
from sizeviz.errors import InputError
from sizeviz.files import read_domain, read_field, read_mesh, write_field
from sizeviz.sizing import BackgroundMesh, PreserveOptions, SizeField, preserved

MESH_WITH = """
import json, sys
import gmsh
background, out = sys.argv[1:]
gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
gmsh.merge(background)
gmsh.model.add("square")
gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
gmsh.model.occ.synchronize()
field = gmsh.model.mesh.field.add("PostView")
gmsh.model.mesh.field.setNumber(field, "ViewTag", gmsh.view.getTags()[0])
gmsh.model.mesh.field.setAsBackgroundMesh(field)
for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
    gmsh.option.setNumber(f"Mesh.MeshSize{name}", 0)
for name, value in (("RecombineAll", 1), ("RecombinationAlgorithm", 3), ("Algorithm", 8)):
    gmsh.option.setNumber(f"Mesh.{name}", value)
gmsh.model.mesh.generate(2)
for version, binary in ((4.1, 0), (4.1, 1), (2.2, 0), (2.2, 1)):
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.write(f"{out}/{version}-{binary}.msh")
gmsh.finalize()
"""


def growing_field() -> SizeField:
    """Return sizes that grow from the centre of the unit square."""
    x, y = np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 41))
    return SizeField(BackgroundMesh.unit_square_grid(41, 41), (0.02 + 0.15 * np.hypot(x - 0.5, y - 0.5)).ravel())


@pytest.mark.gmsh
@pytest.mark.parametrize("suffix", [".pos", ".msh"])
def test_gmsh_meshes_to_our_field_and_we_read_its_mesh(tmp_path: Path, suffix: str) -> None:
    field = growing_field()
    path = write_field(tmp_path / f"h{suffix}", field)
    subprocess.run([sys.executable, "-c", MESH_WITH, str(path), str(tmp_path)], check=True, timeout=120)
    meshes = [read_mesh(tmp_path / name).mesh for name in ("4.1-0.msh", "4.1-1.msh", "2.2-0.msh")]
    for mesh in meshes:
        assert mesh.areas.sum() == pytest.approx(1.0, rel=1e-12)
        assert (mesh.areas > 0).all()
    corner = meshes[0].points[meshes[0].quads]
    edges = np.linalg.norm(np.roll(corner, -1, axis=1) - corner, axis=2).mean(axis=1)
    sizes = field.at(corner.mean(axis=1))
    assert 0.75 < np.exp(np.log(edges / sizes).mean()) < 1.3, "the mesh follows the field"
    assert np.corrcoef(np.log(edges), np.log(sizes))[0, 1] > 0.8
    assert read_domain(tmp_path / "4.1-1.msh").area == pytest.approx(1.0, rel=1e-12)
    with pytest.raises(InputError, match=r"binary version 2\.2; 4\.1 and ASCII 2\.2 are supported"):
        read_mesh(tmp_path / "2.2-1.msh")


@pytest.mark.gmsh
def test_gmshs_meshes_are_judged_and_ours_is_the_field_to_give_it(tmp_path: Path) -> None:
    """The paper's "non-intrusive": with h* from a file, somebody else's mesher keeps far more of what h asked for."""
    x, y = np.meshgrid(np.linspace(0, 1, 65), np.linspace(0, 1, 65))
    sizes = np.clip(np.abs(x - 0.4 - 0.2 * y), 0.02, 0.2).ravel()
    asked = SizeField(BackgroundMesh.unit_square_grid(65, 65), sizes)
    shares = []
    for name, field in (("h", asked), ("h-star", preserved(asked, PreserveOptions(alpha=2.0)))):
        path = write_field(tmp_path / f"{name}.pos", field)
        (tmp_path / name).mkdir()
        subprocess.run([sys.executable, "-c", MESH_WITH, str(path), str(tmp_path / name)], check=True, timeout=120)
        report = judged(read_mesh(tmp_path / name / "4.1-1.msh").mesh, asked)
        assert report.n_inverted == 0 and report.quality_summary["mean"] > 0.5
        shares.append(report.correct_percent["sqrt-area"])
    assert shares[1] > shares[0] + 20.0


@pytest.mark.gmsh
def test_gmsh_reads_our_view_as_we_mean_it(tmp_path: Path) -> None:
    path = write_field(tmp_path / "h.pos", growing_field())
    probe = (
        "import gmsh, json, sys\ngmsh.initialize(interruptible=False)\ngmsh.option.setNumber('General.Terminal', 0)\n"
        "gmsh.merge(sys.argv[1])\ntag = gmsh.view.getTags()[0]\n"
        "print(json.dumps([gmsh.view.probe(tag, x, y, 0)[0][0] for x, y in json.loads(sys.argv[2])]))"
    )
    where = np.random.default_rng(0).random((50, 2))
    command = [sys.executable, "-c", probe, str(path), json.dumps(where.tolist())]
    shown = subprocess.run(command, check=True, timeout=120, capture_output=True, text=True).stdout
    assert np.allclose(json.loads(shown.splitlines()[-1]), growing_field().at(where), rtol=1e-12)


def test_a_written_out_file_with_parametric_nodes_and_scattered_numbers(tmp_path: Path) -> None:
    (tmp_path / "f.msh").write_text(MSH_TEXT)
    field = read_field(tmp_path / "f.msh")
    at = {tuple(point): size for point, size in zip(field.background.points.tolist(), field.sizes, strict=True)}
    assert at == {(0, 0): 0.1, (1, 0): 0.2, (1, 1): 0.3, (0, 1): 0.4, (0.5, 0.5): 0.05}
    assert len(field.background.triangles) == 4


def test_a_view_of_triangles_and_quadrangles_takes_the_smaller_size_where_they_meet(tmp_path: Path) -> None:
    (tmp_path / "f.pos").write_text(POS_TEXT)
    field = read_field(tmp_path / "f.pos")
    at = {tuple(point): size for point, size in zip(field.background.points.tolist(), field.sizes, strict=True)}
    assert at == {(0, 0): 0.1, (1, 0): 0.2, (2, 0): 0.5, (1, 1): 0.3, (0, 1): 0.4}
    assert len(field.background.triangles) == 3


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            'View "t" { TT(0,0,0,1,0,0,0,1,0){1,0,0,0,1,0,0,0,1,1,0,0,0,1,0,0,0,1}; };',
            "TT elements, a tensor.*isotropic",
        ),
        ('View "v" { VT(0,0,0,1,0,0,0,1,0){1,0,0,0,1,0,0,0,1}; };', "VT elements, a vector view"),
        ('View "s" { SS(0,0,0,1,0,0,0,1,0,0,0,1){1,1,1,1}; };', "three-dimensional SS elements"),
        ('View "s" { ST(0,0,0,1,0,0,0,1,1){1,1,1}; };', "do not share one z"),
        ('View "s" { ST(0,0,0,1,0,0,0,1,0){1,1,1,2,2,2}; };', "one value a corner and one time step"),
        ('View "s" { ST(0,0,0,1,0,0,0,1){1,1,1}; };', "9 numbers are announced, 8"),
        ('View "s" { ST(0,0,0,1,0,0,0,1,0){1,1,z}; };', "'z' is not a number"),
        ('View "s" { ST(0,0,0,1,0,0,0,1,0){1,1,1', "torn"),
        ('View "a" { }; View "b" { };', "holds 2 views"),
        ('View "a" { };', "its view is empty"),
    ],
)
def test_views_that_cannot_be_sizes(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "f.pos").write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        read_field(tmp_path / "f.pos")
    assert str(tmp_path / "f.pos") in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("4.1 0 8", "4 0 8", "version 4; 4.1 and ASCII 2.2 are supported"),
        ("4.1 0 8", "4.1 1 8", "unknown layout"),
        ("$EndNodes", "", "does not end"),
        ("5 3 9 4", "5 3 7 4", "node 7 does not exist"),
        ("4 2 3 4", "2 2 3 4", "two elements have the same number"),
        ("2 1 2 4", "2 1 9 4", r"6 corners|holds|corrupt|cut"),
        ("2 5 1 9", "2 999999999 1 9", "999999999 nodes; between 0 and"),
        ("2 1 1 4\n", "2 1 1 400000\n", "cut or corrupt"),
        ("1\n0.0\n3\n0\n1\n5", "1\n0.0\n3\n0\n9\n5", "cut or corrupt"),
        ("3\n0\n1\n5", "3\n0\n9\n1", "9 components a node: an anisotropic metric"),
        ("9 0.1", "9 nan", "1 of 5 sizes is NaN"),
        (".5 .5 0 .5 .5", ".5 .5 1 .5 .5", "do not share one z"),
    ],
)
def test_damaged_meshes_say_what_is_wrong(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert old in MSH_TEXT
    (tmp_path / "f.msh").write_text(MSH_TEXT.replace(old, new, 1))
    with pytest.raises(InputError, match=words):
        read_field(tmp_path / "f.msh")
