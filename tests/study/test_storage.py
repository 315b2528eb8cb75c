"""Study files: what was saved comes back, bit for bit; what is wrong is named; nothing leaves its folder."""

from __future__ import annotations

import json
import os
import re
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from files.reader_seeds import quad_mesh
from study.cases import valley_source

from sizeviz.conformity import MEASURES, MeshReport
from sizeviz.errors import InputError
from sizeviz.files import Image, read_field, write_field
from sizeviz.geometry import Domain
from sizeviz.improvement.guarantee import GuaranteeReport
from sizeviz.meshing import MeshOptions
from sizeviz.sizing import BackgroundMesh, LimitOptions, PreserveOptions, SizeField
from sizeviz.sizing.analytic import AnalyticSize
from sizeviz.sources import Source, load
from sizeviz.sources.painting import Brush, Stroke, painted
from sizeviz.study import METHODS, MethodRun, Study, StudyOptions
from sizeviz.study.storage import StudyFile, read_study, schema, write_study


@pytest.fixture(scope="module")
def finished() -> Study:
    """Return a study with all its results; what they are does not matter here, so they are made up."""
    options = StudyOptions(
        limit=LimitOptions(epsilon=0.4), preserve=PreserveOptions(alpha=1.5), mesh=MeshOptions(seed=3)
    )
    study = Study(valley_source(17, 0.08, 0.3), options)
    for k, method in enumerate(METHODS):
        study = study.with_run(method, made_up(study, k))
    return study


def made_up(study: Study, k: int) -> MethodRun:
    """Return results of the right kinds and sizes."""
    raw, draw, field = quad_mesh(), np.random.default_rng(k), study.source.field
    mesh = raw.with_points(raw.points + 1e-3 * draw.random(raw.points.shape))
    sizes = {measure: draw.random(raw.n_quads) for measure in MEASURES}
    report = MeshReport(draw.random(raw.n_quads), sizes, draw.random(raw.n_quads), raw.n_points, 0.125, 1.5, 9.5)
    target = field if k == 0 else field.with_sizes(field.sizes / (k + 1))
    seconds = {"field": 0.1, "mesh": 1 / 3, "smooth": 2.0, "judge": 0.0}
    if k < 3:
        return MethodRun(target, raw, mesh, report, seconds)
    left = GuaranteeReport(raw.n_quads, np.array([2, 5, 7]), np.array([1.5, 1.25, 1.125]), ("b", "a", "b"))
    return MethodRun(target, raw, mesh, report, seconds, field.with_sizes(field.sizes / 9), left)


def same(a: Any, b: Any) -> bool:
    """Whether two values are the same all the way down, arrays bit for bit."""
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and a.dtype == b.dtype and np.array_equal(a, b)
    if isinstance(a, Mapping):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if hasattr(a, "__dataclass_fields__"):
        return type(a) is type(b) and all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    return bool(a == b)


def painted_file(study: Study) -> StudyFile:
    """Return a painted study with its strokes and a view."""
    original = study.source.field
    strokes = (
        Stroke(Brush(mode="set", radius=0.2, value=0.11), np.array([[0.1, 0.2], [0.6, 0.7]])),
        Stroke(Brush(mode="multiply", value=2.0, mask=(0.0, 0.2)), np.array([[0.5, 0.5]]), "line"),
        Stroke(Brush(mode="erase", radius=0.1), np.array([[0.1, 0.2], [0.3, 0.3], [0.1, 0.4]]), "polygon"),
    )
    field = original
    for stroke in strokes:
        field = painted(field, stroke, original)
    source = replace(study.source, field=field, reference=field, provenance={"kind": "painted", "strokes": 3})
    view = {"panes": [{"method": "none", "low": None}], "layout": {"split": 0.5}, "dark": True}
    return StudyFile(study.with_source(source), strokes, original, view)


def test_a_study_comes_back_whole(tmp_path: Path, finished: Study) -> None:
    back = read_study(write_study(tmp_path / "a.sizeviz", StudyFile(finished))).study
    assert same(back, finished)
    assert back.runs["none"].is_complete
    assert back.source.reference is back.source.field, "what was one object is one again"
    backgrounds = {id(made.target.background) for made in back.runs.values() if made.target is not None}
    assert backgrounds == {id(back.source.field.background)}


def test_paint_and_view_come_back(tmp_path: Path, finished: Study) -> None:
    content = painted_file(finished)
    back = read_study(write_study(tmp_path / "a.sizeviz", content))
    assert same(back.strokes, content.strokes)
    assert dict(back.view) == dict(content.view)
    assert back.original is not None
    field = back.original
    for stroke in back.strokes:
        field = painted(field, stroke, back.original)
    assert np.array_equal(field.sizes, back.study.source.field.sizes), "the strokes say how the field came about"


def test_equal_studies_are_equal_files_and_arrays_are_kept_once(tmp_path: Path, finished: Study) -> None:
    a, b = (write_study(tmp_path / name, StudyFile(finished)) for name in ("a.sizeviz", "b.sizeviz"))
    assert a.read_bytes() == b.read_bytes()
    again = write_study(tmp_path / "c.sizeviz", read_study(a))
    assert again.read_bytes() == a.read_bytes()
    names = zipfile.ZipFile(a).namelist()
    assert len(names) == len(set(names))
    sizes = [name for name in names if zipfile.ZipFile(a).getinfo(name).file_size == 128 + 8 * 17 * 17]
    assert len(sizes) == 5, "the sizes as given, of the three targets that differ, and the tight ones"


def test_halves_of_killed_saves_are_cleared_away_in_time(tmp_path: Path) -> None:
    old, fresh = tmp_path / ".a.0123456789abcdef.part.sizeviz", tmp_path / ".a.fedcba9876543210.part.sizeviz"
    old.write_bytes(b"half")
    fresh.write_bytes(b"half")
    os.utime(old, (1, 1))
    path = write_study(tmp_path / "a.sizeviz", StudyFile(Study(valley_source(5))))
    assert sorted(tmp_path.iterdir()) == sorted([fresh, path])


SOURCES: dict[str, Callable[[], Source]] = {
    "formula": lambda: load("expr:0.2 + 0.1*x"),
    "triangles and a domain": lambda: everything(),
    "grid that was bent": lambda: bent(),
}


def everything() -> Source:
    """Return a source with all that a source can have."""
    points = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1 / 3]])
    triangles = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], dtype=np.int32)
    field = SizeField(BackgroundMesh(points, triangles), np.array([0.1, 0.2, 0.3, 0.4, 0.5]), "five nodes")
    domain = Domain(
        points[:4],
        (np.array([[0.5, 0.5], [0.5, 0.6], [0.6, 0.5]]),),
        lines=(np.array([[1.0, 1.0], [1.5, 1.5]]),),
        fixed_points=np.array([[1.7, 0.3]]),
        label="plate",
    )
    image = Image(np.arange(12.0).reshape(3, 4), (0.5, 0.25), (1.0, 2.0), "pixels")
    other = field.with_sizes(2 * field.sizes, "reference")
    provenance = {"kind": "field", "path": "/gone/x.vtu", "n": np.int64(3), "nested": {"a": (1, 2.5, None)}}
    return Source("x", "all there is", domain, field, other, image, provenance)


def bent() -> Source:
    """Return a grid whose nodes were moved by a hair: it must not be straightened."""
    source = valley_source(5)
    grid = source.field.background
    moved = BackgroundMesh(np.nextafter(grid.points, 2.0), grid.triangles, grid.grid)
    field = SizeField(moved, source.field.sizes)
    return replace(source, field=field, reference=field)


@pytest.mark.parametrize("name", SOURCES)
def test_every_kind_of_source_comes_back(tmp_path: Path, name: str) -> None:
    source = SOURCES[name]()
    back = read_study(write_study(tmp_path / "a.sizeviz", StudyFile(Study(source)))).study.source
    for part in ("name", "label", "domain", "field", "image"):
        assert same(getattr(back, part), getattr(source, part)), part
    if isinstance(source.reference, AnalyticSize):
        assert isinstance(back.reference, AnalyticSize) and back.reference.field is back.field
        where = np.random.default_rng(0).random((99, 2))
        assert np.array_equal(back.reference.at(where), source.reference.at(where))
    else:
        assert same(back.reference, source.reference)
    assert back.provenance.get("kind") == source.provenance.get("kind")


def test_a_python_function_cannot_be_saved_and_nothing_is_written(tmp_path: Path) -> None:
    source = valley_source(5)
    source = replace(source, reference=AnalyticSize(lambda x, y: x + 1.0, source.field, "mine"))
    with pytest.raises(InputError, match="mine: sizes given by a Python function cannot be saved"):
        write_study(tmp_path / "a.sizeviz", StudyFile(Study(source)))
    with pytest.raises(InputError, match="what JSON cannot"):
        write_study(tmp_path / "a.sizeviz", StudyFile(Study(valley_source(5)), view={"x": object()}))
    with pytest.raises(InputError, match="what JSON cannot"):
        write_study(tmp_path / "a.sizeviz", StudyFile(Study(valley_source(5)), view={"x": float("nan")}))
    assert not list(tmp_path.iterdir())


# -- linked inputs -----------------------------------------------------------------------------------------------------


def linked(tmp_path: Path) -> Path:
    """Return a study file that refers to ``data/f.vtu`` beside it."""
    (tmp_path / "data").mkdir()
    file = write_field(tmp_path / "data" / "f.vtu", valley_source(9).field)
    return write_study(tmp_path / "a.sizeviz", StudyFile(Study(load(str(file)))), embed=False)


def test_a_linked_input_is_read_again_wherever_the_folder_is_moved(tmp_path: Path) -> None:
    (tmp_path / "old").mkdir()
    path = linked(tmp_path / "old")
    assert {name for name in zipfile.ZipFile(path).namelist() if name.startswith("arrays")} <= {
        f"arrays/a{k}.npy" for k in range(3)
    }, "loop, corners and fixed points; no sizes"
    (tmp_path / "old").rename(tmp_path / "new")
    source = read_study(tmp_path / "new" / "a.sizeviz").study.source
    assert same(source.field, read_field(tmp_path / "new" / "data" / "f.vtu"))


def test_a_linked_input_that_changed_or_went_is_noticed(tmp_path: Path) -> None:
    path = linked(tmp_path)
    data = tmp_path / "data" / "f.vtu"
    content = data.read_bytes()
    data.write_bytes(content.replace(b"\n", b" \n", 1))
    with pytest.raises(InputError, match=r"a\.sizeviz: its input data/f\.vtu has changed since"):
        read_study(path)
    data.unlink()
    with pytest.raises(InputError, match=r"f\.vtu.*no such file"):
        read_study(path)


def test_an_input_elsewhere_is_embedded(tmp_path: Path) -> None:
    (tmp_path / "studies").mkdir()
    file = write_field(tmp_path / "f.vtu", valley_source(9).field)
    path = write_study(tmp_path / "studies" / "a.sizeviz", StudyFile(Study(load(str(file)))), embed=False)
    file.unlink()
    assert same(read_study(path).study.source.field.sizes, valley_source(9).field.sizes)


@pytest.mark.parametrize("name", ["../f.vtu", "/etc/passwd", "data/../../f.vtu", "data\\f.vtu", "link/f.vtu"])
def test_no_input_outside_the_folder_is_opened(tmp_path: Path, name: str) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "link").symlink_to(tmp_path)
    path = linked(tmp_path / "in")
    write_field(tmp_path / "f.vtu", valley_source(9).field)
    changed(path, lambda tree: tree["source"]["input"].update(path=name))
    with pytest.raises(InputError, match="lies outside the study's folder"):
        read_study(path)


# -- damage ------------------------------------------------------------------------------------------------------------


def changed(path: Path, change: Callable[[dict[str, Any]], object], member: str = "study.json") -> None:
    """Change the text of a study file in place."""
    with zipfile.ZipFile(path) as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    tree = json.loads(content[member])
    change(tree)
    content[member] = json.dumps(tree).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in content.items():
            archive.writestr(name, data)


def set_at(*keys: str, value: Any) -> Callable[[dict[str, Any]], None]:
    """Return a change of one value."""

    def change(tree: dict[str, Any]) -> None:
        for key in keys[:-1]:
            tree = tree[key] if isinstance(tree, dict) else tree[int(key)]
        tree[keys[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (set_at("format", value="other"), "format is 'other'"),
        (set_at("version", value="1"), "version is '1'"),
        (set_at("version", value=99), r"newer sizeviz \(study version 99, known up to 1\); update"),
        (set_at("options", "mesh", "scale", value=-1.0), r"options\.mesh: mesh scale is -1\.0; it must be"),
        (set_at("options", "mesh", "scale", value="big"), r"options\.mesh\.scale: Input should be a valid number"),
        (set_at("options", "mesh", "colour", value=1), r"options\.mesh\.colour: there is no such option"),
        (set_at("options", "preserve", "distance", value="far"), r"options\.preserve\.distance: Input should be"),
        (set_at("options", "smoothing", value=1), r"options\.smoothing: Input should be a valid boolean"),
        (set_at("extra", value=1), r"study\.json\.extra: Extra inputs are not permitted"),
        (set_at("source", "name", value=None), r"study\.json\.source\.name: Input should be a valid string"),
        (set_at("source", "field", "sizes", value="../a"), r"source\.field\.sizes: String should match pattern"),
        (set_at("source", "field", "sizes", value="a999"), r"source\.field\.sizes: array a999 is missing"),
        (set_at("source", "field", "background", value="b9"), r"backgrounds\.b9 is missing"),
        (set_at("source", "field", value=None), "neither field nor input"),
        (set_at("backgrounds", "b0", "grid", "nx", value=1), r"backgrounds\.b0\.grid\.nx: Input should be greater"),
        (
            set_at("backgrounds", "b0", "grid", "nx", value=900_000),
            r"source\.field\.sizes has shape|original\.sizes has shape|target\.sizes has shape",
        ),
        (set_at("backgrounds", "b0", "grid", value=None), r"backgrounds\.b0 has neither a grid nor points"),
        (set_at("runs", "none", "target", value=None), r"runs\.none has a result without the one"),
        (set_at("runs", "none", "report", "sizes", value={}), r"runs\.none\.report\.sizes has 0 of 3"),
        (set_at("runs", "none", "seconds", "mesh", value=-1), r"runs\.none\.seconds\.mesh: Input should be greater"),
        (set_at("runs", "../x", value={}), r"runs\.\.\./x\.\[key\]: String should match"),
        (set_at("strokes", "0", "brush", "radius", value=0), r"strokes\.0\.brush: .*brush radius is 0"),
        (set_at("strokes", "0", "brush", "mode", value="dab"), r"strokes\.0\.brush\.mode: Input should be"),
        (set_at("strokes", "0", "n_points", value=7), "stroke_points has shape"),
        (set_at("strokes", "0", "shape", value="blob"), r"strokes\.0\.shape: Input should be"),
        (set_at("source", "domain", "loops", value=[]), r"source\.domain\.loops: List should have at least 1"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, finished: Study, change: Callable[..., None], words: str) -> None:
    content = painted_file(finished)
    path = write_study(
        tmp_path / "a.sizeviz", replace(content, study=content.study.with_run("none", made_up(content.study, 0)))
    )
    changed(path, change)
    with pytest.raises(InputError, match=words) as caught:
        read_study(path)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def swapped(path: Path, name: str, data: bytes) -> None:
    """Replace or add a member."""
    with zipfile.ZipFile(path) as archive:
        content = {member: archive.read(member) for member in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for member, old in {**content, name: data}.items():
            archive.writestr(member, old)


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("../../evil.py", b"x", "'../../evil.py', which belongs to no study"),
        ("arrays/a0.npy", b"", "not a NumPy file"),
        ("arrays/a0.pkl", b"", "belongs to no study"),
        ("study.json", b"{", "study.json is not JSON"),
        ("study.json", b"[" * 100_000, "study.json is not JSON"),
        ("study.json", b"[]", "study.json is no JSON object"),
        ("study.json", b'{"format": NaN}', "holds the number NaN"),
        ("study.json", b" " * (2**24 + 1), "at most 16777216 are read"),
        ("view.json", b"\xff", "view.json is not JSON"),
    ],
)
def test_strange_members_are_refused(tmp_path: Path, name: str, data: bytes, words: str) -> None:
    path = write_study(tmp_path / "a.sizeviz", StudyFile(Study(valley_source(5))))
    swapped(path, name, data)
    with pytest.raises(InputError, match=re.escape(words)):
        read_study(path)


def test_pickled_objects_are_never_loaded(tmp_path: Path) -> None:
    import io

    path = write_study(tmp_path / "a.sizeviz", StudyFile(Study(valley_source(5))))
    buffer = io.BytesIO()
    np.save(buffer, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    for k in range(3):
        swapped(path, f"arrays/a{k}.npy", buffer.getvalue())
    with pytest.raises(InputError, match="Python objects, which are never read"):
        read_study(path)


def test_archive_bombs_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_study(tmp_path / "a.sizeviz", StudyFile(Study(valley_source(5))))
    monkeypatch.setattr("sizeviz.study.storage.archive.MAX_BYTES", 2**24)
    assert isinstance(read_study(path), StudyFile)
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        for k in range(100, 117):
            archive.writestr(f"arrays/a{k}.npy", bytes(2**20))
    assert path.stat().st_size < 2**17
    with pytest.raises(InputError, match="the unpacked content should take"):
        read_study(path)
    with zipfile.ZipFile(tmp_path / "many.sizeviz", "w") as archive:
        for k in range(1100):
            archive.writestr(f"arrays/a{k}.npy", b"")
    with pytest.raises(InputError, match="1100 members"):
        read_study(tmp_path / "many.sizeviz")


def test_a_member_that_is_longer_than_announced_is_refused(tmp_path: Path) -> None:
    path = write_study(tmp_path / "a.sizeviz", StudyFile(Study(valley_source(5))))
    swapped(path, "arrays/a900.npy", bytes(70_000))
    announced, lie = (70_000).to_bytes(4, "little"), (70).to_bytes(4, "little")
    path.write_bytes(path.read_bytes().replace(announced, lie))
    with pytest.raises(InputError, match=r"cannot be unpacked|not as long as announced"):
        read_study(path)


def test_files_that_are_no_studies(tmp_path: Path) -> None:
    (tmp_path / "a.sizeviz").write_bytes(b"hello")
    with pytest.raises(InputError, match="no sizeviz study"):
        read_study(tmp_path / "a.sizeviz")
    (tmp_path / "a.sizeviz").write_bytes(b"PK\x03\x04 and no more")
    with pytest.raises(InputError, match="cannot be unpacked"):
        read_study(tmp_path / "a.sizeviz")
    with pytest.raises(InputError, match="no such file"):
        read_study(tmp_path / "b.sizeviz")
    with zipfile.ZipFile(tmp_path / "c.sizeviz", "w"):
        pass
    with pytest.raises(InputError, match=r"no study\.json"):
        read_study(tmp_path / "c.sizeviz")


def test_damaged_studies_never_crash_the_reader(tmp_path: Path, finished: Study) -> None:
    from random import Random

    from files.reader_fuzz import mutated

    content = painted_file(finished)
    data = write_study(tmp_path / "a.sizeviz", content).read_bytes()
    plain = json.loads(zipfile.ZipFile(tmp_path / "a.sizeviz").read("study.json"))
    texts = [json.dumps(plain).encode(), json.dumps(plain, indent=2).encode()]
    opened = 0
    for number in range(150):
        draw = Random(number)
        path = tmp_path / "b.sizeviz"
        if number % 2:
            path.write_bytes(mutated(data, data, draw))
        else:
            path.write_bytes(data)
            swapped(path, "study.json", mutated(texts[0], texts[1], draw))
        try:
            opened += isinstance(read_study(path), StudyFile)
        except InputError as error:
            assert str(path) in str(error) and str(error).isprintable()
    assert opened < 150


# -- versions ----------------------------------------------------------------------------------------------------------


def test_every_older_version_has_a_migration() -> None:
    assert sorted(schema.MIGRATIONS) == list(range(1, schema.VERSION))


def test_older_texts_are_brought_up_to_date_step_by_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_study(tmp_path / "a.sizeviz", StudyFile(Study(valley_source(5))))
    now = schema.VERSION

    def renamed(tree: dict[str, Any]) -> dict[str, Any]:
        source = dict(tree["source"])
        source["label"] = source.pop("title")
        return {**tree, "source": source}

    def shouted(tree: dict[str, Any]) -> dict[str, Any]:
        return {**tree, "source": {**tree["source"], "label": tree["source"]["label"].upper()}}

    monkeypatch.setattr(schema, "VERSION", now + 2)
    monkeypatch.setattr(schema, "MIGRATIONS", {**schema.MIGRATIONS, now: renamed, now + 1: shouted})
    changed(path, lambda tree: tree["source"].update(title=tree["source"].pop("label")))
    assert read_study(path).study.source.label == "A SLANTED VALLEY"
