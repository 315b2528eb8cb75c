"""Autosaves: gone when all is well, found when the program was not able to say goodbye."""

from __future__ import annotations

import os
import random
from pathlib import Path

import pytest
from study.cases import valley_source
from study.killed_saves import killed

from sizeviz.errors import InputError
from sizeviz.study import Study
from sizeviz.study.storage import StudyFile, write_study
from sizeviz.study.storage.autosave import Autosave, leftovers


def content() -> StudyFile:
    return StudyFile(Study(valley_source(5)), view={"dark": True})


def test_a_program_that_ends_well_leaves_nothing(tmp_path: Path) -> None:
    with Autosave(tmp_path / "autosave") as autosave:
        autosave.save(content(), tmp_path / "a.sizeviz")
        assert autosave.path.exists()
        assert leftovers(tmp_path / "autosave") == []
        autosave.discard()
        assert not autosave.path.exists()
        autosave.save(content())
    assert list((tmp_path / "autosave").iterdir()) == []


def test_killed_programs_leave_their_studies(tmp_path: Path) -> None:
    assert list(killed(12, tmp_path, random.Random(1))) == list(range(1, 13))


def test_several_windows_do_not_disturb_each_other(tmp_path: Path) -> None:
    with Autosave(tmp_path) as one, Autosave(tmp_path) as two:
        one.save(content())
        two.save(content())
        assert leftovers(tmp_path) == []
    assert list(tmp_path.iterdir()) == []


def test_a_study_whose_lock_is_gone_is_a_leftover_too(tmp_path: Path) -> None:
    path = write_study(tmp_path / "1-ab.sizeviz", content())
    (tmp_path / ".1-ab.0123.part.sizeviz").write_bytes(b"half")
    (tmp_path / "2-cd.lock").write_bytes(b"")
    older = write_study(tmp_path / "3-ef.sizeviz", content())
    os.utime(older, (1, 1))
    found = leftovers(tmp_path)
    assert [leftover.path for leftover in found] == [path, older], "the newest first"
    assert sorted(tmp_path.iterdir()) == [path, older], "halves and lonely locks are cleared away"
    assert dict(found[0].read().view) == {"dark": True}
    found[0].remove()
    assert [leftover.path for leftover in leftovers(tmp_path)] == [older]


def test_no_folder_no_leftovers_and_a_file_is_no_folder(tmp_path: Path) -> None:
    assert leftovers(tmp_path / "none") == []
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        Autosave(tmp_path / "file" / "autosave")
