"""Tiers, and what they need: plain tests need nothing; `gl` draws off-screen; `display` opens windows; `gmsh` meshes;
`browser` opens pages.

A test whose tier is not there is skipped; under CI nothing may be missing, so there every skip is a failure.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from functools import cache
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Generator

# Before anything imports VTK: pictures are drawn without an X server, whether or not pytest-xvfb starts one later.
if not os.environ.get("DISPLAY"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
os.environ.setdefault("QT_API", "pyqt5")
os.environ.setdefault("MPLBACKEND", "Agg")

IN_CI = bool(os.environ.get("CI"))

PROBE = "import pyvista as pv; p = pv.Plotter(off_screen=True, window_size=(8, 8)); p.show(auto_close=False); p.close()"


@cache
def has_gl() -> bool:
    """Whether VTK can draw off-screen; probed in a process of its own, because VTK crashes without OpenGL."""
    probe = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, timeout=120)
    return probe.returncode == 0


def has_display() -> bool:
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def has_gmsh() -> bool:
    return importlib.util.find_spec("gmsh") is not None


BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


def has_browser() -> bool:
    return BROWSER is not None


TIERS = {
    "gl": (has_gl, "no off-screen OpenGL; install libegl1 libgl1-mesa-dri"),
    "display": (has_display, "no display; install xvfb"),
    "gmsh": (has_gmsh, "no gmsh; pip install 'sizeviz[gmsh]'"),
    "browser": (has_browser, "no browser; install chromium"),
}


@pytest.fixture
def browser() -> str:
    """Return what starts the browser; only for tests marked with it."""
    assert BROWSER is not None
    return BROWSER


def pytest_runtest_setup(item: pytest.Item) -> None:
    for tier, (available, remedy) in TIERS.items():
        if item.get_closest_marker(tier) is not None and not available():
            pytest.skip(remedy)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if IN_CI and report.skipped and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"skipped, which CI does not allow: {report.longrepr}"
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    report = yield
    if IN_CI and report.skipped:
        report.outcome = "failed"
        report.longrepr = f"skipped, which CI does not allow: {report.longrepr}"
    return report


def pytest_configure(config: pytest.Config) -> None:
    """Never test compiled code that was made from other sources; the workers of xdist start after this."""
    if not hasattr(config, "workerinput"):
        from sizeviz.compiled import drop_stale

        drop_stale()
