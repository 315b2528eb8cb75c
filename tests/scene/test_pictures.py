from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from scene.fakes import fake_report, grid_field, lattice, subject

from sizeviz.errors import InputError
from sizeviz.scene import Camera2D, Subject, ViewState, compose, save_comparison, save_picture
from sizeviz.scene.comparison import Layout
from sizeviz.scene.opengl import probe
from sizeviz.scene.stage import Stage

pytestmark = pytest.mark.gl


@pytest.fixture(scope="module")
def stage():
    with Stage() as stage:
        yield stage


def whole(spec, aspect: float = 1.0) -> Camera2D:
    return Camera2D.fitted(spec.bounds, aspect, 1.0)


def test_every_element_is_drawn_in_exactly_its_color(stage) -> None:
    mesh = lattice(8)
    ratios = np.linspace(0.5, 2.0, 64)
    shown = Subject(mesh=mesh, report=fake_report(mesh, 0.125 / ratios))
    spec = compose(shown, ViewState(outline_failing=False))
    pixels = stage.shoot(spec, whole(spec), 160, 160)
    colors = spec.scale.colors(ratios).reshape(8, 8, 3)
    for i in range(8):
        for j in range(8):
            np.testing.assert_array_equal(pixels[159 - (20 * i + 10), 20 * j + 10], colors[i, j])


def test_a_grid_field_is_drawn_the_right_way_up(stage) -> None:
    field = grid_field(33)
    x, y = field.background.points.T
    spec = compose(
        Subject(prescribed=field.with_sizes(0.01 + x + 10.0 * y)), ViewState(color_by="prescribed", log=False)
    )
    pixels = stage.shoot(spec, whole(spec), 132, 132).astype(int)
    for column, row, value in ((66, 66, 5.51), (2, 2, 9.88), (129, 129, 1.13)):
        expected = spec.scale.colors(np.array([value]))[0].astype(int)
        assert np.abs(pixels[row, column] - expected).max() <= 12


def test_showing_other_colors_touches_no_geometry(stage) -> None:
    shown = subject(10)
    first, second = (compose(shown, ViewState(color_by=q)) for q in ("ratio", "quality"))
    stage.shoot(first, whole(first), 64, 64)
    data = stage._renderer._shown["elements"].parts
    pixels = stage.shoot(second, whole(second), 64, 64)
    assert stage._renderer._shown["elements"].parts is data
    assert "failing" not in stage._renderer._shown
    again = stage.shoot(compose(shown, ViewState(color_by="quality")), whole(second), 64, 64)
    np.testing.assert_array_equal(pixels, again)


def test_memory_of_the_plotter_stays_flat_over_many_scenes(stage) -> None:
    for k in range(12):
        spec = compose(subject(6 + k % 3), ViewState(color_by="ratio" if k % 2 else "target"))
        stage.shoot(spec, whole(spec), 48, 48)
    assert len(stage._plotter.actors) <= len(spec.layers)


def test_the_comparison_has_rows_columns_and_the_size_asked_for(tmp_path) -> None:
    rows = [subject(40, scale=0.9, title="Gradient limiting"), subject(40, scale=1.3)]
    path = save_comparison(rows, tmp_path / "compare.png", width=1000)
    with Image.open(path) as image:
        picture = np.asarray(image)
    layout = Layout(1000, 1.0)
    assert picture.shape == (layout.height(2), 1000, 3)
    orange = []
    for row in range(2):
        left, top, right, bottom = layout.pane_box(row, 0)
        pane = picture[top:bottom, left:right].astype(int)
        orange.append((pane[..., 0] > pane[..., 2] + 60).mean())
        assert (pane.reshape(-1, 3) == 255).all(axis=1).mean() < 0.08  # no hole
    assert orange[0] > orange[1] + 0.1


def test_pictures_of_every_kind(tmp_path) -> None:
    for quantity in ("ratio", "quality", "size", "prescribed", "target"):
        path = save_picture(subject(12), tmp_path / f"{quantity}.png", color_by=quantity, width=400)
        with Image.open(path) as picture:
            assert picture.size[0] == 400


@pytest.mark.parametrize("suffix", ["svg", "pdf"])
def test_vector_figures_hold_no_bitmap_of_the_mesh(tmp_path, suffix: str) -> None:
    path = save_picture(subject(10), tmp_path / f"mesh.{suffix}")
    data = path.read_bytes()
    if suffix == "svg":
        text = data.decode()
        assert "<image" not in text and "correct, worst R" in text
        assert text.count("<path") >= 50
    else:
        assert data.startswith(b"%PDF") and b"/Subtype /Image" not in data


def test_a_failed_write_leaves_nothing_behind(tmp_path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        save_picture(subject(6), tmp_path / "no" / "such" / "picture.png", width=200)
    with pytest.raises(InputError, match=re.escape(".bmpx")):
        save_picture(subject(6), tmp_path / "picture.bmpx", width=200)
    assert not list(tmp_path.rglob("*"))


def test_what_cannot_be_shown_is_said(tmp_path) -> None:
    with pytest.raises(InputError, match="not computed yet"):
        save_picture(replace(subject(6), target=None), tmp_path / "x.png", color_by="target")
    with pytest.raises(InputError, match="run the study first"):
        save_comparison([replace(subject(6), report=None)], tmp_path / "x.png")


def test_the_probe_finds_that_drawing_works() -> None:
    assert probe() is None
