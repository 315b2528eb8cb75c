"""What is shipped: one version everywhere, everything a wheel needs in it, a desktop entry that starts the window."""

from __future__ import annotations

import configparser
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from packaging.requirements import Requirement

import sizeviz

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


def test_one_version_everywhere() -> None:
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert sizeviz.__version__ == PROJECT["version"] == re.search(r"^version: (.+)$", citation, re.MULTILINE)[1]
    assert "## [Unreleased]" in (ROOT / "CHANGELOG.md").read_text("utf-8")


def test_the_desktop_entry_starts_the_window_and_has_an_icon() -> None:
    entry = configparser.ConfigParser(interpolation=None)
    entry.optionxform = str
    entry.read(ROOT / "packaging" / "sizeviz.desktop", "utf-8")
    desktop = entry["Desktop Entry"]
    assert desktop["Exec"].split()[0] in {**PROJECT["scripts"], **PROJECT["gui-scripts"]}
    assert desktop["Icon"] == "sizeviz" and desktop["Type"] == "Application"
    types = ElementTree.parse(ROOT / "packaging" / "sizeviz.xml").getroot()
    assert desktop["MimeType"].rstrip(";") == types[0].get("type")
    icon = ElementTree.parse(ROOT / "sizeviz" / "app" / "icons" / "sizeviz.svg").getroot()
    assert icon.get("viewBox") == "0 0 256 256"


def test_the_lock_fits_the_project() -> None:
    lines = (ROOT / ".ci" / "lock.txt").read_text("utf-8").splitlines()[1:]
    locked = {Requirement(line).name.lower(): Requirement(line) for line in lines}
    extras = PROJECT["optional-dependencies"].values()
    wanted = [*PROJECT["dependencies"], *(name for extra in extras for name in extra)]
    checked = 0
    for requirement in map(Requirement, wanted):
        pinned = locked.get(requirement.name.lower().replace("_", "-"))
        if pinned is not None:
            assert requirement.specifier.contains(next(iter(pinned.specifier)).version), requirement
            checked += 1
    assert checked > 25


@pytest.mark.slow
def test_the_wheel_holds_all_that_is_not_python(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(tmp_path), str(ROOT)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    wheel = next(tmp_path.glob("*.whl"))
    names = set(zipfile.ZipFile(wheel).namelist())
    package = ROOT / "sizeviz"
    for path in package.rglob("*"):
        if path.is_file() and "__pycache__" not in path.parts:
            assert path.relative_to(ROOT).as_posix() in names
    shared = {name.split(".data/data/")[1] for name in names if ".data/data/" in name}
    assert shared == {
        "share/applications/sizeviz.desktop",
        "share/mime/packages/sizeviz.xml",
        "share/icons/hicolor/scalable/apps/sizeviz.svg",
    }
    assert not [name for name in names if name.startswith("tests")]
