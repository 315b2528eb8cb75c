"""What ``docs/security.md`` says is so: its files exist, its limits are those of the code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from sizeviz.files import convert, guard, numpy_files, outlines
from sizeviz.meshing import MeshOptions
from sizeviz.sizing import options
from sizeviz.sources import formula
from sizeviz.study.storage import archive

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "security.md").read_text("utf-8")
CODE = sorted(set(re.findall(r"`(?:python )?((?:files|sources|study|scene|app|tests)/[\w/]+\.py)", TEXT)))
LIMITS = {
    "a file, and what it unpacks to": [f"{guard.MAX_BYTES // 2**30} GiB", f"{guard.MAX_BYTES // 2**20} MiB"],
    "nodes of a field or mesh": [f"{guard.MAX_NODES // 10**6} million", str(guard.MAX_NODES)],
    "pixels of a picture": [f"{guard.MAX_PIXELS // 10**6} million", str(guard.MAX_PIXELS)],
    "vertices and loops of an outline": [f"{outlines.MAX_OUTLINE:,} and {outlines.MAX_LOOPS:,}"],
    "a formula": [f"{formula.LONGEST:,} characters, {formula.DEEPEST} levels", f"use at most {formula.LONGEST}"],
    "a study's text; its members": [f"{archive.MAX_JSON // 2**20} MiB; {numpy_files.MAX_MEMBERS:,}"],
    "coordinates and sizes": [f"{convert.EXTREME:g}", "1e60"],
    "α and β": [f"{options.LEAST:g}", f"{1 / options.LEAST:g}"],
    "pairs of segments": [f"{outlines.MOST_NEAR // 10**6} million"],
    "elements of a mesh": [f"{MeshOptions().max_elements // 10**6} million", str(MeshOptions().max_elements)],
}


@pytest.mark.parametrize("name", CODE)
def test_every_file_that_is_named_exists(name: str) -> None:
    assert (ROOT / name).exists() or (ROOT / "sizeviz" / name).exists()


@pytest.mark.parametrize("what", LIMITS)
def test_every_limit_is_the_one_in_force(what: str) -> None:
    row = next(line for line in TEXT.splitlines() if line.startswith(f"| {what}"))
    assert all(words in row for words in LIMITS[what]), row


def test_every_row_of_limits_is_checked() -> None:
    rows = re.findall(r"^\| (.+?) \|", TEXT[TEXT.index("## Limits") : TEXT.index("## Writing")], re.MULTILINE)
    assert all(any(row.startswith(what) for what in LIMITS) for row in rows[1:] if not row.startswith("---"))
