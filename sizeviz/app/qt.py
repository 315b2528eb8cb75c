"""The few names whose module differs between Qt 5 and Qt 6, and a painter that always ends."""

from __future__ import annotations

from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any

from qtpy import QtGui, QtWidgets

if TYPE_CHECKING:
    from collections.abc import Iterator

QUndoStack = getattr(QtWidgets, "QUndoStack", None) or QtGui.QUndoStack
QUndoCommand = getattr(QtWidgets, "QUndoCommand", None) or QtGui.QUndoCommand
QAction = getattr(QtWidgets, "QAction", None) or QtGui.QAction
QActionGroup = getattr(QtWidgets, "QActionGroup", None) or QtGui.QActionGroup
QShortcut = getattr(QtWidgets, "QShortcut", None) or QtGui.QShortcut
QOpenGLWidget = getattr(QtWidgets, "QOpenGLWidget", None) or import_module("qtpy.QtOpenGLWidgets").QOpenGLWidget

__all__ = ["QAction", "QActionGroup", "QOpenGLWidget", "QShortcut", "QUndoCommand", "QUndoStack", "painting"]


@contextmanager
def painting(widget: Any, kind: Any = QtGui.QPainter) -> Iterator[Any]:
    """Paint on a widget; the painter ends with the block, also by an error.

    One that is left to the garbage collector lives as long as the traceback that refers to it, and Qt complains of it
    at every frame.
    """
    painter = kind(widget)
    try:
        yield painter
    finally:
        painter.end()
