"""Writing that leaves either the whole new file or what was there before."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


_REASONS = {
    errno.ENOSPC: "the disk is full; free some space or write elsewhere",
    errno.EDQUOT: "your disk quota is used up; free some space or write elsewhere",
    errno.EFBIG: "the file would be larger than is allowed here; write elsewhere",
    errno.EACCES: "permission denied; choose a folder of your own",
    errno.EPERM: "not permitted; choose a folder of your own",
    errno.EROFS: "the file system is read-only; choose another place",
    errno.ENOENT: "the folder does not exist; create it first",
    errno.ENOTDIR: "a part of the path is a file, not a folder; check the path",
    errno.EISDIR: "it is a folder; name a file in it",
    errno.ENAMETOOLONG: "the name is too long; choose a shorter one",
    errno.ELOOP: "the symbolic links go round in a circle; choose another place",
}


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Give a temporary sibling to write to; it takes the name of ``path`` if the block ends well, else it goes.

    Whoever reads ``path`` meanwhile, or after a crash at any moment, finds the old file or the new one, whole: the
    content is on the disk before the name is. The sibling keeps the suffix, because writers choose the format by it.
    A symbolic link is followed, and the permissions of the old file are kept.

    Raises
    ------
    InputError
        If the place cannot be written.
    """
    named = Path(path)
    part: Path | None = None
    try:
        target = Path(os.path.realpath(named))
        if target.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        part = target.with_name(f".{target.stem[:80]}.{secrets.token_hex(8)}.part{target.suffix[:20]}")
        part.touch(exist_ok=False)
        yield part
        _keep_mode(target, part)
        _flush(part)
        os.replace(part, target)
        part = None
        _flush(target.parent)
    except OSError as problem:
        raise write_error(named, problem) from problem
    finally:
        if part is not None:
            with contextlib.suppress(OSError):
                part.unlink(missing_ok=True)


def write_chunks(path: str | Path, chunks: Iterable[bytes]) -> Path:
    """Write chunks of bytes one after the other, whole or not at all, and return the path.

    Raises
    ------
    InputError
        If the place cannot be written.
    """
    with replacing(path) as part, part.open("wb") as file:
        for chunk in chunks:
            file.write(chunk)
    return Path(path)


def write_error(path: Path, problem: OSError) -> InputError:
    """Return the one-line error of a failed write: the path, what is wrong and the remedy."""
    reason = _REASONS.get(problem.errno or 0) or f"{_reason(problem)}; choose another place"
    return InputError(f"{path}: cannot be written ({reason})")


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
        raise write_error(named, problem) from problem


def _keep_mode(old: Path, new: Path) -> None:
    """Give the new file the permissions of the one that it replaces."""
    with contextlib.suppress(FileNotFoundError):
        new.chmod(old.stat().st_mode & 0o7777)


def _flush(path: Path) -> None:
    """Have the content of a file or folder on the disk before what comes next."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _reason(problem: OSError) -> str:
    return (problem.strerror or str(problem)).lower()
