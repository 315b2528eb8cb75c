"""Bad input: one line that names it and the remedy, exit code 2, and nothing left behind."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sizeviz.cli import run_command_line
from sizeviz.files import read_mesh


def refused(arguments: list[str], capsys: pytest.CaptureFixture, code: int = 2) -> str:
    """Return what is said, after checking that it is one line on standard error alone."""
    assert run_command_line(arguments) == code
    printed = capsys.readouterr()
    assert not printed.out
    # on a fresh machine the kernels are compiled first, which has a line of its own
    said = [line for line in printed.err.splitlines(keepends=True) if "compiling the kernels" not in line]
    assert len(said) == 1 and said[0].startswith("sizeviz: "), printed.err
    assert "Traceback" not in printed.err
    return said[0]


def array(value: object) -> Callable[[Path], None]:
    return lambda path: np.save(path, value)


def raw(content: bytes) -> Callable[[Path], None]:
    return lambda path: path.write_bytes(content)


def with_value(value: float) -> np.ndarray:
    sizes = np.full((5, 5), 0.1)
    sizes[2, 3] = value
    return sizes


FIELDS = {
    "missing": (lambda path: None, "no such"),
    "corrupt": (raw(b"\x93NUMPY\x01\x00junk"), "f.npy"),
    "empty file": (raw(b""), "empty"),
    "empty array": (array(np.empty((0, 0))), "f.npy"),
    "NaN": (array(with_value(np.nan)), "NaN"),
    "infinite": (array(with_value(np.inf)), "infinite"),
    "zero": (array(with_value(0.0)), "not above zero"),
    "negative": (array(with_value(-0.1)), "not above zero"),
    "one row": (array(np.ones((1, 9))), "2-D array"),
    "three dimensions": (array(np.ones((3, 3, 3))), "2-D array"),
    "text": (array(np.array([["a", "b"], ["c", "d"]])), "f.npy"),
    "pickle": (array(np.array([[{}, {}], [{}, {}]], dtype=object)), "f.npy"),
}


@pytest.mark.parametrize("case", FIELDS)
def test_fields_that_cannot_be_used(case: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    make, words = FIELDS[case]
    make(tmp_path / "f.npy")
    out = tmp_path / "out"
    said = refused(["compare", str(tmp_path / "f.npy"), "--out", str(out)], capsys)
    assert words in said
    assert "f.npy" in said
    assert not out.exists()


FORMULAS = {
    "unknown name": ("0.1 + z", "z"),
    "unknown function": ("exec(1)", "exec"),
    "code": ("__import__('os').system('true')", "formula"),
    "attribute": ("x.__class__", "formula"),
    "subscript": ("x[0]", "formula"),
    "lambda": ("(lambda: 0.1)()", "formula"),
    "statement": ("import os", "formula"),
    "nothing": ("", "formula"),
    "torn": ("0.1 + (x", "formula"),
    "negative": ("x - 2", "above"),
    "zero": ("0", "above"),
    "not a number": ("0.1 + log(x - 5)", "formula"),
    "huge": ("9**9**9**9**9", "formula"),
    "beyond all measure": ("1e300", "beyond 1e+60"),
}


@pytest.mark.parametrize("case", FORMULAS)
def test_formulas_that_cannot_be_used(case: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    formula, words = FORMULAS[case]
    out = tmp_path / "out"
    said = refused(["run", f"expr:{formula}", "--out", str(out)], capsys)
    assert words in said
    assert not out.exists()


OPTIONS = {
    "alpha zero": (["--alpha", "0"], "alpha is 0"),
    "alpha negative": (["--alpha", "-1"], "alpha is -1"),
    "alpha NaN": (["--alpha", "nan"], "alpha is nan"),
    "alpha huge": (["--alpha", "1e300"], "alpha is 1e+300; give 1e-06 to 1e+06"),
    "beta tiny": (["--beta", "1e-9"], "beta is 1e-09; give 1e-06 to 1e+06"),
    "alpha a word": (["--alpha", "two"], "two"),
    "beta zero": (["--beta", "0"], "beta is 0"),
    "epsilon zero": (["--epsilon", "0"], "epsilon is 0"),
    "mesh scale": (["--mesh-scale", "0"], "mesh scale is 0"),
    "threads": (["--threads", "0"], "threads is 0"),
    "seed": (["--seed", "-4"], "seed is -4"),
    "method": (["--mesher", "magic"], "magic"),
    "measure": (["--measure", "volume"], "volume"),
    "unknown option": (["--speed", "high"], "--speed"),
    "no elements": (["--max-elements", "0"], "max_elements is 0"),
    "domain missing": (["--domain", "none.csv"], "none.csv"),
}


@pytest.mark.parametrize("case", OPTIONS)
def test_options_that_make_no_sense(case: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    typed, words = OPTIONS[case]
    out = tmp_path / "out"
    said = refused(["compare", "expr:0.1 + 0.1*x", "--out", str(out), *typed], capsys)
    assert words in said
    assert not out.exists()


def test_a_mesh_too_large_is_not_begun(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    out = tmp_path / "out"
    said = refused(["run", "expr:0.01 + 0.1*x", "--out", str(out), "--max-elements", "10"], capsys, code=1)
    assert "10" in said and "elements" in said
    assert not out.exists()


def test_sizes_that_ask_for_far_too_many_elements_are_refused_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    """Before the boundary is laid: it alone would take all memory."""
    out, began = tmp_path / "out", time.process_time()
    said = refused(["run", "expr:0.2", "--beta", "1e-6", "--out", str(out)], capsys, code=1)
    assert "at least 2.71e+13 elements, more than 5000000; raise the sizes, beta" in said
    assert time.process_time() - began < 5.0 and not out.exists()


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        (["run", "ring", "--out", "o", "--threads", "1.5"], "--threads: '1.5' is not a whole number"),
        (["run", "ring", "--out", "o", "--seed", "1e3"], "--seed: '1e3' is not a whole number"),
        (["adapt", "ring", "--out", "o", "--cells", "x"], "--cells: 'x' is not a whole number"),
        (["run", "ring", "--out", ""], "--out: the name of the file or folder is empty"),
        (["field", "ring", "-o", ""], "-o: the name of the file or folder is empty"),
        (["run", "ring", "--out", "o", "--domain", " "], "--domain: the name of the file or folder is empty"),
        (["shot", "", "-o", "a.png"], "the name of the file or folder is empty"),
    ],
)
def test_no_count_is_rounded_and_no_name_is_empty(
    typed: list[str], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    assert words in refused(typed, capsys)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("typed", [["run", "--out", "o"], ["film", "-o", "o.gif"]])
def test_a_source_with_a_name_too_long_for_a_file(typed: list[str], capsys: pytest.CaptureFixture) -> None:
    assert "there is no such example or file" in refused([*typed, "x" * 5000], capsys)


def test_a_film_that_turns_to_no_alpha(capsys: pytest.CaptureFixture) -> None:
    assert "alpha turns from 1.0 to inf" in refused(["film", "ring", "-o", "o.gif", "--last", "inf"], capsys)


def test_a_domain_thinner_than_any_size_is_meshed(tmp_path: Path) -> None:
    (tmp_path / "thin.csv").write_text("0,0\n1,0\n1,1e-9\n0,1e-9\n")
    typed = [
        "run",
        "expr:0.2",
        "--domain",
        str(tmp_path / "thin.csv"),
        "--out",
        str(tmp_path / "o"),
        "--method",
        "none",
    ]
    assert run_command_line(typed) == 0
    assert read_mesh(tmp_path / "o" / "mesh.vtu").mesh.n_quads >= 5


def test_an_outline_that_crosses_itself(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    outline, out = tmp_path / "outline.csv", tmp_path / "out"
    outline.write_text("0,0\n3,1\n3,0\n0,1\n0,0.5\n1,0.7\n")
    said = refused(["run", "expr:0.1", "--domain", str(outline), "--out", str(out)], capsys)
    assert "outline.csv" in said and "cross" in said
    assert not out.exists()


@pytest.mark.parametrize("command", ["run", "compare"])
def test_an_output_that_cannot_be_written(command: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    blocker = tmp_path / "file"
    blocker.write_text("in the way")
    said = refused([command, "expr:0.1", "--out", str(blocker / "below")], capsys)
    assert str(blocker / "below") in said and "cannot create" in said
    assert blocker.read_text() == "in the way"


def test_the_output_is_tried_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sizeviz.cli import session

    monkeypatch.setattr(session, "loaded", lambda *_: pytest.fail("work began"))
    refused(["run", "ring", "--out", "/proc/sizeviz"], capsys)
    refused(["field", "ring", "-o", str(tmp_path / "none" / "h.vtu")], capsys)
    refused(["field", "ring", "-o", str(tmp_path / "h.docx")], capsys)


MESHES = {
    "missing": (lambda path: None, "no such"),
    "empty": (raw(b""), "empty"),
    "corrupt": (raw(b"<VTKFile"), "not well-formed"),
    "other XML": (raw(b"<html></html>"), "m.vtu"),
}


@pytest.mark.parametrize("case", MESHES)
def test_meshes_that_cannot_be_drawn(case: str, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    make, words = MESHES[case]
    make(tmp_path / "m.vtu")
    said = refused(["shot", str(tmp_path / "m.vtu"), "-o", str(tmp_path / "m.png")], capsys)
    assert words in said and "m.vtu" in said
    assert not (tmp_path / "m.png").exists()


def test_mistyped_commands(capsys: pytest.CaptureFixture) -> None:
    assert "paint" in refused(["paint", "ring"], capsys)
    assert "out" in refused(["compare", "ring"], capsys).lower()
    assert "source" in refused(["compare", "--out", "x"], capsys).lower()
    assert "nowhere" in refused(["field", "nowhere", "-o", "x.vtu"], capsys)


def test_what_should_not_happen_is_still_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sizeviz.cli import session

    def broken(*_: object) -> None:
        raise ZeroDivisionError("first\nsecond")

    monkeypatch.setattr(session, "loaded", broken)
    said = refused(["run", "ring", "--out", str(tmp_path / "out")], capsys, code=1)
    assert "ZeroDivisionError: first second" in said and "SIZEVIZ_DEBUG=1" in said
    assert not (tmp_path / "out").exists()


def test_ctrl_c_leaves_nothing(tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    from sizeviz.cli import session

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(session, "loaded", interrupted)
    assert "stopped" in refused(["run", "ring", "--out", str(tmp_path / "out")], capsys, code=1)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", ["run", "compare"])
def test_a_guarantee_that_cannot_be_given_is_refused(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    said = refused([command, "ring", "--out", str(tmp_path / "out"), "--guarantee", "--no-smooth"], capsys)
    assert "--guarantee" in said and "--smooth" in said
    assert not (tmp_path / "out").exists()
