"""Fields as NumPy arrays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.files import read_field, write_field
from sizeviz.geometry import Domain
from sizeviz.sizing import BackgroundMesh, Grid, SizeField


def test_row_zero_lies_at_the_smallest_y_of_the_unit_square(tmp_path: Path) -> None:
    sizes = np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]])
    np.save(tmp_path / "f.npy", sizes)
    field = read_field(tmp_path / "f.npy")
    assert field.background.grid == Grid(0.0, 0.0, 0.5, 1.0, 3, 2)
    assert field.sizes[0] == 0.1 and tuple(field.background.points[0]) == (0.0, 0.0)
    assert field.sizes[5] == 0.6 and tuple(field.background.points[5]) == (1.0, 1.0)


def test_the_domain_says_where_a_bare_array_lies(tmp_path: Path) -> None:
    np.save(tmp_path / "f.npy", np.ones((3, 5)))
    field = read_field(tmp_path / "f.npy", Domain.rectangle(-2.0, 1.0, 2.0, 7.0))
    assert field.background.grid == Grid(-2.0, 1.0, 1.0, 3.0, 5, 3)


def test_npz_keeps_the_axes(tmp_path: Path) -> None:
    background = BackgroundMesh.regular(Grid(-1.0, 2.0, 0.25, 0.5, 4, 3))
    field = SizeField(background, np.linspace(1.0, 2.0, 12))
    back = read_field(write_field(tmp_path / "f.npz", field))
    assert back.background.grid == background.grid
    assert np.array_equal(back.sizes, field.sizes)


def test_a_triangulation_cannot_be_an_array(tmp_path: Path) -> None:
    background = BackgroundMesh(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.array([[0, 1, 2]], dtype=np.int32))
    with pytest.raises(InputError, match=r"not on a regular grid"):
        write_field(tmp_path / "f.npy", SizeField(background, np.ones(3)))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "empty"),
        (b"junk", "not a NumPy file"),
        (b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (9, 9)", "header.*cut or corrupt"),
    ],
)
def test_junk_is_refused(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "f.npy"
    path.write_bytes(content)
    with pytest.raises(InputError, match=words) as caught:
        read_field(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    "sizes",
    [np.ones(4), np.ones((2, 2, 2)), np.ones((1, 5)), np.array([["a", "b"]] * 2), np.ones((2, 2), dtype=complex)],
)
def test_arrays_of_another_kind_are_refused(tmp_path: Path, sizes: np.ndarray) -> None:
    np.save(tmp_path / "f.npy", sizes)
    with pytest.raises(InputError, match="2-D array of sizes"):
        read_field(tmp_path / "f.npy")


def test_pickled_objects_are_never_loaded(tmp_path: Path) -> None:
    np.save(tmp_path / "f.npy", np.array([[{}, 1], [2, 3]], dtype=object))
    with pytest.raises(InputError, match="Python objects, which are never read"):
        read_field(tmp_path / "f.npy")


@pytest.mark.parametrize("x", [[0.0, 1.0, 3.0], [0.0, 1.0], [2.0, 1.0, 0.0], [0.0, np.nan, 2.0]])
def test_axes_must_grow_in_equal_steps(tmp_path: Path, x: list[float]) -> None:
    np.savez(tmp_path / "f.npz", sizes=np.ones((2, 3)), x=np.array(x))
    with pytest.raises(InputError, match="x must"):
        read_field(tmp_path / "f.npz")


@pytest.mark.parametrize("name", ["f", "f.xyz"])
def test_unknown_suffixes_name_the_known_ones(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"\.npy"):
        read_field(tmp_path / name)
