"""Domains as lists of points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.files import read_domain

SQUARE = "0,0\n2,0\n2,2\n0,2\n"
HOLE = "0.5,0.5\n1.5,0.5\n1.5,1.5\n0.5,1.5\n"


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "outline.csv"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    "text", [SQUARE, "x,y\n" + SQUARE, SQUARE.replace(",", " "), "# a square\n\n" + SQUARE + "0,0\n"]
)
def test_one_loop(tmp_path: Path, text: str) -> None:
    domain = read_domain(written(tmp_path, text))
    assert domain.area == 4.0
    assert not domain.holes


def test_an_empty_line_begins_a_hole(tmp_path: Path) -> None:
    domain = read_domain(written(tmp_path, SQUARE + "\n" + HOLE))
    assert domain.area == 3.0
    assert np.array_equal(np.sort(domain.holes[0], axis=0)[0], [0.5, 0.5])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,0\n1,1\n1,0\n0,1\n", "no area, or crosses itself"),
        ("0,0\n3,1\n3,0\n0,1\n0,0.5\n1,0.7\n", "crosses or touches itself near"),
        (SQUARE + "\n" + HOLE.replace("1.5", "2.5"), "loops cross or touch each other, or a hole lies outside"),
        (SQUARE + "\n5,5\n6,5\n6,6\n", "a hole lies outside"),
        ("0,0\n1,nan\n1,1\n", "line 2 is '1,nan'"),
        ("0,0\n1\n1,1\n", "line 2 is '1'"),
        ("0,0\n1,0,0\n1,1\n", "line 2"),
        ("0,0\n1,0\n", "three distinct"),
        ("0,0\n1,1\n2,2\n", "no area"),
        ("x,y\n", "no point"),
    ],
)
def test_outlines_that_make_no_sense(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        read_domain(written(tmp_path, text))
    assert "outline.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_binary_file_is_no_outline(tmp_path: Path) -> None:
    path = tmp_path / "outline.csv"
    path.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(InputError, match="not a text file"):
        read_domain(path)
