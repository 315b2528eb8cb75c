"""Parts of a mesh made anew by themselves: they fit, and all else stays what it is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sizeviz.conformity import judged, shape_quality
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.improvement import GuaranteeOptions, GuaranteeReport, SmoothOptions, improved
from sizeviz.meshing import MeshOptions, generated
from sizeviz.meshing.checks import edges_of
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sizing.lowered import lowered
from sizeviz.study import promise as module
from sizeviz.study.patches import patches_around, repatched
from sizeviz.study.promise import Promise, promised

DOMAIN = Domain.unit_square()
NOTHING = GuaranteeReport(0, np.empty(0, dtype=np.int64), np.empty(0), ())


def waves(low: float) -> SizeField:
    background = BackgroundMesh.unit_square_grid(65, 65)
    x, y = background.points.T
    return SizeField(background, low * (1.4 + 0.4 * np.sin(5 * x) * np.cos(4 * y)), "waves")


def made(field: SizeField) -> QuadMesh:
    return improved(generated(DOMAIN, field, MeshOptions(scale=0.9)), DOMAIN, field)


def at(mesh: QuadMesh, *places: tuple[float, float]) -> np.ndarray:
    """Return the elements nearest to some places."""
    centre = mesh.points[mesh.quads].mean(axis=1)
    return np.array([np.hypot(*(centre - place).T).argmin() for place in places], dtype=np.int64)


def as_set(mesh: QuadMesh, rows: np.ndarray | slice) -> set[bytes]:
    """Return elements by the places of their corners, in order from the lowest."""
    corner = mesh.points[mesh.quads[rows]]
    return {np.roll(c, -int(np.lexsort(c.T)[0]), axis=0).tobytes() for c in corner}


def whatever(*_: object) -> bool:
    return True


def anew(
    mesh: QuadMesh,
    field: SizeField,
    finer: SizeField,
    elements: np.ndarray,
    better: Callable[..., bool] = whatever,
    threads: int = 1,
) -> tuple[QuadMesh, GuaranteeReport]:
    patches = patches_around(mesh, elements, 3)
    options = GuaranteeOptions(smooth=SmoothOptions(threads=threads))
    meshing = MeshOptions(scale=1.0, threads=threads)
    return repatched(mesh, NOTHING, patches, DOMAIN, field, finer, meshing, options, better)


def test_patches_share_no_node_and_surround_what_is_asked_for() -> None:
    mesh = made(waves(0.015))
    elements = at(mesh, (0.2, 0.2), (0.25, 0.2), (0.8, 0.5), (0.99, 0.99))
    patches = patches_around(mesh, elements, 3)
    assert len(patches) == 3
    nodes = np.concatenate([patch.nodes for patch in patches])
    assert len(np.unique(nodes)) == len(nodes)
    assert np.isin(elements, np.concatenate([patch.rows[patch.core] for patch in patches])).all()
    for patch in patches:
        outside = np.delete(np.arange(mesh.n_quads), patch.rows)
        np.testing.assert_array_equal(patch.rim, np.isin(patch.nodes, mesh.quads[outside]))
        edges, count = edges_of(mesh.quads[patch.rows])
        assert np.bincount(edges[count == 1].ravel()).max() == 2


def test_all_but_the_patches_stays_bit_for_bit_and_all_fits() -> None:
    field = waves(0.015)
    mesh = made(field)
    places = (0.2, 0.2), (0.8, 0.5), (0.99, 0.99)
    spots = np.array(places)
    finer = lowered(field, spots, np.full(3, 0.03), np.full(3, 0.5), np.full(3, 0.001))
    after, report = anew(mesh, field, finer, at(mesh, *places))
    inside = np.concatenate([patch.rows for patch in patches_around(mesh, at(mesh, *places), 3)])
    outside = np.setdiff1d(np.arange(mesh.n_quads), inside)
    assert as_set(mesh, outside) < as_set(after, slice(None))
    assert after.areas.sum() == pytest.approx(1.0, abs=1e-12)
    assert after.n_quads > mesh.n_quads + 20
    _, count = edges_of(after.quads)
    assert count.max() == 2
    assert (count == 1).sum() == (edges_of(mesh.quads)[1] == 1).sum()
    assert np.bincount(after.quads.ravel(), minlength=after.n_points).all()
    assert shape_quality(after).min() > 0.5
    assert report.n_quads == after.n_quads
    bound = after.curve >= 0
    assert np.unique(after.points[bound], axis=0).shape == np.unique(mesh.points[mesh.curve >= 0], axis=0).shape
    assert after.fixed.sum() == mesh.fixed.sum()


def test_a_patch_that_is_no_better_leaves_the_mesh_what_it_is() -> None:
    field = waves(0.03)
    mesh = made(field)
    after, report = anew(mesh, field, field, at(mesh, (0.5, 0.5)), lambda *_: False)
    assert after is mesh and report is NOTHING


def test_the_same_for_any_number_of_threads() -> None:
    field = waves(0.02)
    mesh = made(field)
    elements = at(mesh, (0.3, 0.6), (0.02, 0.3))
    one, two = (anew(mesh, field, field, elements, threads=n)[0] for n in (1, 2))
    np.testing.assert_array_equal(one.points, two.points)
    np.testing.assert_array_equal(one.quads, two.quads)


def test_what_was_left_is_known_by_its_new_number() -> None:
    field = waves(0.015)
    mesh = made(field)
    near, far = at(mesh, (0.2, 0.2), (0.8, 0.8))
    left = np.sort([near, far])
    report = GuaranteeReport(mesh.n_quads, left, np.array([1.1, 1.1]), ("a reason",) * 2)
    patches = patches_around(mesh, np.array([near]), 3)
    after, found = repatched(
        mesh, report, patches, DOMAIN, field, field, MeshOptions(scale=0.9), GuaranteeOptions(), whatever
    )
    rows = [row for row, reason in zip(found.elements, found.reasons, strict=True) if reason == "a reason"]
    assert as_set(after, np.array(rows)) == as_set(mesh, np.array([far]))


def test_a_few_elements_that_are_left_do_not_cost_another_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    field = waves(0.015)
    mesh = made(field.with_sizes(0.8 * field.sizes))
    assert judged(mesh, field).correct_percent["max-edge"] == 100.0
    # a dent that no operation could mend, as far as the first repair is concerned
    low = field.with_sizes(np.where(np.hypot(*(field.background.points - 0.5).T) < 0.02, 0.6, 1.0) * field.sizes)
    ratio = judged(mesh, low).ratios["max-edge"]
    left = np.flatnonzero(ratio > 1.0)
    assert 0 < len(left) < 30
    first = Promise(field, mesh, mesh, GuaranteeReport(mesh.n_quads, left, ratio[left], ("left",) * len(left)))
    monkeypatch.setattr(module, "_repaired", lambda *_: first)
    monkeypatch.setattr(module, "generated", lambda *_: pytest.fail("the whole mesh was made again"))
    best = promised(DOMAIN, low, field, mesh)
    assert best.report.holds
    assert best.raw is mesh and best.tight is not field
    assert judged(best.mesh, low).correct_percent["max-edge"] == 100.0
    assert best.mesh.n_quads < 1.1 * mesh.n_quads


def test_a_poor_element_is_made_anew_in_its_patch(monkeypatch: pytest.MonkeyPatch) -> None:
    field = waves(0.015)
    mesh = made(field.with_sizes(0.8 * field.sizes))
    points = mesh.points.copy()
    row = mesh.quads[at(mesh, (0.5, 0.5))[0]]
    points[row[0]] += 0.45 * (points[row[2]] - points[row[0]])  # nearly a triangle
    dented = mesh.with_points(points)
    assert 0 < len(module._below(module.POOR, dented)) < 5
    held = GuaranteeReport(mesh.n_quads, np.empty(0, dtype=np.int64), np.empty(0), ())
    first = Promise(field, dented, dented, held)
    monkeypatch.setattr(module, "_repaired", lambda *_: first)
    monkeypatch.setattr(module, "generated", lambda *_: pytest.fail("the whole mesh was made again"))
    best = promised(DOMAIN, field, field, dented)
    assert best.report.holds
    assert shape_quality(best.mesh).min() > module.POOR
    far = np.hypot(*(dented.points[dented.quads].mean(axis=1) - 0.5).T) > 0.3
    assert as_set(dented, far) < as_set(best.mesh, slice(None))


def test_where_many_elements_are_poor_a_mesh_may_cost_more(monkeypatch: pytest.MonkeyPatch) -> None:
    field = waves(0.03)
    mesh = made(field)
    bad = np.arange(0, mesh.n_quads, 10)
    held = GuaranteeReport(mesh.n_quads, np.empty(0, dtype=np.int64), np.empty(0), ())
    dearer = made(field.with_sizes(0.92 * field.sizes))
    assert module.DEARER < dearer.n_quads / mesh.n_quads < module.MUCH_DEARER
    monkeypatch.setattr(module, "generated", lambda *_: dearer)
    monkeypatch.setattr(module, "_repaired", lambda _d, _r, t, raw, *_: Promise(t, raw, raw, held))
    for poor, wanted in ((bad, dearer), (bad[:1], mesh)):
        monkeypatch.setattr(module, "_patched", lambda *_: None)
        monkeypatch.setattr(module, "_below", lambda _, m, poor=poor: poor if m is mesh else poor[:0])
        assert promised(DOMAIN, field, field, mesh).mesh is wanted
