from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sizeviz.errors import InputError
from sizeviz.scene.colormaps import MAPS, RATIO_MAP, color_map
from sizeviz.scene.scale import ColorScale, ratio_scale, tick_label


def is_blue(color: np.ndarray) -> bool:
    return int(color[2]) > int(color[0])


@pytest.mark.parametrize("classes", [0, 2, 6, 9])
def test_one_is_blue_and_just_above_is_orange(classes: int) -> None:
    scale = ratio_scale(0.4, 2.0, classes=classes)
    at, below, rounding, above = scale.colors(np.array([1.0, 0.999999, 1.0 + 5e-10, 1.0 + 1e-6]))
    assert is_blue(at) and is_blue(below) and is_blue(rounding)
    assert not is_blue(above)


@given(st.floats(0.01, 100.0))
def test_blue_exactly_where_the_element_is_correct(ratio: float) -> None:
    color = ratio_scale(0.3, 3.0).colors(np.array([ratio]))[0]
    assert is_blue(color) == (ratio <= 1.0 + 1e-9)


def test_the_bar_shows_what_the_elements_show() -> None:
    for scale in (
        ratio_scale(0.5, 2.0),
        ColorScale(color_map("viridis"), 0.0, 1.0),
        ColorScale(color_map("ice_r"), 1e-3, 1.0, "log"),
    ):
        steps = 200
        values = np.array([scale.value_at((k + 0.5) / steps) for k in range(steps)])
        difference = scale.colors(values).astype(int) - scale.bar(steps).astype(int)
        assert np.abs(difference).max() <= 6  # half a table row at most


def test_the_ratio_bar_has_a_tick_at_one_in_its_middle_and_one_at_1_1() -> None:
    ticks = {label: at for at, label in ratio_scale(0.35, 4.0).ticks()}
    assert ticks["1"] == pytest.approx(0.5)
    assert 0.5 < ticks["1.1"] < 0.6


@pytest.mark.parametrize("norm", ["linear", "log", "ratio"])
def test_place_and_value_are_inverse(norm) -> None:
    scale = ColorScale(RATIO_MAP, 0.25, 3.0, norm)
    places = np.linspace(0.0, 1.0, 41)
    back = scale.fractions(np.array([scale.value_at(p) for p in places]))
    np.testing.assert_allclose(back, places, atol=1e-12)


def test_classes_give_so_many_colors() -> None:
    scale = ColorScale(color_map("viridis"), 0.0, 1.0, classes=5)
    assert len(np.unique(scale.colors(np.linspace(0, 1, 1000)), axis=0)) == 5


def test_beyond_the_ends_the_end_colors_hold_and_nan_is_grey() -> None:
    scale = ColorScale(color_map("magma"), 1.0, 2.0)
    low, beneath, high, over, undefined = scale.colors(np.array([1.0, -5.0, 2.0, 9.0, np.nan]))
    assert (low == beneath).all() and (high == over).all()
    assert len(set(undefined.tolist())) == 1


@pytest.mark.parametrize("name", [name for name in MAPS if name != RATIO_MAP.name])
def test_smooth_maps_change_their_lightness_one_way(name: str) -> None:
    luminance = MAPS[name].table @ np.array([0.2126, 0.7152, 0.0722])
    steps = np.diff(luminance)
    assert (steps >= -1.0).all() or (steps <= 1.0).all()
    assert abs(luminance[-1] - luminance[0]) > 120


@pytest.mark.parametrize(
    "bad",
    [
        lambda: ColorScale(color_map("grey"), 1.0, 1.0),
        lambda: ColorScale(color_map("grey"), float("nan"), 1.0),
        lambda: ColorScale(color_map("grey"), -1.0, 1.0, "log"),
        lambda: ColorScale(RATIO_MAP, 1.1, 2.0, "ratio"),
        lambda: color_map("rainbow"),
    ],
)
def test_impossible_scales_are_refused(bad) -> None:
    with pytest.raises(InputError):
        bad()


def test_tick_labels_are_short() -> None:
    shown = [tick_label(v) for v in (0.0, 1.0, 0.05, 0.25, 1200.0, 2.5e-4, 1e-6)]
    assert shown == ["0", "1", "0.05", "0.25", "1200", "2.5·10⁻⁴", "10⁻⁶"]
