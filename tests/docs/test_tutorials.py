"""The tutorials run, as Python and as the notebooks that they are offered as."""

from __future__ import annotations

import os
import runpy
import shutil
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

FOLDER = Path(__file__).parents[2] / "docs" / "tutorials"
TUTORIALS = sorted(FOLDER.glob("lesson_*.py"))


def test_there_is_a_tutorial_for_every_lesson():
    assert [path.stem.split("_", 2)[2] for path in TUTORIALS] == [
        "line", "ball", "two_methods", "adaptive", "own_data"
    ]  # fmt: skip


@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.stem)
def test_a_tutorial_runs_as_python(path, capsys):
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    try:
        runpy.run_path(str(path), run_name="__main__")
        assert plt.get_fignums(), "something to look at"
    finally:
        plt.close("all")
    assert capsys.readouterr().out and "assert " in path.read_text("utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.stem)
def test_a_tutorial_runs_as_a_notebook(path, tmp_path, monkeypatch):
    from sphinx_gallery.notebook import python_to_jupyter_cli

    root = str(FOLDER.parents[1])
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, (root, os.environ.get("PYTHONPATH")))))
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")  # what a notebook has
    script = shutil.copy(path, tmp_path)
    python_to_jupyter_cli([str(script)])
    notebook = nbformat.read(tmp_path / f"{path.stem}.ipynb", as_version=4)
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    data = [output["data"] for cell in notebook.cells for output in cell.get("outputs", ()) if "data" in output]
    assert any("image/png" in entry for entry in data)
