"""Plateaus of a field get one lattice, and straight outlines keep two elements at every node."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from sizeviz.conformity import shape_quality
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.meshing import MeshOptions, generated
from sizeviz.meshing.frontal import packing
from sizeviz.sizing import BackgroundMesh, Grid, SizeField

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray


def field(function: Callable[[NDArray, NDArray], NDArray], nodes: int = 101) -> SizeField:
    background = BackgroundMesh.regular(Grid(0.0, 0.0, 1 / (nodes - 1), 1 / (nodes - 1), nodes, nodes))
    return SizeField(background, function(*background.points.T), "test")


def irregular(mesh: QuadMesh) -> NDArray:
    """Return the inner nodes that have not four elements."""
    valence = np.bincount(mesh.quads.ravel(), minlength=mesh.n_points)
    return mesh.points[(mesh.curve < 0) & (valence != 4)]


def test_a_constant_size_on_a_square_gives_squares() -> None:
    mesh = generated(Domain.unit_square(), field(lambda x, y: 0.021 + 0 * x), MeshOptions(scale=1.0))
    assert mesh.n_quads == 48**2
    assert len(irregular(mesh)) == 0
    assert shape_quality(mesh).min() > 0.999


def test_fronts_that_meet_on_a_plateau_fit_together() -> None:
    """A coarse blob inside a fine plateau: far from the blob every node is regular."""

    def sizes(x: NDArray, y: NDArray) -> NDArray:
        return np.maximum(0.01, 0.01 + 0.5 * (0.15 - np.hypot(x - 0.45, y - 0.55)))

    mesh = generated(Domain.unit_square(), field(sizes), MeshOptions(scale=0.9))
    odd = irregular(mesh)
    assert len(odd) > 0
    assert np.hypot(odd[:, 0] - 0.45, odd[:, 1] - 0.55).max() < 0.22


def test_a_narrow_valley_has_no_lattice(monkeypatch: pytest.MonkeyPatch) -> None:
    """A floor less than a few elements wide is meshed as if there were no plateaus."""
    narrow = field(lambda x, y: np.maximum(0.02, np.abs(x + 0.3 * y - 0.6)))
    mesh = generated(Domain.unit_square(), narrow)
    monkeypatch.setattr(packing, "plateaus", lambda *_: np.empty((0, 5)))
    assert np.array_equal(generated(Domain.unit_square(), narrow).points, mesh.points)


@pytest.mark.parametrize("seed", range(6))
def test_no_element_bends_around_a_straight_outline(seed: int) -> None:
    """Sizes that grow steeply towards the sides; only the corners of the square may have one element."""
    steep = field(lambda x, y: 0.004 + 0.5 * np.abs(np.hypot(x - 0.5, y - 0.5) - 0.25))
    mesh = generated(Domain.unit_square(), steep, MeshOptions(seed=seed))
    valence = np.bincount(mesh.quads.ravel(), minlength=mesh.n_points)
    assert np.count_nonzero(valence == 1) <= 4
    assert valence[(mesh.curve >= 0) & ~mesh.fixed].min() >= 2
    corner = mesh.points[valence == 1]
    assert np.isin(corner, (0.0, 1.0)).all()
