"""The first page is there before anything heavy is loaded."""

from __future__ import annotations

import platform
import subprocess
import sys

HEAVY = ("numba", "scipy", "pyvista", "vtkmodules", "matplotlib", "shapely")


def test_the_window_is_built_without_what_only_a_run_or_a_pane_needs(tmp_path) -> None:
    script = f"""
import sys
from sizeviz.app.launch import application
app = application()
from sizeviz.app.engine import PipelineEngine
from sizeviz.app.settings import Settings
from sizeviz.app.window import MainWindow
window = MainWindow(PipelineEngine(), Settings({str(tmp_path / "settings.ini")!r}))
print([name for name in {HEAVY!r} if name in sys.modules])
window.close()
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout.strip() == "[]", done.stderr


def test_what_is_loaded_ahead_waits_for_a_kernel_that_is_being_loaded(monkeypatch) -> None:
    """A run begun with the window loads its first kernel meanwhile; numba's registries bear one thread at a time."""
    from numba.core.compiler_lock import global_compiler_lock
    from numba.core.registry import cpu_target

    from sizeviz.app.prepare import _load

    locked = []
    for context in (cpu_target.typing_context, cpu_target.target_context):
        monkeypatch.setattr(context, "refresh", lambda: locked.append(global_compiler_lock.is_locked()))
    _load()
    assert locked == [True, True]


def test_threads_share_one_arena_once_the_application_is_made() -> None:
    script = """
import threading
from sizeviz.app.launch import application
app = application()
blocks = []
threads = [threading.Thread(target=lambda: blocks.append(bytearray(100_000))) for _ in range(4)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
import ctypes
libc = ctypes.CDLL(None)
libc.malloc_info.argtypes = [ctypes.c_int, ctypes.c_void_p]
libc.fopen.restype = ctypes.c_void_p
libc.fclose.argtypes = [ctypes.c_void_p]
import tempfile, os
with tempfile.NamedTemporaryFile() as file:
    stream = libc.fopen(file.name.encode(), b"w")
    libc.malloc_info(0, stream)
    libc.fclose(stream)
    print(open(file.name).read().count("<heap nr="))
"""
    if platform.libc_ver()[0] != "glibc":
        return
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout.strip() == "1", done.stderr
