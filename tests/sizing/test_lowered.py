"""Sizes lowered around some places: so much there, and nothing elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sizing.lowered import lowered


@pytest.mark.parametrize("nodes", [3, 65], ids=["coarse", "fine"])
def test_sizes_are_a_share_near_a_place_and_the_same_beyond_twice_the_reach(nodes: int) -> None:
    background = BackgroundMesh.unit_square_grid(nodes, nodes)
    field = SizeField(background, 0.1 + 0.05 * background.points[:, 0])
    places, reach = np.array([[0.31, 0.43], [0.77, 0.8]]), np.array([0.06, 0.04])
    low = lowered(field, places, reach, np.array([0.7, 0.9]), np.zeros(2))
    assert low.at(places) == pytest.approx([0.7, 0.9] * field.at(places), rel=1e-12)
    points = np.random.default_rng(1).uniform(0.0, 1.0, (4000, 2))
    away = np.array([np.hypot(*(points - place).T) for place in places])
    ratio = low.at(points) / field.at(points)
    assert ratio.min() >= 0.7 - 1e-12 and ratio.max() <= 1.0 + 1e-12
    # a nonagon holds all that is lowered, up to a background edge
    far = (away > 2.0 * reach[:, None] + np.sqrt(2.0) / 64).all(axis=0)
    assert ratio[far] == pytest.approx(1.0, abs=1e-12)
    assert (ratio[away[0] < 0.8 * reach[0]] < 0.75).all()


def test_no_place_leaves_the_field_itself() -> None:
    field = SizeField(BackgroundMesh.unit_square_grid(5, 5), np.full(25, 0.1))
    assert lowered(field, np.empty((0, 2)), *(np.empty(0) for _ in range(3))) is field


def test_far_from_the_origin_and_on_existing_nodes() -> None:
    background = BackgroundMesh.unit_square_grid(9, 9)
    moved = BackgroundMesh(background.points + 1e6, background.triangles)
    field = SizeField(moved, np.full(81, 0.1))
    low = lowered(field, moved.points[[0, 40]], np.full(2, 0.125), np.full(2, 0.5), np.zeros(2))
    assert low.at(moved.points[[0, 40]]) == pytest.approx([0.05, 0.05])
    assert low.at(np.array([[1e6 + 0.9, 1e6 + 0.1]])) == pytest.approx([0.1])


def test_no_size_is_lowered_below_the_least_that_a_place_asks_for() -> None:
    background = BackgroundMesh.unit_square_grid(65, 65)
    field = SizeField(background, 0.02 + 0.2 * background.points[:, 0])
    place = np.array([[0.4, 0.5]])
    low = lowered(field, place, np.array([0.2]), np.array([0.5]), np.array([0.08]))
    assert low.at(place) == pytest.approx([0.08])
    small = np.array([[0.25, 0.5], [0.29, 0.45]])
    assert low.at(small) == pytest.approx(field.at(small))
