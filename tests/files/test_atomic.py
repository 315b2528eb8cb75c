"""Nothing is ever half-written."""

from __future__ import annotations

from pathlib import Path

import pytest

from sizeviz.errors import InputError
from sizeviz.files import output_folder, replacing, require_writable_file


def test_a_failure_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(RuntimeError, match="half-way"), replacing(path) as part:
        part.write_text("ne")
        raise RuntimeError("half-way")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_success_replaces_it_and_keeps_the_suffix_while_writing(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    with replacing(path) as part:
        assert part.suffix == ".txt" and part != path
        part.write_text("new")
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_an_output_folder_that_failed_is_gone_again(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), output_folder(tmp_path / "a" / "b"):
        raise RuntimeError
    assert not list(tmp_path.iterdir())


def test_an_output_folder_with_results_stays(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), output_folder(tmp_path / "a") as folder:
        (folder / "done").write_text("")
        raise RuntimeError
    assert (tmp_path / "a" / "done").exists()


def test_a_file_is_no_folder_nor_a_folder_a_file(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(InputError, match="cannot create this folder"), output_folder(file):
        pass
    with pytest.raises(InputError, match="cannot create this folder"), output_folder(file / "below"):
        pass
    with pytest.raises(InputError, match="is a folder"):
        require_writable_file(tmp_path)
    with pytest.raises(InputError, match="does not exist"):
        require_writable_file(tmp_path / "none" / "x.vtu")


def test_a_folder_that_refuses_files_is_found_out_beforehand() -> None:
    with pytest.raises(InputError, match="cannot be written"):
        require_writable_file("/proc/sizeviz.vtu")
