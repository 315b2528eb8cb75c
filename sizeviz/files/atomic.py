"""Writing that leaves either the whole new file or what was there before."""

from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Give a temporary sibling to write to; it takes the name of ``path`` if the block ends well, else it goes.

    The sibling keeps the suffix, because writers choose the format by it.

    Raises
    ------
    InputError
        If the place cannot be written.
    """
    path = Path(path)
    part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        yield part
        _flush(part)
        part.replace(path)
    except OSError as problem:
        raise InputError(f"{path}: cannot be written ({_reason(problem)}); choose another place") from problem
    finally:
        part.unlink(missing_ok=True)


def require_writable_file(path: str | Path) -> Path:
    """Return the path if a file could be written there, before any work is done for it.

    Raises
    ------
    InputError
        If its folder does not exist or cannot be written, or the path is a folder.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file in it")
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist; create it or choose another place")
    _try_writing(path.parent, path)
    return path


@contextmanager
def output_folder(path: str | Path) -> Iterator[Path]:
    """Give a folder that can be written, created if need be; one created here goes again if the block fails.

    Raises
    ------
    InputError
        If it cannot be created or written.
    """
    path = Path(path)
    created = [folder for folder in (path, *path.parents) if not folder.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        _remove_empty(created)
        raise InputError(f"{path}: cannot create this folder ({_reason(problem)}); choose another --out") from problem
    try:
        _try_writing(path, path)
        yield path
    except BaseException:
        _remove_empty(created)
        raise


def _remove_empty(folders: list[Path]) -> None:
    for folder in folders:
        try:
            folder.rmdir()
        except OSError:  # not empty, or never made: what is in it was finished
            return


def _try_writing(folder: Path, named: Path) -> None:
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as problem:
        raise InputError(f"{named}: cannot be written ({_reason(problem)}); choose another place") from problem


def _flush(path: Path) -> None:
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def _reason(problem: OSError) -> str:
    return (problem.strerror or str(problem)).lower()
