"""The ideal count N* against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.geometry import Domain
from sizeviz.sizing import BackgroundMesh, SizeField, ideal_count
from tests import fields

SQUARE = Domain.unit_square()


def test_constant_and_linear_fields():
    background = BackgroundMesh.unit_square_grid(6, 4)
    assert ideal_count(SizeField(background, np.full(24, 0.1)), SQUARE) == pytest.approx(100, rel=1e-12)
    for least, rise in ((0.1, 0.3), (0.1, 1e-6), (1e-3, 2.0)):
        field = SizeField(background, least + rise * background.points[:, 0])
        assert ideal_count(field, SQUARE) == pytest.approx(1 / (least * (least + rise)), rel=1e-9)


def test_refining_the_background_changes_nothing():
    field = fields.on_grid(9, 7, 3, spread=0.6)
    domain = Domain.rectangle(*field.background.bounds)
    fine = BackgroundMesh.regular(
        type(field.background.grid)(-0.3, 0.2, 1 / 32, 1 / 24, 33, 25)  # every edge cut in four
    )
    finer = SizeField(fine, field.at(fine.points))
    assert ideal_count(finer, domain) == pytest.approx(ideal_count(field, domain), rel=1e-9)


def test_parts_of_the_background_and_beyond_it():
    background = BackgroundMesh.unit_square_grid(5, 5)
    field = SizeField(background, 0.1 + 0.2 * background.points[:, 0])
    part = Domain.rectangle(0.13, 0.3, 0.61, 0.77)
    wanted = 0.47 / 0.2 * (1 / (0.1 + 0.2 * 0.13) - 1 / (0.1 + 0.2 * 0.61))
    assert ideal_count(field, part) == pytest.approx(wanted, rel=1e-3)
    beyond = Domain.rectangle(0.0, 0.0, 2.0, 1.0)  # sizes of 0.3 continue on the right
    assert ideal_count(field, beyond) == pytest.approx(1 / (0.1 * 0.3) + 1 / 0.09, rel=1e-3)
