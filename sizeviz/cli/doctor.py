"""``sizeviz doctor``: what is here, what is missing, and the line that installs it."""

from __future__ import annotations

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

    findings = [*_versions(), _cores(), _kernels(), _opengl(), _display(), _fonts(), *_extras()]
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


def _display() -> Finding:
    from sizeviz.scene.opengl import has_display

    return Finding("display", "there" if has_display() else "none; pictures are drawn off-screen")


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
