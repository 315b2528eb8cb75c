"""Stale compiled code is found out, through any number of imports, and nothing else is thrown away."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from sizeviz import compiled
from sizeviz.errors import Cancelled

LOW = "from numba import njit\n\n@njit(cache=True)\ndef low(x):\n    return x\n"
HIGH = "from numba import njit\nfrom sizeviz.a._low import low\n\n@njit(cache=True)\ndef high(x):\n    return low(x)\n"
ALONE = "from numba import njit\n\n@njit(cache=True)\ndef alone(x):\n    return x\n"


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    root = tmp_path / "sizeviz"
    for name, text in {"a/_low.py": LOW, "b/_high.py": HIGH, "b/_alone.py": ALONE, "b/plain.py": "x = 1\n"}.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        if "njit" not in text:
            continue
        cache = path.parent / "__pycache__"
        cache.mkdir(exist_ok=True)
        (cache / f"{path.stem}.f-1.py311.nbi").write_text("")
        (cache / f"{path.stem}.f-1.py311.1.nbc").write_text("")
    monkeypatch.setattr(compiled, "PACKAGE", root)
    compiled._fingerprints.cache_clear()
    yield root
    compiled._fingerprints.cache_clear()


def left(root: Path) -> set[str]:
    return {path.name.split(".")[0] for path in root.rglob("*.nb[ic]")}


def changed(root: Path, name: str) -> None:
    path = root / name
    path.write_text(path.read_text() + "# another word\n")
    compiled._fingerprints.cache_clear()


def test_the_first_look_drops_nothing(package: Path) -> None:
    assert compiled.drop_stale() == []
    assert left(package) == {"_low", "_high", "_alone"}


def test_a_change_reaches_the_callers_and_nobody_else(package: Path) -> None:
    compiled.drop_stale()
    changed(package, "a/_low.py")
    assert compiled.drop_stale() == ["sizeviz.a._low", "sizeviz.b._high"]
    assert left(package) == {"_alone"}
    assert compiled.drop_stale() == [], "noted"


def test_a_change_of_a_caller_leaves_what_it_calls(package: Path) -> None:
    compiled.drop_stale()
    changed(package, "b/_high.py")
    compiled.drop_stale()
    assert left(package) == {"_low", "_alone"}


def test_compiled_means_from_these_very_sources(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    steps: list[tuple[float, str]] = []

    class Recording:
        def step(self, fraction: float, message: str = "") -> None:
            steps.append((fraction, message))

    from sizeviz.study import rehearsal

    monkeypatch.setattr(compiled, "_play_parts", lambda monitor: monitor.step(1.0, "in processes"))
    monkeypatch.setattr(rehearsal, "rehearsed", lambda monitor: monitor.step(0.5, "size preserving: mesh"))
    assert not compiled.are_compiled()
    compiled.compile_kernels(Recording())
    assert compiled.are_compiled()
    assert steps == [(0.95, "in processes"), (pytest.approx(0.975), "compiling, once only: size preserving: mesh")]
    changed(package, "b/_alone.py")
    assert not compiled.are_compiled()


def test_notes_that_are_no_json_count_as_none(package: Path) -> None:
    compiled.drop_stale()
    (package / "__pycache__" / "kernels.json").write_text("{")
    assert not compiled.are_compiled()
    assert compiled.drop_stale() == []


def test_parts_run_in_processes_and_their_failure_is_left_to_the_rehearsal(monkeypatch: pytest.MonkeyPatch) -> None:
    steps: list[tuple[float, str]] = []

    class Recording:
        def step(self, fraction: float, message: str = "") -> None:
            steps.append((fraction, message))

    monkeypatch.setattr(compiled, "PART_SECONDS", {"judge": 1.0, "no such part": 1.0})
    compiled._play_parts(Recording())
    assert steps[-1][0] == 1.0
    assert any("judge" in message for _, message in steps)


def test_cancelling_ends_the_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []

    class Recorded(subprocess.Popen):
        def __init__(self, *args: object, **kwargs: object) -> None:
            super().__init__(*args, **kwargs)
            started.append(self)

    class Stop:
        def step(self, fraction: float, message: str = "") -> None:
            raise Cancelled

    monkeypatch.setattr(compiled.subprocess, "Popen", Recorded)
    with pytest.raises(Cancelled):
        compiled._play_parts(Stop())
    assert started
    assert all(process.returncode == -9 for process in started)


def test_the_parts_are_those_of_the_rehearsal() -> None:
    from sizeviz.study.rehearsal import PARTS

    assert list(compiled.PART_SECONDS) == list(PARTS)


@pytest.mark.parametrize("part", ["field", "mesh", "smooth", "judge"])
def test_each_part_runs(part: str) -> None:
    from sizeviz.study.rehearsal import PARTS

    assert PARTS[part]() is None


def test_the_rehearsal_plays_fields_on_grids_and_on_triangulations(monkeypatch: pytest.MonkeyPatch) -> None:
    import sizeviz.sizing
    from sizeviz.study.rehearsal import PARTS

    grids, whole = [], sizeviz.sizing.preserved

    def seen(field, *rest, **options):
        grids.append(field.background.grid is not None)
        return whole(field, *rest, **options)

    monkeypatch.setattr(sizeviz.sizing, "preserved", seen)
    PARTS["field"]()
    assert set(grids) == {True, False}
