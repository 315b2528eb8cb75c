"""The quadtree that seeds the packing: what lies outside the domain costs nothing."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from sizeviz.geometry import Domain
from sizeviz.meshing import MeshOptions
from sizeviz.meshing.frontal import _region_kernels as kernels
from sizeviz.meshing.frontal.boundary import outline
from sizeviz.meshing.frontal.packing import seeded
from sizeviz.meshing.frontal.region import region_arrays
from sizeviz.sizing import BackgroundMesh, Grid, SizeField
from sizeviz.sources.shapes import shape


def on_box(domain: Domain, n: int, size: float) -> SizeField:
    x0, y0, x1, y1 = domain.bounds
    grid = Grid(x0, y0, (x1 - x0) / (n - 1), (y1 - y0) / (n - 1), n, n)
    return SizeField(BackgroundMesh.regular(grid), np.full(n * n, size), "even")


@pytest.mark.parametrize("name", ["L", "star", "annulus", "coastline"])
def test_no_square_that_meets_the_domain_is_taken_for_outside(name: str) -> None:
    domain = shape(name)
    x0, y0, x1, y1 = domain.bounds
    width = max(x1 - x0, y1 - y0)
    region = region_arrays(domain, outline(domain, on_box(domain, 5, 0.1 * width), 1.0))
    inside = shapely.Polygon(domain.outer, domain.holes)
    rng = np.random.default_rng(1)
    hint, seen, far = 0, 0, 0
    for _ in range(2000):
        x, y = rng.uniform(x0, x1), rng.uniform(y0, y1)
        half = 0.5 * width * 10.0 ** rng.uniform(-4.0, -0.5)
        beyond, hint = kernels.outside(region, x, y, half, hint, np.empty(24, dtype=np.int64))
        # chords cut off slivers of curves; what the packing asks is whether a node may lie there
        meets = inside.buffer(-0.03 * width).intersects(shapely.box(x - half, y - half, x + half, y + half))
        assert not (beyond and meets)
        seen += beyond
        far += inside.distance(shapely.Point(x, y)) > 0.1 * width and half < 0.01 * width
    assert seen > 0.5 * far > 0


def test_sizes_too_small_for_any_tree_do_not_matter_beyond_the_boundary() -> None:
    domain = shape("L")
    field = on_box(domain, 65, 0.05)
    inside = shapely.Polygon(domain.outer)
    away = shapely.distance(inside, shapely.points(field.background.points))
    spoilt = field.with_sizes(np.where(away > 0.1, 1e-9, field.sizes))
    region = region_arrays(domain, outline(domain, field, 1.0))
    plain, seeds = (seeded(region, size, MeshOptions(scale=1.0)) for size in (field, spoilt))
    assert len(seeds.rows) >= len(plain.rows)
    assert seeds.asked == pytest.approx(domain.area / 0.05**2, rel=0.1)
