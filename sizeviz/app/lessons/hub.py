"""Where lessons meet the window: pages, panels and commands; the only module of theirs that knows it."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from qtpy.QtCore import QObject

from sizeviz.app.exports import save_process_film
from sizeviz.app.lessons.in_panes import PaneLessons
from sizeviz.app.lessons.line_page import LineController, LinePage
from sizeviz.app.lessons.process import ProcessController
from sizeviz.app.lessons.process_page import ProcessPage
from sizeviz.app.menus import LEARN, menu_button
from sizeviz.app.theme import apply_theme

if TYPE_CHECKING:
    from collections.abc import Callable

    from qtpy.QtWidgets import QWidget

    from sizeviz.app.frame import Frame
    from sizeviz.app.lessons.page import LessonPage
    from sizeviz.app.panes.canvas import Canvas
    from sizeviz.app.theme import Theme
    from sizeviz.study import Study

PRESENTER_SCALE = 1.5
"""How much larger words are in presenter mode."""


class Lessons(QObject):
    """Opens lessons in a window and takes it back to where it was.

    Parameters
    ----------
    window : Frame
        Which.
    make_canvas : callable
        Makes the drawing widget of a lesson's pane.
    """

    def __init__(self, window: Frame, make_canvas: Callable[[QWidget], Canvas]) -> None:
        super().__init__(window)
        self._window, self._make_canvas = window, make_canvas
        self._page_before: QWidget | None = None
        self.type_scale = 1.0
        self.line = LineController(self)
        self._line_page: LinePage | None = None
        self.process = ProcessController(window.controller, parent=self)
        self._process_page: ProcessPage | None = None
        self.panes = PaneLessons(window)
        self._add_menu()
        on = window.actions_.on
        on("lesson-line", self.open_line)
        on("lesson-process", self.open_process)
        on("why", self.panes.ask)
        on("explain", self.panes.explain)
        on("presenter", self.set_presenter)
        window.welcome.lesson_requested.connect(self.open_line)
        window.controller.study_changed.connect(self._on_study)

    # -- pages -----------------------------------------------------------------------------------------------------

    @property
    def line_page(self) -> LinePage:
        """The lesson on a line, made when it is first needed."""
        if self._line_page is None:
            self._line_page = LinePage(self.line)
            self._adopt(self._line_page)
        return self._line_page

    def open_line(self) -> None:
        """Open the lesson on a line."""
        self._open(self.line_page)

    @property
    def process_page(self) -> ProcessPage:
        """The player of the adaptive process, made when it is first needed."""
        if self._process_page is None:
            self._process_page = ProcessPage(self.process, self._window.controller, self._make_canvas)
            self._process_page.film_asked.connect(partial(save_process_film, self._window))
            self._adopt(self._process_page)
        return self._process_page

    def open_process(self) -> None:
        """Open the player of the adaptive process."""
        self._open(self.process_page)

    def leave(self) -> None:
        """Go back to what was there before the lesson."""
        window, before = self._window, self._page_before
        if before is None:
            return
        if before is window.welcome and window.controller.study is not None:
            before = window.board
        window.turn_page(before)
        self._page_before = None

    def set_theme(self, theme: Theme) -> None:
        """Take the window's colours."""
        for page in self._pages():
            page.set_theme(theme, self.type_scale)

    def set_presenter(self, on: bool) -> None:
        """Make everything legible from the last row, or as it was."""
        self.type_scale = PRESENTER_SCALE if on else 1.0
        apply_theme(self._window, self._window.theme, self.type_scale)
        self.set_theme(self._window.theme)
        self._window.suit_bar()
        self.panes.set_presenter(on, self.type_scale)

    def escape(self) -> bool:
        """Put away what a lesson has put over the panes, or leave its page; return whether there was either."""
        if self._window.pages.currentWidget() in self._pages():
            self.leave()
            return True
        return self.panes.close_ball()

    def close(self) -> None:
        """Stop what moves by itself, and give the application its usual type back."""
        if self._line_page is not None:
            self._line_page.transport.stop()
        if self._process_page is not None:
            self._process_page.dispose()
        self.process.close()
        self.panes.panel.transport.stop()
        if self.type_scale != 1.0:
            apply_theme(self._window, self._window.theme, 1.0)

    # -- inside ----------------------------------------------------------------------------------------------------

    def _on_study(self, old: Study | None, new: Study) -> None:
        """Show what was opened while a lesson was on show."""
        if old is None or old.source is not new.source:
            self.leave()

    def _pages(self) -> list[LessonPage]:
        return [page for page in (self._line_page, self._process_page) if page is not None]

    def _adopt(self, page: LessonPage) -> None:
        page.set_theme(self._window.theme, self.type_scale)
        page.left.connect(self.leave)
        self._window.pages.addWidget(page)

    def _open(self, page: LessonPage) -> None:
        pages = self._window.pages
        if pages.currentWidget() not in self._pages():
            self._page_before = pages.currentWidget()
        self._window.turn_page(page)
        page.take_focus()

    def _add_menu(self) -> None:
        window = self._window
        button = menu_button("Learn", "Lessons and explanations", LEARN, window.actions_, window)
        window.toolbar.insertWidget(window.actions_["theme"], button)
