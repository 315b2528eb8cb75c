"""A person who has not read the paper goes through the lessons, by mouse and keyboard, and looks at each step.

Played by a test, which asks what the person would have seen, and by ``screenshots/make_lessons.py``, which keeps it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from app.driver import LEFT, Person
from qtpy.QtCore import Qt
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication, QPushButton

if TYPE_CHECKING:
    from collections.abc import Callable

    from qtpy.QtWidgets import QWidget

    from sizeviz.app.window import MainWindow


class Student(Person):
    """Follows lessons."""

    def __init__(self, window: MainWindow, take: Callable[[str], None]) -> None:
        super().__init__(window)
        self.take = take

    @property
    def line(self):
        return self.window.lessons.line_page

    @property
    def panel(self):
        return self.window.lessons.panes.panel

    def press(self, button: QWidget) -> None:
        assert button.isVisible() and button.isEnabled(), button.accessibleName() or button.text()
        QTest.mouseClick(button, LEFT)
        self.rest(20)

    def drag_handle(self, start: tuple[float, float], stop: tuple[float, float], steps: int = 8) -> None:
        """Drag a handle of the field on the line."""
        plot = self.line.plots.sizes
        ends = [plot.pixel(*place).toPoint() for place in (start, stop)]
        QTest.mousePress(plot.viewport(), LEFT, pos=ends[0])
        for k in range(1, steps + 1):
            QTest.mouseMove(plot.viewport(), ends[0] + (ends[1] - ends[0]) * k / steps)
            QTest.qWait(10)
        QTest.mouseRelease(plot.viewport(), LEFT, pos=ends[1])
        self.rest(20)

    def seen(self) -> str:
        """Return the words of the lesson on show."""
        page = self.line
        return " ".join(label.text() for label in (page.heading, page.words, page.verdict, page.task))


def lesson_on_a_line(student: Student) -> None:
    """Open the lesson from the first page and go through its six steps."""
    window, page = student.window, student.line
    button = next(b for b in window.welcome.findChildren(QPushButton) if b.text().startswith("New here"))
    student.press(button)
    assert "how long an element of the mesh may be" in student.seen()
    student.take("lesson-line-1")

    student.press(page.next)  # the front misses the valley
    assert "R = 5.00" in student.seen() and "2 elements, 1 of them correct" in student.seen()
    student.take("lesson-line-2")

    student.press(page.next)  # a gentler slope, by keyboard
    before = len(page.controller.shown.fronts["gradient-limiting"].ratios)
    page.controls["epsilon"].number.slider.setFocus()
    for _ in range(4):
        QTest.keyClick(page.controls["epsilon"].number.slider, Qt.Key.Key_PageDown)
    assert len(page.controller.shown.fronts["gradient-limiting"].ratios) > before
    student.take("lesson-line-3")

    student.press(page.next)
    assert "Size preserving</b>: 5 elements, all of them correct" in student.seen()
    student.take("lesson-line-4")

    student.press(page.next)  # the ball, a step at a time, then played to its end
    assert "largest ball it allows is tried first" in student.seen()
    while not page.controller.shown.ball.at(page.controller.lesson.step).shrank:
        student.press(page.transport.forward)
    for _ in range(2):
        student.press(page.transport.forward)
    assert "looked at next" in student.seen() or "shrinks" in student.seen()
    student.take("lesson-line-5")
    student.press(page.transport.play)
    student.wait(lambda: "The ball stops" in student.seen(), 40)
    assert "What stops it is the node" in student.seen()
    student.take("lesson-line-5-end")

    student.press(page.next)  # a field of one's own
    student.drag_handle((0.0, 0.5), (0.0, 0.3))
    student.drag_handle((page.controller.lesson.knots[1]), (0.35, 0.12))
    assert page.controller.lesson.knots[1][1] < 0.2 and page.controller.shown.fronts["size-preserving"].passed
    student.take("lesson-line-6")
    student.press(page.restart)
    student.key(Qt.Key.Key_Escape)
    assert window.pages.currentWidget() is not page


def ball_in_the_plane(student: Student, source: str, place: tuple[float, float]) -> None:
    """Open an example, ask by a right click why h* is what it is, follow the ball, ask elsewhere, go back."""
    window = student.window
    lessons = window.lessons.panes
    window.controller.open_source(source)
    student.wait(lambda: window.controller.study is not None, 300)
    student.wait_settled(600)
    pane = window.board.panes[0]
    view = pane.view
    QTest.mouseClick(pane.surface.glass, Qt.MouseButton.RightButton, pos=student.spot(pane, *place))
    student.wait(lessons.menu.isVisible, 5)
    student.take("lesson-ball-menu")
    QTest.keyClick(lessons.menu, Qt.Key.Key_Down)
    QTest.keyClick(lessons.menu, Qt.Key.Key_Return)
    student.wait(lambda: lessons.why.asked is not None, 60)
    panel = student.panel
    assert "Suppose as large as the size there" in panel.ball.words.text()
    student.take("lesson-ball-1")
    count = lessons.why.asked.story.count
    panel.transport.slider.setFocus()
    while lessons.why.asked.step < 2 * count // 3:
        QTest.keyClick(panel.transport.slider, Qt.Key.Key_PageUp)
    student.take("lesson-ball-2")
    QTest.keyClick(panel.transport.slider, Qt.Key.Key_End)
    assert "The ball stops" in panel.ball.words.text() and "h* = β·r/α" in panel.ball.words.text()
    student.take("lesson-ball-3")
    camera = pane.surface.camera
    first = lessons.why.asked.story
    student.click(pane, camera.x + 0.2 * camera.height, camera.y)
    student.wait(lambda: lessons.why.asked is not None and lessons.why.asked.story is not first, 60)
    student.key(Qt.Key.Key_Escape)
    assert not lessons.why.is_open and pane.view == view


def explanation(student: Student) -> None:
    """Go to the worst element and have it explained."""
    student.key(Qt.Key.Key_F)
    student.key(Qt.Key.Key_W)
    student.key(Qt.Key.Key_F1)
    student.rest(100)
    assert "which you have pinned" in student.panel.topic.words.text()
    student.take("lesson-explain")
    student.key(Qt.Key.Key_P)


def presenter(student: Student) -> None:
    """Make everything large, in the panes and on the line."""
    window = student.window
    student.key(Qt.Key.Key_F11)
    student.key(Qt.Key.Key_F)
    student.rest(100)
    assert not window.pipeline_dock.isVisible()
    student.take("presenter-panes")
    student.key(Qt.Key.Key_F2)
    student.line.controller.show_chapter(3)
    student.take("presenter-line")
    student.key(Qt.Key.Key_Escape)
    student.key(Qt.Key.Key_F11)
    assert window.pipeline_dock.isVisible()


def adaptive_process(student: Student, cells: str, limit: str) -> None:
    """Run the process, look at its meshes, and play them."""
    window = student.window
    student.key(Qt.Key.Key_F3)
    page, process = window.lessons.process_page, window.lessons.process
    student.type_number(page.cells, cells)
    student.type_number(page.limit, limit)
    student.press(page.start)
    student.wait(lambda: process.shown.count >= 2, 600)
    student.wait(lambda: not process.shown.running and not window.controller.jobs.is_busy, 900)
    student.wait(lambda: process.shown.subject is not None, 60)
    assert "converged in" in page.words.text()
    student.take("lesson-process")
    page.transport.slider.setFocus()
    QTest.keyClick(page.transport.slider, Qt.Key.Key_Home)
    student.wait(lambda: process.shown.subject.title == "Uniform mesh", 60)
    assert "as large as asked for" in page.words.text()
    student.take("lesson-process-0")
    student.press(page.leave)
    assert window.pages.currentWidget() is window.board


def screen() -> object:
    """Return what is on the whole screen, menus included."""
    QTest.qWait(200)
    return QApplication.primaryScreen().grabWindow(0)
