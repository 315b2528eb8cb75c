"""The paper's figures: files of both kinds, text as text, and what the panels show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image as Picture

from sizeviz.files import Image
from sizeviz.geometry import Domain
from sizeviz.meshing import MeshOptions
from sizeviz.scene.figures.meshes import image_errors
from sizeviz.scene.figures.paper import save_figures
from sizeviz.scene.figures.sheet import COLORS, Published, draw_evolution, inside, painted_cells, save_evolution, sheet
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sources import Source
from sizeviz.study import COMPARED, Study, StudyOptions, run
from sizeviz.study.adaptive import AdaptOptions, adapted
from sizeviz.study.backgrounds import uniform_mesh
from sizeviz.study.paper import Adaptation, ImageRun, line_example


def slope() -> Source:
    x = (np.arange(16) + 0.5) / 16
    image = Image(np.tile(x, (16, 1)), (1 / 16, 1 / 16), (1 / 32, 1 / 32), label="a slope")
    background = BackgroundMesh.unit_square_grid(17, 17)
    field = SizeField(background, 0.06 + 0.5 * np.abs(background.points[:, 0] - 0.5))
    return Source("slope", "a slope", Domain.unit_square(), field, field, image)


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    folder = tmp_path_factory.mktemp("figures")
    study = StudyOptions(mesh=MeshOptions(mesher="decomposition", scale=0.8))
    ring = []
    for method in COMPARED:
        place = folder / method
        evolution = adapted(slope(), AdaptOptions(method=method, study=study, cells=4, iterations=2), place)
        ring.append(Adaptation("decomposition", method, evolution, place))
    done = run(Study(slope(), study), COMPARED)
    images = {name: [ImageRun(done.source, "decomposition", dict(done.runs), {})] for name in ("first", "second")}
    norms = save_figures(line_example(), ring, images, folder)
    save_evolution(ring[0].evolution, folder)
    return folder, ring, images, norms


def test_every_figure_is_there_twice(drawn):
    folder, *_ = drawn
    names = [f"figure-{k}" for k in range(1, 9)] + [f"figure-{k}-second" for k in (6, 7, 8)] + ["evolution"]
    for name in names:
        with Picture.open(folder / f"{name}.png") as picture:
            grey = np.asarray(picture.convert("L"))
        assert min(picture.size) > 400
        assert len(np.unique(grey)) > 10
        text = (folder / f"{name}.svg").read_text(encoding="utf-8")
        assert "<text" in text


def test_the_verdict_is_in_the_figure(drawn):
    folder, _, images, _ = drawn
    one = images["first"][0]
    text = (folder / "figure-8.svg").read_text(encoding="utf-8")
    assert f"{one.runs['size-preserving'].mesh.n_quads:,} elements" in text
    assert f"largest {one.runs['size-preserving'].report.max_ratio['mean-edge']:.3f}" in text


def test_a_linear_image_is_interpolated_without_error(drawn):
    _, _, images, norms = drawn
    done = images["first"][0].runs["size-preserving"]
    errors, x = image_errors(slope(), done), done.mesh.points[done.mesh.quads][:, :, 0]
    within = (x > 1 / 32).all(axis=1) & (x < 31 / 32).all(axis=1)  # beyond the pixel centres the image is constant
    assert within.sum() > 50
    assert errors[within].max() < 1e-12 < errors.max()
    found = norms["first", "decomposition", "size-preserving"]
    assert found["max"] == pytest.approx(100 * errors.max())
    assert found["mean"] == pytest.approx(100 * errors @ done.mesh.areas)
    assert found["mean"] < found["rms"] < found["max"]


def test_an_evolution_is_drawn_as_it_is(drawn):
    _, ring, *_ = drawn
    rows = ring[0].evolution.iterations
    assert len(rows) >= 2
    _, (axes,) = sheet((1, 1))
    draw_evolution(axes, {"": ring[0].evolution}, "analytic", COLORS["size-preserving"])
    line = axes.get_lines()[0]
    assert line.get_xdata().tolist() == [row.number for row in rows[1:]]
    assert line.get_ydata().tolist() == [row.analytic_ratio for row in rows[1:]]


def test_cells_painted_as_pixels():
    corner = np.array([[0, 0], [0.5, 0], [0.5, 0.5], [0, 0.5]])
    corners = np.stack([corner + shift for shift in ([0, 0], [0.5, 0], [0.5, 0.5])])
    colors = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255]], dtype=np.uint8)
    picture = painted_cells(corners, colors, (0.0, 0.0, 1.0, 1.0), pixels=40)
    assert picture.shape == (40, 40, 3)
    assert picture[30, 10].tolist() == [255, 0, 0]  # the highest y comes first
    assert picture[30, 30].tolist() == [0, 255, 0]
    assert picture[10, 30].tolist() == [0, 0, 255]
    assert picture[10, 10].tolist() == [255, 255, 255]
    share = (picture == colors[1]).all(axis=2).mean()
    assert share == pytest.approx(0.25, abs=0.04)


def test_a_published_number_is_drawn_where_it_belongs(drawn):
    _, ring, *_ = drawn
    _, (axes,) = sheet((1, 1))
    draw_evolution(axes, {"": ring[0].evolution}, "analytic", "black", Published("theirs", 1.046, 4))
    assert [line.get_xydata().tolist() for line in axes.get_lines() if line.get_label() == "theirs"] == [[[4, 1.046]]]
    assert axes.get_ylim()[0] < 1.0
    draw_evolution(axes, {"": ring[0].evolution}, "analytic", "black", Published("bound", 99.0))
    assert axes.get_ylim()[1] > 99.0


def test_elements_inside_a_box():
    mesh = uniform_mesh(Domain.unit_square(), 10, MeshOptions())
    assert inside(mesh, (0.0, 0.0, 1.0, 1.0)).all()
    assert inside(mesh, (0.41, 0.41, 0.49, 0.59)).sum() == 2
    assert not inside(replace(mesh), (2.0, 2.0, 3.0, 3.0)).any()
