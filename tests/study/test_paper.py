"""The paper's examples: one dimension against closed forms, tables and summary against what they are made of."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.files import Image
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.sizing import (
    BackgroundMesh,
    LimitOptions,
    PreserveOptions,
    SizeField,
    ideal_count,
    limited,
    preserved,
)
from sizeviz.sources import Source
from sizeviz.study import COMPARED, Study, StudyOptions, run
from sizeviz.study.evolution import Evolution, Iteration
from sizeviz.study.paper import (
    PUBLISHED,
    ROWS,
    Adaptation,
    ImageRun,
    PaperOptions,
    image_table,
    line_example,
    ring_table,
)
from sizeviz.study.paper.images import EQUAL_COUNT, image_runs, image_source
from sizeviz.study.paper.published import STRICT
from sizeviz.study.paper.summary import summary
from sizeviz.study.paper.tables import shown
from sizeviz.study.pipeline import GUARANTEED


def adaptation(method: str, mesher: str, ratios: tuple[float, ...]) -> Adaptation:
    rows = tuple(
        Iteration(
            number=k, mesh=f"mesh-{k:03d}.vtu", n_quads=1000 * (k + 1), n_nodes=1100 * (k + 1), background_ratio=1.3,
            analytic_ratio=ratio, background_correct=90.0, analytic_correct=99.95, strict_ratio=1.2,
            strict_correct=98.0, quality_min=0.4, quality_mean=0.9,
            quality_max=1.0, quality_std=0.1, irregular=20.0, seconds=2.0,
        )
        for k, ratio in enumerate(ratios)
    )  # fmt: skip
    return Adaptation(mesher, method, Evolution(source="ring", iterations=rows), Path())


RING = [
    adaptation("gradient-limiting", "decomposition", (50.0, 3.0, 1.5)),
    adaptation("size-preserving", "decomposition", (50.0, 1.05)),
]


def tiny_image_run() -> ImageRun:
    x = np.linspace(0, 1, 16)
    image = Image(np.outer(x, x**2), (1 / 16, 1 / 16), (1 / 32, 1 / 32), label="a slope")
    background = BackgroundMesh.unit_square_grid(17, 17)
    sizes = 0.08 + 0.3 * np.abs(background.points[:, 0] - 0.5)
    field = SizeField(background, sizes)
    source = Source("slope", "a slope", Domain.unit_square(), field, field, image)
    done = run(Study(source, StudyOptions()), COMPARED)
    runs = {method: done.runs[method] for method in COMPARED}
    return ImageRun(source, "frontal", {**runs, EQUAL_COUNT: runs["gradient-limiting"]}, dict.fromkeys(COMPARED, 0.5))


@pytest.fixture(scope="module")
def images() -> list[ImageRun]:
    return [tiny_image_run()]


def test_one_dimension_in_closed_form():
    example = line_example()
    s = np.abs(example.x - 0.75)
    closed = {
        "none": np.minimum(0.5, 0.1 + 3 * s),
        "gradient-limiting": np.minimum(0.5, 0.1 + s),
        "size-preserving": np.minimum(0.5, np.maximum(0.1, (3 * s + 0.1) / 4)),
    }
    for method, sizes in closed.items():
        assert np.abs(example.sizes[method] - sizes).max() < 1e-12
        steps = np.diff(example.nodes[method])[:-1]
        at = np.interp(example.nodes[method][:-2], example.x, sizes)
        assert np.abs(steps - at).max() < 1e-12
    for alpha, sizes in example.by_alpha.items():
        valley = np.maximum(0.1, (3 * s + 0.1) / (1 + 3 * alpha))
        assert np.abs(sizes - np.minimum(0.5, valley)).max() < 1e-12


def test_ratios_have_the_published_shape():
    example = line_example()
    assert len(example.nodes["none"]) == 3  # "only two elements are generated"
    assert example.ratios["none"].max() > example.ratios["gradient-limiting"].max() > 1
    assert example.ratios["size-preserving"].max() <= 1 + 1e-9


def test_tables_hold_the_published_columns():
    table = ring_table(RING)
    rows = list(csv.reader(io.StringIO(table.as_csv())))
    assert rows[0][1:] == ["gradient-limiting"] * 2 + ["size-preserving"] * 2
    assert rows[1][1:] == ["published", "decomposition"] * 2
    assert [row[0] for row in rows[2:]] == [*ROWS, *STRICT]
    assert rows[2][1:] == ["64845", "3000", "111092", "2000"]
    assert rows[5][2] == "1.500" and rows[5][4] == "1.050"
    latex = table.as_latex()
    assert latex.count(r"\\") == len(rows) and r"99.770" in latex and "%)" not in latex.replace(r"\%", "")


def test_the_guarantee_has_a_column_of_its_own(images):
    table = ring_table([*RING, adaptation(GUARANTEED, "frontal", (50.0, 1.0))])
    rows = list(csv.reader(io.StringIO(table.as_csv())))
    assert (rows[0][-1], rows[1][-1]) == (GUARANTEED, "frontal")
    by_name = {row[0]: row[1:] for row in rows}
    assert by_name["max R(e), longest edge"] == ["", "1.200", "", "1.200", "1.200"]
    assert r"\multicolumn{1}{c}{guaranteed}" in table.as_latex()
    study = run(Study(images[0].source, StudyOptions()), (GUARANTEED,))
    one = replace(images[0], runs={**images[0].runs, GUARANTEED: study.runs[GUARANTEED]})
    column = image_table([one]).columns[GUARANTEED, "frontal"]
    assert column["correct faces (%)"] == column["correct faces, longest edge (%)"] == 100.0
    assert "time (s)" not in column
    assert PaperOptions().methods("frontal") == (*COMPARED, GUARANTEED)
    assert PaperOptions().methods("decomposition") == COMPARED


def test_sizes_vary_over_the_image():
    source = image_source("mri")
    assert np.mean(source.field.sizes == source.field.sizes.min()) < 1e-3
    ideal = {
        name: ideal_count(process(source.field), source.domain)
        for name, process in (
            ("limited", lambda field: limited(field, LimitOptions(epsilon=0.5))),
            ("preserved", lambda field: preserved(field, PreserveOptions(alpha=2.0))),
        )
    }
    assert ideal["preserved"] > 1.4 * ideal["limited"]


def test_the_published_percentages_follow_from_the_counts():
    for name, columns in PUBLISHED.items():
        for method, column in columns.items():
            percent = 100 * column["correct faces"] / column["total faces"]
            misprint = (name, method) == ("table-2", "gradient-limiting")
            assert (abs(percent - column["correct faces (%)"]) > 0.02) == misprint


def test_only_all_elements_are_a_hundred_percent():
    assert shown("correct faces (%)", 99.99999) == "99.999"
    assert shown("correct faces (%)", 100.0) == "100"


def test_table_2_comes_from_the_reports(images):
    columns = image_table(images).columns
    report = images[0].runs["size-preserving"].report
    assert columns["size-preserving", "frontal"]["total faces"] == report.n_quads
    assert columns["size-preserving", "frontal"]["max R(e)"] == report.max_ratio["mean-edge"]
    assert columns["size-preserving", "published"]["time (s)"] == 6.67
    assert columns["size-preserving", "frontal"]["time (s)"] == 0.5


def test_the_summary_sets_side_by_side(images):
    names = images[0].runs
    norms = {("slope", "frontal", name): {"mean": 1.0, "rms": 2.0 + k, "max": 9.0} for k, name in enumerate(names)}
    text = summary(PaperOptions(), line_example(), RING, {"slope": images}, norms)
    assert "converged in 1 iteration (the paper: 4)" in text
    assert "did not converge in 2 iterations" in text
    assert "50.0 % larger than gradient limiting's at one mesh scale, and 25.0 % smaller at equal" in text
    assert text.count("| total faces |") == 2
    assert "mesh scale, 0.83" in text


def test_gradient_limiting_is_meshed_again_at_equal_count():
    found = image_runs("phantom", PaperOptions(meshers=("decomposition",), scale=6.0))[0]
    counts = {method: one.report.n_quads for method, one in found.runs.items()}
    assert counts["gradient-limiting"] < 0.9 * counts["size-preserving"]
    assert counts[EQUAL_COUNT] == pytest.approx(counts["size-preserving"], rel=0.1)
    assert isinstance(found.runs[EQUAL_COUNT].mesh, QuadMesh)
    assert all(0 < seconds < 60 for seconds in found.field_seconds.values())


@pytest.mark.parametrize("bad", [{"meshers": ("magic",)}, {"meshers": ()}, {"iterations": 0}])
def test_options_out_of_range(bad):
    with pytest.raises(InputError):
        PaperOptions(**bad)
