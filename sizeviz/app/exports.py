"""What leaves the window as a page or a film: written beside the window's thread, without its OpenGL."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from qtpy.QtWidgets import QFileDialog

from sizeviz.app.films import FilmDialog, Turn, ask_place, film_process, film_study
from sizeviz.app.jobs import Job
from sizeviz.app.news import Notice

if TYPE_CHECKING:
    from sizeviz.app.frame import Frame
    from sizeviz.monitor import Monitor


def save_page(window: Frame, path: str | None = None) -> None:
    """Save the meshes of the panes as a page that opens in a browser; asks for the place if none is given."""
    from sizeviz.scene.page import save_page as save

    panes = [pane for pane in window.board.visible_panes if pane.subject.mesh is not None]
    if not panes:
        window.controller.noticed.emit(Notice("info", "There is no mesh to save yet"))
        return
    path = path or QFileDialog.getSaveFileName(window, "Save an interactive page", "compare.html", "Pages (*.html)")[0]
    if not path:
        return
    subjects = {pane.view.method: pane.subject for pane in panes}
    names = list(subjects)
    views = [pane.view.with_changes(method=str(names.index(pane.view.method))) for pane in panes]
    study, dark = window.controller.study, window.theme.dark
    title, measure = study.source.label if study is not None else "sizeviz", window.board.active.view.measure
    target = Path(path)

    def work(monitor: Monitor) -> None:
        monitor.step(0.0, "writing the page")
        save(list(subjects.values()), target, panes=views, measure=measure, title=title, dark=dark)

    def done(_: object) -> None:
        window.controller.noticed.emit(Notice("info", f"Saved {target.name}"))

    window.controller.jobs.submit(Job(f"saving {target.name}", work, done))


def ask_film(window: Frame) -> None:
    """Ask what a film of a turning α shows and where it goes, then have it made."""
    if window.controller.study is None:
        return
    dialog = FilmDialog(Turn(), window)
    dialog.accepted.connect(lambda: save_film(window, dialog.turn))
    dialog.finished.connect(dialog.deleteLater)
    dialog.open()


def save_film(window: Frame, turn: Turn, path: str | None = None) -> None:
    """Have a film made of the study's methods while α turns; asks for the place if none is given."""
    path = path or ask_place(window, "Save a film of a turning α", "alpha")
    if path:
        typed = [*turn.as_typed(), "--measure", window.board.active.view.measure, *_ground(window)]
        film_study(window.controller, window.files.content(), Path(path).resolve(), typed)


def save_process_film(window: Frame, folder: Path, path: str | None = None) -> None:
    """Have a film made of an adaptive process, iteration by iteration; asks for the place if none is given."""
    path = path or ask_place(window, "Save a film of the iterations", "adapted")
    if path:
        film_process(window.controller, folder, Path(path).resolve(), _ground(window))


def _ground(window: Frame) -> list[str]:
    return ["--dark"] if window.theme.dark else []
