"""The panes with OpenGL: what is seen is what the scene says, and nothing grows."""

from __future__ import annotations

import resource
import threading

import numpy as np
import pytest
from app.driver import Person, blue_share, orange_share
from app.fakes import FakeEngine, fake_source
from qtpy.QtWidgets import QApplication, QWidget

from sizeviz.app.panes.canvas import GLCanvas
from sizeviz.app.settings import Settings
from sizeviz.app.window import MainWindow

pytestmark = pytest.mark.display


@pytest.fixture
def window(qtbot, tmp_path):
    window = MainWindow(FakeEngine(), Settings(str(tmp_path / "settings.ini")))
    qtbot.addWidget(window)
    window.resize(1300, 800)
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow, timeout=5000)
    with qtbot.waitSignal(window.controller.settled, timeout=10_000):
        window.controller.open_source("ring")
    Person(window).wait_settled()
    yield window
    window.close()


def test_the_middle_of_an_element_has_exactly_its_color(window) -> None:
    person, pane = Person(window), window.board.panes[1]
    picture = person.look_at(pane)
    ratio = window.devicePixelRatioF()
    mesh, colors = pane.subject.mesh, pane.spec.layers[0].colors
    hits = 0
    for element in range(0, mesh.n_quads, 29):
        x, y = mesh.points[mesh.quads[element]].mean(axis=0)
        spot = person.spot(pane, float(x), float(y))
        seen = picture[round(spot.y() * ratio), round(spot.x() * ratio)].astype(int)
        hits += int(np.abs(seen - colors[element].astype(int)).max() <= 2)
    assert hits == len(range(0, mesh.n_quads, 29))


def test_another_quantity_another_picture_and_back(window) -> None:
    person, pane = Person(window), window.board.panes[0]
    first = person.look_at(pane)
    assert orange_share(first) > 0.05 and blue_share(first) > 0.05
    window.actions_["color-target"].trigger()
    assert orange_share(person.look_at(pane)) < 0.01
    window.actions_["color-ratio"].trigger()
    assert np.abs(person.look_at(pane).astype(int) - first.astype(int)).mean() < 0.5


def test_painting_is_seen_while_the_button_is_down(window) -> None:
    person, (pane, other) = Person(window), window.board.visible_panes
    window.actions_["paint"].trigger()
    window.paint.value.set_value(0.001)
    window.paint.radius.set_value(0.2)
    before, target = person.look_at(pane), person.look_at(other)
    person.drag(pane, [(0.2, 0.2), (0.3, 0.2)], lift=False)
    person.wait(lambda: bool(window.controller.painting.preview.targets), 5.0)
    assert np.abs(person.look_at(pane).astype(int) - before.astype(int)).mean() > 2.0
    assert np.abs(person.look_at(other).astype(int) - target.astype(int)).mean() > 0.5
    window.controller.painting.abort()
    assert np.abs(person.look_at(pane).astype(int) - before.astype(int)).mean() < 2.0


def test_memory_stays_flat_over_many_studies(window) -> None:
    person = Person(window)

    def resident() -> float:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * resource.getpagesize() / 1e6

    for round_ in range(2):
        for k in range(30):
            window.controller.store.amend(window.controller.study.with_source(fake_source(f"s{round_}{k}")))
            window.controller.apply()
            person.wait(lambda: not window.controller.jobs.is_busy and not window.controller.missing(), 10.0)
            person.rest(5)
        if round_ == 0:
            before = resident()
    assert resident() - before < 40.0
    assert all(len(pane.surface.canvas.view.actors) <= 6 for pane in window.board.visible_panes)


def test_vtk_is_only_touched_in_the_windows_thread(window, monkeypatch) -> None:
    threads: set[int] = set()
    for name in ("show_scene", "look", "show_edges"):
        original = getattr(GLCanvas, name)

        def watched(self, *args, original=original):
            threads.add(threading.get_ident())
            return original(self, *args)

        monkeypatch.setattr(GLCanvas, name, watched)
    person = Person(window)
    window.controller.set_source(fake_source("again"), "Open again")
    person.wait_settled(10)
    window.actions_["paint"].trigger()
    person.drag(window.board.panes[0], [(0.2, 0.2), (0.4, 0.4)])
    person.wait_settled(10)
    assert threads == {threading.get_ident()}


def test_an_idle_window_draws_nothing(window, monkeypatch) -> None:
    person, drawn = Person(window), []
    person.rest(300)
    for pane in window.board.visible_panes:
        pane.surface.canvas.view.ren_win.AddObserver("StartEvent", lambda *_: drawn.append(1))
    person.rest(600)
    assert drawn == [] and not window.controller.jobs._timer.isActive()


def test_canvases_are_made_once(window) -> None:
    canvases, person = [pane.surface.canvas for pane in window.board.panes], Person(window)
    for count in (4, 2, 3, 2):
        window.actions_[f"panes-{count}"].trigger()
        person.wait_settled(10)
    assert [pane.surface.canvas for pane in window.board.panes[:2]] == canvases
    assert len(window.board.panes) == 4
    drawn = [pane.surface.canvas.view.renderer.GetActors().GetNumberOfItems() for pane in window.board.panes]
    assert min(drawn[:2]) > 0 and drawn[2:] == [0, 0]  # what nobody sees takes no memory
    assert all(isinstance(canvas.widget(), QWidget) for canvas in canvases)


def test_a_slow_scene_follows_the_hand_and_is_sharp_again_at_rest(window, monkeypatch) -> None:
    monkeypatch.setattr("sizeviz.app.panes.view.SLOW_SECONDS", 0.0)
    person, pane = Person(window), window.board.panes[0]
    view = pane.surface.canvas.view
    before, frames = person.look_at(pane), view.frames
    pane.surface.move_camera(pane.surface.camera.panned(40, 0, pane.surface.height()))
    window.grab()
    assert view.is_moving and view.frames == frames  # the old frame, moved
    ratio = window.devicePixelRatioF()
    shift, margin = round(40 * ratio), round(60 * ratio)
    person.wait(lambda: not view.is_moving)
    after = person.look_at(pane)
    assert view.frames > frames
    same = np.abs(after[:, margin:].astype(int) - before[:, margin - shift : -shift].astype(int)).mean()
    assert same < 4.0  # drawn anew it is where the moved frame was


def test_hovering_and_marks_draw_no_scene_anew(window) -> None:
    person, pane = Person(window), window.board.panes[0]
    person.rest(300)
    frames = [other.surface.canvas.view.frames for other in window.board.visible_panes]
    for x in (0.3, 0.4, 0.5):
        person.hover(pane, x, 0.5)
    window.controller.store.amend(window.controller.study.with_options(window.controller.study.options))
    window.board.refresh()
    person.rest(100)
    assert [other.surface.canvas.view.frames for other in window.board.visible_panes] == frames


def test_a_large_scene_is_drawn_in_pieces_and_looks_the_same(window, monkeypatch) -> None:
    person, pane = Person(window), window.board.panes[0]
    view = pane.surface.canvas.view
    whole, frames = person.look_at(pane), view.frames
    monkeypatch.setattr("sizeviz.scene.renderer.SLICE", 60)
    monkeypatch.setattr("sizeviz.app.panes.view.PIECE_SECONDS", 0.0)
    window.controller.set_source(fake_source("again"), "Open again")  # another mesh, in slices now
    person.wait_settled(10)
    assert len(view._pieces) > 8 and view.frames > frames
    in_pieces = person.look_at(pane)
    assert np.abs(in_pieces.astype(int) - whole.astype(int)).mean() < 0.5


def test_a_pane_made_ready_draws_at_once_what_it_is_shown_first(qtbot, tmp_path) -> None:
    window = MainWindow(FakeEngine(), Settings(str(tmp_path / "settings.ini")))
    qtbot.addWidget(window)
    window.resize(1300, 800)
    window.show()
    person = Person(window)
    window.preparation.start()
    person.wait(lambda: window.preparation.is_done, 60)
    assert all(pane.surface.canvas.is_ready for pane in window.board.visible_panes)
    window.controller.open_source("ring")
    person.wait_settled(20)
    assert orange_share(person.look_at(window.board.panes[0])) > 0.05
    window.close()


def test_the_old_frame_stays_until_the_new_one_is_whole(window, monkeypatch) -> None:
    person, pane = Person(window), window.board.panes[0]
    view = pane.surface.canvas.view
    monkeypatch.setattr("sizeviz.scene.renderer.SLICE", 60)
    monkeypatch.setattr("sizeviz.app.panes.view.PIECE_SECONDS", 0.0)
    window.controller.set_source(fake_source("again"), "Open again")  # another mesh, in slices now
    person.wait_settled(10)
    old, frames = person.look_at(pane).astype(int), view.frames
    window.actions_["color-quality"].trigger()
    seen_half_drawn, pictures = 0, []
    for _ in range(400):
        QApplication.processEvents()
        half_drawn = 0 < view._next_piece < len(view._pieces) and view._turn.is_busy
        if half_drawn and seen_half_drawn < 6:
            seen_half_drawn += 1
            pictures.append(person.picture_of(pane).astype(int))
        if view.frames > frames and not window.is_settling:
            break
    assert view.frames > frames and seen_half_drawn >= 3
    assert all(np.abs(picture - old).max() <= 2 for picture in pictures)
    assert np.abs(person.look_at(pane).astype(int) - old).mean() > 5.0


def test_no_pane_stays_blank_after_the_first_run_or_any_other(qtbot, tmp_path) -> None:
    """Opened before, during and after the preparation, small and large, again and again: every pane has its picture."""
    for n, wait in ((24, 0), (24, 60), (90, 0), (90, 150)):
        window = MainWindow(FakeEngine(n=n), Settings(str(tmp_path / f"{n}-{wait}.ini")))
        qtbot.addWidget(window)
        window.resize(1300, 800)
        window.show()
        person = Person(window)
        window.preparation.start()
        person.rest(wait)
        for name in ("ring", "again"):
            window.controller.open_source(name)
            person.rest(50)
            person.wait_settled(30)
            for pane in window.board.visible_panes:
                picture = person.look_at(pane)
                assert pane.surface.isVisible() and orange_share(picture) + blue_share(picture) > 0.2, (n, wait, name)
        window.close()


def test_a_large_mesh_is_handed_over_in_turns_and_the_latest_scene_wins(window, monkeypatch) -> None:
    person, pane = Person(window), window.board.panes[0]
    view = pane.surface.canvas.view
    first = person.look_at(pane).astype(int)
    specs = [pane.spec]
    window.controller.set_source(fake_source("again"), "Open again")
    person.wait_settled(10)
    specs.append(pane.spec)
    monkeypatch.setattr("sizeviz.scene.renderer.SLICE", 60)
    monkeypatch.setattr("sizeviz.app.panes.view.PIECE_SECONDS", 0.0)
    shown, edges = view._scene.spec, view._scene._edges
    view.show_scene(specs[0], edges)
    assert view.is_drawing and view._scene.spec is shown  # nothing of it is seen before all of it is there
    view.show_edges(not edges)
    QApplication.processEvents()
    assert view.is_drawing and view._scene.spec is shown
    assert view._scene._edges == edges
    view.show_scene(specs[1], edges)  # the first is not wanted any more
    view.show_scene(specs[0], not edges)
    view.show_edges(edges)
    person.wait(lambda: not view.is_drawing, 10)
    assert view._scene.spec is specs[0] and view._scene._edges == edges
    parts = sum(len(layer.parts) for layer in view._scene._shown.values())
    assert view.renderer.GetActors().GetNumberOfItems() == parts > 8  # of the scenes let go nothing stays
    assert np.abs(person.look_at(pane).astype(int) - first).mean() < 0.5


def test_a_large_mesh_is_never_black_while_the_window_is_resized(qtbot, tmp_path) -> None:
    window = MainWindow(FakeEngine(n=220), Settings(str(tmp_path / "settings.ini")))
    qtbot.addWidget(window)
    window.resize(1300, 800)
    window.show()
    window.controller.open_source("ring")
    person = Person(window)
    person.wait_settled(60)
    black = []
    for k in range(10):
        window.resize(1240 + 20 * (k % 4), 740 + 15 * (k % 5))
        person.rest(4 + 9 * k % 50)
        black += [float((person.picture_of(pane).max(axis=2) < 8).mean()) for pane in window.board.visible_panes]
    window.close()
    assert max(black) < 0.1
