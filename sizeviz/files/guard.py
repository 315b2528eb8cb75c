"""What stands between a file and a parser: size limits, and one readable line for whatever goes wrong."""

from __future__ import annotations

import errno
import logging
import os
import stat
import warnings
import zlib
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import Cancelled, InputError, SizevizError

if TYPE_CHECKING:
    from collections.abc import Iterator

MAX_BYTES = 2**30
"""Largest file that is read, in bytes, and the most that one may unpack to."""

MAX_NODES = 20_000_000
"""Most nodes of a field or mesh that is read; a picture may have twice as many pixels."""

MAX_PIXELS = 2 * MAX_NODES

_READ_ERRORS = {
    errno.ENOENT: "there is no such file; check the path",
    errno.EACCES: "no permission to read it",
    errno.EPERM: "no permission to read it",
    errno.ENOTDIR: "a part of the path is a file, not a folder; check the path",
    errno.ENAMETOOLONG: "the name is too long; check the path",
    errno.ELOOP: "the symbolic links go round in a circle",
}


def one_line(value: object, limit: int = 200) -> str:
    """Return the text on one line, without control characters, cut to ``limit``: fit for a message."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(value)[: 4 * limit]).split())
    return text if len(text) <= limit else text[: limit - 1] + "…"


def load(path: str | Path, limit: int = MAX_BYTES) -> bytes:
    """Return the content of an ordinary file of at most ``limit`` bytes, read once.

    Raises
    ------
    InputError
        If it is missing, not readable, not an ordinary file (a folder, a pipe, a device), empty or too large.
    """
    name = one_line(path)
    try:
        # Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        try:
            status = os.fstat(handle)
            if not stat.S_ISREG(status.st_mode):
                what = "a folder" if stat.S_ISDIR(status.st_mode) else "not an ordinary file"
                raise InputError(f"{name}: this is {what}; give a file")
            if status.st_size > limit:
                raise InputError(f"{name}: {_mib(status.st_size)} exceeds the limit of {_mib(limit)}; reduce the file")
            with open(handle, "rb", closefd=False) as file:
                data = file.read(limit)
        finally:
            os.close(handle)
    except OSError as error:
        raise InputError(
            f"cannot read {name}: {_READ_ERRORS.get(error.errno or 0, error.strerror or error)}"
        ) from error
    except ValueError as error:  # a null character in the path
        if isinstance(error, InputError):
            raise
        raise InputError(f"cannot read {name}: the path holds a null character; check the path") from error
    if not data:
        raise InputError(f"{name}: the file is empty")
    return data


@contextmanager
def guarded(name: str, what: str) -> Iterator[None]:
    """Turn every failure of a parser into one ``InputError`` of one line.

    Parsers check what they can name; whatever else a corrupt file provokes in them or in a library (a short array, a
    wrong key, an impossible allocation) means the same to the user: the file cannot be read.

    Parameters
    ----------
    name : str
        The input, as the user knows it.
    what : str
        What it should have been, as in "a GeoJSON file".
    """
    try:
        with np.errstate(all="ignore"):  # what overflows is caught by the checks of its result
            yield
    except Cancelled:
        raise
    except InputError as error:
        text = one_line(error, 400).removeprefix(f"{one_line(Path(name).name)}: ")
        raise InputError(text if one_line(name) in text else f"{one_line(name)}: {text}") from error
    except SizevizError:
        raise
    except MemoryError as error:
        raise InputError(f"{one_line(name)}: not enough memory to read it; reduce the file") from error
    except Exception as error:
        reason = one_line(error) or type(error).__name__
        raise InputError(f"{one_line(name)}: not a readable {what} ({reason}); check or export it again") from error


@contextmanager
def quiet(logger: str) -> Iterator[None]:
    """Keep a library's warnings and log to itself: what is wrong with a file is said once, in the error."""
    log = logging.getLogger(logger)
    before, log.disabled = log.disabled, True
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        log.disabled = before


@contextmanager
def silent_stderr() -> Iterator[None]:
    """Keep what a C library prints to itself, as libtiff does of every damage; the error says it once.

    It holds for the whole process: whatever else is printed there meanwhile is lost, so keep the block short.
    """
    try:
        kept = os.dup(2)
    except OSError:  # a program without a terminal may have none
        yield
        return
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        os.close(nowhere)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def check_nodes(count: int, what: str = "nodes", limit: int = MAX_NODES) -> None:
    """Raise ``InputError`` if a file declares a negative number of things, or more than the limit."""
    if not 0 <= count <= limit:
        raise InputError(f"it declares {count} {what}; between 0 and {limit} can be read")


def check_available(needed: int, available: int, what: str) -> None:
    """Raise ``InputError`` if a file declares more than it holds: checked before anything is allocated."""
    if needed < 0 or needed > available:
        raise InputError(
            f"{what} should take {needed} bytes, but only {available} are left; the file is cut or corrupt"
        )


def inflated(data: bytes, limit: int, wbits: int = zlib.MAX_WBITS) -> bytes:
    """Return zlib (or with ``wbits=31`` gzip) data unpacked, at most ``limit`` bytes of it.

    Raises
    ------
    InputError
        If it unpacks to more, as an archive bomb does.
    """
    engine = zlib.decompressobj(wbits)
    content = engine.decompress(data, limit + 1)
    if len(content) > limit:
        raise InputError(f"it unpacks to more than {_mib(limit)}; the file is corrupt or too large")
    if not engine.eof:
        raise InputError("its compressed data end too early; the file is cut or corrupt")
    return content


def started(data: bytes, count: int, wbits: int = zlib.MAX_WBITS) -> bytes:
    """Return the first ``count`` bytes of zlib (or with ``wbits=31`` gzip) data, or as many as there are."""
    return zlib.decompressobj(wbits).decompress(data, count)


def _mib(count: int) -> str:
    return f"{count} bytes" if count < 2**20 else f"{count / 2**20:.0f} MiB"
