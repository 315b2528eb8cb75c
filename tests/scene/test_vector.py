"""Vector figures are vectors: a path for every element, text as text, no picture inside."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from scene.fakes import subject

from sizeviz.scene import save_picture


@pytest.mark.parametrize("quantity", ["ratio", "quality", "size"])
def test_a_figure_of_five_thousand_elements_is_paths_alone(tmp_path: Path, quantity: str) -> None:
    shown = subject(71)
    assert shown.mesh.n_quads == 5041
    text = save_picture(shown, tmp_path / "m.svg", color_by=quantity).read_text("utf-8")
    assert "<image" not in text and "base64" not in text
    closed = sum(len(re.findall(r"[zZ]", path)) for path in re.findall(r'<path[^>]* d="([^"]*)"', text))
    assert closed >= 5041, "every element is a closed path"
    assert "<text" in text and "Size preserving" in text and "elements" not in re.findall(r"<glyph", text)
    pdf = save_picture(shown, tmp_path / "m.pdf", color_by=quantity).read_bytes()
    assert b"/Subtype /Image" not in pdf and pdf.startswith(b"%PDF")


@pytest.mark.parametrize("suffix", [".svg", ".pdf"])
def test_equal_scenes_are_equal_files_and_nothing_is_left_beside_them(tmp_path: Path, suffix: str) -> None:
    for k in "ab":
        save_picture(subject(6), tmp_path / f"{k}{suffix}")
    assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()
    assert len(list(tmp_path.iterdir())) == 2
