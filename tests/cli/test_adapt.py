"""``sizeviz adapt`` and ``sizeviz paper``: what they write, say and refuse."""

from __future__ import annotations

import json

import pytest

from sizeviz.cli import run_command_line
from sizeviz.cli.app import app

ADAPT = ["adapt", "valley", "--mesher", "decomposition", "--cells", "3", "--iterations", "3"]


def test_adapt_writes_meshes_record_and_plot(tmp_path, capsys):
    out = tmp_path / "process"
    assert run_command_line([*ADAPT, "--out", str(out)]) == 0
    said = capsys.readouterr().out
    record = json.loads((out / "evolution.json").read_text())
    count = len(record["iterations"])
    assert sorted(path.name for path in out.iterdir()) == sorted(
        ["evolution.json", "evolution.png", "evolution.svg", *(f"mesh-{k:03d}.vtu" for k in range(count))]
    )
    assert count >= 2
    assert record["options"]["method"] == "size-preserving"
    assert ("not converged" in said) != record["converged"]


def test_adapt_refuses_another_process_in_one_line(tmp_path, capsys):
    assert run_command_line([*ADAPT, "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    assert run_command_line([*ADAPT, "--out", str(tmp_path), "--alpha", "1"]) == 2
    said = capsys.readouterr().err
    assert "another adaptive process" in said and said.count("\n") == 1


@pytest.mark.parametrize(
    "wrong", [["--cells", "0"], ["--iterations", "0"], ["--limit", "0"], ["--guarantee", "--method", "none"]]
)
def test_adapt_refuses_what_is_out_of_range(wrong, tmp_path, capsys):
    out = tmp_path / "never"
    assert run_command_line([*ADAPT, "--out", str(out), *wrong]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not out.exists()


def test_paper_is_understood_and_refuses_bad_numbers(tmp_path, capsys):
    command, bound, *_ = app.parse_args(["paper", "--out", str(tmp_path), "--iterations", "7"], exit_on_error=False)
    assert command.__name__ == "paper"
    assert bound.arguments["choices"].iterations == 7
    assert run_command_line(["paper", "--out", str(tmp_path / "never"), "--iterations", "0"]) == 2
    assert not (tmp_path / "never").exists()
