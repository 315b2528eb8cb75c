"""Off-screen OpenGL: chosen before VTK is imported, and probed where a failure would end the process."""

from __future__ import annotations

import os
import subprocess
import sys

from sizeviz.errors import MissingDependencyError

PACKAGES = "libegl1 libgl1-mesa-dri"
"""Debian packages that draw without a screen."""

_PROBE = (
    "from sizeviz.scene.opengl import use_offscreen; use_offscreen()\n"
    "import pyvista\n"
    "plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16), lighting='none')\n"
    "plotter.show(auto_close=False)\n"
    "print(plotter.screenshot(return_img=True).shape)\n"
)


def has_display() -> bool:
    """Return whether this process can reach a screen, real or virtual."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def use_offscreen() -> None:
    """Make VTK draw through EGL where there is no display; call it before pyvista or VTK is imported."""
    if not has_display():
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


def probe(timeout: float = 60.0) -> str | None:
    """Draw a tiny picture in a process of its own.

    Without a GL library VTK ends the process by a segmentation fault, so nothing less than a process tells.

    Returns
    -------
    str or None
        None where pictures can be drawn, else one line that says what is missing and how to install it.
    """
    try:
        done = subprocess.run(
            [sys.executable, "-c", _PROBE], capture_output=True, text=True, timeout=timeout, check=False
        )
    except subprocess.TimeoutExpired:
        return f"drawing did not finish in {timeout:.0f} s; check the OpenGL driver"
    if done.returncode == 0 and "(16, 16, 3)" in done.stdout:
        return None
    return f"pictures need OpenGL, which does not work here; install it: apt-get install {PACKAGES}"


def require_gl() -> None:
    """Raise where no picture can be drawn.

    Raises
    ------
    MissingDependencyError
        With the line that installs what is missing.
    """
    problem = probe()
    if problem is not None:
        raise MissingDependencyError(problem)
