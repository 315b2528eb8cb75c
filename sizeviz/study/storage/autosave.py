"""Autosaves: a study under way, kept beside the others until its program ends well, and found again if it did not."""

from __future__ import annotations

import contextlib
import fcntl
import glob
import os
import secrets
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from sizeviz.errors import InputError
from sizeviz.files.atomic import write_error
from sizeviz.study.storage.study_file import SUFFIX, StudyFile, read_study, write_study

if TYPE_CHECKING:
    from types import TracebackType

_LOCK = ".lock"


def autosave_folder() -> Path:
    """Return the folder for autosaves of this user, which need not exist yet."""
    from platformdirs import user_state_path

    return Path(user_state_path("sizeviz")) / "autosave"


class Autosave:
    """The autosave of one window. While it is open its lock is held; a killed program cannot hold it any longer.

    Use it as a context manager, or call ``close``: a program that ends well leaves nothing.

    Parameters
    ----------
    folder : path-like, optional
        Where autosaves are kept; made if need be. By default ``autosave_folder()``.

    Raises
    ------
    InputError
        If the folder cannot be made or written.
    """

    def __init__(self, folder: str | Path | None = None) -> None:
        self.folder = autosave_folder() if folder is None else Path(folder)
        name = f"{os.getpid()}-{secrets.token_hex(6)}"
        self.path = self.folder / f"{name}{SUFFIX}"
        self._lock_path = self.folder / f"{name}{_LOCK}"
        try:
            self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            self._lock: BinaryIO | None = _locked(self._lock_path)
        except OSError as problem:
            raise write_error(self._lock_path, problem) from problem

    def save(self, content: StudyFile, origin: str | Path | None = None) -> Path:
        """Replace the autosave, whole or not at all.

        Parameters
        ----------
        content : StudyFile
            The study as it is now; the source is always embedded.
        origin : path-like, optional
            The study file that it belongs to, if it was ever saved.

        Raises
        ------
        InputError
            If it cannot be written; the last autosave stays.
        """
        absolute = None if origin is None else os.path.abspath(origin)
        return write_study(self.path, replace(content, origin=absolute))

    def discard(self) -> None:
        """Remove the autosave: the study was saved, or its changes were given up."""
        self.path.unlink(missing_ok=True)

    def leave(self) -> None:
        """Let go of the lock and leave the autosave to be found the next time: there are unsaved changes."""
        if self._lock is not None:
            self._lock_path.unlink(missing_ok=True)
            self._lock.close()
            self._lock = None

    def close(self) -> None:
        """Remove the autosave and let go of the lock."""
        if self._lock is not None:
            self.discard()
            self._lock_path.unlink(missing_ok=True)
            self._lock.close()
            self._lock = None

    def __enter__(self) -> Autosave:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


@dataclass(frozen=True)
class Leftover:
    """The autosave of a program that did not end well.

    Parameters
    ----------
    path : Path
        The autosave.
    modified : float
        When it was written, in seconds since 1970.
    """

    path: Path
    modified: float

    def read(self) -> StudyFile:
        """Return the study.

        Raises
        ------
        InputError
            As ``read_study``.
        """
        return read_study(self.path)

    def remove(self) -> None:
        """Remove the autosave: it was recovered, or is not wanted."""
        for path in (self.path, self.path.with_suffix(_LOCK)):
            path.unlink(missing_ok=True)


def leftovers(folder: str | Path | None = None) -> list[Leftover]:
    """Return the autosaves whose programs are gone, the newest first; those of running ones are left alone.

    What such programs left besides, half-written files and locks without an autosave, is removed.

    Raises
    ------
    InputError
        If the folder cannot be read.
    """
    folder = autosave_folder() if folder is None else Path(folder)
    if not folder.is_dir():
        return []
    found = []
    try:
        for stem in sorted({path.stem for suffix in (_LOCK, SUFFIX) for path in folder.glob(f"[0-9]*{suffix}")}):
            lock, study = folder / f"{stem}{_LOCK}", folder / f"{stem}{SUFFIX}"
            if _is_held(lock):
                continue
            for part in folder.glob(f".{glob.escape(stem)}.*.part{SUFFIX}"):
                part.unlink(missing_ok=True)
            if study.exists():
                found.append(Leftover(study, study.stat().st_mtime))
            else:
                lock.unlink(missing_ok=True)
    except OSError as problem:
        raise InputError(f"cannot look for autosaves in {folder}: {problem.strerror}; check the folder") from problem
    return sorted(found, key=lambda leftover: -leftover.modified)


def _locked(path: Path) -> BinaryIO:
    """Return a new lock file, held; again if another program took it for a leftover before it was held."""
    while True:
        file = path.open("wb")
        fcntl.flock(file, fcntl.LOCK_EX)
        with contextlib.suppress(FileNotFoundError):
            if path.stat().st_ino == os.fstat(file.fileno()).st_ino:
                return file
        file.close()


def _is_held(lock: Path) -> bool:
    """Whether a running program holds a lock: the system lets go of it when the program ends, however it ends."""
    with contextlib.suppress(FileNotFoundError), lock.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False
