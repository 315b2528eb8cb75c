from __future__ import annotations

import numpy as np
import pytest
from scene.fakes import fake_report, grid_field, lattice, subject

from sizeviz.geometry import Domain
from sizeviz.scene.camera import Camera2D
from sizeviz.scene.canvas import text_width
from sizeviz.scene.comparison import wrapped
from sizeviz.scene.compose import compose, outline_segments, scale_for
from sizeviz.scene.spec import CellLayer, ImageLayer, LineLayer, TriangleLayer
from sizeviz.scene.subject import Subject
from sizeviz.scene.verdict import percent, quality_words, ratio_words
from sizeviz.scene.view import ViewState
from sizeviz.sizing import BackgroundMesh, SizeField


def layer(spec, name):
    return next((entry for entry in spec.layers if entry.name == name), None)


def test_elements_keep_the_meshs_own_arrays_and_get_a_color_each() -> None:
    shown = subject(12)
    spec = compose(shown, ViewState())
    cells = layer(spec, "elements")
    assert isinstance(cells, CellLayer)
    assert cells.points is shown.mesh.points and cells.quads is shown.mesh.quads
    assert cells.colors.shape == (144, 3) and cells.colors.dtype == np.uint8


def test_exactly_the_failing_elements_are_outlined() -> None:
    shown = subject(12)
    lines = layer(compose(shown, ViewState()), "failing")
    failing = np.flatnonzero(shown.report.ratios["mean-edge"] > 1.0 + 1e-9)
    assert 0 < len(failing) < 144
    np.testing.assert_array_equal(lines.segments, outline_segments(shown.mesh.quads[failing]))
    assert layer(compose(shown, ViewState(outline_failing=False)), "failing") is None


def test_the_measure_changes_what_is_shown() -> None:
    shown = subject(12)
    colors = [layer(compose(shown, ViewState(measure=m)), "elements").colors for m in ("mean-edge", "max-edge")]
    assert (colors[0] != colors[1]).any()


def test_a_field_on_a_grid_is_one_picture_with_row_zero_at_the_bottom() -> None:
    x_field = grid_field(9)
    rising = x_field.with_sizes(0.1 + x_field.background.points[:, 1])
    picture = layer(compose(Subject(prescribed=rising), ViewState(color_by="prescribed")), "field")
    assert isinstance(picture, ImageLayer) and picture.colors.shape == (9, 9, 3)
    assert picture.bounds == (0.0, 0.0, 1.0, 1.0)
    scale = scale_for([rising.sizes], ViewState(color_by="prescribed"))
    np.testing.assert_array_equal(picture.colors[0, 0], scale.colors(np.array([0.1]))[0])


def test_a_field_on_triangles_is_triangles() -> None:
    grid = grid_field(5)
    field = SizeField(BackgroundMesh(grid.background.points, grid.background.triangles), grid.sizes)
    spec = compose(Subject(target=field), ViewState(color_by="target"))
    assert isinstance(layer(spec, "field"), TriangleLayer)


def test_holes_are_outlined_too() -> None:
    hole = np.array([[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]])
    domain = Domain(np.array([[0, 0], [1, 0], [1, 1], [0, 1]]), holes=(hole,))
    lines = layer(compose(Subject(domain=domain), ViewState()), "outline")
    assert isinstance(lines, LineLayer) and len(lines.segments) == 4 + 3
    assert set(np.bincount(lines.segments.ravel())) == {2}


def test_nothing_yet_is_said_and_not_an_error() -> None:
    for view, words in ((ViewState(), "no mesh yet"), (ViewState(color_by="target"), "not computed yet")):
        spec = compose(Subject(), view)
        assert spec.verdict == words and spec.scale is None and spec.passed is None


def test_a_shared_scale_covers_both_sets_of_values() -> None:
    scale = scale_for([np.array([0.5, 0.9]), np.array([0.7, 1.8])], ViewState())
    assert (scale.low, scale.high) == (0.5, 1.8)


@pytest.mark.parametrize("mode", ["fixed", "percentile"])
def test_ranges_fixed_and_by_percentile(mode) -> None:
    values = np.linspace(1.0, 101.0, 1001)
    view = ViewState(color_by="size", range_mode=mode, low=2.0, high=3.0, percentile=10.0)
    scale = scale_for([values], view)
    expected = (2.0, 3.0) if mode == "fixed" else (11.0, 91.0)
    assert (scale.low, scale.high) == pytest.approx(expected)


def test_constant_values_still_have_a_range() -> None:
    scale = scale_for([np.full(5, 0.02)], ViewState(color_by="prescribed"))
    assert scale.low < 0.02 < scale.high


def test_verdicts_never_flatter() -> None:
    ratios = np.full(100_000, 0.9)
    ratios[8123] = 1.0251
    assert ratio_words(ratios) == ("99.9990 % correct, worst R = 1.03 at element 8123", False)
    ratios[8123] = 1.0 + 5e-10
    assert ratio_words(ratios) == ("100 % correct, worst R = 1.00 at element 8123", True)
    assert ratio_words(np.array([0.5, 1.0001]))[0].startswith("50.00 % correct, worst R = 1.0001 at")


def test_percent_reaches_100_only_for_all() -> None:
    assert percent(999_999, 1_000_000) == "99.9999 %"
    assert percent(2, 3) == "66.66 %"
    assert percent(7, 7) == "100 %" and percent(0, 0) == "0 %"


def test_inverted_elements_are_called_so() -> None:
    words, passed = quality_words(np.array([0.9, -0.1]))
    assert "inverted" in words and passed is False


def test_a_bare_mesh_can_be_composed_by_report() -> None:
    mesh = lattice(4)
    spec = compose(Subject(mesh=mesh, report=fake_report(mesh, np.full(16, 0.25))), ViewState())
    assert spec.passed is True and spec.bounds == (0.0, 0.0, 1.0, 1.0)


def test_the_camera_maps_pixels_there_and_back_and_zooms_about_the_cursor() -> None:
    camera = Camera2D.fitted((0.0, 0.0, 2.0, 1.0), 1.5)
    assert camera.height >= 2.0 / 1.5
    x, y = camera.to_model(37.0, 81.0, 300, 200)
    assert camera.to_pixel(x, y, 300, 200) == pytest.approx((37.0, 81.0))
    assert camera.zoomed(3.0, x, y).to_pixel(x, y, 300, 200) == pytest.approx((37.0, 81.0))
    moved = camera.panned(10.0, -5.0, 200)
    assert moved.to_pixel(x, y, 300, 200) == pytest.approx((47.0, 76.0))


def test_the_guaranteed_method_is_judged_by_what_it_promises() -> None:
    mesh = lattice(6, 0.05)
    report = fake_report(mesh, np.full(36, 0.198))
    assert report.ratios["mean-edge"].max() < 1.0 < report.ratios["max-edge"].max()
    promised = compose(Subject(mesh=mesh, report=report, promise="max-edge"), ViewState())
    assert "correct by the longest edge, worst R = 1." in promised.verdict and promised.passed is False
    plain = compose(Subject(mesh=mesh, report=report), ViewState())
    assert plain.verdict.startswith("100 % correct, worst R = 0.") and plain.passed is True


@pytest.mark.parametrize("width", [150.0, 330.0, 480.0, 900.0])
def test_words_under_a_pane_are_broken_to_its_width(width: float) -> None:
    words = "4 inverted, mean quality 0.922, worst 0.000 at element 8670"
    lines, size = wrapped(words, width, 25)
    assert " ".join(lines) == words and len(lines) <= 2 and size <= 25
    assert all(text_width(line, size) <= width for line in lines)


def test_a_selection_outlives_the_mesh_it_was_made_in() -> None:
    shown = subject(12)
    assert len(layer(compose(shown, ViewState(), selected=np.array([3, 900])), "selected").segments) == 4
    assert layer(compose(shown, ViewState(), selected=np.array([900, 901])), "selected") is None, "nothing is no layer"
