"""The pipeline: field, mesh, smooth, judge, like with like, and only as much as is asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from study.cases import valley_source

from sizeviz.errors import Cancelled, InputError, MeshingError
from sizeviz.meshing import MeshOptions
from sizeviz.sizing import LimitOptions, PreserveOptions, limited, preserved
from sizeviz.study import COMPARED, METHODS, Study, StudyOptions, processed, run
from sizeviz.study.report import mesh_arrays, report_of
from sizeviz.study.study import STAGES


@pytest.fixture(scope="module")
def study() -> Study:
    return run(Study(valley_source()), METHODS)


def test_each_method_drives_the_mesher_with_its_own_field(study: Study) -> None:
    field, options = study.source.field, study.options
    expected = {
        "none": field.sizes,
        "gradient-limiting": limited(field, options.limit).sizes,
        "size-preserving": preserved(field, options.preserve).sizes,
    }
    for method, sizes in expected.items():
        assert np.array_equal(study.runs[method].target.sizes, sizes)


@pytest.mark.parametrize("method", METHODS)
def test_meshes_are_sound(study: Study, method: str) -> None:
    mesh = study.runs[method].mesh
    assert study.runs[method].report.n_inverted == 0
    assert mesh.areas.sum() == pytest.approx(1.0, rel=1e-9)
    assert tuple(study.runs[method].seconds) == STAGES


def test_size_preserving_honours_the_field_and_limiting_does_not(study: Study) -> None:
    correct = {method: study.runs[method].report.correct_percent["mean-edge"] for method in COMPARED}
    assert correct["size-preserving"] > 99.0
    assert correct["gradient-limiting"] < correct["size-preserving"] - 5.0


def test_what_is_there_is_kept_and_what_is_missing_is_run(study: Study) -> None:
    again = run(study, METHODS)
    assert all(
        again.runs[method] == study.runs[method] or again.runs[method].mesh is study.runs[method].mesh
        for method in METHODS
    )
    raw = study.with_options(replace(study.options, smoothing=False))
    unsmoothed = run(raw, ("size-preserving",)).runs["size-preserving"]
    assert unsmoothed.raw is study.runs["size-preserving"].raw
    assert unsmoothed.mesh is unsmoothed.raw


def test_beta_scales_what_every_method_asks_for() -> None:
    source = valley_source(17)
    options = StudyOptions(preserve=PreserveOptions(beta=0.5), limit=LimitOptions(epsilon=0.25))
    halved = Study(source, options)
    assert np.allclose(processed(halved, "none").sizes, 0.5 * source.field.sizes)
    asked = source.field.with_sizes(0.5 * source.field.sizes)
    assert np.allclose(processed(halved, "gradient-limiting").sizes, limited(asked, options.limit).sizes)
    assert processed(halved, "size-preserving").sizes.max() <= 0.5 * source.field.sizes.max()


def test_the_result_does_not_depend_on_threads() -> None:
    meshes = [
        run(Study(valley_source(33), StudyOptions(threads=threads)), ("size-preserving",)).runs["size-preserving"].mesh
        for threads in (1, 2)
    ]
    assert np.array_equal(meshes[0].points, meshes[1].points)
    assert np.array_equal(meshes[0].quads, meshes[1].quads)


def test_progress_grows_and_names_the_stages() -> None:
    steps: list[tuple[float, str]] = []

    class Recording:
        def step(self, fraction: float, message: str = "") -> None:
            steps.append((fraction, message))

    run(Study(valley_source(17)), COMPARED, Recording())
    fractions = [fraction for fraction, _ in steps]
    assert np.diff(fractions).min() > -1e-12, "but for rounding, it never goes back"
    assert fractions[-1] == 1.0
    said = {message for _, message in steps}
    for stage in STAGES:
        assert f"gradient limiting: {stage}" in said
        assert f"size preserving: {stage}" in said


def test_cancelling_stops_at_once_and_leaves_the_study_alone() -> None:
    class Stop:
        def step(self, fraction: float, message: str = "") -> None:
            if fraction > 0.3:
                raise Cancelled

    before = Study(valley_source(17))
    with pytest.raises(Cancelled):
        run(before, COMPARED, Stop())
    assert not before.runs


def test_an_unknown_method_names_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"'magic' is unknown; choose one of none"):
        run(Study(valley_source(9)), ("magic",))


def test_too_many_elements_are_refused_before_meshing() -> None:
    options = StudyOptions(mesh=MeshOptions(max_elements=50))
    with pytest.raises(MeshingError, match="50"):
        run(Study(valley_source(17), options), ("size-preserving",))


def test_report_has_the_promised_keys(study: Study) -> None:
    report = report_of(study, COMPARED)
    assert set(report) == {"source", "options", "methods", "versions"}
    assert list(report["methods"]) == list(COMPARED)
    for method, entry in report["methods"].items():
        finished = study.runs[method]
        assert entry["n_quads"] == finished.mesh.n_quads
        assert entry["n_nodes"] == finished.mesh.n_points
        assert entry["n_inverted"] == finished.report.n_inverted
        assert set(entry["correct_percent"]) == set(entry["max_ratio"]) == {"mean_edge", "sqrt_area", "max_edge"}
        assert set(entry["quality"]) == {"min", "max", "mean", "std"}
        assert set(entry["seconds"]) == {*STAGES, "total"}
        ratios = finished.report.ratios["max-edge"]
        assert entry["max_ratio"]["max_edge"] == ratios.max()
        assert entry["correct_percent"]["max_edge"] == pytest.approx(100 * np.mean(ratios <= 1 + 1e-9))
        assert 0 < entry["irregular_percent"] < 40


def test_arrays_of_a_mesh_file(study: Study) -> None:
    mesh, cells, points = mesh_arrays(study, "size-preserving", "max-edge")
    assert set(cells) == {"ratio", "quality", "size"} and set(points) == {"size_prescribed", "size_target"}
    corners = mesh.points[mesh.quads]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    assert np.allclose(cells["size"], longest, rtol=1e-12)
    assert (points["size_target"] <= points["size_prescribed"] * (1 + 1e-12)).all()
    assert (cells["ratio"] >= cells["size"] / points["size_prescribed"][mesh.quads].min(axis=1) * (1 - 1e-12)).all()


def test_a_method_that_was_not_run_has_no_report(study: Study) -> None:
    with pytest.raises(InputError, match="run it first"):
        report_of(Study(study.source), COMPARED)
