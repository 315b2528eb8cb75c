"""The immutable document: a source, the options, and each method's results as far as they were computed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from sizeviz.study.options import StudyOptions

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sizeviz.conformity import MeshReport
    from sizeviz.geometry import QuadMesh
    from sizeviz.improvement import GuaranteeReport
    from sizeviz.sizing import SizeField
    from sizeviz.sources import Source

STAGES: tuple[str, ...] = ("field", "mesh", "smooth", "judge")
"""The stages of one method's run, in order; ``MethodRun.seconds`` counts by them."""


@dataclass(frozen=True, eq=False)
class MethodRun:
    """One method's results; a stage that has not been run, or is stale, is None, and so is all that follows it.

    Parameters
    ----------
    target : SizeField, optional
        The processed field, which drives mesher and smoother.
    raw : QuadMesh, optional
        The mesh as generated.
    mesh : QuadMesh, optional
        The mesh as improved; the raw one where smoothing is off.
    report : MeshReport, optional
        Its judgement against the field the user gave.
    seconds : mapping of str to float
        Wall-clock time by stage, for the stages that were run.
    tight : SizeField, optional
        What the guaranteed mesh is generated for: ``target``, finer where that has no slack; made with the mesh.
    guarantee : GuaranteeReport, optional
        What the guarantee reached; made with the improved mesh.
    """

    target: SizeField | None = None
    raw: QuadMesh | None = None
    mesh: QuadMesh | None = None
    report: MeshReport | None = None
    seconds: Mapping[str, float] = field(default_factory=dict)
    tight: SizeField | None = None
    guarantee: GuaranteeReport | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "seconds", MappingProxyType(dict(self.seconds)))

    @property
    def is_complete(self) -> bool:
        """Whether every stage has a result."""
        return self.report is not None

    @property
    def total_seconds(self) -> float:
        """Wall-clock time of all stages together."""
        return sum(self.seconds.values())

    def cleared_from(self, stage: str) -> MethodRun:
        """Return the run without the results of a stage and of those after it."""
        first = STAGES.index(stage)
        made_by = {"target": 0, "tight": 1, "raw": 1, "guarantee": 2, "mesh": 2, "report": 3}
        dropped = {name: None for name, stage_index in made_by.items() if stage_index >= first}
        kept = {name: value for name, value in self.seconds.items() if STAGES.index(name) < first}
        return replace(self, **dropped, seconds=kept)


@dataclass(frozen=True, eq=False)
class Study:
    """A source, what is asked for, and what came of it.

    Parameters
    ----------
    source : Source
        Where the size field, its domain and the reference come from.
    options : StudyOptions
        What is asked for.
    runs : mapping of str to MethodRun
        Results by method: 'none', 'gradient-limiting', 'size-preserving', 'guaranteed'.
    """

    source: Source
    options: StudyOptions = field(default_factory=StudyOptions)
    runs: Mapping[str, MethodRun] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "runs", MappingProxyType(dict(self.runs)))

    def with_source(self, source: Source) -> Study:
        """Return the study of another source; no result survives."""
        return replace(self, source=source, runs={})

    def with_options(self, options: StudyOptions) -> Study:
        """Return the study with other options; results that they change, and all that follows, are dropped."""
        runs = {}
        for method, run in self.runs.items():
            stage = first_stale_stage(method, self.options, options)
            runs[method] = run if stage is None else run.cleared_from(stage)
        return replace(self, options=options, runs=runs)

    def with_run(self, method: str, run: MethodRun) -> Study:
        """Return the study with one method's results replaced."""
        return replace(self, runs={**self.runs, method: run})


def first_stale_stage(method: str, old: StudyOptions, new: StudyOptions) -> str | None:
    """Return the first stage of a method's run that a change of options reaches, None where it reaches none."""
    old, new = old.without_threads(), new.without_threads()
    own_old, own_new = {
        "gradient-limiting": (old.limit, new.limit),
        "size-preserving": (old.preserve, new.preserve),
        "guaranteed": (old.preserve, new.preserve),
    }.get(method, (None, None))
    if old.beta != new.beta or own_old != own_new:
        return "field"
    if old.mesh != new.mesh:
        return "mesh"
    if old.smooth != new.smooth or old.smoothing != new.smoothing:
        return "smooth"
    return None
