"""The menus of the toolbar: what has no button of its own is found there, with its keys."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qtpy.QtWidgets import QMenu, QToolButton

if TYPE_CHECKING:
    from collections.abc import Sequence

    from qtpy.QtWidgets import QWidget

    from sizeviz.app.actions import Actions

FILE: tuple[str, ...] = (
    "open", "canvas", "recover", "", "save", "save-as", "", "save-picture", "save-comparison", "save-page", "save-film",
    "", "save-mesh", "save-prescribed", "save-target", "", "copy-command", "copy-python", "", "quit",
)  # fmt: skip
"""Commands of the menu File, in order; an empty name is a line between."""

VIEW: tuple[str, ...] = (
    "fit", "zoom-in", "zoom-out", "", "worst-ratio", "worst-quality", "unpin", "", "color-ratio", "color-quality",
    "color-size", "color-prescribed", "color-target", "", "panel-pipeline", "panel-results", "theme",
)  # fmt: skip
"""Commands of the menu View: the toolbar's buttons show the rest."""

LEARN: tuple[str, ...] = (
    "lesson-line", "lesson-process", "why", "explain", "", "presenter", "", "palette", "shortcuts", "log", "about",
)  # fmt: skip
"""Commands of the menu Learn."""


def menu_button(title: str, accessible: str, names: Sequence[str], actions: Actions, parent: QWidget) -> QToolButton:
    """Return a button that opens a menu of commands.

    Parameters
    ----------
    title : str
        The word on the button.
    accessible : str
        Its name for screen readers.
    names : sequence of str
        Commands, in order; an empty name is a line between.
    actions : Actions
        Where the commands are.
    parent : QWidget
        Owner of the menu.
    """
    menu = QMenu(parent)
    for name in names:
        if name:
            menu.addAction(actions[name])
        else:
            menu.addSeparator()
    button = QToolButton()
    button.setText(title)
    button.setAccessibleName(accessible)
    button.setMenu(menu)
    button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
    return button
