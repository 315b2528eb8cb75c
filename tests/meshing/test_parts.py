"""Packing in parts side by side: no seam where they meet, and the same nodes for any number of threads."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from sizeviz.geometry import Domain
from sizeviz.meshing import MeshOptions
from sizeviz.meshing.frontal import packing
from sizeviz.meshing.frontal.boundary import outline
from sizeviz.meshing.frontal.region import region_arrays
from sizeviz.sizing import BackgroundMesh, SizeField


def field() -> SizeField:
    """Return sizes with a valley that crosses the cuts."""
    background = BackgroundMesh.unit_square_grid(65, 65)
    x, y = background.points.T
    return SizeField(background, 0.008 + 0.15 * np.abs(x - 0.3 - 0.3 * y), "valley")


def nodes(threads: int | None = None) -> np.ndarray:
    size, options, domain = field(), MeshOptions(scale=1.0, threads=threads), Domain.unit_square()
    rim = outline(domain, size, 1.0)
    region = region_arrays(domain, rim)
    return packing.packed(rim, region, packing.seeded(region, size, options), size, options)


def test_parts_meet_without_gap_or_crowd(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = nodes()
    monkeypatch.setattr(packing, "SMALLEST", 100)
    parts = nodes()
    assert len(parts) == pytest.approx(len(whole), rel=0.02)
    size = field()
    distance, _ = cKDTree(parts).query(parts, 2)
    assert (distance[:, 1] / size.at(parts)).min() > 0.5
    where = np.random.default_rng(0).uniform(0.0, 1.0, (20_000, 2))
    furthest = [(cKDTree(found).query(where)[0] / size.at(where)).max() for found in (whole, parts)]
    assert furthest[1] < 1.1 * furthest[0]


def test_nodes_do_not_depend_on_the_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packing, "SMALLEST", 100)
    assert np.array_equal(nodes(1), nodes(2))
