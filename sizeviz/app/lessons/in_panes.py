"""Explanations beside the panes: the ball over them, the panel that speaks of them, the menu of a right click."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtCore import QObject
from qtpy.QtGui import QCursor
from qtpy.QtWidgets import QMenu

from sizeviz.app.lessons.explain import NOTHING, explained
from sizeviz.app.lessons.explain_panel import ExplainPanel
from sizeviz.app.lessons.overlay import BallOverlay
from sizeviz.app.lessons.why import WhyController
from sizeviz.app.news import Notice

if TYPE_CHECKING:
    from sizeviz.app.frame import Frame
    from sizeviz.app.lessons.ball import BallStory
    from sizeviz.app.lessons.explain import Topic
    from sizeviz.app.lessons.why import Asked
    from sizeviz.app.panes.pane import Pane
    from sizeviz.geometry import Domain
    from sizeviz.scene.camera import Camera2D
    from sizeviz.scene.view import ViewState

ROOM = 2.6
"""How many radii of the first ball a pane is high while the ball is told."""


class PaneLessons(QObject):
    """Links the panel Explain and the ball with a window's panes.

    Parameters
    ----------
    window : Frame
        Which.
    """

    def __init__(self, window: Frame) -> None:
        super().__init__(window)
        self._window = window
        self.panel = ExplainPanel()
        window.tabs.insertTab(1, self.panel, "Explain")
        self.why = WhyController(window.controller, self)
        self.type_scale = 1.0
        self._topic: Topic | None = None
        self._seen: tuple[object, ...] = ()
        self._views: list[tuple[Pane, ViewState, Camera2D]] = []
        self._picking = False
        self._usual_width: int | None = None
        self._domain: Domain | None = None
        self._framed: BallStory | None = None
        self._connect()

    # -- intents ---------------------------------------------------------------------------------------------------

    def explain(self) -> None:
        """Bring the panel to the front."""
        self._window.actions_["panel-results"].setChecked(True)
        self._window.tabs.setCurrentWidget(self.panel)
        self.refresh()

    def ask(self) -> None:
        """Ask why h* is what it is: at the pinned element, under the cursor, or at the next click."""
        window = self._window
        if window.controller.study is None or window.pages.currentWidget() is not window.board:
            window.controller.noticed.emit(Notice("info", "Open a study first; the lesson on a line needs none"))
            return
        place = self._pinned_place() or self._cursor_place()
        if place is not None:
            self.ask_at(*place)
        else:
            self.pick()

    def pick(self) -> None:
        """Let the next click say where."""
        self._picking = True
        self._window.controller.noticed.emit(Notice("info", "Click the place to ask about"))

    def ask_at(self, x: float, y: float) -> None:
        """Ask about a place."""
        self._picking = False
        self.why.ask(x, y)

    def close_ball(self) -> bool:
        """Put the ball away; return whether there was one."""
        was_open = self.why.is_open or self._picking
        self._picking = False
        self.why.close()
        return was_open

    def set_presenter(self, on: bool, type_scale: float) -> None:
        """Take the size of words and marks; an audience sees the panes and their explanation, and no options."""
        window = self._window
        self.type_scale = type_scale
        if self._usual_width is None:
            self._usual_width = window.tabs.minimumWidth()
        window.tabs.setMinimumWidth(round(self._usual_width * type_scale))
        window.actions_["panel-pipeline"].setChecked(not on)
        if on and window.pages.currentWidget() is window.board:
            self.explain()
        self._show_ball(self.why.asked)
        window.board.refresh()

    def refresh(self) -> None:
        """Explain what the active pane shows now, if somebody is looking."""
        window = self._window
        study, pane = window.controller.study, window.board.active
        if not self.panel.isVisible():
            return
        if study is None:
            self.panel.show_explanation(NOTHING)
            return
        if (seen := (pane.view.method, pane.view.color_by)) != self._seen:
            self._seen, self._topic = seen, None  # another choice in the panes is followed
        pin = window.inspector.pin
        pinned = pin[1] if pin is not None and pin[0] == pane.view.method else None
        self.panel.show_explanation(explained(study, pane.subject, pane.view, self._topic, pinned))

    # -- inside ----------------------------------------------------------------------------------------------------

    def _connect(self) -> None:
        window, panel, why = self._window, self.panel, self.why
        panel.topic_chosen.connect(self._choose_topic)
        panel.why_requested.connect(self.pick)
        panel.step_requested.connect(why.show_step)
        panel.closed.connect(self.close_ball)
        why.changed.connect(self._show_ball)
        why.began.connect(self._make_room)
        why.ended.connect(self._restore)
        window.board.clicked.connect(self._clicked)
        window.board.menu_requested.connect(self._open_menu)
        window.board.active_changed.connect(lambda pane: self.refresh())
        window.board.views_changed.connect(self.refresh)
        window.controller.study_changed.connect(lambda old, new: self.refresh())
        window.inspector.pinned.connect(lambda pin: self.refresh())
        window.tabs.currentChanged.connect(lambda index: self.refresh())

    def _choose_topic(self, topic: Topic) -> None:
        self._topic = topic
        self.refresh()

    def _clicked(self, pane: Pane, x: float, y: float) -> None:
        if self._picking or self.why.is_open:
            self.ask_at(x, y)

    def _open_menu(self, pane: Pane, x: float, y: float) -> None:
        if self._window.controller.study is None:
            return
        self._window.board.set_active(pane)
        self.menu = QMenu(pane)
        self.menu.addAction("Why is h* this here?").triggered.connect(lambda: self.ask_at(x, y))
        self.menu.addAction(self._window.actions_["explain"])
        self.menu.addSeparator()
        self.menu.addAction(self._window.actions_["worst-ratio"])
        self.menu.popup(QCursor.pos())

    def _make_room(self) -> None:
        """Show the sizes the ball shrinks among, and h* beside them; what was there comes back afterwards."""
        panes, study = self._window.board.visible_panes, self._window.controller.study
        self._domain = None if study is None else study.source.domain
        self._views = [(pane, pane.view, pane.surface.camera) for pane in panes]
        plain = {"cmap": None, "range_mode": "auto", "low": None, "high": None, "log": None, "classes": 0}
        for pane, quantity in zip(panes, ("prescribed", "target"), strict=False):
            method = {} if quantity == "prescribed" else {"method": "size-preserving"}
            pane.set_view(pane.view.with_changes(color_by=quantity, **method, **plain))
        self.explain()
        self.panel.show_waiting("Looking at the sizes around this place…")

    def _restore(self) -> None:
        views, self._views = self._views, []
        study = self._window.controller.study
        same = study is not None and study.source.domain is self._domain
        for pane, view, camera in views:
            pane.set_view(view)
            if same:
                pane.surface.move_camera(camera)
            else:
                pane.surface.fit()  # where one looked before is another domain's place
        self.panel.show_no_ball()
        self.refresh()

    def _show_ball(self, asked: Asked | None) -> None:
        overlay = None if asked is None else BallOverlay(asked, self.type_scale)
        board = self._window.board
        for pane in board.panes:
            pane.surface.glass.overlay = overlay
            pane.surface.glass.setAccessibleDescription("" if overlay is None else overlay.words())
            pane.surface.glass.update()
        if asked is not None:
            self.panel.show_ball(asked)
            if asked.story is not self._framed:  # a new ball is looked at as a whole
                self._framed = asked.story
                x, y = asked.story.trace.centre
                surface = board.visible_panes[0].surface
                surface.move_camera(surface.camera.at(float(x), float(y), ROOM * asked.story.trace.start))
        elif self.why.is_open:
            self.panel.show_waiting("The study changes; the ball is asked for again…")

    def _pinned_place(self) -> tuple[float, float] | None:
        pin, pane = self._window.inspector.pin, self._window.board.active
        mesh = pane.subject.mesh
        if pin is None or mesh is None or pin[0] != pane.view.method or pin[1] >= mesh.n_quads:
            return None
        x, y = mesh.points[mesh.quads[pin[1]]].mean(axis=0)
        return float(x), float(y)

    def _cursor_place(self) -> tuple[float, float] | None:
        for pane in self._window.board.visible_panes:
            glass = pane.surface.glass
            if glass.underMouse():
                at = glass.mapFromGlobal(QCursor.pos())
                return pane.surface.camera.to_model(at.x(), at.y(), glass.width(), glass.height())
        return None
