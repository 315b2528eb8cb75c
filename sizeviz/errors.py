"""The errors that sizeviz raises on purpose: each is one line that names the input and the remedy."""

from __future__ import annotations


class SizevizError(Exception):
    """Base of every error a user can cause or mend; its text is shown as it is, without a traceback."""


class InputError(SizevizError, ValueError):
    """A file, field, outline or parameter cannot be used; the text names it and says what to do."""


class MissingDependencyError(SizevizError, ImportError):
    """An optional library or system package is absent; the text holds the line that installs it."""


class MeshingError(SizevizError, RuntimeError):
    """No valid mesh could be made of a valid input; the text says where and what to try."""


class Cancelled(Exception):
    """The user asked a running job to stop; raised by ``Monitor.step``."""
