"""Reading, writing and running again and again: no file stays open, and memory does not grow."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from files.reader_seeds import grid_field, quad_mesh
from study.cases import valley_source

from sizeviz.errors import InputError
from sizeviz.files import read_field, read_mesh, write_field, write_mesh
from sizeviz.files.registry import FIELD_WRITERS, MESH_READERS
from sizeviz.scene import save_page, save_picture
from sizeviz.study import Study, run
from sizeviz.study.storage import StudyFile, read_study, write_study


def resident() -> float:
    """Return the megabytes in use, after what can be given back was."""
    for _ in range(2):
        gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE") / 1e6


def check(work: Callable[[], object], rounds: int, most: float) -> None:
    """Do the work to warm up, then often: as many descriptors as before, and less than ``most`` MB more."""
    for _ in range(max(rounds // 4, 2)):
        work()
    memory, files = resident(), len(os.listdir("/proc/self/fd"))
    for _ in range(rounds):
        work()
    assert len(os.listdir("/proc/self/fd")) == files
    assert resident() - memory < most


@pytest.mark.parametrize("suffix", sorted(FIELD_WRITERS))
def test_fields(tmp_path: Path, suffix: str) -> None:
    field = grid_field()
    check(lambda: read_field(write_field(tmp_path / f"f{suffix}", field)), 60, 4.0)


@pytest.mark.parametrize("suffix", sorted(set(MESH_READERS) - {".vtp"}))
def test_meshes(tmp_path: Path, suffix: str) -> None:
    mesh = quad_mesh()
    check(lambda: read_mesh(write_mesh(tmp_path / f"m{suffix}", mesh)), 60, 4.0)


@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".npz", ".msh", ".pos", ".png", ".sizeviz"])
def test_files_that_are_refused(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"f{suffix}"
    path.write_bytes(b"\x89PNG not at all" * 50)

    def refused() -> None:
        with contextlib.suppress(InputError):
            read_study(path) if suffix == ".sizeviz" else read_field(path)

    check(refused, 100, 4.0)


def test_studies(tmp_path: Path) -> None:
    content = StudyFile(run(Study(valley_source(33, 0.05, 0.15))))
    check(lambda: read_study(write_study(tmp_path / "s.sizeviz", content)), 30, 6.0)


def test_the_whole_pipeline(tmp_path: Path) -> None:
    def once() -> None:
        study = run(Study(valley_source(33, 0.05, 0.15)), ("gradient-limiting", "size-preserving", "guaranteed"))
        save_page(study, tmp_path / "p.html")
        save_picture(study, tmp_path / "p.svg")

    check(once, 5, 25.0)
