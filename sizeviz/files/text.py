"""Numbers written out in a file, parsed at the speed of C and counted before they are trusted."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import one_line

if TYPE_CHECKING:
    from numpy.typing import DTypeLike, NDArray


def count_words(text: bytes) -> int:
    """Return the number of words between blanks."""
    is_blank = np.frombuffer(b" " + text, dtype=np.uint8) <= 32
    return int(np.count_nonzero(is_blank[:-1] & ~is_blank[1:]))


def numbers(text: bytes, what: str, count: int | None = None, dtype: DTypeLike = np.float64) -> NDArray[Any]:
    """Return every number of a text that holds nothing else.

    Parameters
    ----------
    text : bytes
        Numbers between blanks.
    what : str
        What they are, for the message.
    count : int, optional
        How many there must be.
    dtype : numpy type
        float64 or int64.

    Raises
    ------
    InputError
        If a word is no number, or there are more or fewer than ``count``.
    """
    words = count_words(text)
    if count is not None and words != count:
        raise InputError(f"{what}: {count} numbers are announced, {words} are there; the file is cut or corrupt")
    if words == 0:
        return np.empty(0, dtype=dtype)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # up to numpy 2.2 a word that is no number only warns
            values: NDArray[Any] = np.fromstring(text, dtype=dtype, sep=" ")
    except (ValueError, DeprecationWarning):
        raise InputError(f"{what}: {_first_bad(text, dtype)!r} is not a number; the file is corrupt") from None
    if len(values) != words:
        raise InputError(f"{what}: not every word is a number; the file is corrupt")
    return values


def indices(text: bytes, what: str, count: int | None = None) -> NDArray[np.int64]:
    """Return every whole number of a text that holds nothing else.

    Raises
    ------
    InputError
        As ``numbers``.
    """
    return numbers(text, what, count, np.int64)


def whole(value: bytes | str, what: str) -> int:
    """Return one whole number.

    Raises
    ------
    InputError
        If it is none, or beyond 64 bits.
    """
    try:
        number = int(value[:30])
    except ValueError:
        raise InputError(f"{what} is {_shown(value)!r}; it must be a whole number") from None
    if len(value) > 30 or abs(number) >= 2**62:
        raise InputError(f"{what} is {_shown(value)!r}; it is too large")
    return number


def _shown(value: bytes | str) -> str:
    return one_line(value.decode("latin-1") if isinstance(value, bytes) else value, 40)


def _first_bad(text: bytes, dtype: DTypeLike) -> str:
    """Return the first word that is no number."""
    read = int if np.dtype(dtype).kind == "i" else float
    for word in text.split():
        try:
            read(word)
        except ValueError:
            return _shown(word)
    return ""
