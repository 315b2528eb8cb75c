"""The few names whose module differs between Qt 5 and Qt 6."""

from __future__ import annotations

from qtpy import QtGui, QtWidgets

QUndoStack = getattr(QtWidgets, "QUndoStack", None) or QtGui.QUndoStack
QUndoCommand = getattr(QtWidgets, "QUndoCommand", None) or QtGui.QUndoCommand
QAction = getattr(QtWidgets, "QAction", None) or QtGui.QAction
QActionGroup = getattr(QtWidgets, "QActionGroup", None) or QtGui.QActionGroup
QShortcut = getattr(QtWidgets, "QShortcut", None) or QtGui.QShortcut

__all__ = ["QAction", "QActionGroup", "QShortcut", "QUndoCommand", "QUndoStack"]
