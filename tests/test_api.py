"""The ten functions: the pipeline's own results, typed and documented, with progress where somebody watches."""

from __future__ import annotations

import inspect
import sys
import types
from pathlib import Path

import numpy as np
import pytest

import sizeviz
from sizeviz import notebook
from sizeviz.errors import Cancelled, InputError
from sizeviz.study import Study, StudyOptions, run

TEN = ("load", "paint", "limit", "preserve", "mesh", "smooth", "report", "show", "screenshot", "adapt")
VALLEY = "expr:min(0.15, max(0.04, abs(x - 0.4 - 0.2*y)))"


@pytest.fixture(scope="module")
def source():
    return sizeviz.load(VALLEY)


@pytest.fixture(scope="module")
def study(source) -> Study:
    return run(Study(source, StudyOptions().with_comparable_slope()))


@pytest.mark.parametrize("name", TEN)
def test_each_is_typed_and_documented(name: str) -> None:
    function = getattr(sizeviz, name)
    signature = inspect.signature(function)
    assert signature.return_annotation is not inspect.Signature.empty
    words = inspect.getdoc(function)
    assert "Parameters\n----------" in words and "Raises\n------" in words
    for parameter in signature.parameters.values():
        assert parameter.annotation is not inspect.Parameter.empty
        assert parameter.name in words, f"{name} does not say what {parameter.name} is"


def test_stage_by_stage_is_the_pipeline_bit_by_bit(source, study) -> None:
    for method, field in (
        ("gradient-limiting", sizeviz.limit(source, 0.5)),
        ("size-preserving", sizeviz.preserve(source, 2.0)),
    ):
        done = study.runs[method]
        assert np.array_equal(field.sizes, done.target.sizes)
        quads = sizeviz.smooth(source, sizeviz.mesh(source, field), field)
        assert np.array_equal(quads.points, done.mesh.points) and np.array_equal(quads.quads, done.mesh.quads)
        report = sizeviz.report(source, quads)
        assert report.max_ratio == done.report.max_ratio and report.correct_percent == done.report.correct_percent
        assert f"{report.n_quads:,}" in report._repr_html_() and "max R(e)" in report._repr_html_()


def test_sources_of_every_kind(source, tmp_path: Path) -> None:
    sizes = np.linspace(0.1, 0.2, 12).reshape(3, 4)
    by_array = sizeviz.load(sizes)
    assert np.array_equal(by_array.field.at([[0, 0], [1, 0], [1, 1]]), [0.1, sizes[0, 3], 0.2])
    np.save(tmp_path / "f.npy", sizes)
    assert np.array_equal(sizeviz.load(tmp_path / "f.npy").field.sizes, by_array.field.sizes)
    assert sizeviz.load(by_array.field).field is by_array.field and sizeviz.load(source) is source
    (tmp_path / "d.csv").write_text("0,0\n2,0\n2,1\n0,1\n")
    assert sizeviz.load(sizes, tmp_path / "d.csv").domain.area == 2.0
    by_function = sizeviz.load(lambda x, y: 0.1 + 0.05 * x * y)
    assert by_function.reference.at([[0.5, 0.5]]) == pytest.approx(0.1125, rel=1e-15)
    assert sizeviz.load(VALLEY, sizeviz.Domain.rectangle(0, 0, 2, 1)).domain.area == 2.0
    for wrong in (np.ones(5), np.ones((1, 5)), np.zeros((3, 3)), "no-such-thing", None, [[1, 2], [3]], [["a"] * 2] * 2,
                  np.ones((3, 3), complex), lambda x, y: np.ones(3), lambda x, y: "a"):  # fmt: skip
        with pytest.raises(InputError):
            sizeviz.load(wrong)


def test_painting(source) -> None:
    blank = sizeviz.load(np.full((33, 33), 0.1))
    path = [(0.2, 0.5), (0.8, 0.5)]
    there = np.abs(blank.field.background.points[:, 1] - 0.5) < 1e-9
    for effect, expected in (({"size": 0.02}, 0.02), ({"factor": 0.5}, 0.05), ({"at_most": 0.3}, 0.1)):
        done = sizeviz.paint(blank, path, radius=0.1, **effect)
        inner = there & (np.abs(blank.field.background.points[:, 0] - 0.5) < 0.3)
        assert np.allclose(done.field.sizes[inner], expected) and done.reference is done.field
    assert sizeviz.paint(done, path, radius=0.1, size=0.2).provenance["strokes"] == 2
    for effects in ({}, {"size": 0.1, "factor": 2.0}):
        with pytest.raises(InputError, match="exactly one of size, factor and at_most"):
            sizeviz.paint(blank, path, radius=0.1, **effects)
    with pytest.raises(InputError, match="reaches no node"):
        sizeviz.paint(blank, [(5.0, 5.0)], radius=0.1, size=0.1)


def test_what_cannot_be_shown_or_drawn_is_told_in_a_line(source, tmp_path: Path) -> None:
    for wrong in (
        lambda: sizeviz.show(3),
        lambda: sizeviz.save_page(source, tmp_path / "p.html"),
        lambda: sizeviz.screenshot(tmp_path / "p.png", source, width=0),
        lambda: sizeviz.paint(source, [(0.5, 0.5)], radius=0.1, size=0.1, shape="circle"),
    ):
        with pytest.raises(InputError, match=r"cannot be shown|give 64 to 20000 pixels|shape 'circle' is unknown"):
            wrong()
    assert not list(tmp_path.iterdir())


def test_show_is_a_page_in_a_frame_that_cannot_reach_the_notebook(source, study, tmp_path: Path) -> None:
    quads = study.runs["size-preserving"].mesh
    for shown in (sizeviz.show(study), sizeviz.show(source, {"mine": quads}), sizeviz.show(quads)):
        frame = shown._repr_html_()
        assert frame.startswith("<iframe srcdoc=") and 'sandbox="allow-scripts"' in frame and "<script" not in frame
        assert shown.save(tmp_path / "p.html").read_text("utf-8") == shown.page
        assert ".open()" in repr(shown)
    assert '"mine"' in sizeviz.show(source, {"mine": quads}).page
    with pytest.raises(InputError, match="leave meshes out"):
        sizeviz.show(study, quads)
    with pytest.raises(InputError, match="give that first"):
        sizeviz.show(quads, quads)


@pytest.mark.gl
def test_a_source_without_a_mesh_shows_its_sizes(source) -> None:
    assert "data:image/png;base64," in sizeviz.show(source).page
    assert "data:image/png;base64," in sizeviz.show(Study(source)).page


@pytest.mark.gl
def test_screenshots_by_suffix(source, study, tmp_path: Path) -> None:
    one = study.runs["size-preserving"].mesh
    for name, begins in (
        ("a.png", b"\x89PNG"),
        ("a.svg", b"<?xml"),
        ("a.pdf", b"%PDF"),
        ("a.html", b"<!doctype html>"),
    ):
        assert sizeviz.screenshot(tmp_path / name, source, one).read_bytes().startswith(begins)
    assert sizeviz.screenshot(tmp_path / "both.png", study).stat().st_size > 20_000
    with pytest.raises(InputError, match="shows one mesh"):
        sizeviz.screenshot(tmp_path / "both.svg", study)


def test_adapting(source, tmp_path: Path) -> None:
    from sizeviz.study.adaptive import AdaptOptions

    evolution = sizeviz.adapt(source, tmp_path / "a", options=AdaptOptions(cells=8, iterations=1, limit=0.1))
    assert [row.number for row in evolution.iterations] == [0, 1]
    assert sizeviz.read_mesh(tmp_path / "a" / "mesh-001.vtu").mesh.n_quads == evolution.iterations[1].n_quads


def test_a_monitor_handed_in_is_told_and_can_stop(source) -> None:
    class Stop:
        told = 0

        def step(self, fraction: float, message: str = "") -> None:
            self.told += 1
            if self.told > 2:
                raise Cancelled

    with pytest.raises(Cancelled):
        sizeviz.mesh(source, monitor=Stop())


def test_progress_in_a_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[str] = []
    handle = types.SimpleNamespace(update=lambda html: drawn.append(html))
    display = types.SimpleNamespace(HTML=lambda text: text, display=lambda html, display_id: handle)
    shell = types.SimpleNamespace(kernel=object())
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=lambda: shell, display=display))
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    assert notebook.in_notebook()
    monkeypatch.setattr(notebook, "UPDATES_A_SECOND", 1e9)
    with pytest.raises(ValueError, match="x"), notebook.progress() as bar:
        bar.step(0.25, "meshing <it>")
        raise ValueError("x")
    assert 'value="25"' in drawn[0] and "meshing &lt;it&gt;" in drawn[0]
    assert drawn[-1] == "", "it vanishes, however the work ends"


def test_elsewhere_there_is_no_notebook() -> None:
    assert not notebook.in_notebook()
