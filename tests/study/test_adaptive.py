"""The adaptive process: it converges, it can be stopped and taken up, and it keeps what it says."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from sizeviz.conformity import judged
from sizeviz.errors import Cancelled, InputError, MeshingError
from sizeviz.files import read_mesh
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.meshing import MeshOptions
from sizeviz.sizing import AnalyticSize, BackgroundMesh, SizeField
from sizeviz.sources.source import Source
from sizeviz.study import StudyOptions
from sizeviz.study.adaptive import AdaptOptions, adapted
from sizeviz.study.backgrounds import background_of, uniform_mesh
from sizeviz.study.evolution import read_evolution
from sizeviz.study.pipeline import GUARANTEED

FINEST = 0.01


def ring(x, y):
    return np.minimum(0.25, np.abs(np.hypot(x - 0.5, y - 0.5) - 0.2575) + FINEST)


def ring_source() -> Source:
    background = BackgroundMesh.unit_square_grid(65, 65)
    field = SizeField(background, ring(*background.points.T))
    return Source("ring", "a ring", Domain.unit_square(), field, AnalyticSize(ring, field, "ring"))


def options(**changes) -> AdaptOptions:
    mesh = MeshOptions(mesher="decomposition", scale=0.8)
    return AdaptOptions(**{"study": StudyOptions(mesh=mesh), "cells": 12, "iterations": 6, **changes})


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("adapt")
    return folder, adapted(ring_source(), options(), folder)


def test_size_preserving_converges(finished):
    _, evolution = finished
    assert evolution.converged
    last = evolution.iterations[-1]
    assert last.analytic_ratio <= 1.1
    assert last.analytic_correct > 99
    assert [row.number for row in evolution.iterations] == list(range(len(evolution.iterations)))
    assert evolution.iterations[0].n_quads == 144
    assert all(row.analytic_ratio > 1.1 for row in evolution.iterations[:-1])


def test_the_guarantee_ends_with_every_element_correct(tmp_path):
    field = ring_source().field
    source = replace(ring_source(), reference=field)
    evolution = adapted(source, options(method=GUARANTEED, study=StudyOptions()), tmp_path)
    last = evolution.iterations[-1]
    assert evolution.converged and evolution.limit == 1.0
    assert evolution.iterations[1].strict_ratio > 1.0
    assert last.strict_correct == 100.0 and last.analytic_ratio == last.strict_ratio <= 1.0
    report = judged(read_mesh(tmp_path / last.mesh).mesh, field)
    assert report.correct_percent["max-edge"] == 100.0


def test_the_record_says_what_the_meshes_are(finished):
    folder, evolution = finished
    assert read_evolution(folder) == evolution
    last = evolution.iterations[-1]
    content = read_mesh(folder / last.mesh)
    report = judged(content.mesh, ring_source().reference)
    assert report.max_ratio["mean-edge"] == pytest.approx(last.analytic_ratio, rel=1e-9)
    assert content.cell_data["ratio"].max() == pytest.approx(last.analytic_ratio, rel=1e-9)
    before = read_mesh(folder / evolution.iterations[-2].mesh).mesh
    against = judged(content.mesh, background_of(before, ring_source().reference))
    assert against.max_ratio["mean-edge"] == pytest.approx(last.background_ratio, rel=1e-9)


def test_a_stopped_process_is_taken_up(finished, tmp_path):
    _, whole = finished

    class Stop:
        def step(self, fraction: float, message: str = "") -> None:
            if fraction > 1.5 / 7:
                raise Cancelled

    with pytest.raises(Cancelled):
        adapted(ring_source(), options(), tmp_path, Stop())
    kept = read_evolution(tmp_path)
    assert [row.number for row in kept.iterations] == [0]
    again = adapted(ring_source(), options(), tmp_path)
    assert [(row.n_quads, row.analytic_ratio) for row in again.iterations] == [
        (row.n_quads, row.analytic_ratio) for row in whole.iterations
    ]


def test_a_finished_process_is_not_run_again(finished):
    folder, evolution = finished
    written = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    assert adapted(ring_source(), options(iterations=50), folder) == evolution
    assert written == {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}


def test_another_source_of_the_same_name_is_refused(finished):
    folder, _ = finished
    doubled = replace(ring_source(), field=ring_source().field.with_sizes(2 * ring_source().field.sizes))
    with pytest.raises(InputError, match=r"another adaptive process \(other sizes, or another domain\)"):
        adapted(doubled, options(), folder)


def test_a_first_mesh_too_large_is_not_begun(tmp_path):
    with pytest.raises(MeshingError, match=r"1e\+16 elements, 100000000 along its longer side.*--cells"):
        adapted(ring_source(), options(cells=100_000_000), tmp_path / "a")


def test_another_process_is_refused(finished):
    folder, _ = finished
    words = r"another adaptive process \(method size-preserving, not gradient-limiting\); choose another --out"
    with pytest.raises(InputError, match=words):
        adapted(ring_source(), options(method="gradient-limiting"), folder)


def test_a_record_of_an_older_version_is_taken_up_with_what_it_lacks(finished, tmp_path):
    folder, whole = finished
    for path in folder.glob("*.vtu"):
        shutil.copy(path, tmp_path)
    content = json.loads((folder / "evolution.json").read_text())
    content["iterations"] = [
        {name: value for name, value in row.items() if not name.startswith("strict")}
        for row in content["iterations"][:3]
    ]
    del content["options"]["fingerprint"]
    (tmp_path / "evolution.json").write_text(json.dumps(content))
    assert np.isnan(read_evolution(tmp_path).iterations[1].strict_ratio)
    again = adapted(ring_source(), options(), tmp_path)
    for mine, theirs in zip(again.iterations, whole.iterations, strict=True):
        assert mine.strict_ratio == pytest.approx(theirs.strict_ratio, rel=1e-12)
        assert mine.strict_correct == pytest.approx(theirs.strict_correct, rel=1e-12)
        assert mine.n_quads == theirs.n_quads
    assert read_evolution(tmp_path) == again


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"source": "ring"}', "has no 'iterations', as a record of sizeviz adapt does"),
        ("[]", "is not the record of an adaptive process"),
        ("[" * 100_000, "is not the record of an adaptive process"),
        ("\xff", "is not the record of an adaptive process"),
    ],
)
def test_a_spoilt_record_is_refused(tmp_path, text, words):
    (tmp_path / "evolution.json").write_text(text, encoding="latin-1")
    with pytest.raises(InputError, match=rf"evolution.json: {words}.*remove that file to begin anew") as caught:
        adapted(ring_source(), options(), tmp_path)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 400


@pytest.mark.parametrize("bad", [{"method": "magic"}, {"cells": 0}, {"iterations": 0}, {"limit": float("nan")}])
def test_options_out_of_range(bad):
    with pytest.raises(InputError):
        options(**bad)


@pytest.mark.parametrize(("sampling", "nodes", "triangles"), [("nodes", 16, 18), ("refined", 16 + 24 + 9, 72)])
def test_a_background_covers_the_mesh(sampling, nodes, triangles):
    mesh = uniform_mesh(Domain.unit_square(), 3, MeshOptions())
    reference = ring_source().reference
    field = background_of(mesh, reference, sampling)
    corner = field.background.points[field.background.triangles]
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    assert (len(field.sizes), len(areas)) == (nodes, triangles)
    assert areas.min() > 0 and areas.sum() == pytest.approx(1.0)
    assert np.array_equal(field.sizes, reference.at(field.background.points))


def test_the_diagonal_lies_inside_a_dart():
    points = np.array([[0, 0], [1, 0.2], [0.3, 0.3], [0.2, 1]])
    for turn in range(4):
        quads = np.roll([[0, 1, 2, 3]], turn, axis=1).astype(np.int32)
        dart = QuadMesh(points, quads, np.full(4, -1, dtype=np.int32), np.zeros(4, dtype=bool))
        field = background_of(dart, ring_source().reference, "nodes")
        assert all({0, 2} <= set(row) for row in field.background.triangles.tolist())


def test_uniform_meshes():
    wide = uniform_mesh(Domain.rectangle(0, 0, 3, 1), 30, MeshOptions())
    assert wide.n_quads == 300
    assert wide.areas == pytest.approx(np.full(300, 0.01))
    t = np.arange(48) * (2 * np.pi / 48)
    disc = Domain(np.column_stack([np.cos(t), np.sin(t)]))
    mesh = uniform_mesh(disc, 20, MeshOptions(mesher="decomposition", scale=0.5))
    assert np.sqrt(mesh.areas).mean() == pytest.approx(0.1, rel=0.15)
