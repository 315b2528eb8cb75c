"""The part of a field in a box."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.sizing.part import part_of
from tests.fields import catalogue, frame

FIELDS = catalogue()


@pytest.mark.parametrize("name", FIELDS)
def test_within_the_box_nothing_changes_and_beyond_it_little_is_left(name: str) -> None:
    field = FIELDS[name]
    x0, y0, x1, y1 = field.background.bounds
    corner, width = np.array([x0, y0]), np.array([x1 - x0, y1 - y0])
    low, high = corner + width * [0.3, 0.1], corner + width * [0.5, 0.4]
    part = part_of(field, low, high)
    there = np.random.default_rng(3).uniform(low, high, (500, 2))
    np.testing.assert_allclose(part.at(there), field.at(there), rtol=1e-12)
    assert len(part.background.triangles) <= len(field.background.triangles)
    assert np.isin(part.sizes, field.sizes).all()


def test_a_small_box_needs_few_triangles() -> None:
    field = FIELDS["rough grid"]
    middle = field.background.points.mean(axis=0)
    assert len(part_of(field, middle, middle + 1e-6).background.triangles) <= 6


def test_beyond_the_background_the_whole_field_counts() -> None:
    field = frame()
    assert part_of(field, np.array([2.0, 2.0]), np.array([3.0, 3.0])) is field
