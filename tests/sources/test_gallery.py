"""The examples, and loading by name, formula and file."""

from __future__ import annotations

import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.geometry import Domain
from sizeviz.sizing import PreserveOptions, ideal_count, preserved
from sizeviz.sources import examples, load


@pytest.fixture(scope="module")
def ring():
    return load("ring")


def test_the_ring_asks_for_what_section_5_1_asks_for(ring):
    assert ideal_count(ring.field, ring.domain) == pytest.approx(12_933, rel=2e-3)
    assert ideal_count(preserved(ring.field, PreserveOptions()), ring.domain) == pytest.approx(64_619, rel=3e-3)
    assert len(ring.field.sizes) <= 100_000
    assert ring.provenance["error"] <= 0.01
    assert ring.field.sizes.min() == pytest.approx(0.25e-3, rel=1e-9)


def test_the_valley_is_equation_1():
    source = load("valley")
    where = np.random.default_rng(0).random((500, 2))
    wanted = np.minimum(0.5, 0.1 + 3 * np.abs(where[:, 0] - 0.75))
    np.testing.assert_allclose(source.reference.at(where), wanted, rtol=1e-14)
    np.testing.assert_allclose(source.field.at(where), wanted, rtol=0.01)


@pytest.mark.parametrize("name", ["mri", "terrain", "coast"])
def test_examples_from_pictures_cover_their_domain(name):
    source = load(name)
    assert source.image is not None
    np.testing.assert_allclose(source.field.background.bounds, source.domain.bounds, rtol=1e-12)
    assert source.field.sizes.min() > 0
    assert source.field.sizes.max() > 5 * source.field.sizes.min()


def test_names_are_distinct_and_a_slip_is_put_right():
    names = [example.name for example in examples()]
    assert len(set(names)) == len(names) >= 6
    with pytest.raises(InputError, match="did you mean ring"):
        load("rinng")
    with pytest.raises(InputError, match="a formula begins with expr:"):
        load("quite something else")


def test_a_formula_may_have_a_domain_of_its_own():
    domain = Domain.rectangle(-1.0, 2.0, 1.0, 3.0)
    source = load("expr:0.1 + 0.05*x*x", domain)
    assert source.domain is domain
    np.testing.assert_allclose(source.field.background.bounds, domain.bounds)
    assert source.provenance["formula"] == "0.1 + 0.05*x*x"
    assert source.reference.at([[0.5, 2.5]])[0] == pytest.approx(0.1125)
    moved = load("valley", Domain.rectangle(0.5, 0.5, 1.0, 1.0))
    np.testing.assert_allclose(moved.field.background.bounds, (0.5, 0.5, 1.0, 1.0))


def test_files_of_sizes_and_pictures(tmp_path):
    rows = 0.1 + 0.05 * np.random.default_rng(1).random((5, 7))
    np.save(tmp_path / "sizes.npy", rows)
    source = load(str(tmp_path / "sizes.npy"))
    np.testing.assert_array_equal(source.field.sizes, rows.ravel())
    assert source.provenance["kind"] == "field"

    from PIL import Image

    Image.fromarray(np.tile(np.arange(0, 250, 10, dtype=np.uint8), (20, 1))).save(tmp_path / "ramp.png")
    source = load(str(tmp_path / "ramp.png"), image_size="intensity")
    (x0, y0, x1, y1), middle = source.domain.bounds, 0.5 * (source.domain.bounds[1] + source.domain.bounds[3])
    along = source.field.at(np.column_stack([np.linspace(x0, x1, 40), np.full(40, middle)]))
    assert (np.diff(along) >= -1e-12).all()
    assert along[-1] == pytest.approx(10 * along[0])
    assert y1 > y0
    with pytest.raises(InputError, match="colour"):
        load(str(tmp_path / "ramp.png"), image_size="colour")
