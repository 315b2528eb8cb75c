"""What leaves the window as mesh, field, page or film: written beside the window's thread, without its OpenGL."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sizeviz.app.films import FilmDialog, Turn, ask_film_place, film_process, film_study
from sizeviz.app.jobs import Job
from sizeviz.app.news import Notice
from sizeviz.app.places import ask_place, kinds
from sizeviz.errors import InputError
from sizeviz.scene.subject import METHOD_TITLES

if TYPE_CHECKING:
    from collections.abc import Callable

    from sizeviz.app.frame import Frame
    from sizeviz.monitor import Monitor
    from sizeviz.sizing import SizeField


def save_page(window: Frame, path: str | None = None) -> None:
    """Save the meshes of the panes as a page that opens in a browser; asks for the place if none is given."""
    from sizeviz.scene.page import save_page as save

    panes = [pane for pane in window.board.visible_panes if pane.subject.mesh is not None]
    if not panes:
        window.controller.noticed.emit(Notice("info", "There is no mesh to save yet"))
        return
    path = path or ask_place(window, "Save an interactive page", "compare.html", "Pages (*.html)")
    if not path:
        return
    subjects = {pane.view.method: pane.subject for pane in panes}
    names = list(subjects)
    views = [pane.view.with_changes(method=str(names.index(pane.view.method))) for pane in panes]
    study, dark = window.controller.study, window.theme.dark
    title, measure = study.source.label if study is not None else "sizeviz", window.board.active.view.measure
    shown = list(subjects.values())
    _write(window, path, lambda place: save(shown, place, panes=views, measure=measure, title=title, dark=dark))


def save_mesh(window: Frame, path: str | None = None) -> None:
    """Save the active pane's mesh with R, quality and sizes, as the command line would; asks for the place."""
    from sizeviz.files.registry import MESH_WRITERS, write_mesh
    from sizeviz.study.report import mesh_arrays

    study, view = window.controller.study, window.board.active.view
    if study is None:
        return
    try:
        arrays = mesh_arrays(study, view.method, view.measure)
    except InputError:
        older = f"The mesh of {_title(view.method)} is not up to date: press Apply (F5), then save it"
        window.controller.noticed.emit(Notice("error", older))
        return
    name = f"{study.source.name}-{view.method}.vtu"
    path = path or ask_place(window, "Save the mesh", name, kinds("Meshes", MESH_WRITERS))
    if path:
        _write(window, path, lambda place: write_mesh(place, *arrays))


def save_prescribed(window: Frame, path: str | None = None) -> None:
    """Save the sizes as they were given or painted; asks for the place if none is given."""
    study = window.controller.study
    if study is not None:
        _save_field(window, study.source.field, "Save the prescribed size h", f"{study.source.name}-h", path)


def save_target(window: Frame, path: str | None = None) -> None:
    """Save the processed field of the active pane's method; asks for the place if none is given."""
    study, method = window.controller.study, window.board.active.view.method
    if study is None:
        return
    shown = window.controller.displayed(method)
    if shown.target_stale or shown.subject.target is None:
        older = f"The target size h* of {_title(method)} is not up to date: press Apply (F5), then save it"
        window.controller.noticed.emit(Notice("error", older))
        return
    _save_field(window, shown.subject.target, "Save the target size h*", f"{study.source.name}-{method}", path)


def _save_field(window: Frame, field: SizeField, title: str, stem: str, path: str | None) -> None:
    from sizeviz.files.registry import FIELD_WRITERS, write_field

    path = path or ask_place(window, title, f"{stem}.vtu", kinds("Size fields", FIELD_WRITERS))
    if path:
        _write(window, path, lambda place: write_field(place, field))


def _write(window: Frame, path: str, write: Callable[[Path], object]) -> None:
    """Write a file on the worker, and say how it went; a run under way is not broken off for it."""
    controller, place = window.controller, Path(path)
    if _is_taken(window, place.name):
        return

    def work(monitor: Monitor) -> None:
        monitor.step(0.0, f"writing {place.name}")
        write(place)

    def done(_: object) -> None:
        controller.noticed.emit(Notice("info", f"Saved {place.name}"))

    controller.jobs.submit(Job(f"saving {place.name}", work, done))


def _is_taken(window: Frame, name: str) -> bool:
    """Return whether the worker has a run under way, and say so: saving would break it off."""
    if window.controller.is_running:
        words = f"{name} is not saved while a run is under way: wait for its end or cancel it (Ctrl+.), then save again"
        window.controller.noticed.emit(Notice("warning", words))
    return window.controller.is_running


def _title(method: str) -> str:
    return METHOD_TITLES.get(method, method).lower()


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
    path = path or ask_film_place(window, "Save a film of a turning α", "alpha")
    if path and not _is_taken(window, Path(path).name):
        typed = [*turn.as_typed(), "--measure", window.board.active.view.measure, *_ground(window)]
        film_study(window.controller, window.files.content(), Path(path).resolve(), typed)


def save_process_film(window: Frame, folder: Path, path: str | None = None) -> None:
    """Have a film made of an adaptive process, iteration by iteration; asks for the place if none is given."""
    path = path or ask_film_place(window, "Save a film of the iterations", "adapted")
    if path:
        film_process(window.controller, folder, Path(path).resolve(), _ground(window))


def _ground(window: Frame) -> list[str]:
    return ["--dark"] if window.theme.dark else []
