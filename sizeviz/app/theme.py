"""Light and dark: one set of colour tokens, and the style sheet made from them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from qtpy.QtGui import QColor, QPalette
from qtpy.QtWidgets import QApplication

if TYPE_CHECKING:
    from qtpy.QtWidgets import QWidget


@dataclass(frozen=True)
class Theme:
    """Colours by what they are for, as ``#rrggbb``.

    Parameters
    ----------
    dark : bool
        Whether panes get a dark ground.
    window, panel, raised, border : str
        Grounds from back to front, and the lines between them.
    text, muted : str
        Words, and words that stand back.
    accent, on_accent, tint : str
        What can be pressed, words on it, and a trace of it.
    good, bad, warn : str
        Verdicts; always beside words.
    """

    dark: bool
    window: str
    panel: str
    raised: str
    border: str
    text: str
    muted: str
    accent: str
    on_accent: str
    tint: str
    good: str
    bad: str
    warn: str


LIGHT = Theme(
    False, "#eef0f3", "#fbfcfd", "#ffffff", "#d8dde4", "#262b33", "#626c79",
    "#1f5fa8", "#ffffff", "#dfeaf6", "#1f7750", "#b8430a", "#9a6a00",
)  # fmt: skip
DARK = Theme(
    True, "#14161a", "#1c1f25", "#262a32", "#353b45", "#dfe3e9", "#98a2af",
    "#6aa9e6", "#0d1116", "#22344a", "#5ec99a", "#ff9a5a", "#e5b64a",
)  # fmt: skip

ICONS = (Path(__file__).parent / "icons").as_posix()
"""Folder of the small pictures that the style sheet names."""

APPLIED = "sizeviz-dark"
"""Property of a window that says which theme it has."""

TYPE_SCALE = "sizeviz-type-scale"
"""Property of a window that says how much larger than usual its words are."""

THEMES = {"light": LIGHT, "dark": DARK}
"""The themes by name."""


def apply_theme(window: QWidget, theme: Theme, type_scale: float | None = None) -> None:
    """Give a window and all that it opens a theme; what it has already is left alone.

    The style sheet is the window's and not the application's: Qt takes five times as long to take another one of those.

    Parameters
    ----------
    window : QWidget
        Which.
    theme : Theme
        Its colours.
    type_scale : float, optional
        How much larger than usual words are, as for an audience; as before by default.
    """
    app = QApplication.instance()
    before = float(window.property(TYPE_SCALE) or 1.0)
    scale = before if type_scale is None else type_scale
    if window.property(APPLIED) == theme.dark and scale == before:
        return
    if window.property(APPLIED) is None:
        app.setStyle("Fusion")
    window.setProperty(APPLIED, theme.dark)
    window.setProperty(TYPE_SCALE, scale)
    app.setPalette(palette(theme))
    window.setStyleSheet(style_sheet(theme, scale))


def palette(theme: Theme) -> QPalette:
    """Return the palette that widgets fall back on."""
    colors = QPalette()
    roles = {
        QPalette.ColorRole.Window: theme.window,
        QPalette.ColorRole.Base: theme.raised,
        QPalette.ColorRole.AlternateBase: theme.panel,
        QPalette.ColorRole.Button: theme.raised,
        QPalette.ColorRole.WindowText: theme.text,
        QPalette.ColorRole.Text: theme.text,
        QPalette.ColorRole.ButtonText: theme.text,
        QPalette.ColorRole.ToolTipBase: theme.raised,
        QPalette.ColorRole.ToolTipText: theme.text,
        QPalette.ColorRole.Highlight: theme.accent,
        QPalette.ColorRole.HighlightedText: theme.on_accent,
        QPalette.ColorRole.Link: theme.accent,
        QPalette.ColorRole.PlaceholderText: theme.muted,
    }
    for role, color in roles.items():
        colors.setColor(role, QColor(color))
    for role in (QPalette.ColorRole.Text, QPalette.ColorRole.ButtonText, QPalette.ColorRole.WindowText):
        colors.setColor(QPalette.ColorGroup.Disabled, role, QColor(theme.muted))
    return colors


def style_sheet(theme: Theme, type_scale: float = 1.0) -> str:
    """Return the style sheet of the whole window."""
    sheet = re.sub(r"(\d+)pt", lambda size: f"{int(size[1]) * type_scale:g}pt", _SHEET)
    for name in ("window", "panel", "raised", "border", "text", "muted", "accent", "on_accent", "tint", "good", "bad",
                 "warn"):  # fmt: skip
        sheet = sheet.replace(f"@{name};", f"{getattr(theme, name)};")
    return sheet.replace("@icons", ICONS)


_SHEET = """
QWidget { color: @text; font-size: 10pt; }
QMainWindow, QDialog { background: @window; }
QToolTip { background: @raised; color: @text; border: 1px solid @border; padding: 5px 7px; }

QToolBar { background: @panel; border: none; border-bottom: 1px solid @border; padding: 5px 8px; spacing: 3px; }
QToolBar::separator { background: @border; width: 1px; margin: 6px 7px; }
QToolButton { background: transparent; border: 1px solid transparent; border-radius: 6px; padding: 5px 7px; }
QToolButton:hover { background: @tint; }
QToolButton:focus { border-color: @accent; }
QToolButton:checked { background: @tint; color: @accent; border-color: @accent; }
QToolButton:disabled { color: @border; }
QToolButton#small { padding: 2px 8px; color: @muted; }
QToolButton#small:hover { color: @text; }
QToolButton[popupMode="2"] { padding-right: 19px; }
QToolButton::menu-indicator { image: url(@icons/down.svg); width: 10px; height: 10px;
  subcontrol-origin: padding; subcontrol-position: center right; right: 6px; }
QToolButton#search { background: @raised; color: @muted; border: 1px solid @border; padding: 5px 14px;
  text-align: left; }

QStatusBar { background: @panel; border-top: 1px solid @border; }
QStatusBar::item { border: none; }

QPushButton { background: @raised; border: 1px solid @border; border-radius: 6px; padding: 6px 13px; }
QPushButton:hover { border-color: @accent; }
QPushButton:focus { border-color: @accent; }
QPushButton:pressed { background: @tint; }
QPushButton:checked { background: @tint; border-color: @accent; color: @accent; }
QPushButton:disabled { color: @muted; background: @panel; }
QPushButton[primary="true"] { background: @accent; color: @on_accent; border-color: @accent; font-weight: 600; }
QPushButton[primary="true"]:disabled { background: @border; border-color: @border; color: @muted; }

QLineEdit, QDoubleSpinBox, QSpinBox, QComboBox, QPlainTextEdit {
  background: @raised; border: 1px solid @border; border-radius: 6px; padding: 4px 7px;
  selection-background-color: @accent; selection-color: @on_accent; }
QLineEdit:focus, QDoubleSpinBox:focus, QSpinBox:focus, QComboBox:focus, QPlainTextEdit:focus { border-color: @accent; }
QLineEdit[invalid="true"], QDoubleSpinBox[invalid="true"] { border-color: @bad; }
QComboBox { padding-right: 0; }
QComboBox::drop-down { border: none; width: 22px; }
QComboBox::down-arrow, QSpinBox::down-arrow, QDoubleSpinBox::down-arrow { image: url(@icons/down.svg); width: 11px;
  height: 11px; }
QSpinBox::up-arrow, QDoubleSpinBox::up-arrow { image: url(@icons/up.svg); width: 11px; height: 11px; }
QSpinBox, QDoubleSpinBox { padding-right: 0; }
QSpinBox::up-button, QDoubleSpinBox::up-button { subcontrol-position: top right; border: none; width: 17px; }
QSpinBox::down-button, QDoubleSpinBox::down-button { subcontrol-position: bottom right; border: none; width: 17px; }
QComboBox:disabled, QSpinBox:disabled, QDoubleSpinBox:disabled, QLineEdit:disabled { color: @muted;
  background: @panel; }
QComboBox QAbstractItemView { background: @raised; border: 1px solid @border; selection-background-color: @tint;
  selection-color: @text; outline: none; padding: 3px; }
QCheckBox { spacing: 8px; }

QScrollArea, QScrollArea > QWidget > QWidget#sidebar { background: @panel; border: none; }
QScrollBar:vertical { background: transparent; width: 10px; margin: 0; }
QScrollBar::handle:vertical { background: @border; border-radius: 4px; min-height: 30px; margin: 2px; }
QScrollBar::handle:vertical:hover { background: @muted; }
QScrollBar:horizontal { background: transparent; height: 10px; margin: 0; }
QScrollBar::handle:horizontal { background: @border; border-radius: 4px; min-width: 30px; margin: 2px; }
QScrollBar::add-line, QScrollBar::sub-line { width: 0; height: 0; }
QScrollBar::add-page, QScrollBar::sub-page { background: transparent; }

QDockWidget { font-weight: 600; }
QDockWidget::title { background: @panel; padding: 8px 10px; }
QDockWidget > QWidget { background: @panel; }
QMainWindow::separator { background: @border; width: 1px; height: 1px; }

QWidget#footer { background: @panel; border-top: 1px solid @border; }
QFrame#pane { background: @raised; border: 1px solid @border; border-radius: 8px; }
QFrame#pane[active="true"] { border: 1px solid @accent; }
QFrame#section { background: @panel; border: none; border-bottom: 1px solid @border; }
QToolButton#sectionHead { font-weight: 600; padding: 9px 12px; border: 1px solid transparent; border-radius: 0;
  text-align: left; }
QToolButton#sectionHead:checked { background: transparent; color: @text; }
QToolButton#sectionHead:hover { background: @tint; }
QToolButton#sectionHead:focus { border-color: @accent; }
QSplitter, QSplitter > QWidget { background: @panel; }
QFrame#card { background: @raised; border: 1px solid @border; border-radius: 8px; }
QFrame#popup { background: @raised; border: 1px solid @border; border-radius: 10px; }
QFrame#toast { background: @raised; border: 1px solid @border; border-left: 4px solid @accent; border-radius: 8px; }
QFrame#toast[level="error"] { border-left-color: @bad; }
QFrame#toast[level="warning"] { border-left-color: @warn; }

QLabel[role="muted"] { color: @muted; }
QLabel[role="title"] { font-size: 19pt; font-weight: 300; }
QLabel[role="heading"] { font-weight: 600; }
QLabel[role="lesson"] { font-size: 11pt; }
QLabel#equation { background: @tint; border-radius: 8px; padding: 9px 12px; font-size: 12pt; }
QLabel#task { border: none; border-left: 3px solid @accent; padding: 2px 0 2px 10px; }
QWidget#explain { background: @panel; }
QFrame#card QScrollArea, QWidget#explain QStackedWidget, QWidget#told { background: transparent; border: none; }
QLabel[role="good"] { color: @good; font-weight: 600; }
QLabel[role="bad"] { color: @bad; font-weight: 600; }
QLabel#badge { background: @warn; color: @window; border-radius: 8px; padding: 1px 8px; font-size: 8pt;
  font-weight: 600; }
QLabel#verdict { font-size: 10pt; }

QTabWidget::pane { border: none; background: @panel; }
QTabBar { background: @panel; }
QTabBar::tab { background: transparent; padding: 8px 12px; border: none; border-bottom: 2px solid transparent;
  color: @muted; }
QTabBar::tab:selected { color: @text; border-bottom-color: @accent; }
QTabBar::tab:hover { color: @text; }
QTabBar::tab:focus { color: @accent; }

QTableView { font-size: 9pt; }
QTableView, QListView, QUndoView { background: @raised; border: 1px solid @border; border-radius: 6px;
  gridline-color: transparent; alternate-background-color: @panel; selection-background-color: @tint;
  selection-color: @text; outline: none; }
QListView::item { padding: 5px 8px; border-radius: 4px; }
QListView::item:selected { background: @tint; color: @text; }
QListView::item:hover { background: @tint; }
QHeaderView::section { background: @panel; border: none; border-bottom: 1px solid @border; padding: 5px 6px;
  color: @muted; }
QTableCornerButton::section { background: @panel; border: none; }

QProgressBar { background: @border; border: none; border-radius: 3px; max-height: 6px; min-height: 6px; }
QProgressBar::chunk { background: @accent; border-radius: 3px; }
QSlider::groove:horizontal { background: @border; height: 4px; border-radius: 2px; }
QSlider::sub-page:horizontal { background: @accent; border-radius: 2px; }
QSlider::handle:horizontal { background: @raised; border: 2px solid @accent; width: 12px; margin: -6px 0;
  border-radius: 8px; }
QSlider::handle:horizontal:focus { background: @accent; }
QMenu { background: @raised; border: 1px solid @border; padding: 5px; }
QMenu::item { padding: 5px 26px 5px 12px; border-radius: 4px; }
QMenu::item:selected { background: @tint; }
QMenu::separator { height: 1px; background: @border; margin: 4px 8px; }
QMenuBar { background: @panel; }
QMenuBar::item { padding: 5px 9px; border-radius: 4px; background: transparent; }
QMenuBar::item:selected { background: @tint; }
"""
