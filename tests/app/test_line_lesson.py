"""The lesson on a line: what follows from what is chosen, and the page as a person uses it."""

from __future__ import annotations

import re

import numpy as np
import pytest
from app.driver import LEFT
from hypothesis import given, settings
from hypothesis import strategies as st
from qtpy.QtCore import QPoint, Qt

from sizeviz.app.lessons.ball import story_words, term_rows
from sizeviz.app.lessons.chapters import BALL, TITLES, chapter_of, verdict_rows
from sizeviz.app.lessons.line import LineLesson, resolved

CLOSE = {"rtol": 1e-12}


def test_the_papers_field_gives_the_papers_figures():
    shown = resolved(LineLesson())
    s = np.abs(shown.x - 0.75)
    np.testing.assert_allclose(shown.curves["gradient-limiting"], np.minimum(0.5, 0.1 + s), **CLOSE)
    closed = np.minimum(0.5, np.maximum(0.1, (3 * s + 0.1) / 4))
    np.testing.assert_allclose(shown.curves["size-preserving"], closed, **CLOSE)
    fronts = shown.fronts
    assert {name: len(front.ratios) for name, front in fronts.items()} == {
        "none": 2, "gradient-limiting": 3, "size-preserving": 5
    }  # fmt: skip
    assert fronts["none"].ratios.max() == pytest.approx(5.0)
    assert fronts["gradient-limiting"].ratios.max() == pytest.approx(3.5)
    assert fronts["size-preserving"].passed and not fronts["none"].passed
    assert "5.00 times" in fronts["none"].verdict and fronts["size-preserving"].verdict.endswith("all of them correct.")


sizes = st.floats(0.03, 0.6)


@given(st.lists(sizes, min_size=3, max_size=9), st.floats(1.0, 4.0), st.floats(0.3, 1.0), st.floats(0, 1))
@settings(max_examples=40, deadline=None)
def test_size_preserving_never_fails_on_a_line_where_alpha_is_at_least_beta(heights, alpha, beta, place):
    x = np.linspace(0, 1, len(heights)).tolist()
    knots = tuple(zip(x, heights, strict=True))
    shown = resolved(LineLesson(knots=knots, alpha=alpha, beta=beta, place=place))
    assert shown.fronts["size-preserving"].passed
    story = shown.ball
    radii = [story.at(k).radius for k in range(story.count)]
    assert radii == sorted(radii, reverse=True)
    assert story.at(story.count).is_end and story.at(story.count - 1).candidate == story.trace.size
    assert story.trace.size >= story.trace.exact_size * (1 - 1e-12)


def test_handles_stay_between_their_neighbours_and_the_ends_at_the_ends():
    lesson = LineLesson()
    moved = lesson.with_knot(2, 5.0, -1.0)
    assert moved.knots[1][0] < moved.knots[2][0] < moved.knots[3][0] and moved.knots[2][1] == 0.03
    assert lesson.with_knot(0, 0.5, 0.2).knots[0] == (0.0, 0.2)
    assert lesson.with_knot(4, 0.5, 9.0).knots[4] == (1.0, 0.6)
    more = lesson.with_new_knot(0.3, 0.2)
    assert len(more.knots) == 6 and more.without_knot(1) == lesson
    assert lesson.with_new_knot(0.75, 0.2) is lesson and lesson.without_knot(0) is lesson
    assert len(lesson.knots) == 5  # a lesson is a value


def test_another_ball_starts_anew_and_the_same_goes_on():
    lesson = LineLesson(step=7)
    assert lesson.with_changes(epsilon=0.5).step == 7
    assert lesson.with_changes(alpha=2.0).step == 0 == lesson.with_knot(2, 0.7, 0.1).step


@pytest.mark.parametrize("chapter", range(len(TITLES)))
def test_every_chapter_tells_its_numbers_in_plain_words(chapter):
    shown = resolved(LineLesson(chapter=chapter))
    told = chapter_of(shown)
    assert told.title == TITLES[chapter] and told.task and told.equation
    plain = re.sub("<[^>]+>|&[a-z]+;", "", told.words)
    assert re.search(r"\d", plain) and not re.search(r"nan|None|inf\b", plain)
    for _, words, passed in verdict_rows(shown, told):
        assert ("all of them correct" in words) == passed


def test_the_ball_is_told_with_the_terms_of_the_equation():
    story = resolved(LineLesson(place=0.55)).ball
    assert "r = α·h = 1 × 0.5 = <b>0.5</b>" in story_words(story, story.at(0))
    first = next(k for k in range(story.count) if story.at(k).shrank)
    moment = story.at(first)
    terms = {symbol: number for symbol, _, number in term_rows(story, moment)}
    assert float(terms["r"]) < 0.5 and terms["h(y)"] == f"{moment.size:.4g}"
    end = story_words(story, story.at(story.count - 1))
    assert "What stops it is the node at x = 0.725" in end and "exact answer" not in end
    story = resolved(LineLesson(place=0.52)).ball  # (3 · 0.23 + 0.1) / 4, blocked between two nodes
    assert "the exact answer is 0.1975" in story_words(story, story.at(story.count - 1))


def test_a_ball_that_nothing_blocks_says_so():
    flat = resolved(LineLesson(knots=((0.0, 0.2), (1.0, 0.2))))
    assert "so the size asked for is kept." in story_words(flat.ball, flat.ball.at(99))
    assert flat.fronts["none"].passed


# -- the page ----------------------------------------------------------------------------------------------------------


@pytest.fixture
def page(flat_window):
    flat_window.welcome.lesson_requested.emit()
    page = flat_window.lessons.line_page
    assert flat_window.pages.currentWidget() is page
    return page


def pixel(page, x, size) -> QPoint:
    return page.plots.sizes.pixel(x, size).toPoint()


def press(qtbot, page, x, size):
    qtbot.mousePress(page.plots.sizes.viewport(), LEFT, pos=pixel(page, x, size))


def test_the_lesson_is_left_to_where_one_came_from(flat_window, page):
    page.leave.click()
    assert flat_window.pages.currentWidget() is flat_window.welcome
    flat_window.actions_["lesson-line"].trigger()
    assert flat_window.pages.currentWidget() is page


def test_opening_a_source_leaves_the_lesson_and_shows_the_panels(qtbot, flat_window, page):
    with qtbot.waitSignal(flat_window.controller.settled, timeout=10_000):
        flat_window.controller.open_source("ring")
    assert flat_window.pages.currentWidget() is flat_window.board and flat_window.pipeline_dock.isVisible()


def test_a_study_dropped_on_a_lesson_is_shown(qtbot, opened):
    from app.fakes import fake_source

    opened.actions_["lesson-line"].trigger()
    with qtbot.waitSignal(opened.controller.settled, timeout=10_000):
        opened.controller.set_source(fake_source("mri"), "Open a study")
    assert opened.pages.currentWidget() is opened.board and opened.inspector_dock.isVisible()


def test_a_run_that_ends_does_not_end_the_lesson(qtbot, opened):
    opened.actions_["lesson-line"].trigger()
    assert not opened.pipeline_dock.isVisible()
    with qtbot.waitSignal(opened.controller.settled, timeout=10_000):
        opened.size_panel.alpha.changed.emit(3.0)
    assert opened.pages.currentWidget() is opened.lessons.line_page
    opened.lessons.line_page.leave.click()
    assert opened.pages.currentWidget() is opened.board and opened.pipeline_dock.isVisible()


def test_dragging_a_handle_by_mouse_moves_everything_that_follows(qtbot, page):
    page.controller.show_chapter(3)
    before = page.verdict.text()
    viewport = page.plots.sizes.viewport()
    press(qtbot, page, 0.75, 0.1)
    for size in (0.2, 0.3, 0.4, 0.45):
        qtbot.mouseMove(viewport, pixel(page, 0.75, size))
    qtbot.mouseRelease(viewport, LEFT, pos=pixel(page, 0.75, 0.45))
    x, size = page.controller.lesson.knots[2]
    assert x == pytest.approx(0.75, abs=0.01) and size == pytest.approx(0.45, abs=0.01)
    assert page.verdict.text() != before and page.controller.shown.fronts["size-preserving"].passed


def test_handles_are_added_and_removed_by_mouse_and_moved_by_keys(qtbot, page):
    plot = page.plots.sizes
    qtbot.mouseDClick(plot.viewport(), LEFT, pos=pixel(page, 0.3, 0.3))
    assert len(page.controller.lesson.knots) == 6
    qtbot.mousePress(plot.viewport(), Qt.MouseButton.RightButton, pos=pixel(page, 0.3, 0.3))
    assert len(page.controller.lesson.knots) == 5
    plot.setFocus()
    qtbot.keyClick(plot, Qt.Key.Key_PageDown)
    qtbot.keyClick(plot, Qt.Key.Key_PageDown)
    qtbot.keyClick(plot, Qt.Key.Key_Up)
    qtbot.keyClick(plot, Qt.Key.Key_Left)
    assert page.controller.lesson.knots[2] == pytest.approx((0.745, 0.11))


def test_the_chapters_follow_each_other_by_button(qtbot, page):
    seen = []
    for _ in TITLES:
        seen.append(page.heading.text())
        qtbot.mouseClick(page.next, LEFT)
    assert tuple(seen) == TITLES and not page.next.isEnabled()
    assert all(control.isVisible() for control in page.controls.values())
    page.restart.click()
    assert page.heading.text() == TITLES[0] and not page.back.isEnabled()


def test_sliders_turn_alpha_beta_and_epsilon(qtbot, page):
    page.controller.show_chapter(5)
    for name, control in page.controls.items():
        before = page.controller.shown
        qtbot.keyClick(control.number.slider, Qt.Key.Key_Left)
        assert getattr(page.controller.lesson, name) < 1.0
        assert page.controller.shown is not before


def test_the_ball_is_stepped_played_and_asked_for_elsewhere(qtbot, page):
    page.controller.show_chapter(BALL)
    assert page.transport.isVisible() and page.terms.isVisible() and not page.plots.ratios.isVisible()
    qtbot.mouseClick(page.transport.forward, LEFT)
    assert page.controller.lesson.step == 1 and page.transport.label.text().startswith("2 of")
    qtbot.mouseClick(page.transport.back, LEFT)
    qtbot.mouseClick(page.transport.play, LEFT)
    assert page.transport.is_playing
    qtbot.waitUntil(lambda: page.controller.lesson.step >= 2, timeout=5000)
    page.transport.slider.setValue(page.transport.slider.maximum())
    assert not page.transport.is_playing and "The ball stops" in page.words.text()
    viewport = page.plots.sizes.viewport()
    qtbot.mouseClick(viewport, LEFT, pos=pixel(page, 0.3, 0.2))
    assert page.controller.lesson.place == pytest.approx(0.3, abs=0.01) and page.controller.lesson.step == 0


def axis_width(page) -> float:
    return page.plots.sizes.getPlotItem().getAxis("left").fixedWidth


def test_presenter_mode_enlarges_words_and_pictures_and_goes_back(flat_window, page):
    usual = page.words.font().pointSizeF(), axis_width(page)
    flat_window.actions_["presenter"].setChecked(True)
    large = page.words.font().pointSizeF(), axis_width(page)
    assert large[0] == 1.5 * usual[0] and large[1] == 1.5 * usual[1]
    flat_window.actions_["presenter"].setChecked(False)
    assert page.words.font().pointSizeF() == usual[0]
