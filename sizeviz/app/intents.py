"""Which intent goes where: the connections between widgets and controller, and what each command does."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QApplication, QFileDialog

from sizeviz.app.exports import ask_film, save_mesh, save_page, save_prescribed, save_target
from sizeviz.app.feedback import About
from sizeviz.app.news import Notice
from sizeviz.app.panes.board import Selection
from sizeviz.app.panes.remembered import restore_view
from sizeviz.app.places import ask_place, kinds
from sizeviz.app.qt import QShortcut
from sizeviz.app.theme import DARK, LIGHT

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from sizeviz.app.frame import Frame
    from sizeviz.study import Study

CANVAS_NODES = 257
CANVAS_SIZE = 0.05


def connect_panels(window: Frame) -> None:
    """Send every panel's intents to the controller, and every change back to the widgets."""
    controller, board = window.controller, window.board
    window.files.view_restored.connect(lambda values: restore_view(board, values))
    window.files.state_changed.connect(window.show_title)
    window.welcome.recover_requested.connect(window.files.recover)
    for source in (window.source, window.welcome):
        source.open_requested.connect(controller.open_source)
        source.file_requested.connect(lambda: open_file(window))
    window.source.canvas_requested.connect(controller.open_canvas)
    window.welcome.canvas_requested.connect(lambda: controller.open_canvas(CANVAS_NODES, CANVAS_SIZE))
    for panel in (window.size_panel, window.mesh_panel, window.smooth_panel):
        panel.changed.connect(controller.change)
    judge = window.judge_panel
    judge.apply_requested.connect(lambda: _keep_keyboard(window))
    judge.apply_requested.connect(controller.apply)
    judge.automatic_toggled.connect(lambda on: setattr(controller, "automatic", on))
    judge.measure_chosen.connect(lambda measure: _set_measure(window, measure))
    window.progress.cancel_requested.connect(lambda: _keep_keyboard(window))
    window.progress.cancel_requested.connect(controller.cancel)
    controller.study_changed.connect(lambda old, new: _on_study(window, old, new))
    controller.store.stack.indexChanged.connect(lambda index: window.show_state())
    controller.painting.changed.connect(board.refresh)
    controller.busy_changed.connect(window.progress.show_busy)
    controller.busy_changed.connect(lambda busy: window.show_state())
    controller.progressed.connect(window.progress.show_progress)
    controller.noticed.connect(window.toast.tell)
    controller.refused.connect(window.show_options)
    controller.opened.connect(window.settings.remember_source)
    controller.opened.connect(lambda spec: window.toast.forget_error())
    board.views_changed.connect(lambda: _on_views(window))
    board.active_changed.connect(lambda pane: window.show_judgement())
    window.statistics.copied.connect(lambda name: controller.noticed.emit(Notice("info", f"Table copied as {name}")))
    for histogram in window.histograms:
        histogram.selected.connect(lambda method, chosen: _select(window, method, chosen))
    window.tool.active_changed.connect(lambda on: _on_tool(window, on))


def connect_actions(window: Frame, leave_lesson: Callable[[], bool]) -> None:
    """Say what each command does; Esc leaves a lesson, if there is one to leave, before anything is put down."""
    controller, board, on = window.controller, window.board, window.actions_.on
    on("open", lambda: open_file(window))
    on("canvas", lambda: controller.open_canvas(CANVAS_NODES, CANVAS_SIZE))
    on("save", lambda: save_study(window, window.files.path))
    on("save-as", lambda: save_study(window))
    on("recover", lambda: recover_last(window))
    on("copy-command", lambda: copy_recipe(window, "command"))
    on("copy-python", lambda: copy_recipe(window, "Python"))
    on("save-picture", lambda: save_picture(window))
    on("save-comparison", lambda: save_comparison(window))
    on("save-page", lambda: save_page(window))
    on("save-film", lambda: ask_film(window))
    on("save-mesh", lambda: save_mesh(window))
    on("save-prescribed", lambda: save_prescribed(window))
    on("save-target", lambda: save_target(window))
    on("quit", window.close)
    on("undo", controller.undo)
    on("redo", controller.redo)
    on("apply", controller.apply)
    on("cancel", controller.cancel)
    on("paint", window.tool.set_active)
    on("brush-smaller", lambda: window.paint.step_radius(-1.0))
    on("brush-larger", lambda: window.paint.step_radius(1.0))
    for mode in window.paint.modes:
        on(f"brush-{mode}", lambda mode=mode: window.paint.set_mode(mode))
    for count in (1, 2, 3, 4):
        on(f"panes-{count}", lambda on, count=count: board.set_count(count) if on else None)
    for name, state in (
        ("panes-2", True),
        ("link", board.linked),
        ("shared-range", board.shared_range),
        ("theme", window.theme.dark),
        ("panel-pipeline", True),
        ("panel-results", True),
    ):
        window.actions_[name].setChecked(state)
    for name in ("panel-pipeline", "panel-results"):
        on(name, lambda shown: window.show_docks())
    on("link", board.set_linked)
    on("shared-range", board.set_shared_range)
    on("swap", board.swap)
    on("fit", board.fit)
    on("zoom-in", lambda: _zoom(window, 1.25))
    on("zoom-out", lambda: _zoom(window, 0.8))
    for quantity in ("ratio", "quality", "size", "prescribed", "target"):
        on(f"color-{quantity}", lambda quantity=quantity: _color(window, quantity))
    on("worst-ratio", lambda: window.inspector.go_to_worst("ratio"))
    on("worst-quality", lambda: window.inspector.go_to_worst("quality"))
    on("unpin", lambda: window.inspector.set_pin("", None))
    for name, form in (("copy-table", "Markdown"), ("copy-table-csv", "CSV"), ("copy-table-latex", "LaTeX")):
        on(name, lambda form=form: window.statistics.copy(form))
    on("palette", window.palette_.open)
    on("shortcuts", window.overlay.open)
    on("theme", lambda dark: window.set_theme(DARK if dark else LIGHT))
    on("log", lambda: _show_log(window))
    on("about", lambda: About(window).open())
    _connect_keys(window, leave_lesson)


def open_file(window: Frame) -> None:
    """Ask for a file and open it."""
    from sizeviz.files.registry import FIELD_READERS, IMAGE_READERS

    read = kinds("Studies, size fields and images", (".sizeviz", *sorted({*FIELD_READERS, *IMAGE_READERS})))
    path, _ = QFileDialog.getOpenFileName(
        window, "Open a study, a size field or an image", "", f"{read};;All files (*)"
    )
    if path:
        window.controller.open_source(path)


def save_study(window: Frame, path: Path | None = None) -> None:
    """Save the study; asks for the place if none is given."""
    study = window.controller.study
    if study is None:
        return
    if path is None:
        asked = window.files.path or Path(f"{study.source.name}.sizeviz")
        chosen, _ = QFileDialog.getSaveFileName(window, "Save the study", str(asked), "Studies (*.sizeviz)")
        path = Path(chosen) if chosen else None
    if path is not None:
        window.files.save(path)


def recover_last(window: Frame) -> None:
    """Open the newest study that was left unsaved."""
    found = window.files.leftovers()
    if found:
        window.files.recover(found[0])
    else:
        window.controller.noticed.emit(Notice("info", "There is no unsaved study to recover"))


def copy_recipe(window: Frame, language: str) -> None:
    """Put on the clipboard what makes the meshes on show again, outside the window.

    Painted sizes have no name: a script refers to the study file, a command to the sizes exported beside it.
    """
    from sizeviz.errors import SizevizError
    from sizeviz.files import write_field
    from sizeviz.study.recipe import as_command, as_python, has_name

    study, methods, saved = window.controller.study, window.board.methods, window.files.source_path
    measure = window.board.active.view.measure
    if study is None:
        return
    saved = None if saved is None else saved.resolve()
    exported = ""
    try:
        if language == "Python":
            words = as_python(study, methods, study_file=saved)
        elif saved is None or has_name(study.source):
            words = as_command(study, methods, measure=measure)
        else:
            field_file = write_field(saved.with_suffix(".npz"), study.source.field)
            words = as_command(study, methods, field_file=field_file, measure=measure)
            exported = f"; its sizes are in {field_file.name}"
    except SizevizError as error:
        window.controller.noticed.emit(Notice("error", str(error)))
        return
    QApplication.clipboard().setText(words)
    window.controller.noticed.emit(Notice("info", f"Copied as {language}{exported}"))


def save_picture(window: Frame, path: str | None = None) -> None:
    """Save what the active pane shows, its zoom, colours and verdict included; asks for the place if none is given."""
    from sizeviz.scene.picture import save_picture as save

    pane = window.board.active
    path = path or _ask_picture(window, "picture.png")
    if not path:
        return
    subject, view, surface = pane.subject, pane.view, pane.surface
    bounds = None if surface.shows_all else surface.camera.box(surface.aspect)

    def work() -> None:
        save(subject, path, view=view, dark=window.theme.dark, edges=pane.shows_edges, bounds=bounds)

    _saved(window, path, work)


def save_comparison(window: Frame, path: str | None = None) -> None:
    """Save the comparison of the methods on show."""
    from sizeviz.scene.comparison import save_comparison as save

    study = window.controller.study
    path = path or (_ask_picture(window, "compare.png") if study is not None else None)
    if not path or study is None:
        return
    methods = [name for name in window.board.methods if name in study.runs and study.runs[name].is_complete]
    measure = window.board.active.view.measure
    _saved(window, path, lambda: save(study, path, methods=methods, measure=measure, dark=window.theme.dark))


def _saved(window: Frame, path: str, work: Callable[[], object]) -> None:
    """Draw in the window's thread, where VTK belongs, and say how it went."""
    from sizeviz.errors import SizevizError

    try:
        work()
    except SizevizError as error:
        window.controller.noticed.emit(Notice("error", str(error)))
        return
    window.controller.noticed.emit(Notice("info", f"Saved {Path(path).name}"))


def _ask_picture(window: Frame, name: str) -> str:
    return ask_place(window, "Save a picture", name, "Pictures, vector figures (*.png *.jpg *.tif *.svg *.pdf)")


def _connect_keys(window: Frame, leave_lesson: Callable[[], bool]) -> None:
    """Esc drops what is under way; Enter finishes a line or polygon."""
    escape = QShortcut(Qt.Key.Key_Escape, window)
    escape.activated.connect(lambda: _escape(window, leave_lesson))
    for key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
        enter = QShortcut(key, window.board)
        enter.setContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        enter.activated.connect(window.tool.finish)


def _escape(window: Frame, leave_lesson: Callable[[], bool]) -> None:
    if window.controller.painting.stroke is not None:
        window.tool.abort()
    elif leave_lesson():
        return
    elif window.tool.active:
        window.actions_["paint"].setChecked(False)
    else:
        window.toast.hide()
        window.inspector.set_pin("", None)


def _show_log(window: Frame) -> None:
    window.actions_["panel-results"].setChecked(True)
    window.tabs.setCurrentWidget(window.log)


def _keep_keyboard(window: Frame) -> None:
    """Give the keyboard to the picture before the button that has it goes: or it would go to whatever comes next."""
    if window.pages.currentWidget() is window.board:
        window.board.active.surface.glass.setFocus()


def _on_study(window: Frame, old: Study | None, new: Study) -> None:
    if old is None or old.source.domain is not new.source.domain:
        x0, y0, x1, y1 = new.source.domain.bounds
        window.paint.suit(new.source.field, max(x1 - x0, y1 - y0))
    window.show_study(new)


def _on_views(window: Frame) -> None:
    window.controller.set_wanted(window.board.methods)
    if window.controller.study is not None:
        window.show_judgement()
        window.show_state()


def _on_tool(window: Frame, on: bool) -> None:
    action = window.actions_["paint"]
    if action.isChecked() != on:
        action.setChecked(on)
    if on:
        window.sections[1].head.setChecked(True)


def _set_measure(window: Frame, measure: str) -> None:
    for pane in window.board.panes:
        pane.set_view(pane.view.with_changes(measure=measure), tell=False)
    window.board.refresh()
    _on_views(window)


def _color(window: Frame, quantity: str) -> None:
    pane = window.board.active
    changes = {"color_by": quantity, "cmap": None, "range_mode": "auto", "low": None, "high": None, "log": None}
    pane.set_view(pane.view.with_changes(**changes, classes=0))


def _zoom(window: Frame, factor: float) -> None:
    surface = window.board.active.surface
    surface.move_camera(surface.camera.zoomed(factor, surface.camera.x, surface.camera.y))


def _select(window: Frame, method: str, chosen: NDArray[np.intp] | None) -> None:
    window.board.select(None if chosen is None else Selection(method, chosen))
