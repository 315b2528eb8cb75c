"""Why is h* this here? The ball of Algorithm 1 at a place of the plane: asked for, computed, stepped through."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from qtpy.QtCore import QObject, QTimer, Signal

from sizeviz.app.jobs import Job
from sizeviz.app.lessons.ball import BallStory
from sizeviz.app.news import Notice

if TYPE_CHECKING:
    from sizeviz.app.controller import Controller
    from sizeviz.monitor import Monitor
    from sizeviz.sizing import PreserveOptions, SizeField
    from sizeviz.study import Study


@dataclass(frozen=True, eq=False)
class Asked:
    """A ball that is told.

    Parameters
    ----------
    story : BallStory
        Its steps.
    field : SizeField
        The sizes it shrinks among.
    step : int
        The moment on show.
    """

    story: BallStory
    field: SizeField
    step: int = 0


class WhyController(QObject):
    """Asks for balls on the window's one worker, and steps through the answer. It knows no widget.

    Parameters
    ----------
    controller : Controller
        Whose study is asked about.
    parent : QObject, optional
        Owner.

    Signals
    -------
    changed(Asked or None)
        What is told now; None once there is nothing to tell.
    began()
        A first ball was asked for: time to make room for it.
    ended()
        The ball was put away.
    """

    changed = Signal(object)
    began = Signal()
    ended = Signal()

    def __init__(self, controller: Controller, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._controller = controller
        self.asked: Asked | None = None
        self.place: tuple[float, float] | None = None
        self._due = False
        controller.jobs.idle.connect(self._when_idle)
        controller.study_changed.connect(self._on_study)

    @property
    def is_open(self) -> bool:
        """Whether a place is asked about."""
        return self.place is not None

    def ask(self, x: float, y: float) -> None:
        """Ask about the background's node nearest to a place; a run under way is waited for, not broken off."""
        if self._controller.study is None:
            return
        first = not self.is_open
        self.place = (x, y)
        if first:
            self.began.emit()
        if self._controller.is_running:
            self._due = True
            self._controller.noticed.emit(Notice("info", "The ball is shown as soon as the run has ended"))
        else:
            self._request()

    def show_step(self, step: int) -> None:
        """Show the ball at another step."""
        asked = self.asked
        if asked is not None and step != asked.step:
            last = asked.story.count - 1
            self._tell(Asked(asked.story, asked.field, min(max(step, 0), last)))

    def close(self) -> None:
        """Put the ball away."""
        if self.is_open:
            self.place, self._due = None, False
            self._tell(None)
            self.ended.emit()

    # -- inside ----------------------------------------------------------------------------------------------------

    def _request(self) -> None:
        study, place = self._controller.study, self.place
        self._due = False
        if study is None or place is None:
            return
        field, options = study.source.field, study.options.preserve

        def show(story: BallStory) -> None:
            now = self._controller.study
            if now is not None and now.source.field is field and now.options.preserve == options:
                self._tell(Asked(story, field) if self.is_open else None)

        self._controller.jobs.submit(
            Job("shrinking the ball", lambda monitor: ball_story(field, place, options, monitor), show)
        )

    def _when_idle(self) -> None:
        if self._due:
            self._request()

    def _on_study(self, old: Study | None, new: Study) -> None:
        """Ask again where sizes or α and β have changed; another domain ends it."""
        if not self.is_open or old is None:
            return
        if old.source.domain is not new.source.domain:
            self.close()
        elif old.source.field is not new.source.field or old.options.preserve != new.options.preserve:
            self._due = True
            self._tell(None)
            if not self._controller.jobs.is_busy:
                QTimer.singleShot(0, self._ask_if_quiet)  # the change may start a run yet

    def _ask_if_quiet(self) -> None:
        """Ask unless the change has started a run, whose end is waited for."""
        if self._due and not self._controller.jobs.is_busy:
            self._request()

    def _tell(self, asked: Asked | None) -> None:
        self.asked = asked
        self.changed.emit(asked)


def ball_story(field: SizeField, place: tuple[float, float], options: PreserveOptions, monitor: Monitor) -> BallStory:
    """Return how the ball shrinks at the node nearest to a place; for the worker."""
    from sizeviz.sizing.ball import ball_at

    points = field.background.points
    used = np.unique(field.background.triangles)
    node = int(used[((points[used] - place) ** 2).sum(axis=1).argmin()])
    monitor.step(0.0, "Shrinking the ball")
    return BallStory(ball_at(field, node, options, monitor), points, field.sizes, options)
