"""Values on the command line that are read more strictly than the parser would: no count is rounded, no name empty."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cyclopts import Token


def _whole(kind: Any, tokens: Sequence[Token]) -> int:
    typed = tokens[0].value
    try:
        return int(typed)
    except ValueError:
        raise ValueError(f"{typed!r} is not a whole number; give one such as 4") from None


def _place(kind: Any, tokens: Sequence[Token]) -> Path:
    typed = tokens[0].value
    if not typed.strip():
        raise ValueError("the name of the file or folder is empty; give one, or . for the current folder")
    return Path(typed)


Whole = Annotated[int, Parameter(converter=_whole)]
"""A count: 1.5 is an error, not 2."""

Place = Annotated[Path, Parameter(converter=_place)]
"""A file or folder: an empty name, as of a variable that is not set, is an error, not the current folder."""
