"""Domains at the edge of what makes sense: each gives a valid mesh, or one clear error."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sizeviz.conformity import judged
from sizeviz.errors import InputError
from sizeviz.files import read_domain
from sizeviz.geometry import Domain
from sizeviz.improvement import improved
from sizeviz.meshing import MeshOptions, generated
from sizeviz.sizing import BackgroundMesh, Grid, PreserveOptions, SizeField, preserved
from sizeviz.sources.shapes import circle, shape

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
FEW = settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)


def growing(domain: Domain, smallest: float = 0.04) -> SizeField:
    """Return sizes that grow from a place in the domain's box; ``smallest`` is over its width."""
    x0, y0, x1, y1 = domain.bounds
    grid = Grid(x0, y0, (x1 - x0) / 16, (y1 - y0) / 16, 17, 17)
    background = BackgroundMesh.regular(grid)
    width = max(x1 - x0, y1 - y0)
    away = np.hypot(*((background.points - [x0, y0]) / width - 0.3).T)
    return preserved(SizeField(background, width * (smallest + 0.1 * away)), PreserveOptions())


def assert_meshed(domain: Domain, smallest: float = 0.04) -> None:
    """Mesh and smooth, and check that nothing is inverted and the area is that inside the boundary nodes."""
    size = growing(domain, smallest)
    mesh = improved(generated(domain, size, MeshOptions(scale=0.9)), domain, size)  # verified against its outline
    report = judged(mesh, size)
    assert report.n_inverted == 0
    sampled = 0.02 if any(len(curve.points) > 2 for curve in domain.curves) else 1e-9
    assert float(mesh.areas.sum()) == pytest.approx(domain.area, rel=sampled)


def moved(domain: Domain, extent: float, shift: float) -> Domain:
    holes = tuple(extent * hole + shift for hole in domain.holes)
    return Domain(extent * domain.outer + shift, holes, domain.corners)


@FEW
@given(name=st.sampled_from(["square", "L", "plate", "gear"]), extent=st.integers(-9, 9), shift=st.integers(-3, 6))
def test_of_any_extent_and_far_from_the_origin(name: str, extent: int, shift: int) -> None:
    assert_meshed(moved(shape(name), 10.0**extent, 10.0 ** (extent + shift)))


@FEW
@given(gap=st.integers(-10, -1), across=st.booleans())
def test_with_a_slit(gap: int, across: bool) -> None:
    slit = np.array([[0.3, 0.5], [0.7, 0.5], [0.7, 0.5 + 10.0**gap], [0.3, 0.5 + 10.0**gap]])
    assert_meshed(Domain(SQUARE, (slit[:, ::-1] if across else slit,)))


@FEW
@given(gap=st.floats(3e-3, 0.1), radius=st.floats(0.1, 0.35))
def test_with_circles_that_nearly_touch(gap: float, radius: float) -> None:
    assert_meshed(Domain(circle(0.5, 0.5, 0.5), (circle(1.0 - gap - radius, 0.5, radius),)))


@FEW
@given(angle=st.floats(5.0, 60.0), outward=st.booleans())
def test_with_a_sharp_corner(angle: float, outward: bool) -> None:
    t = np.deg2rad(angle)
    if outward:
        assert_meshed(Domain(np.array([[0, 0], [1, 0], [np.cos(t), np.sin(t)]])))
        return
    rise = 0.3 * np.tan(min(t, 0.8))
    assert_meshed(Domain(np.array([[0, 0], [1, 0], [1, 0.5], [0.7, 0.5], [1, 0.5 + rise], [1, 1], [0, 1]])))


@pytest.mark.parametrize("angle", [12.35, 13.65, 14.2])
def test_a_flat_element_beside_a_sharp_corner_goes_before_it_shrinks(angle: float) -> None:
    # one element of a flat boundary node drew its neighbours in until no operation could mend it
    t = np.deg2rad(angle)
    assert_meshed(Domain(np.array([[0, 0], [1, 0], [np.cos(t), np.sin(t)]])))


def test_with_holes_that_touch_at_a_corner() -> None:
    hole = np.array([[0.2, 0.2], [0.5, 0.2], [0.5, 0.5], [0.2, 0.5]])
    assert_meshed(Domain(SQUARE, (hole, hole + 0.3)))


def test_with_vertices_listed_again_and_again() -> None:
    assert_meshed(Domain(np.repeat(SQUARE, 3, axis=0)))


def test_a_coast_of_many_vertices_from_geojson(tmp_path: Path) -> None:
    coast = shape("coastline")
    rings = [np.vstack([loop, loop[:1]]).tolist() for loop in coast.loops]
    path = tmp_path / "coast.geojson"
    path.write_text(json.dumps({"type": "Polygon", "coordinates": rings}), encoding="utf-8")
    assert_meshed(read_domain(path))


def overlapping() -> Domain:
    hole = np.array([[0.2, 0.2], [0.55, 0.2], [0.55, 0.55], [0.2, 0.55]])
    return Domain(SQUARE, (hole, hole + 0.3))


NONSENSE: dict[str, tuple[Domain, str]] = {
    "bow tie": (Domain(np.array([[0, 0], [1, 1], [1, 0], [0, 0.9]])), "outline crosses or touches itself near"),
    "overlapping holes": (overlapping(), "loops cross or touch each other"),
    "line outside": (Domain(SQUARE, lines=(np.array([[0.5, 0.5], [1.5, 0.5]]),)), "inner line 0 leaves the domain"),
    "line along": (Domain(SQUARE, lines=(np.array([[0.2, 0.0], [0.8, 0.0]]),)), "inner line 0 runs along the outline"),
    "point outside": (Domain(SQUARE, fixed_points=np.array([[1.5, 0.5]])), "fixed point 0 at .* lies outside"),
}


@pytest.mark.parametrize("name", NONSENSE)
def test_a_domain_that_makes_no_sense_is_refused_with_the_reason(name: str) -> None:
    domain, words = NONSENSE[name]
    with pytest.raises(InputError, match=words):
        generated(domain, growing(Domain(SQUARE)))


@pytest.mark.parametrize("smallest", [0.05, 0.12])
def test_circles_closer_than_chords_can_follow_get_shorter_ones(smallest: float) -> None:
    domain = Domain(circle(0.5, 0.5, 0.5), (circle(0.7 - 1e-7, 0.5, 0.3),))
    mesh = generated(domain, growing(domain, smallest))
    assert float(mesh.areas.sum()) == pytest.approx(domain.area, rel=0.05)


def test_circles_that_cross_are_refused() -> None:
    domain = Domain(circle(0.5, 0.5, 0.5), (circle(0.75, 0.5, 0.3),))
    with pytest.raises(InputError, match="cross or touch each other"):
        generated(domain, growing(domain))


@pytest.mark.parametrize(
    ("outer", "words"),
    [(1e-100 * SQUARE, "1e-100 wide; scale it"), (1e100 * SQUARE, "1e\\+100 wide"), (SQUARE + 1e15, "move it nearer")],
    ids=["tiny", "huge", "far away"],
)
def test_a_domain_that_numbers_cannot_hold_is_refused(outer: NDArray[np.float64], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Domain(outer)
