"""Domains from drawings and maps: GeoJSON and SVG."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
import pytest
from files.reader_seeds import SVG, geojson

from sizeviz.errors import InputError
from sizeviz.files import ReadOptions, read_domain
from sizeviz.geometry import Domain
from sizeviz.geometry.outline import require_simple

SQUARE = [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]
HOLE = [[0.5, 0.5], [0.5, 1], [1, 1], [1, 0.5], [0.5, 0.5]]


def from_geojson(tmp_path: Path, tree: object, options: ReadOptions | None = None) -> Domain:
    (tmp_path / "d.geojson").write_text(json.dumps(tree))
    return read_domain(tmp_path / "d.geojson", options or ReadOptions())


def from_svg(tmp_path: Path, body: str, options: ReadOptions | None = None) -> Domain:
    (tmp_path / "d.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10">{body}</svg>')
    domain = read_domain(tmp_path / "d.svg", options or ReadOptions())
    require_simple(domain)
    return domain


def polygon(*rings: object) -> dict[str, object]:
    return {"type": "Polygon", "coordinates": list(rings)}


def test_a_polygon_with_a_hole_keeps_its_vertices(tmp_path: Path) -> None:
    domain = from_geojson(tmp_path, polygon(SQUARE, HOLE))
    assert domain.outer.tolist() == SQUARE[:-1]
    assert domain.area == 3.75
    assert domain.label == "d.geojson"


def test_regions_that_touch_are_joined_and_lines_and_points_kept(tmp_path: Path) -> None:
    (tmp_path / "d.json").write_bytes(geojson())
    domain = read_domain(tmp_path / "d.json")
    assert domain.area == pytest.approx(5.75)
    assert len(domain.holes) == 1
    assert domain.lines[0].tolist() == [[2.2, 0.5], [2.8, 1.5]]
    assert [sorted(line.tolist()) for line in domain.lines[1:]] == [[[2.0, 0.0], [2.0, 2.0]]]
    assert domain.notes == ("regions share edges: they are kept as 1 inner line(s)",)
    assert domain.fixed_points.tolist() == [[1.5, 1.5]]


def test_what_was_mended_is_said(tmp_path: Path) -> None:
    other = [[x + 1, y] for x, y in SQUARE]
    overlapping = from_geojson(tmp_path, {"type": "MultiPolygon", "coordinates": [[SQUARE], [other]]})
    assert overlapping.notes == ("polygons overlap: they were joined",)
    assert overlapping.area == pytest.approx(6.0)
    assert not overlapping.lines
    bow = from_geojson(tmp_path, polygon([[0, 0], [2, 0], [2, 2], [1, -1], [0, 2], [0, 0]]), ReadOptions(part=1))
    assert any("crosses or touches itself" in note for note in bow.notes)
    assert from_geojson(tmp_path, polygon(SQUARE, HOLE)).notes == ()
    twice = from_svg(tmp_path, '<path d="M0 0 L4 0 L4 0 L4 4 L0 4 Z"/>')
    assert twice.area == pytest.approx(16.0)


def test_separate_regions_need_a_choice(tmp_path: Path) -> None:
    far = [[x + 5, y / 2] for x, y in SQUARE]
    both = {"type": "MultiPolygon", "coordinates": [[far], [SQUARE]]}
    with pytest.raises(InputError, match=r"2 separate region\(s\); one domain is supported: choose a part from 1 to 2"):
        from_geojson(tmp_path, both)
    assert from_geojson(tmp_path, both, ReadOptions(part=1)).area == 4.0
    assert from_geojson(tmp_path, both, ReadOptions(part=2)).area == 2.0
    with pytest.raises(InputError, match="choose a part from 1 to 2"):
        from_geojson(tmp_path, both, ReadOptions(part=3))


def test_a_spike_and_a_doubled_point_are_mended(tmp_path: Path) -> None:
    spike = [[0, 0], [2, 0], [2, 0], [2, 1], [3, 1], [2, 1], [2, 2], [0, 2], [0, 0]]
    domain = from_geojson(tmp_path, polygon(spike))
    require_simple(domain)
    assert domain.area == 4.0


def test_a_bow_tie_is_two_regions(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="2 separate"):
        from_geojson(tmp_path, polygon([[0, 0], [3, 2], [3, 0], [0, 2], [0, 0]]))


@pytest.mark.parametrize(
    ("tree", "words"),
    [
        ([], "no GeoJSON object"),
        ({"type": "Topology"}, "type 'Topology' is none of GeoJSON's"),
        ({"type": "Feature", "geometry": None}, "no Polygon or MultiPolygon"),
        ({"type": "Point", "coordinates": [0, 0]}, "no Polygon or MultiPolygon"),
        (polygon([[0, 0], [1, 1], [0, 0]]), "fewer than four points"),
        (polygon([[0, 0], [1, 1], [2, 2], [0, 0]]), "outlines no area"),
        (polygon([[0, 0], [1, "a"], [1, 1], [0, 0]]), "two numbers, x and y"),
        (polygon([[0, 0], [1], [1, 1], [0, 0]]), "two numbers, x and y"),
        (polygon([[0, 0], [1e99, 0], [1, 1], [0, 0]]), "beyond 1e"),
        (polygon(7), "two numbers, x and y"),
        ({"type": "Polygon", "coordinates": 7}, "a list of coordinates"),
        ({"type": "FeatureCollection", "features": {"a": 1}}, "a list of coordinates or features"),
        (
            {"type": "GeometryCollection", "geometries": [polygon(SQUARE), {"type": "Point", "coordinates": [9, 9]}]},
            r"point \(9, 9\) lies outside",
        ),
    ],
)
def test_maps_that_make_no_domain(tmp_path: Path, tree: object, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        from_geojson(tmp_path, tree)
    assert str(tmp_path / "d.geojson") in str(caught.value)


def test_text_that_is_no_json_or_nests_without_end(tmp_path: Path) -> None:
    (tmp_path / "d.json").write_text("{")
    with pytest.raises(InputError, match="not JSON"):
        read_domain(tmp_path / "d.json")
    (tmp_path / "d.json").write_text("[" * 100_000)
    with pytest.raises(InputError, match=r"d\.json"):
        read_domain(tmp_path / "d.json")


def test_a_scribble_is_refused_soon(tmp_path: Path) -> None:
    scribble = np.random.default_rng(0).random((3000, 2)).tolist()
    with pytest.raises(InputError, match="cross each other too often"):
        from_geojson(tmp_path, polygon([*scribble, scribble[0]]))


def test_curves_that_run_beside_each_other_for_ever_are_refused_soon(tmp_path: Path) -> None:
    began = time.process_time()
    with pytest.raises(InputError, match="run over each other too often"):
        from_svg(tmp_path, f'<path d="M0,0 {"c1e9,0 0,1e9 1,1" * 500}"/>')
    assert time.process_time() - began < 5.0


def test_y_points_upwards_in_the_domain(tmp_path: Path) -> None:
    domain = from_svg(tmp_path, '<path d="M1,1 h2 v1 z"/>')  # its right angle is at the top right of the drawing
    assert sorted(map(tuple, domain.outer.tolist())) == [(1, 9), (3, 8), (3, 9)]


@pytest.mark.parametrize(
    ("body", "area"),
    [
        ('<rect x="1" y="2" width="3" height="4"/>', 12.0),
        ('<rect x="1" y="2" width="3" height="4" rx="1"/>', 12 - 4 + np.pi),
        ('<circle cx="5" cy="5" r="2"/>', 4 * np.pi),
        ('<ellipse cx="5" cy="5" rx="2" ry="1"/>', 2 * np.pi),
        ('<polygon points="0,0 4,0 4,3"/>', 6.0),
        ('<path d="M0 0 L4 0 4 4 0 4Z M1 1 1 2 2 2 2 1z"/>', 15.0),
        ('<path d="m0 0 4 0 0 4-4 0zm1 1 0 1 1 0 0-1z"/>', 15.0),
        ('<path d="M0 0Q2 4 4 0Z"/>', 2 / 3 * 4 * 2),
        ('<path d="M0 0q1 2 2 2t2-2z"/>', 2 / 3 * 4 * 2),
        ('<path d="M0 0C0 4 4 4 4 0Z"/>', 0.6 * 4 * 4),
        ('<path d="M0 0c0 2 1 3 2 3s2-1 2-3Z"/>', 0.0),
        ('<path d="M1 3A2 2 0 0 1 5 3Z"/>', 2 * np.pi),
        ('<path d="M1 3a2 2 0 014 0Z"/>', 2 * np.pi),
        ('<path d="M1 3A1 1 0 0 1 5 3Z"/>', 2 * np.pi),
        ('<path d="M3 3A2 1 90 1 0 3 3.0001Z"/>', 2 * np.pi),
        ('<path transform="translate(1 2) scale(2)" d="M0 0h1v1h-1z"/>', 4.0),
        ('<g transform="rotate(30 3 3)"><path transform="skewX(20)" d="M0 0h2v1h-2z"/></g>', 2.0),
        ('<g transform="matrix(0 1 -3 0 5 5)"><path d="M0 0h1v1h-1z"/></g>', 3.0),
        ('<path d="M0 0h9v9h-9z"/><circle cx="3" cy="3" r="1"/><circle cx="6" cy="6" r="1"/>', 81 - 2 * np.pi),
        ('<defs><circle r="4"/></defs><path d="M0 0h1v1h-1z"/><circle r="3" display="none"/>', 1.0),
    ],
)
def test_the_area_of_a_shape(tmp_path: Path, body: str, area: float) -> None:
    domain = from_svg(tmp_path, body, ReadOptions(tolerance=1e-5))
    if area == 0.0:  # against a quadrature of the two cubics, each given by its control points
        t = np.linspace(0, 1, 200_001)[:, None]
        weights = np.hstack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
        half = np.array([[0, 0], [0, 2], [1, 3], [2, 3]]), np.array([[2, 3], [3, 3], [4, 2], [4, 0]])
        area = sum(float(np.trapezoid(y, x)) for x, y in ((weights @ control).T for control in half))
    assert domain.area == pytest.approx(area, abs=2e-4)


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-3, 1e-4])
def test_curves_are_sampled_to_the_tolerance_and_no_finer_than_needed(tmp_path: Path, tolerance: float) -> None:
    domain = from_svg(tmp_path, '<circle cx="5" cy="5" r="4"/>', ReadOptions(tolerance=tolerance))
    middles = (domain.outer + np.roll(domain.outer, -1, axis=0)) / 2
    sagitta = 4 - np.hypot(*(middles - 5).T)
    assert sagitta.max() <= tolerance * (1 + 1e-9)
    assert len(domain.outer) <= max(32, 2.5 * np.pi / np.arccos(1 - tolerance / 4))
    assert not domain.corners[0].any(), "a circle has no corner"


def test_a_scaled_drawing_keeps_the_tolerance_in_model_units(tmp_path: Path) -> None:
    domain = from_svg(tmp_path, '<g transform="scale(100)"><circle r="4"/></g>', ReadOptions(tolerance=0.01))
    middles = (domain.outer + np.roll(domain.outer, -1, axis=0)) / 2 - [0, 10]
    assert 400 - np.hypot(*middles.T).min() <= 0.01


def test_corners_are_where_curves_meet_at_an_angle(tmp_path: Path) -> None:
    domain = from_svg(tmp_path, '<path d="M1 1H5A2 2 0 0 1 7 3V7H1Z"/>')
    assert sorted(map(tuple, domain.outer[domain.corners[0]].tolist())) == [(1, 3), (1, 9), (7, 3)]


def test_the_seed_drawing(tmp_path: Path) -> None:
    (tmp_path / "d.svg").write_text(SVG)
    domain = read_domain(tmp_path / "d.svg")
    require_simple(domain)
    assert len(domain.holes) == 5
    assert domain.bounds == pytest.approx((5.0, 5.0, 95.0, 75.0))


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("", "no path, polygon, rectangle"),
        ('<path d="M0 0L1 1"/>', "no loop of three|no area"),
        ('<path d="L0 0"/>', "do not begin with M"),
        ('<path d="M0 0L1"/>', "end within a command"),
        ('<path d="M0 0X1"/>', "cannot be read at 'X1'"),
        ('<path d="M0 0 1 0 1 1Z5"/>', "numbers after Z"),
        ('<path d="M0 0L1e400 0 1 1Z"/>', "not finite"),
        ('<path d="M0 0A1e30 1 0 0 0 1 1Z"/>', "too long for its ends"),
        ('<path transform="wobble(3)" d="M0 0L1 0 1 1Z"/>', "transform 'wobble'"),
        ('<path transform="scale" d="M0 0L1 0 1 1Z"/>', "transform 'scale' cannot be read"),
        ('<rect width="3cm" height="2cm"/>', "only plain numbers and px"),
        ('<use href="#a"/>', "flatten the drawing"),
        ('<path d="M0 0h1v1h-1z M3 3h1v1h-1z"/>', "2 separate"),
    ],
)
def test_drawings_that_make_no_domain(tmp_path: Path, body: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        from_svg(tmp_path, body)
    assert str(tmp_path / "d.svg") in str(caught.value)


def test_a_drawing_that_declares_entities_is_refused(tmp_path: Path) -> None:
    laughs = "".join(f'<!ENTITY l{k + 1} "{f"&l{k};" * 10}">' for k in range(9))
    (tmp_path / "d.svg").write_text(f'<!DOCTYPE svg [<!ENTITY l0 "ha">{laughs}]><svg>&l9;</svg>')
    with pytest.raises(InputError, match="document type or entities"):
        read_domain(tmp_path / "d.svg")
