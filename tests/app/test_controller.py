from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from app.fakes import fake_source

from sizeviz.errors import MeshingError
from sizeviz.sources.painting import Brush


def open_ring(qtbot, controller, name: str = "ring") -> None:
    with qtbot.waitSignal(controller.settled, timeout=10_000):
        controller.open_source(name)


def with_alpha(alpha: float):
    return lambda options: replace(options, preserve=replace(options.preserve, alpha=alpha))


def stroke(controller, path, brush=None) -> None:
    brush = brush or Brush(radius=0.1, value=0.005)
    controller.painting.begin(brush, "freehand", *path[0])
    for point in path[1:]:
        controller.painting.extend(*point)
    controller.painting.end()


def test_opening_runs_both_methods_and_says_when_all_is_there(qtbot, controller, engine) -> None:
    open_ring(qtbot, controller)
    assert engine.calls == ["load ring", "run gradient-limiting", "run size-preserving"]
    assert set(controller.study.runs) == {"gradient-limiting", "size-preserving"}
    assert controller.missing() == () and not controller.displayed("size-preserving").stale


def test_a_change_runs_only_what_it_made_stale(qtbot, controller, engine) -> None:
    open_ring(qtbot, controller)
    engine.calls.clear()
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.change(with_alpha(3.0), "α = 3", "preserve.alpha")
    assert engine.calls == ["run size-preserving"]


def test_the_last_good_result_stays_and_is_called_stale_until_the_next(qtbot, controller, engine) -> None:
    open_ring(qtbot, controller)
    before = controller.displayed("size-preserving").subject
    engine.seconds = 0.3
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.change(with_alpha(3.0), "α = 3")
        shown = controller.displayed("size-preserving")
        assert shown.stale and shown.subject.mesh is before.mesh and shown.subject.report is before.report
    assert controller.displayed("size-preserving").subject.mesh is not before.mesh


def test_a_slow_study_waits_for_apply(qtbot, controller, engine, monkeypatch) -> None:
    open_ring(qtbot, controller)
    monkeypatch.setattr("sizeviz.app.controller.AUTO_SECONDS", -1.0)
    engine.calls.clear()
    controller.change(with_alpha(3.0), "α = 3")
    qtbot.wait(80)
    assert engine.calls == [] and controller.missing() == ("size-preserving",)
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.apply()
    assert engine.calls == ["run size-preserving"]


def test_a_stroke_that_asks_for_many_more_elements_waits_for_apply(qtbot, controller, engine, monkeypatch) -> None:
    engine.seconds = 0.05
    open_ring(qtbot, controller)
    monkeypatch.setattr("sizeviz.app.controller.AUTO_SECONDS", 1.0)
    engine.calls.clear()
    stroke(controller, [(0.3, 0.5), (0.7, 0.5)], Brush(radius=0.1, value=0.0005))
    qtbot.wait(80)
    assert not any(call.startswith("run") for call in engine.calls) and controller.missing()
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.undo()
        stroke(controller, [(0.3, 0.5), (0.7, 0.5)], Brush(radius=0.02, value=0.015))
    assert any(call.startswith("run") for call in engine.calls)


def test_the_first_stroke_on_a_blank_canvas_is_meshed_at_once(qtbot, controller, engine, monkeypatch) -> None:
    engine.seconds = 0.05
    monkeypatch.setattr("sizeviz.app.controller.AUTO_SECONDS", 0.5)
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.open_canvas(65, 0.06)
    with qtbot.waitSignal(controller.settled, timeout=5000):
        stroke(controller, [(0.2, 0.7), (0.8, 0.8)], Brush(radius=0.035, value=0.004))  # 20 times as many: still few


def test_undo_brings_back_results_without_running_again(qtbot, controller, engine) -> None:
    open_ring(qtbot, controller)
    first = controller.study
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.change(with_alpha(3.0), "α = 3")
    second = controller.study
    engine.calls.clear()
    controller.undo()
    assert controller.study is first and controller.missing() == ()
    controller.redo()
    assert controller.study is second and controller.missing() == ()
    assert engine.calls == []


def test_a_dragged_slider_is_one_step_of_undo(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    for alpha in (2.1, 2.5, 2.9):
        controller.change(with_alpha(alpha), f"α = {alpha}", "preserve.alpha")
    assert controller.store.stack.count() == 1
    controller.undo()
    assert controller.study.options.preserve.alpha == 2.0
    controller.redo()
    assert controller.study.options.preserve.alpha == 2.9


def test_different_controls_are_steps_of_their_own(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    controller.change(with_alpha(2.5), "α", "preserve.alpha")
    controller.change(lambda o: replace(o, mesh=replace(o.mesh, seed=3)), "seed", "mesh.seed")
    assert controller.store.stack.count() == 2


def test_an_impossible_value_is_a_notice_and_changes_nothing(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    before = controller.study
    with qtbot.waitSignal(controller.noticed) as caught:
        controller.change(with_alpha(-1.0), "α = -1")
    assert "alpha is -1" in caught.args[0].text and controller.study is before


def test_a_failed_run_says_why_and_leaves_the_rest_working(qtbot, controller, engine) -> None:
    open_ring(qtbot, controller)
    engine.fail = MeshingError("no mesh near (0.3, 0.4); ask for smaller elements")
    with qtbot.waitSignal(controller.noticed, timeout=5000) as caught:
        controller.change(with_alpha(3.0), "α = 3")
    assert caught.args[0].text.startswith("no mesh near") and "Traceback" in caught.args[0].details
    assert controller.displayed("size-preserving").stale
    engine.fail = None
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.apply()


def test_a_source_that_cannot_be_read_leaves_the_study_alone(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    before = controller.study
    with qtbot.waitSignal(controller.noticed, timeout=5000) as caught:
        controller.open_source("nan.npy")
    assert "NaN" in caught.args[0].text and controller.study is before


def test_a_result_for_an_older_study_is_not_applied(qtbot, controller, engine) -> None:
    open_ring(qtbot, controller)
    engine.seconds = 0.2
    with qtbot.waitSignal(controller.settled, timeout=8000):
        controller.change(with_alpha(3.0), "α = 3")
        qtbot.wait(60)
        controller.change(with_alpha(4.0), "α = 4")
    assert controller.study.options.preserve.alpha == 4.0
    assert all(run.is_complete for run in controller.study.runs.values())


def test_cancel_keeps_what_was_there_and_is_quick(qtbot, controller, engine) -> None:
    open_ring(qtbot, controller)
    engine.seconds = 20.0
    controller.change(with_alpha(3.0), "α = 3")
    qtbot.wait(60)
    with qtbot.waitSignal(controller.jobs.idle, timeout=200):
        controller.cancel()
    assert controller.displayed("size-preserving").stale


def test_progress_runs_once_from_nought_to_one_over_all_methods(qtbot, controller, engine) -> None:
    engine.seconds = 0.4
    seen = []
    controller.progressed.connect(lambda fraction, words, left: seen.append(fraction))
    open_ring(qtbot, controller)
    assert len(seen) > 6 and seen == sorted(seen) and max(seen) > 0.7


def test_a_stroke_is_one_step_and_reaches_only_the_nodes_under_it(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    before = controller.study.source.field
    with qtbot.waitSignal(controller.settled, timeout=5000):
        stroke(controller, [(0.2, 0.2), (0.4, 0.2), (0.5, 0.3)])
    after = controller.study.source.field
    changed = np.flatnonzero(after.sizes != before.sizes)
    assert 0 < len(changed) < len(before.sizes) // 4 and controller.store.stack.count() == 1
    assert controller.study.source.reference is after  # R is judged against what was painted
    controller.undo()
    assert controller.study.source.field is before


def test_while_a_stroke_is_drawn_field_and_targets_follow(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    controller.painting.begin(Brush(radius=0.2, value=0.001), "freehand", 0.5, 0.5)
    shown = controller.displayed("size-preserving")
    assert shown.subject.prescribed.sizes.min() == 0.001 and shown.stale
    qtbot.waitUntil(lambda: bool(controller.painting.preview and controller.painting.preview.targets), timeout=3000)
    assert controller.displayed("size-preserving").subject.target.sizes.min() == pytest.approx(0.0007)
    assert controller.displayed("gradient-limiting").subject.target.sizes.min() == pytest.approx(0.00095)
    controller.painting.abort()
    assert controller.displayed("size-preserving").subject.prescribed.sizes.min() > 0.001
    assert controller.store.stack.count() == 0 and not controller.displayed("size-preserving").stale


def test_where_no_run_follows_a_stroke_its_processed_fields_do(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    controller.automatic = False
    stroke(controller, [(0.5, 0.5)], Brush(radius=0.2, value=0.001))
    assert controller.missing()
    qtbot.waitUntil(lambda: not controller.displayed("size-preserving").is_stale("target"), timeout=3000)
    shown = controller.displayed("size-preserving")
    assert shown.subject.target.sizes.min() == pytest.approx(0.0007) and shown.is_stale("ratio")
    assert controller.displayed("gradient-limiting").subject.target.sizes.min() == pytest.approx(0.00095)


def test_a_processed_field_that_is_older_than_the_study_is_called_stale(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    controller.automatic = False
    controller.change(with_alpha(3.0), "α = 3")
    shown = controller.displayed("size-preserving")
    assert shown.is_stale("target") and shown.subject.target is not None and not shown.is_stale("prescribed")


def test_a_large_field_is_painted_without_the_processed_fields(qtbot, controller, engine, monkeypatch) -> None:
    monkeypatch.setattr("sizeviz.app.engine.LIVE_NODES", 100)
    open_ring(qtbot, controller)
    engine.calls.clear()
    controller.painting.begin(Brush(radius=0.2, value=0.001), "freehand", 0.5, 0.5)
    qtbot.wait(60)
    assert engine.calls == [] and controller.painting.preview is not None
    assert controller.displayed("size-preserving").is_stale("target")
    controller.painting.abort()
    assert not controller.displayed("size-preserving").is_stale("target")


def test_a_stroke_beside_the_field_is_no_step(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    stroke(controller, [(5.0, 5.0)])
    assert controller.store.stack.count() == 0 and controller.painting.preview is None


def test_erasing_after_two_strokes_brings_the_original_back(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    original = controller.study.source.field
    for y in (0.4, 0.6):
        stroke(controller, [(0.2, y), (0.8, y)])
    stroke(controller, [(0.5, 0.5)], Brush(mode="erase", radius=2.0, hardness=1.0))
    np.testing.assert_array_equal(controller.study.source.field.sizes, original.sizes)
    assert controller.study.source.provenance["strokes"] == 3


def test_the_canvas_is_blank_and_can_be_painted(qtbot, controller) -> None:
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.open_canvas(33, 0.05)
    assert np.ptp(controller.study.source.field.sizes) == 0.0
    stroke(controller, [(0.5, 0.5)])
    assert controller.study.source.field.sizes.min() == pytest.approx(0.005)


def test_results_of_another_source_are_never_shown(qtbot, controller, engine) -> None:
    open_ring(qtbot, controller)
    engine.seconds = 5.0
    controller.set_source(fake_source("other"), "Open other")
    shown = controller.displayed("size-preserving")
    assert shown.subject.mesh is None and not shown.stale
    controller.cancel()


def test_new_methods_wanted_are_run_and_those_there_are_kept(qtbot, controller, engine) -> None:
    open_ring(qtbot, controller)
    engine.calls.clear()
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.set_wanted(("none", "size-preserving"))
    assert engine.calls == ["run none"]


def test_a_method_asked_for_by_name_is_run_however_long_that_takes(qtbot, controller, engine, monkeypatch) -> None:
    open_ring(qtbot, controller)
    monkeypatch.setattr(controller, "is_cheap", lambda: False)
    engine.calls.clear()
    with qtbot.waitSignal(controller.settled, timeout=5000):
        controller.set_wanted(("gradient-limiting", "guaranteed"))
    assert engine.calls == ["run guaranteed"]
    controller.automatic = False
    controller.set_wanted(("gradient-limiting", "none"))
    assert controller.missing() == ("none",)


def test_old_steps_let_their_meshes_go(qtbot, controller) -> None:
    open_ring(qtbot, controller)
    for k in range(12):
        with qtbot.waitSignal(controller.settled, timeout=5000):
            controller.change(with_alpha(2.5 + 0.1 * k), f"step {k}")
    stack = controller.store.stack
    kept = [stack.command(k).before for k in range(stack.count()) if stack.command(k).before.runs]
    assert len(kept) <= 8
    while stack.canUndo():
        controller.undo()
    assert controller.study.options.preserve.alpha == 2.0
    qtbot.waitUntil(lambda: controller.missing() == (), timeout=5000)
