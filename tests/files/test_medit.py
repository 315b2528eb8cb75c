"""Medit's files; MMG meshes with our sizes, and its mesh comes back."""

from __future__ import annotations

import importlib.util
import subprocess
from pathlib import Path

import numpy as np
import pytest
from files.reader_seeds import quad_mesh, triangle_field
from files.test_gmsh_files import growing_field

from sizeviz.errors import InputError
from sizeviz.files import read_domain, read_field, read_mesh, write_field, write_mesh
from sizeviz.sizing import BackgroundMesh, PreserveOptions, SizeField, preserved


def mmg2d() -> Path:
    """Return the program that comes with the package ``mmgpy``."""
    found = importlib.util.find_spec("mmgpy")
    assert found is not None and found.origin is not None, "pip install 'sizeviz[dev]'"
    return Path(found.origin).parent / "bin" / "mmg2d_O3"


def test_mmg_meshes_to_our_sizes_and_we_read_its_mesh(tmp_path: Path) -> None:
    field = growing_field()
    write_field(tmp_path / "h.sol", field)
    names = ["-in", tmp_path / "h.mesh", "-sol", tmp_path / "h.sol", "-out", tmp_path / "o.mesh", "-hgrad", "-1"]
    subprocess.run([mmg2d(), *names], check=True, timeout=120, stdout=subprocess.DEVNULL)
    made = read_field(tmp_path / "o.mesh").background
    corner = made.points[made.triangles]
    edges = np.linalg.norm(np.roll(corner, -1, axis=1) - corner, axis=2).mean(axis=1)
    sizes = field.at(corner.mean(axis=1))
    assert np.median(edges / sizes) == pytest.approx(1.0, abs=0.1)
    assert np.corrcoef(np.log(edges), np.log(sizes))[0, 1] > 0.9
    assert read_domain(tmp_path / "o.mesh").area == pytest.approx(1.0, rel=1e-12)


def test_mmgs_meshes_are_judged_and_ours_is_the_field_to_give_it(tmp_path: Path) -> None:
    """MMG makes triangles: R is formed with their mean edge and the least size over each."""
    background = BackgroundMesh.unit_square_grid(65, 65)
    x, y = background.points.T
    asked = SizeField(background, np.clip(np.abs(x - 0.4 - 0.2 * y), 0.02, 0.2))
    shares = []
    for name, field in (("h", asked), ("star", preserved(asked, PreserveOptions(alpha=2.0)))):
        write_field(tmp_path / f"{name}.sol", field)
        files = [
            "-in",
            tmp_path / f"{name}.mesh",
            "-sol",
            tmp_path / f"{name}.sol",
            "-out",
            tmp_path / f"{name}-o.mesh",
        ]
        subprocess.run([mmg2d(), *files, "-hgrad", "-1"], check=True, timeout=120, stdout=subprocess.DEVNULL)
        made = read_field(tmp_path / f"{name}-o.mesh").background
        corner = made.points[made.triangles]
        edges = np.linalg.norm(np.roll(corner, -1, axis=1) - corner, axis=2).mean(axis=1)
        ratios = edges / asked.min_over(made.points, made.triangles[:, [0, 1, 2, 2]])
        shares.append(float(np.mean(ratios <= 1.1)))
    assert shares[1] > shares[0] + 0.1


@pytest.mark.parametrize("suffix", [".sol", ".mesh"])
def test_either_of_the_two_files_may_be_named(tmp_path: Path, suffix: str) -> None:
    write_field(tmp_path / f"f{suffix}", triangle_field())
    for other in (".sol", ".mesh"):
        assert np.array_equal(read_field(tmp_path / f"f{other}").sizes, triangle_field().sizes)


def test_a_missing_companion_is_named(tmp_path: Path) -> None:
    write_field(tmp_path / "f.sol", triangle_field())
    (tmp_path / "f.mesh").unlink()
    with pytest.raises(InputError, match=r"f\.sol: its mesh should be in f\.mesh beside it"):
        read_field(tmp_path / "f.sol")
    write_mesh(tmp_path / "m.mesh", quad_mesh())
    with pytest.raises(InputError, match=r"m\.mesh: its sizes should be in m\.sol beside it"):
        read_field(tmp_path / "m.mesh")


MESH = """MeshVersionFormatted 2  # a comment, with Words
Dimension
3
Vertices 4
0 0 1 7
1 0 1 7
1 1 1 7
0 1 1 7
Quadrilaterals
1
1 2 3 4 9
Edges 1
1 2 3
Corners
2 1 2
End
"""
SOL = "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n4\n1 1\n.1 .2 .3 .4\nEnd\n"


def written(tmp_path: Path, mesh: str, sol: str) -> Path:
    (tmp_path / "f.sol").write_text(sol)
    (tmp_path / "f.mesh").write_text(mesh)
    return tmp_path / "f.mesh"


def test_space_and_references_and_comments(tmp_path: Path) -> None:
    path = written(tmp_path, MESH, SOL)
    assert read_field(path).sizes.tolist() == [0.1, 0.2, 0.3, 0.4]
    assert read_mesh(path).mesh.quads.tolist() == [[0, 1, 2, 3]]


@pytest.mark.parametrize(
    ("mesh", "sol", "words"),
    [
        (MESH, SOL.replace("1 1\n.1 .2 .3 .4", "1 3\n" + "1 0 1 " * 4), "a metric tensor; only isotropic sizes"),
        (MESH, SOL.replace("1 1\n", "1 2\n"), "a vector; only isotropic sizes"),
        (MESH, SOL.replace("1 1\n", "2 1 1\n"), "2 fields"),
        (MESH, SOL.replace(".4\n", ""), "4 numbers are announced, 3 are there"),
        (MESH, SOL.replace("\n4\n", "\n5\n"), "5 sizes for a mesh of 4 vertices"),
        (MESH, SOL.replace("SolAtVertices", "SolAtTriangles"), "no SolAtVertices"),
        (MESH.replace("0 1 1 7", "0 1 2 7"), SOL, "do not share one z"),
        (MESH.replace("1 2 3 4 9", "1 2 3 5 9"), SOL, "names a point outside"),
        (MESH.replace("1 2 3 4 9", "1 2 3 4.5 9"), SOL, "names no vertex"),
        (MESH.replace("Vertices 4", "Vertices 99999999"), SOL, "399999996 numbers are announced"),
        (MESH.replace("Vertices", "Points"), SOL, "no Vertices"),
        (MESH.replace("\n3\n", "\n4\n"), SOL, "Dimension is"),
        (MESH.replace("MeshVersionFormatted", "Mesh"), SOL, "does not begin with MeshVersionFormatted"),
        ("MeshVersionFormatted\0\1", SOL, "binary file"),
        (MESH.replace("Quadrilaterals\n1\n1 2 3 4 9", "Tetrahedra\n1\n1 2 3 4 9"), SOL, "volume mesh"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, mesh: str, sol: str, words: str) -> None:
    path = written(tmp_path, mesh, sol)
    with pytest.raises(InputError, match=words) as caught:
        read_field(path)
    assert str(path) in str(caught.value)
