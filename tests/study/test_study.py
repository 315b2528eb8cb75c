"""The document: whatever changes, nothing stale is left to be shown."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from sizeviz.errors import InputError
from sizeviz.improvement import SmoothOptions
from sizeviz.meshing import MeshOptions
from sizeviz.sizing import LimitOptions, PreserveOptions
from sizeviz.study import MethodRun, Study, StudyOptions
from sizeviz.study.study import STAGES

RESULTS = ("target", "raw", "mesh", "report")
METHODS = ("none", "gradient-limiting", "size-preserving")


def complete() -> MethodRun:
    """Return a run with a marker for every result: only identity matters here."""
    markers: dict[str, Any] = {name: object() for name in RESULTS}
    return MethodRun(**markers, seconds=dict.fromkeys(STAGES, 1.0))


def full_study() -> Study:
    source: Any = object()
    return Study(source, StudyOptions(), {method: complete() for method in METHODS})


def kept(run: MethodRun) -> tuple[str, ...]:
    return tuple(name for name in RESULTS if getattr(run, name) is not None)


CHANGES = {
    "alpha": ({"preserve": PreserveOptions(alpha=3.0)}, {"size-preserving": ()}),
    "beta": ({"preserve": PreserveOptions(beta=0.5)}, dict.fromkeys(METHODS, ())),
    "epsilon": ({"limit": LimitOptions(epsilon=0.1)}, {"gradient-limiting": ()}),
    "scale": ({"mesh": MeshOptions(scale=0.5)}, dict.fromkeys(METHODS, ("target",))),
    "seed": ({"mesh": MeshOptions(seed=3)}, dict.fromkeys(METHODS, ("target",))),
    "sweeps": ({"smooth": SmoothOptions(sweeps=3)}, dict.fromkeys(METHODS, ("target", "raw"))),
    "smoothing": ({"smoothing": False}, dict.fromkeys(METHODS, ("target", "raw"))),
    "threads": ({"threads": 1}, {}),
    "mesh threads": ({"mesh": MeshOptions(threads=1)}, {}),
    "nothing": ({}, {}),
}


@pytest.mark.parametrize("change", CHANGES)
def test_an_option_clears_what_lies_downstream_and_no_more(change: str) -> None:
    replaced, expected = CHANGES[change]
    old = full_study()
    new = old.with_options(replace(old.options, **replaced))
    for method in METHODS:
        left = kept(new.runs[method])
        assert left == expected.get(method, RESULTS)
        for name in left:
            assert getattr(new.runs[method], name) is getattr(old.runs[method], name)
        assert tuple(new.runs[method].seconds) == STAGES[: len(left)]
        assert kept(old.runs[method]) == RESULTS, "the old study is as it was"


def test_another_source_clears_everything() -> None:
    source: Any = object()
    study = full_study().with_source(source)
    assert study.source is source
    assert not study.runs


def test_a_run_is_complete_with_its_report() -> None:
    run = complete()
    assert run.is_complete
    assert run.total_seconds == 4.0
    assert not run.cleared_from("judge").is_complete
    assert kept(run.cleared_from("judge")) == ("target", "raw", "mesh")


def test_with_run_replaces_one_method() -> None:
    study, run = full_study(), complete()
    new = study.with_run("none", run)
    assert new.runs["none"] is run
    assert new.runs["size-preserving"] is study.runs["size-preserving"]


def test_nothing_is_changed_in_place() -> None:
    study = full_study()
    with pytest.raises(TypeError):
        study.runs["none"] = complete()
    with pytest.raises(TypeError):
        study.runs["none"].seconds["field"] = 0.0


def test_comparable_slope_is_one_over_alpha() -> None:
    options = StudyOptions(preserve=PreserveOptions(alpha=4.0)).with_comparable_slope()
    assert options.limit.epsilon == 0.25


def test_threads_must_be_at_least_one() -> None:
    with pytest.raises(InputError, match="threads is 0"):
        StudyOptions(threads=0)


def test_the_guarantee_is_cleared_with_the_mesh_it_belongs_to() -> None:
    run = MethodRun(**{name: object() for name in ("target", "tight", "raw", "mesh", "guarantee", "report")})
    smoothed_again = run.cleared_from("smooth")
    assert smoothed_again.tight is run.tight and smoothed_again.raw is run.raw
    assert smoothed_again.guarantee is None and smoothed_again.mesh is None and smoothed_again.report is None
    assert run.cleared_from("mesh").tight is None
