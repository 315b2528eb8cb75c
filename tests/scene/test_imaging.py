from __future__ import annotations

import numpy as np
import pytest
from scene.fakes import lattice

from sizeviz.files.image import Image
from sizeviz.geometry import Domain
from sizeviz.scene.compose import compose
from sizeviz.scene.imaging import interpolation_errors, sampled
from sizeviz.scene.subject import Subject
from sizeviz.scene.view import ViewState

BOX = (0.0, 0.0, 1.0, 1.0)


def ramp(n: int = 32) -> Image:
    centres = (np.arange(n) + 0.5) / n
    return Image(centres[:, None] * 2.0 + centres[None, :])


def test_a_linear_image_is_sampled_exactly_inside() -> None:
    points = np.random.default_rng(0).uniform(0.05, 0.95, (200, 2))
    np.testing.assert_allclose(sampled(ramp(), points, BOX), points[:, 0] + 2 * points[:, 1], atol=1e-12)


def test_a_linear_image_has_no_error_away_from_the_border() -> None:
    mesh = lattice(8, 0.04)
    inner = (np.abs(mesh.points[mesh.quads] - 0.5) < 0.45).all(axis=(1, 2))
    errors = interpolation_errors(mesh, ramp(), BOX)
    assert inner.any() and errors[inner].max() < 1e-12


def test_finer_meshes_err_less_at_second_order() -> None:
    c = (np.arange(256) + 0.5) / 256
    image = Image(np.sin(3 * c)[:, None] * np.cos(2 * c)[None, :])
    coarse, fine = (interpolation_errors(lattice(n), image, BOX).mean() for n in (8, 16))
    assert coarse / fine == pytest.approx(4.0, rel=0.15)


def test_the_error_can_be_shown_where_there_is_an_image() -> None:
    shown = Subject(mesh=lattice(6), image=Image(np.random.default_rng(1).random((9, 9))), domain=Domain.unit_square())
    assert compose(shown, ViewState(color_by="error")).scale is not None
    without = Subject(mesh=lattice(6), domain=Domain.unit_square())
    assert compose(without, ViewState(color_by="error")).verdict == "no image to measure against"
