"""Gmsh behind our protocol: quadrilaterals alone, on the domain, of the sizes asked for, and ended when cancelled."""

from __future__ import annotations

import subprocess
import sys
import time

import numpy as np
import pytest

from sizeviz.errors import Cancelled, MeshingError, MissingDependencyError
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.meshing import gmsh as backend
from sizeviz.meshing.gmsh import GmshGenerator
from sizeviz.meshing.options import MeshOptions
from sizeviz.sizing import BackgroundMesh, Grid, SizeField

pytestmark = pytest.mark.gmsh

ROUTES = {"blossom": GmshGenerator(), "full-quad": GmshGenerator(algorithm=6, recombination=3)}


def field(low: float = 0.02, high: float = 0.1) -> SizeField:
    background = BackgroundMesh.unit_square_grid(65, 65)
    return SizeField(background, np.clip(np.abs(background.points[:, 0] - 0.4), low, high))


def edge_counts(mesh: QuadMesh) -> np.ndarray:
    edges = np.sort(np.stack([mesh.quads, np.roll(mesh.quads, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    return np.unique(edges, axis=0, return_counts=True)[1]


@pytest.mark.parametrize("route", ROUTES)
def test_covers_the_square_with_quadrilaterals(route: str) -> None:
    domain = Domain.unit_square()
    mesh = ROUTES[route].generate(domain, field(), MeshOptions(scale=1.0))
    assert mesh.n_quads > 100
    assert mesh.areas.min() > 0
    assert mesh.areas.sum() == pytest.approx(1.0, rel=1e-12)
    assert edge_counts(mesh).max() == 2
    assert mesh.fixed.sum() == 4
    on_edge = (mesh.points == 0).any(axis=1) | (mesh.points == 1).any(axis=1)
    assert np.array_equal(mesh.curve >= 0, on_edge)


def test_the_field_sets_the_sizes() -> None:
    """Twice the size, a quarter of the elements, about."""
    domain, generator = Domain.unit_square(), GmshGenerator()
    coarse = generator.generate(domain, field(0.04, 0.08), MeshOptions(scale=1.0)).n_quads
    fine = generator.generate(domain, field(0.04, 0.08), MeshOptions(scale=0.5)).n_quads
    assert 3.0 < fine / coarse < 5.0


def test_a_mesh_that_missed_the_field_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    # what Gmsh makes of a valley it does not see: a few elements as large as at the corners
    coarse = GmshGenerator().answer(Domain.unit_square(), field(0.3, 0.3), MeshOptions(scale=1.0))
    monkeypatch.setattr(GmshGenerator, "answer", lambda *_: coarse)
    with pytest.raises(MeshingError, match="passed the smallest sizes by"):
        GmshGenerator().generate(Domain.unit_square(), field(0.02, 0.1), MeshOptions(scale=1.0))


def test_a_grid_gives_the_sizes_of_its_view() -> None:
    domain, options = Domain.unit_square(), MeshOptions(scale=1.0)
    counts = [GmshGenerator(structured=structured).generate(domain, field(), options).n_quads for structured in (0, 1)]
    assert counts[1] == pytest.approx(counts[0], rel=0.03)


def test_a_grid_is_not_turned_or_mirrored() -> None:
    background = BackgroundMesh.regular(Grid(1.0, -2.0, 0.05, 0.1, 41, 31))
    x, y = background.points.T
    size = SizeField(background, 0.05 + 0.1 * (x - 1.0) + 0.02 * (y + 2.0))
    domain = Domain.rectangle(1.0, -2.0, 3.0, 1.0)
    mesh = GmshGenerator(structured=True).generate(domain, size, MeshOptions(scale=1.0))
    corners = mesh.points[mesh.quads]
    centre, edge = corners.mean(axis=1), np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean(axis=1)
    asked = 0.05 + 0.1 * (centre[:, 0] - 1.0) + 0.02 * (centre[:, 1] + 2.0)
    assert np.median(edge / asked) == pytest.approx(1.0, abs=0.15)
    assert np.corrcoef(edge, asked)[0, 1] > 0.95


def test_holes_curves_lines_and_points_are_kept() -> None:
    angle = 2 * np.pi * np.arange(120) / 120
    hole = np.column_stack([0.3 + 0.1 * np.cos(angle), 0.3 + 0.1 * np.sin(angle)])
    outer = np.array([[0, 0], [1, 0], [1, 1], [0.6, 1], [0.6, 0.8], [0, 0.8]])
    line, lone = np.array([[0.6, 0.2], [0.8, 0.6]]), np.array([[0.8, 0.85]])
    domain = Domain(outer, (hole,), lines=(line,), fixed_points=lone)
    mesh = GmshGenerator().generate(domain, field(0.03, 0.06), MeshOptions(scale=1.0))
    assert edge_counts(mesh).max() == 2
    # A chord of the hole's circle cuts off a little: the area agrees to the square of the size.
    assert mesh.areas.sum() == pytest.approx(domain.area, rel=5e-3)
    for corner in (*outer, *line, *lone):
        at = np.flatnonzero((mesh.points == corner).all(axis=1))
        assert len(at) == 1 and mesh.fixed[at[0]]
    on_hole = mesh.points[mesh.curve == 6]
    assert np.allclose(np.hypot(*(on_hole - 0.3).T), 0.1, rtol=2e-3)
    assert not mesh.fixed[mesh.curve == 6].any(), "a round hole has no corner"
    assert (mesh.curve == 7).sum() > 5, "nodes lie along the inner line"


def test_cancel_ends_the_other_process(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []

    class Recorded(subprocess.Popen):
        def __init__(self, *args: object, **kwargs: object) -> None:
            super().__init__(*args, **kwargs)
            started.append(self)

    class Stop:
        asked = 0.0

        def step(self, fraction: float, message: str = "") -> None:
            if started and time.monotonic() - born > 0.5:
                self.asked = time.monotonic()
                raise Cancelled

    monkeypatch.setattr(backend.subprocess, "Popen", Recorded)
    born, stop = time.monotonic(), Stop()
    with pytest.raises(Cancelled):
        GmshGenerator().generate(Domain.unit_square(), field(0.002, 0.004), MeshOptions(scale=1.0), stop)
    assert time.monotonic() - stop.asked < 0.2
    assert started[0].returncode == -9, "ended, not finished"


def test_a_mesh_too_large_is_not_begun() -> None:
    with pytest.raises(MeshingError, match="asks for about"):
        GmshGenerator().generate(Domain.unit_square(), field(), MeshOptions(max_elements=100))


def test_without_gmsh_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backend, "find_spec", lambda name: None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'sizeviz\[gmsh\]'"):
        GmshGenerator().generate(Domain.unit_square(), field(), MeshOptions())


def test_the_worker_needs_nothing_of_the_package() -> None:
    """It must start fast, and must not take the backend's module for the gmsh package."""
    code = f"import runpy, sys; runpy.run_path({str(backend.WORKER)!r}); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True)
    assert not [name for name in done.stdout.split() if name.startswith(("sizeviz.", "numba"))]
