"""Everything the window can do, by name: one list feeds menus, toolbar, shortcuts, overlay and command palette."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from qtpy.QtGui import QKeySequence

from sizeviz.app.qt import QAction, QActionGroup

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from qtpy.QtWidgets import QWidget


@dataclass(frozen=True)
class Command:
    """One thing to do.

    Parameters
    ----------
    name : str
        Unique name.
    title : str
        Words in menus and palette.
    group : str
        Menu it belongs to.
    shortcut : str
        Keys, empty for none; several alternatives are separated by a blank.
    checkable : bool
        Whether it is a switch.
    words : str
        Other words by which the palette finds it.
    """

    name: str
    title: str
    group: str
    shortcut: str = ""
    checkable: bool = False
    words: str = ""


COMMANDS: tuple[Command, ...] = (
    Command("open", "Open file…", "File", "Ctrl+O"),
    Command("canvas", "New blank canvas", "File", "Ctrl+N"),
    Command("save", "Save the study", "File", "Ctrl+S"),
    Command("save-as", "Save the study as…", "File", "Ctrl+Shift+S"),
    Command("recover", "Recover the last unsaved study", "File", words="autosave crash"),
    Command("save-picture", "Save a picture of this view…", "File", "Ctrl+E", words="export screenshot PNG SVG PDF"),
    Command("save-comparison", "Save the comparison picture…", "File", "Ctrl+Shift+E", words="export PNG SVG PDF"),
    Command("save-page", "Save an interactive page for browsers…", "File", "Ctrl+Alt+E", words="export HTML"),
    Command("save-film", "Save a film of a turning α…", "File", words="export animation video MP4 GIF"),
    Command("save-mesh", "Save the mesh of this pane…", "File", "Ctrl+Alt+M", words="export VTU VTK MSH OBJ"),
    Command("save-prescribed", "Save the prescribed size h…", "File", words="export field painted POS SOL NPZ VTU"),
    Command("save-target", "Save the target size h* of this pane…", "File", words="export field POS SOL NPZ VTU"),
    Command("copy-command", "Copy as command", "File", "Ctrl+Alt+C"),
    Command("copy-python", "Copy as Python", "File", "Ctrl+Alt+P"),
    Command("quit", "Quit", "File", "Ctrl+Q"),
    Command("undo", "Undo", "Edit", "Ctrl+Z"),
    Command("redo", "Redo", "Edit", "Ctrl+Shift+Z Ctrl+Y"),
    Command("apply", "Run what is stale", "Edit", "F5"),
    Command("cancel", "Cancel the run", "Edit", "Ctrl+."),
    Command("paint", "Paint on the field", "Paint", "B", True),
    Command("brush-smaller", "Smaller brush", "Paint", "["),
    Command("brush-larger", "Larger brush", "Paint", "]"),
    Command("brush-set", "Brush: set size", "Paint", "Alt+1"),
    Command("brush-multiply", "Brush: multiply", "Paint", "Alt+2"),
    Command("brush-at-most", "Brush: at most", "Paint", "Alt+3"),
    Command("brush-smooth", "Brush: smooth", "Paint", "Alt+4"),
    Command("brush-erase", "Brush: erase to original", "Paint", "Alt+5"),
    Command("panes-1", "One pane", "View", "Ctrl+1", True),
    Command("panes-2", "Two panes", "View", "Ctrl+2", True),
    Command("panes-3", "Three panes", "View", "Ctrl+3", True),
    Command("panes-4", "Four panes", "View", "Ctrl+4", True),
    Command("link", "Link cameras", "View", "L", True),
    Command("shared-range", "Share colour ranges", "View", "R", True),
    Command("swap", "Swap the first two panes", "View", "X"),
    Command("fit", "Fit to pane", "View", "F"),
    Command("zoom-in", "Zoom in", "View", "+ ="),
    Command("zoom-out", "Zoom out", "View", "-"),
    Command("panel-pipeline", "Pipeline panel", "View", "F8", True, "hide show sidebar options"),
    Command("panel-results", "Results panel", "View", "F9", True, "hide show sidebar table histogram history"),
    Command("color-ratio", "Colour by R", "View", "1"),
    Command("color-quality", "Colour by quality", "View", "2"),
    Command("color-size", "Colour by element size", "View", "3"),
    Command("color-prescribed", "Colour by prescribed size", "View", "4"),
    Command("color-target", "Colour by target size", "View", "5"),
    Command("worst-ratio", "Go to the worst R", "Inspect", "W"),
    Command("worst-quality", "Go to the worst quality", "Inspect", "Q"),
    Command("unpin", "Let go of the pinned element", "Inspect", "P"),
    Command("copy-table", "Copy the table as Markdown", "Inspect", "Ctrl+Shift+C"),
    Command("copy-table-csv", "Copy the table as CSV", "Inspect"),
    Command("copy-table-latex", "Copy the table as LaTeX", "Inspect"),
    Command("lesson-line", "Lesson: sizes on a line", "Learn", "F2"),
    Command("lesson-process", "Lesson: the adaptive process", "Learn", "F3"),
    Command("why", "Why is h* this here?", "Learn", "H"),
    Command("explain", "Explain what is shown", "Learn", "F1"),
    Command("presenter", "Presenter mode: large type", "Learn", "F11", True),
    Command("palette", "Command palette…", "Help", "Ctrl+K Ctrl+Shift+P"),
    Command("shortcuts", "Keyboard shortcuts", "Help", "? Shift+?"),
    Command("theme", "Dark theme", "Help", "Ctrl+D", True),
    Command("log", "Show the log", "Help", ""),
    Command("about", "About sizeviz", "Help", words="versions licence citation"),
)


class Actions:
    """The commands as Qt actions of one window.

    Parameters
    ----------
    window : QWidget
        Whose shortcuts they are.
    """

    def __init__(self, window: QWidget) -> None:
        self._actions: dict[str, QAction] = {}
        for command in COMMANDS:
            action = QAction(command.title, window)
            action.setCheckable(command.checkable)
            if command.shortcut:
                action.setShortcuts([QKeySequence(keys) for keys in command.shortcut.split()])
                shown = action.shortcuts()[0].toString(QKeySequence.SequenceFormat.NativeText)
                action.setToolTip(f"{command.title} ({shown})")
            window.addAction(action)
            self._actions[command.name] = action
        panes = QActionGroup(window)  # exactly one of them is on
        for count in (1, 2, 3, 4):
            panes.addAction(self._actions[f"panes-{count}"])

    def __getitem__(self, name: str) -> QAction:
        return self._actions[name]

    def __iter__(self) -> Iterator[tuple[Command, QAction]]:
        return ((command, self._actions[command.name]) for command in COMMANDS)

    def on(self, name: str, call: Callable[..., object]) -> None:
        """Say what a command does; switches are told their new state."""
        action = self._actions[name]
        if action.isCheckable():
            action.toggled.connect(lambda on: call(on))
        else:
            action.triggered.connect(lambda checked=False: call())
