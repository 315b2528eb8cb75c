"""``sizeviz doctor``: what is here, what is missing, and the line that installs it."""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

WINDOW_PACKAGES: tuple[str, ...] = ("PyQt5", "QtPy", "pyvistaqt", "superqt", "pyqtgraph")
"""Distributions that the window is made of."""

EXTRAS: dict[str, tuple[tuple[str, ...], str]] = {
    "gmsh": (("gmsh",), "the gmsh mesher, --mesher gmsh"),
    "medical": (("nibabel", "pydicom"), "NIfTI and DICOM images"),
    "video": (("imageio_ffmpeg",), "films"),
}
"""The optional extras: the modules they bring, and what these are for."""

DISPLAY_PACKAGES = "xvfb xauth"
"""Debian packages that make a screen where there is none."""

LIBRARIES: dict[str, str] = {
    "libEGL.so.1": "libegl1",
    "libGL.so.1": "libgl1",
    "libX11.so.6": "libx11-6",
    "libX11-xcb.so.1": "libx11-xcb1",
    "libdbus-1.so.3": "libdbus-1-3",
    "libfontconfig.so.1": "libfontconfig1",
    "libfreetype.so.6": "libfreetype6",
    "libglib-2.0.so.0": "libglib2.0-0",
    "libgthread-2.0.so.0": "libglib2.0-0",
    "libxcb.so.1": "libxcb1",
    "libxcb-icccm.so.4": "libxcb-icccm4",
    "libxcb-image.so.0": "libxcb-image0",
    "libxcb-keysyms.so.1": "libxcb-keysyms1",
    "libxcb-randr.so.0": "libxcb-randr0",
    "libxcb-render.so.0": "libxcb-render0",
    "libxcb-render-util.so.0": "libxcb-render-util0",
    "libxcb-shape.so.0": "libxcb-shape0",
    "libxcb-shm.so.0": "libxcb-shm0",
    "libxcb-sync.so.1": "libxcb-sync1",
    "libxcb-util.so.1": "libxcb-util1",
    "libxcb-xfixes.so.0": "libxcb-xfixes0",
    "libxcb-xinerama.so.0": "libxcb-xinerama0",
    "libxcb-xkb.so.1": "libxcb-xkb1",
    "libxkbcommon.so.0": "libxkbcommon0",
    "libxkbcommon-x11.so.0": "libxkbcommon-x11-0",
}
"""Libraries that Qt's part for X11 links to, and the Debian packages that hold them."""

GMSH_SYSTEM_PACKAGES = "libglu1-mesa libxcursor1 libxft2 libxinerama1"
"""Debian packages that gmsh's wheel links to."""


@dataclass(frozen=True)
class Finding:
    """One thing looked at.

    Parameters
    ----------
    name, state : str
        What, and how it is.
    remedy : str
        The line that mends it; empty where nothing is wrong.
    needed : bool
        Whether the command line cannot do its work without it.
    """

    name: str
    state: str
    remedy: str = ""
    needed: bool = False


def doctor() -> int:
    """Say which versions are here, whether pictures can be drawn, and what is missing."""
    from sizeviz.cli.tables import console

    findings = [*_versions(), _cores(), _kernels(), _opengl(), _qt(), _display(), _fonts(), *_extras()]
    out = console()
    for finding in findings:
        mark = "[green]ok[/]" if not finding.remedy else "[red]missing[/]" if finding.needed else "[yellow]note[/]"
        out.print(f"{mark:<18} {finding.name:<22} {finding.state}", highlight=False, soft_wrap=True)
        if finding.remedy:
            out.print(f"{'':<31} {finding.remedy}", highlight=False, soft_wrap=True)
    return 1 if any(finding.needed and finding.remedy for finding in findings) else 0


def _versions() -> list[Finding]:
    from sizeviz.study.report import versions

    found = [Finding(name, state) for name, state in versions().items()]
    return [*found, *(Finding(name, _installed(name)) for name in WINDOW_PACKAGES)]


def _installed(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "not installed; only the window needs it"


def _cores() -> Finding:
    from sizeviz.threads import default_threads

    return Finding("cores", f"{default_threads()} usable")


def _kernels() -> Finding:
    from sizeviz.compiled import are_compiled

    state = "compiled" if are_compiled() else "not compiled yet: the next run or compare does it, in up to a minute"
    return Finding("kernels", state)


def _opengl() -> Finding:
    from sizeviz.scene.opengl import PACKAGES, probe

    if probe() is None:
        return Finding("OpenGL off-screen", "draws")
    return Finding("OpenGL off-screen", "does not work: no pictures", f"sudo apt-get install {PACKAGES}", needed=True)


def _qt() -> Finding:
    """Look for what Qt's part for X11 links to, without loading it: what is missing would end the process."""
    plugin = _x11_plugin()
    if plugin is None:
        return Finding("window", "PyQt5 is not installed; the command line does without", "pip install PyQt5")
    missing = missing_libraries(plugin)
    if not missing:
        return Finding("window", "Qt finds its libraries")
    known = sorted({LIBRARIES[name] for name in missing if name in LIBRARIES})
    state = f"cannot open: {', '.join(missing)} missing"
    remedy = f"sudo apt-get install {' '.join(known)}" if known else "install the packages that hold these libraries"
    return Finding("window", state, remedy)


def missing_libraries(file: Path) -> list[str]:
    """Return the libraries that a shared object links to and the system does not find; none where ``ldd`` is not."""
    if shutil.which("ldd") is None:
        return []
    said = subprocess.run(["ldd", str(file)], capture_output=True, text=True, check=False, timeout=30).stdout
    return sorted({line.split()[0] for line in said.splitlines() if line.rstrip().endswith("not found")})


def _x11_plugin() -> Path | None:
    spec = find_spec("PyQt5")
    root = next(iter(spec.submodule_search_locations or ()), None) if spec else None
    if root is None:
        return None
    plugins = Path(root).glob("Qt*/plugins/platforms/libqxcb.so")
    return next(plugins, Path(root) / "QtWidgets.abi3.so")


def _display() -> Finding:
    from sizeviz.scene.opengl import has_display

    if has_display():
        return Finding("display", "there")
    state = "none; pictures are drawn off-screen"
    if shutil.which("xvfb-run"):
        return Finding("display", f"{state}; xvfb-run sizeviz gui opens the window unseen")
    return Finding("display", f"{state}, the window needs one", f"sudo apt-get install {DISPLAY_PACKAGES}")


def _fonts() -> Finding:
    spec = find_spec("matplotlib")
    where = Path(spec.origin).parent / "mpl-data/fonts/ttf/DejaVuSans.ttf" if spec and spec.origin else None
    if where is not None and where.is_file():
        return Finding("fonts", "DejaVu Sans, from matplotlib")
    return Finding("fonts", "none for pictures", "pip install --force-reinstall matplotlib", needed=True)


def _extras() -> list[Finding]:
    findings = []
    for extra, (modules, purpose) in EXTRAS.items():
        if not all(find_spec(module) for module in modules):
            findings.append(Finding(f"extra {extra}", f"not installed: {purpose}", f"pip install 'sizeviz[{extra}]'"))
        elif extra == "gmsh" and not _imports("gmsh"):
            remedy = f"sudo apt-get install {GMSH_SYSTEM_PACKAGES}"
            findings.append(Finding("extra gmsh", f"cannot be loaded: {purpose}", remedy))
        else:
            findings.append(Finding(f"extra {extra}", f"installed: {purpose}"))
    return findings


def _imports(module: str) -> bool:
    """Return whether a module loads, tried in a process of its own."""
    return subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True, check=False).returncode == 0
