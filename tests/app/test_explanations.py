"""The panel Explain and the ball over the panes: what is said, what is asked, and how it is followed."""

from __future__ import annotations

import re
import time

import numpy as np
import pytest
from app.driver import LEFT, Person
from app.fakes import fake_source
from qtpy.QtCore import Qt

from sizeviz.app.lessons.ball import MOST_MOMENTS, BallStory, headline, story_words
from sizeviz.app.lessons.explain import OF_QUANTITY, TOPICS, explained, steepest
from sizeviz.app.lessons.why import ball_story
from sizeviz.errors import Cancelled
from sizeviz.monitor import SILENT
from sizeviz.scene.view import QUANTITIES, ViewState
from sizeviz.sizing import BackgroundMesh, PreserveOptions, SizeField, preserved
from sizeviz.sizing.ball import ball_at


@pytest.fixture
def lessons(opened):
    opened.actions_["explain"].trigger()
    return opened.lessons.panes


def plain(words: str) -> str:
    return re.sub("<[^>]+>|&[a-z]+;", "", words)


def asked(qtbot, lessons, x=0.62, y=0.55):
    lessons.ask_at(x, y)
    qtbot.waitUntil(lambda: lessons.why.asked is not None, timeout=5000)
    return lessons.why.asked


# -- what is said ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("method", ["none", "gradient-limiting", "size-preserving", "guaranteed"])
def test_everything_a_pane_can_show_is_explained_with_its_numbers(opened, quantity, method):
    controller = opened.controller
    view = ViewState(method=method, color_by=quantity)
    told = explained(controller.study, controller.displayed(method).subject, view)
    assert told.topic == OF_QUANTITY[quantity] and told.title and len(plain(told.words)) > 40
    assert not re.search(r"nan|None|inf\b|\{|\}", plain(told.words).replace("{ h(y)", "").replace("r }", ""))


def test_the_pinned_elements_r_is_worked_out(opened):
    subject, view = opened.controller.displayed("gradient-limiting").subject, ViewState(method="gradient-limiting")
    told = explained(opened.controller.study, subject, view, pinned=277)
    report = subject.report
    rows = {symbol: number for symbol, _, number in told.rows}
    assert float(rows["R(e)"]) == pytest.approx(report.ratios["mean-edge"][277], abs=1e-3)
    size, least = report.sizes["mean-edge"][277], report.least[277]
    assert f"= {size:.4g} / (1 × {least:.4g})" in [words for _, words, _ in told.rows]


def test_a_guarantee_is_judged_by_what_it_promises(opened):
    subject = opened.controller.displayed("guaranteed").subject
    told = explained(opened.controller.study, subject, ViewState(method="guaranteed"))
    assert "longest edge" in told.words


def test_the_steepest_change_is_the_same_on_a_grid_and_on_its_triangles():
    field = fake_source().field
    points, triangles = field.background.points, field.background.triangles
    loose = SizeField(BackgroundMesh(points, triangles), field.sizes, "loose")
    slopes = [abs(np.diff(field.sizes.reshape(65, 65), axis=axis)).max() * 64 for axis in (0, 1)]
    assert steepest(field) == pytest.approx(max(slopes)) and steepest(loose) >= steepest(field) * (1 - 1e-12)


# -- the panel follows the panes ---------------------------------------------------------------------------------------


def test_the_panel_follows_what_the_active_pane_shows(qtbot, opened, lessons):
    assert lessons.panel.explanation.topic == "ratio"
    opened.actions_["color-target"].trigger()
    assert lessons.panel.explanation.title == "Gradient limiting"
    opened.board.set_active(opened.board.panes[1])
    assert lessons.panel.explanation.topic == "ratio" and "Size preserving" in lessons.panel.explanation.words
    for topic in TOPICS:
        qtbot.mouseClick(lessons.panel.topics[topic], LEFT)
        assert lessons.panel.explanation.topic == topic
    opened.actions_["color-quality"].trigger()
    assert lessons.panel.explanation.topic == "quality"


def test_pinning_an_element_explains_it(opened, lessons):
    opened.actions_["worst-ratio"].trigger()
    assert f"Element {opened.inspector.pin[1]}, which you have pinned" in lessons.panel.explanation.words


# -- the ball ----------------------------------------------------------------------------------------------------------


def test_a_place_is_asked_about_by_the_menu_of_a_right_click(qtbot, opened, lessons):
    person = Person(opened)
    pane = opened.board.panes[0]
    before = pane.view, pane.surface.camera
    qtbot.mouseClick(pane.surface.glass, Qt.MouseButton.RightButton, pos=person.spot(pane, 0.62, 0.55))
    entry = lessons.menu.actions()[0]
    assert entry.text() == "Why is h* this here?"
    entry.trigger()
    lessons.menu.close()
    qtbot.waitUntil(lambda: lessons.why.asked is not None, timeout=5000)
    assert pane.view.color_by == "prescribed" and opened.board.panes[1].view.color_by == "target"
    assert pane.surface.glass.overlay is not None and lessons.panel.transport.isVisible()
    np.testing.assert_allclose(lessons.why.asked.story.trace.centre, (0.62, 0.55), atol=0.5 / 64 + 1e-9)
    person.key(Qt.Key.Key_Escape)
    assert pane.surface.glass.overlay is None and (pane.view, pane.surface.camera) == before


def test_the_ball_is_stepped_through_and_asked_for_elsewhere_by_a_click(qtbot, opened, lessons):
    story = asked(qtbot, lessons).story
    panel = lessons.panel
    qtbot.mouseClick(panel.transport.forward, LEFT)
    assert lessons.why.asked.step == 1
    panel.transport.slider.setValue(panel.transport.slider.maximum())
    assert "The ball stops" in panel.ball.words.text() and f"{story.trace.size:.4g}" in panel.ball.words.text()
    pane = opened.board.panes[1]
    x, y = pane.surface.camera.x + 0.05, pane.surface.camera.y
    Person(opened).click(pane, x, y)
    qtbot.waitUntil(lambda: lessons.why.asked is not None and lessons.why.asked.story is not story, timeout=5000)
    assert lessons.why.asked.story.trace.centre[0] > story.trace.centre[0] and lessons.why.asked.step == 0
    qtbot.mouseClick(panel.done, LEFT)
    assert not lessons.why.is_open and panel.chips.isVisible()


def test_the_keyboard_asks_at_the_pinned_element(qtbot, opened, lessons):
    opened.actions_["worst-ratio"].trigger()
    mesh, element = opened.board.active.subject.mesh, opened.inspector.pin[1]
    Person(opened).key(Qt.Key.Key_H)
    qtbot.waitUntil(lambda: lessons.why.asked is not None, timeout=5000)
    centre = mesh.points[mesh.quads[element]].mean(axis=0)
    np.testing.assert_allclose(lessons.why.asked.story.trace.centre, centre, atol=1 / 64)


def test_without_a_place_the_next_click_says_where(qtbot, opened, lessons):
    qtbot.mouseClick(lessons.panel.ask, LEFT)
    assert not lessons.why.is_open
    Person(opened).click(opened.board.panes[0], 0.3, 0.4)
    qtbot.waitUntil(lambda: lessons.why.asked is not None, timeout=5000)


def test_turning_alpha_asks_again_after_the_run(qtbot, opened, lessons):
    story = asked(qtbot, lessons).story
    opened.size_panel.alpha.changed.emit(1.0)
    qtbot.waitUntil(lambda: lessons.why.asked is not None and lessons.why.asked.story is not story, timeout=10_000)
    assert lessons.why.asked.story.options.alpha == 1.0 and not opened.controller.missing()


def test_a_run_under_way_is_not_broken_off_by_a_question(qtbot, opened, lessons, engine):
    engine.seconds = 0.6
    opened.controller.automatic = True
    opened.size_panel.alpha.changed.emit(3.0)
    qtbot.waitUntil(lambda: opened.controller.is_running, timeout=3000)
    with qtbot.waitSignal(opened.controller.settled, timeout=10_000):
        lessons.ask_at(0.5, 0.5)
    qtbot.waitUntil(lambda: lessons.why.asked is not None, timeout=5000)


def test_another_source_puts_the_ball_away(qtbot, opened, lessons):
    asked(qtbot, lessons)
    with qtbot.waitSignal(opened.controller.settled, timeout=10_000):
        opened.controller.open_source("mri")
    assert lessons.why.asked is None and not lessons.why.is_open
    camera = opened.board.panes[0].surface.camera
    assert (camera.x, camera.y) == (0.5, 0.5) and camera.height > 1.0  # the new domain as a whole
    assert opened.board.panes[0].view.color_by == "ratio"


def test_an_audience_sees_panes_and_their_explanation_only(opened, lessons):
    opened.actions_["presenter"].setChecked(True)
    assert not opened.pipeline_dock.isVisible() and lessons.panel.isVisible()
    opened.actions_["presenter"].setChecked(False)
    assert opened.pipeline_dock.isVisible()


def test_the_story_in_the_plane_ends_where_the_algorithm_does():
    field = fake_source().field
    options = PreserveOptions(alpha=2.0, distance="edges")
    story = ball_story(field, (0.62, 0.55), options, SILENT)
    node = int(((field.background.points - story.trace.centre) ** 2).sum(axis=1).argmin())
    made = preserved(field, options).sizes[node]
    last = story.at(story.count - 1)
    assert last.candidate == pytest.approx(made, rel=1e-12) and headline(story, last).startswith("The ball stops")


def test_of_a_long_story_every_change_near_the_end_and_some_between_are_told():
    background = BackgroundMesh.unit_square_grid(81, 81)
    sizes = 0.02 + np.hypot(*(background.points - (0.2, 0.2)).T)
    field = SizeField(background, sizes, "cone")
    story = ball_story(field, (0.6, 0.6), PreserveOptions(alpha=1.0), SILENT)
    assert isinstance(story, BallStory) and len(story.trace.steps) > MOST_MOMENTS >= story.count - 4
    assert story.at(0).is_start and story.at(story.count - 1).radius == story.trace.radius
    assert "nodes later" in story_words(story, story.at(story.count // 2))


def test_a_ball_can_be_cancelled_within_moments():
    background = BackgroundMesh.unit_square_grid(200, 200)
    field = SizeField(background, np.full(40_000, 0.5), "flat")

    class Impatient:
        def step(self, fraction: float, message: str = "") -> None:
            if fraction > 0.1:
                raise Cancelled

    began = time.perf_counter()
    with pytest.raises(Cancelled):
        ball_at(field, 20_100, PreserveOptions(), Impatient())
    assert time.perf_counter() - began < 10
