"""Envelopes after a change of some sizes: the same as from the start, and only what the change reaches is done."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.sizing import BackgroundMesh, LimitOptions, PreserveOptions, SizeField, limited, preserved
from sizeviz.sizing._envelope_kernels import LIMIT, PRESERVE
from sizeviz.sizing.again import processed_again, reached_tiles

VERBS = {
    "limited": (limited, LimitOptions(epsilon=0.4)),
    "preserved": (preserved, PreserveOptions(alpha=1.7, beta=0.8)),
}


def rough(nx: int, ny: int, seed: int) -> SizeField:
    noise = np.random.default_rng(seed)
    background = BackgroundMesh.unit_square_grid(nx, ny)
    return SizeField(background, np.exp(noise.normal(-3.0, 0.5, nx * ny)), "rough")


def touched(field: SizeField, seed: int, factor: float) -> SizeField:
    noise = np.random.default_rng(seed)
    centre, radius = noise.uniform(0.0, 1.0, 2), noise.uniform(0.02, 0.1)
    near = np.hypot(*(field.background.points - centre).T) < radius
    return field.with_sizes(np.where(near, factor * field.sizes, field.sizes))


@pytest.mark.parametrize("name", VERBS)
@pytest.mark.parametrize("factor", [0.1, 0.7, 1.5, 20.0])
@pytest.mark.parametrize("shape", [(41, 33), (64, 64), (9, 50)])
def test_done_again_is_what_it_would_be_from_the_start(name: str, factor: float, shape: tuple[int, int]) -> None:
    verb, options = VERBS[name]
    for seed in range(4):
        before = rough(*shape, seed)
        field = touched(before, seed, factor)
        expected = verb(field, options).sizes
        sizes = processed_again(field, options, before, verb(before, options)).sizes
        np.testing.assert_allclose(sizes, expected, rtol=1e-12)


@pytest.mark.parametrize("name", VERBS)
def test_many_strokes_one_after_another_add_up(name: str) -> None:
    verb, options = VERBS[name]
    field = rough(49, 49, 1)
    result = verb(field, options)
    for seed, factor in enumerate((0.2, 5.0, 0.5, 3.0, 0.1)):
        before, field = field, touched(field, seed, factor)
        result = processed_again(field, options, before, result)
    np.testing.assert_allclose(result.sizes, verb(field, options).sizes, rtol=1e-12)


@pytest.mark.parametrize("name", VERBS)
def test_nothing_changed_is_nothing_done(name: str) -> None:
    verb, options = VERBS[name]
    field = rough(33, 33, 2)
    result = verb(field, options)
    assert np.array_equal(processed_again(field, options, field, result).sizes, result.sizes)


@pytest.mark.parametrize(("kind", "coefficient"), [(LIMIT, 0.5), (PRESERVE, 2.0)])
def test_a_small_change_reaches_a_part_only(kind: int, coefficient: float) -> None:
    background = BackgroundMesh.unit_square_grid(257, 257)
    before = SizeField(background, np.full(257 * 257, 0.02))
    near = np.hypot(*(background.points - 0.5).T) < 0.02
    field = before.with_sizes(np.where(near, 0.01, 0.02))
    tiles = reached_tiles(field, before, before, kind, coefficient, 1.0)
    assert 0 < tiles.sum() < 0.05 * tiles.size


@pytest.mark.parametrize("name", VERBS)
def test_without_a_grid_everything_is_done(name: str) -> None:
    verb, options = VERBS[name]
    grid = BackgroundMesh.unit_square_grid(17, 17)
    before = SizeField(BackgroundMesh(grid.points, grid.triangles), np.linspace(0.02, 0.2, 17 * 17))
    field = before.with_sizes(before.sizes[::-1].copy())
    sizes = processed_again(field, options, before, verb(before, options)).sizes
    assert np.array_equal(sizes, verb(field, options).sizes)
