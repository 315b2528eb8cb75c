from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sizeviz.cli import run_command_line
from sizeviz.errors import InputError
from sizeviz.files import read_mesh, write_field, write_mesh
from sizeviz.geometry import Domain
from sizeviz.improvement import SmoothOptions
from sizeviz.meshing import MeshOptions
from sizeviz.sizing import BackgroundMesh, LimitOptions, PreserveOptions, SizeField
from sizeviz.sources import Source, load
from sizeviz.sources.painting import Brush, Stroke, painted
from sizeviz.study import COMPARED, METHODS, Study, StudyOptions, run
from sizeviz.study.recipe import as_command, as_python, has_name
from sizeviz.study.report import mesh_arrays, report_of
from sizeviz.study.storage import StudyFile, write_study

OPTIONS = StudyOptions(
    limit=LimitOptions(epsilon=0.4),
    preserve=PreserveOptions(alpha=1.7, beta=0.95),
    mesh=MeshOptions(seed=3, scale=0.9),
)


@pytest.fixture(scope="module")
def formula() -> Study:
    return run(Study(load("expr:min(0.15, max(0.05, abs(x - 0.4)))"), OPTIONS), METHODS)


@pytest.fixture(scope="module")
def by_hand() -> Study:
    background = BackgroundMesh.unit_square_grid(33, 33)
    blank = SizeField(background, np.full(33 * 33, 0.12), "blank canvas")
    stroke = Stroke(Brush(radius=0.3, value=0.05), np.array([[0.3, 0.4], [0.6, 0.5]]))
    field = painted(blank, stroke)
    source = Source(
        "canvas", "Blank canvas", Domain.unit_square(), field, field, None, {"kind": "canvas", "strokes": 1}
    )
    return run(Study(source, OPTIONS))


def typed(command: str) -> list[str]:
    words = shlex.split(command)
    assert words[0] == "sizeviz"
    return words[1:]


def same(mesh, other) -> bool:
    return np.array_equal(mesh.points, other.points) and np.array_equal(mesh.quads, other.quads)


def carry_out(script: str) -> Study:
    names: dict = {}
    exec(compile(script, "recipe", "exec"), names)
    return names["study"]


@pytest.mark.gl
def test_the_command_makes_the_same_meshes_bit_by_bit(formula, tmp_path) -> None:
    command = as_command(formula, ("gradient-limiting", "size-preserving", "guaranteed"), out=str(tmp_path / "out"))
    assert run_command_line(typed(command)) == 0
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    for method in ("gradient-limiting", "size-preserving", "guaranteed"):
        content = read_mesh(tmp_path / "out" / f"mesh-{method}.vtu")
        assert same(content.mesh, formula.runs[method].mesh)
        expected = formula.runs[method].report
        assert report["methods"][method]["correct_percent"]["max_edge"] == expected.correct_percent["max-edge"]
        assert report["methods"][method]["quality"]["min"] == float(expected.quality.min())


@pytest.mark.gl
def test_other_methods_are_runs_of_their_own(formula, tmp_path) -> None:
    lines = as_command(formula, ("none", "guaranteed"), out=str(tmp_path / "out")).splitlines()
    assert len(lines) == 2
    for line, method in zip(lines, ("none", "guaranteed"), strict=True):
        assert run_command_line(typed(line)) == 0
        assert same(read_mesh(tmp_path / "out" / method / "mesh.vtu").mesh, formula.runs[method].mesh)


def test_the_script_makes_the_same_meshes_bit_by_bit(formula) -> None:
    again = carry_out(as_python(formula, METHODS))
    assert again.options == OPTIONS and tuple(again.runs) == METHODS
    assert all(same(again.runs[method].mesh, formula.runs[method].mesh) for method in METHODS)


@pytest.mark.gl
def test_a_painted_study_refers_to_files_and_makes_the_same_meshes(by_hand, tmp_path) -> None:
    assert not has_name(by_hand.source)
    for recipe in (as_command, as_python):
        with pytest.raises(InputError, match="save the study first"):
            recipe(by_hand)
    field, saved = tmp_path / "its field.npz", tmp_path / "painted.sizeviz"
    write_field(field, by_hand.source.field)
    write_study(saved, StudyFile(by_hand))
    assert run_command_line(typed(as_command(by_hand, out=str(tmp_path / "out"), field_file=field))) == 0
    again = carry_out(as_python(by_hand, study_file=saved))
    for method in COMPARED:
        assert same(read_mesh(tmp_path / "out" / f"mesh-{method}.vtu").mesh, by_hand.runs[method].mesh)
        assert same(again.runs[method].mesh, by_hand.runs[method].mesh)


@pytest.mark.gl
def test_a_painted_study_in_a_clean_directory_gives_the_same_bytes(by_hand, tmp_path, monkeypatch) -> None:
    """What is copied is run by a shell elsewhere; mesh files agree byte by byte, reports in all but the seconds."""
    clean, here = tmp_path / "clean", tmp_path / "here"
    clean.mkdir()
    here.mkdir()
    monkeypatch.chdir(clean)
    write_field("painted.npz", by_hand.source.field)
    command = as_command(by_hand, field_file="painted.npz").replace("sizeviz", f"{sys.executable} -m sizeviz", 1)
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    subprocess.run(command, shell=True, check=True, cwd=clean, env=environment, capture_output=True, timeout=500)
    made = json.loads((clean / "results" / "report.json").read_text())
    for method in COMPARED:
        write_mesh(here / f"mesh-{method}.vtu", *mesh_arrays(by_hand, method))
        name = f"mesh-{method}.vtu"
        assert (clean / "results" / name).read_bytes() == (here / name).read_bytes()
    expected = json.loads(json.dumps(report_of(by_hand, COMPARED)))
    for report in (made, expected):
        for numbers in report["methods"].values():
            del numbers["seconds"]
    assert made["methods"] == expected["methods"] and made["versions"] == expected["versions"]
    assert made["options"] == expected["options"]


def test_a_file_of_other_sizes_is_refused(by_hand, tmp_path) -> None:
    field = by_hand.source.field
    write_field(tmp_path / "old.npz", field.with_sizes(field.sizes * 1.5))
    with pytest.raises(InputError, match="would not give the same mesh"):
        as_command(by_hand, field_file=tmp_path / "old.npz")


@pytest.mark.parametrize(
    ("changes", "methods"),
    [
        ({"smooth": SmoothOptions(sweeps=3)}, COMPARED),
        ({"limit": LimitOptions(distance="edges")}, COMPARED),
        ({"smoothing": False}, ("guaranteed",)),
    ],
)
def test_what_the_command_line_cannot_say_is_refused(formula, changes, methods) -> None:
    other = formula.with_options(replace(OPTIONS, **changes))
    with pytest.raises(InputError, match="copy as Python"):
        as_command(other, methods)
    assert "StudyOptions(" in as_python(other, methods)


def test_the_measure_of_the_picture_is_typed_only_where_it_is_not_the_usual_one(formula: Study) -> None:
    assert "--measure" not in as_command(formula)
    both = as_command(formula, METHODS, measure="max-edge").splitlines()
    assert all(line.count("--measure max-edge") == 1 for line in both)
