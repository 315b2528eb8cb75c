"""The package itself: a quick import, and a public API that resolves."""

from __future__ import annotations

import subprocess
import sys

import pytest

import sizeviz

HEAVY = ("numba", "scipy", "vtkmodules", "pyvista", "matplotlib", "qtpy", "PyQt5", "gmsh", "cyclopts")


def run_python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout


def test_import_pulls_in_nothing_heavy() -> None:
    loaded = run_python("import sizeviz, sys; print(*sys.modules)").split()
    assert "sizeviz" in loaded
    assert not {name.split(".")[0] for name in loaded} & set(HEAVY)


@pytest.mark.parametrize("name", sizeviz.__all__)
def test_every_public_name_resolves(name: str) -> None:
    assert getattr(sizeviz, name) is not None
    assert name in dir(sizeviz)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = sizeviz.nonsense
