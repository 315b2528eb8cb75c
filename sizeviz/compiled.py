"""Compiled kernels: whether this machine has them, how to make them all at once, and how stale ones are dropped.

Numba keeps compiled code beside each source file and drops it when that very file changes. Code that was inlined from
another file is not noticed, so the files are fingerprinted here together with all the kernels they call.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import subprocess
import sys
import time
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.threads import default_threads

if TYPE_CHECKING:
    from collections.abc import Iterable

PACKAGE = Path(__file__).parent
"""Folder of sizeviz's own code."""

PART_SECONDS: dict[str, float] = {"mesh": 40.0, "smooth": 35.0, "field": 12.0, "judge": 8.0}
"""About how long each part of the rehearsal takes to compile, the longest first."""

POLL_SECONDS = 0.05
"""How often the processes are looked at."""

_NULL = subprocess.DEVNULL
_IMPORTED = re.compile(r"^\s*(?:from|import)\s+(sizeviz[\w.]*)", re.MULTILINE)
_DECORATED = re.compile(r"^\s*from numba import|^\s*import numba|_jit import", re.MULTILINE)


def are_compiled() -> bool:
    """Return whether every kernel that the pipeline needs was compiled here, from the sources as they are now."""
    return _noted().get("compiled") == _overall(_fingerprints())


def compile_kernels(monitor: Monitor = SILENT) -> None:
    """Compile what the pipeline needs by running it on a tiny study, and note it for the next time.

    The parts of the pipeline are compiled in processes side by side; then the whole is run here, from their results.

    Raises
    ------
    Cancelled
        If the monitor says so; what was compiled until then is kept.
    """
    from sizeviz.study.rehearsal import rehearsed

    drop_stale()
    _play_parts(SubMonitor(monitor, 0.0, 0.95))
    rehearsed(SubMonitor(_Prefixed(monitor), 0.95, 1.0))
    fingerprints = _fingerprints()
    _note({"files": fingerprints, "compiled": _overall(fingerprints)})


def _play_parts(monitor: Monitor) -> None:
    """Let each part of the rehearsal compile its kernels in a process of its own, as many at once as there are cores.

    A part that fails is no matter: the rehearsal that follows meets the same trouble, and reports it.
    """
    waiting, done = list(PART_SECONDS), 0.0
    running: dict[str, tuple[subprocess.Popen[bytes], float]] = {}
    total = sum(PART_SECONDS.values())
    try:
        while waiting or running:
            while waiting and len(running) < default_threads():
                part = waiting.pop(0)
                command = [sys.executable, "-m", "sizeviz.study.rehearsal", part]
                process = subprocess.Popen(command, stdin=_NULL, stdout=_NULL, stderr=_NULL)
                running[part] = process, time.monotonic()
            for part in [part for part, (process, _) in running.items() if process.poll() is not None]:
                del running[part]
                done += PART_SECONDS[part]
            now = time.monotonic()
            # A running part's bar nears its end without reaching it.
            under_way = sum(_share(now - began, PART_SECONDS[part]) for part, (_, began) in running.items())
            monitor.step((done + under_way) / total, f"compiling, once only: {', '.join(running) or 'done'}")
            time.sleep(POLL_SECONDS)
    finally:
        for process, _ in running.values():
            process.kill()
            process.wait()


def _share(elapsed: float, expected: float) -> float:
    return expected * elapsed / (elapsed + 0.3 * expected)


def drop_stale() -> list[str]:
    """Delete compiled code that was made from other sources than those it now stands for.

    Returns
    -------
    list of str
        The modules that will be compiled anew.
    """
    noted, now = _noted().get("files", {}), _fingerprints()
    stale = [name for name, print_ in now.items() if name in noted and noted[name] != print_]
    for name in stale:
        source = PACKAGE.joinpath(*name.split(".")[1:]).with_suffix(".py")
        for compiled in source.parent.joinpath("__pycache__").glob(f"{source.stem}.*.nb[ic]"):
            compiled.unlink(missing_ok=True)
    if now != noted:
        _note({"files": now, "compiled": _noted().get("compiled")})
    return stale


def prepared(monitor: Monitor) -> Monitor:
    """Compile the kernels if this machine has not yet; return what is left of the monitor for the work itself.

    The compiler holds the interpreter for seconds, so it works in processes of its own: on the worker of the window it
    would freeze the window.

    Raises
    ------
    Cancelled
        If the monitor says so; what was compiled until then is kept.
    """
    if are_compiled():
        return monitor
    compile_kernels(SubMonitor(monitor, 0.0, 0.8))
    return SubMonitor(monitor, 0.8, 1.0)


class _Prefixed:
    """A monitor that says what its steps are good for."""

    def __init__(self, monitor: Monitor) -> None:
        self._monitor = SubMonitor(monitor, 0.0, 1.0)

    def step(self, fraction: float, message: str = "") -> None:
        """Pass the step on."""
        self._monitor.step(fraction, f"compiling, once only: {message}" if message else "")


@cache
def _fingerprints() -> dict[str, str]:
    """Return a hash for every module with kernels, over its text and that of all it imports from sizeviz."""
    texts = {_name(path): path.read_text(encoding="utf-8") for path in sorted(PACKAGE.rglob("*.py"))}
    calls = {name: _own_imports(text, texts) for name, text in texts.items()}
    with_kernels = {name for name, text in texts.items() if _DECORATED.search(text)}
    found = {}
    for name in sorted(with_kernels):
        digest = hashlib.sha256()
        for other in sorted(_closure(name, calls) & (with_kernels | {name})):
            digest.update(texts[other].encode())
        found[name] = digest.hexdigest()[:16]
    return found


def _own_imports(text: str, known: Iterable[str]) -> set[str]:
    return {name for name in _IMPORTED.findall(text) if name in known}


def _closure(name: str, calls: dict[str, set[str]]) -> set[str]:
    reached, waiting = set(), [name]
    while waiting:
        current = waiting.pop()
        if current not in reached:
            reached.add(current)
            waiting.extend(calls.get(current, ()))
    return reached


def _name(path: Path) -> str:
    return ".".join(("sizeviz", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")


def _overall(fingerprints: dict[str, str]) -> str:
    machine = (platform.python_version(), platform.machine(), platform.node(), version("numba"), version("llvmlite"))
    return hashlib.sha256(json.dumps([fingerprints, machine]).encode()).hexdigest()[:16]


def _notebook() -> Path:
    """Return the file of notes: beside the compiled code where that can be written, else in the user's cache."""
    beside = PACKAGE / "__pycache__"
    if os.access(beside if beside.exists() else PACKAGE, os.W_OK):
        beside.mkdir(exist_ok=True)
        return beside / "kernels.json"
    from platformdirs import user_cache_path

    return user_cache_path("sizeviz", ensure_exists=True) / "kernels.json"


def _noted() -> dict[str, Any]:
    try:
        noted = json.loads(_notebook().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return noted if isinstance(noted, dict) else {}


def _note(content: dict[str, object]) -> None:
    from sizeviz.files import replacing

    with replacing(_notebook()) as part:
        part.write_text(json.dumps(content), encoding="utf-8")
