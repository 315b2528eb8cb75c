"""Damaged files: each gives a value or one line of error that names it, soon and in little memory."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from files.reader_fuzz import TABLES, Outcome, cases, on_alarm, run, timed, tried
from files.reader_seeds import seeds
from files.reader_structures import STRUCTURAL

CASES = 300


def test_every_sound_seed_is_read(tmp_path: Path) -> None:
    """Otherwise the fuzzer would only ever see the first check of a reader."""
    for seed in seeds():
        tables = [name for name, readers in TABLES.items() if seed.suffix in readers]
        outcomes = [tried(name, seed.suffix, seed.data, seed.beside, tmp_path) for name in tables]
        assert "value" in {outcome.kind for outcome in outcomes}, outcomes
        assert {outcome.kind for outcome in outcomes} <= {"value", "error"}, outcomes


def test_every_reader_has_a_seed() -> None:
    known = {suffix for readers in TABLES.values() for suffix in readers} - {".jpeg", ".tiff"}
    assert known == {seed.suffix for seed in seeds()}


def test_the_structure_of_every_kind_of_file_is_damaged() -> None:
    assert set(STRUCTURAL) == {seed.suffix for seed in seeds()} | {"formula"}


@pytest.mark.parametrize("share", range(3))
def test_damaged_files_never_crash_a_reader(tmp_path: Path, share: int) -> None:
    before = {alarm: signal.signal(alarm, on_alarm) for alarm in (signal.SIGALRM, signal.SIGPROF)}
    try:
        bad = bad_outcomes(tmp_path, share)
    finally:
        for alarm, handler in before.items():
            signal.signal(alarm, handler)
    assert not bad, bad


def bad_outcomes(folder: Path, share: int) -> list[tuple[int, Outcome]]:
    found = []
    for number, table, suffix, data, beside in cases(CASES, seed=7):
        if number % 3 == share:
            outcome = timed(table, suffix, data, beside, folder)
            if outcome.kind not in ("value", "error"):
                found.append((number, outcome))
    return found


def test_the_fuzzer_runs_in_worker_processes() -> None:
    outcomes = run(12, seed=3, workers=1)
    assert [number for number, _ in outcomes] == list(range(12))
    assert {outcome.kind for _, outcome in outcomes} <= {"value", "error"}
