"""Stand-ins for a study: a bent lattice, judged by arithmetic that needs no compiled kernel."""

from __future__ import annotations

import numpy as np

from sizeviz.conformity import MeshReport
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.scene.subject import Subject
from sizeviz.sizing import BackgroundMesh, SizeField


def lattice(n: int, bend: float = 0.0, seed: int = 0) -> QuadMesh:
    """An n x n lattice over the unit square, bent inwards; the border stays straight."""
    rng = np.random.default_rng(seed)
    s = np.linspace(0.0, 1.0, n + 1)
    x, y = np.meshgrid(s, s)
    push = bend * np.sin(np.pi * x) * np.sin(np.pi * y)
    x = x + push * np.sin(2 * np.pi * y) + 0.15 * (bend > 0) / n * rng.normal(size=x.shape) * (push != 0)
    y = y + push * np.sin(2 * np.pi * x)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = np.column_stack([corner, corner + 1, corner + n + 2, corner + n + 1])
    points = np.column_stack([x.ravel(), y.ravel()])
    none = np.full(len(points), -1)
    return QuadMesh(points, quads, none, np.zeros(len(points), dtype=bool))


def ring_sizes(points: np.ndarray, floor: float = 0.01) -> np.ndarray:
    away = np.abs(np.hypot(points[:, 0] - 0.5, points[:, 1] - 0.5) - 0.2575)
    return np.minimum(0.25, floor + away / 3.0)


def fake_report(mesh: QuadMesh, asked: np.ndarray) -> MeshReport:
    corner = mesh.points[mesh.quads]
    sides = np.linalg.norm(np.roll(corner, -1, axis=1) - corner, axis=2)
    sizes = {"mean-edge": sides.mean(axis=1), "sqrt-area": np.sqrt(mesh.areas), "max-edge": sides.max(axis=1)}
    quality = mesh.areas / (sides**2).mean(axis=1)
    return MeshReport(asked, sizes, quality, mesh.n_points, 0.04, 1.0, 0.9 * mesh.n_quads)


def grid_field(nodes: int = 65, floor: float = 0.01, label: str = "ring") -> SizeField:
    background = BackgroundMesh.unit_square_grid(nodes, nodes)
    return SizeField(background, ring_sizes(background.points, floor), label)


def subject(n: int = 30, bend: float = 0.05, scale: float = 1.0, title: str = "Size preserving") -> Subject:
    mesh = lattice(n, bend)
    centres = mesh.points[mesh.quads].mean(axis=1)
    asked = scale * (0.6 + np.hypot(*(centres - 0.5).T)) * 1.1 / n
    field_ = grid_field()
    return Subject(
        title=title,
        detail=f"{mesh.n_quads:,} elements",
        mesh=mesh,
        report=fake_report(mesh, asked),
        prescribed=field_,
        target=field_.with_sizes(np.minimum(field_.sizes * 0.9, 0.1)),
        domain=Domain.unit_square(),
    )
