"""The pipeline that every window, command, test and tutorial runs: field, mesh, smooth, judge.

Plain mode is the paper's: the processed field alone drives mesher and smoother, one mesh scale serves every method,
and nothing looks at the user's field before the judge does. The guaranteed method may look at every step: it starts
from h*, makes it finer where an element of that size could reach below the user's sizes, meshes that at its own sizes,
and then moves and inserts nodes until R <= 1 by the longest edge.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

from sizeviz.conformity import judged
from sizeviz.errors import InputError
from sizeviz.improvement import GuaranteeOptions, improved, tightened
from sizeviz.meshing import generated
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sizing import AnalyticSize, ideal_count, limited, preserved
from sizeviz.study.promise import promised
from sizeviz.study.study import STAGES, MethodRun, Study

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sizeviz.sizing import SizeField, SizeFunction
    from sizeviz.study.options import StudyOptions

METHODS: tuple[str, ...] = ("none", "gradient-limiting", "size-preserving", "guaranteed")
"""What can be done with a field: meshed as it is, limited, preserved; or preserved with the guarantee."""

COMPARED: tuple[str, ...] = ("gradient-limiting", "size-preserving")
"""The methods that the paper compares."""

GUARANTEED = "guaranteed"
"""The method whose elements are all correct by the longest edge."""

METHOD_WORDS: dict[str, str] = {
    "none": "field as given",
    "gradient-limiting": "gradient limiting",
    "size-preserving": "size preserving",
    "guaranteed": "guaranteed",
}
"""The methods in words, for progress messages."""

_SHARE: dict[str, tuple[float, float]] = {
    "field": (0.0, 0.05),
    "mesh": (0.05, 0.50),
    "smooth": (0.50, 0.95),
    "judge": (0.95, 1.0),
}
"""Each stage's part of the progress bar, from measured times."""


def run(study: Study, methods: Sequence[str] = COMPARED, monitor: Monitor = SILENT) -> Study:
    """Return the study with the runs of some methods complete; results that are there already are kept.

    Parameters
    ----------
    study : Study
        What to run; it is not changed.
    methods : sequence of str
        Which of ``METHODS``, in the order to run them in.
    monitor : Monitor
        Told the method and the stage.

    Raises
    ------
    InputError
        If a method is unknown.
    MeshingError
        If no valid mesh could be made.
    Cancelled
        If the monitor says so.
    """
    for method in methods:
        _check_method(method)
    for k, method in enumerate(methods):
        part = SubMonitor(monitor, k / len(methods), (k + 1) / len(methods))
        study = study.with_run(method, _completed(study, method, part))
    return study


def processed(study: Study, method: str, monitor: Monitor = SILENT) -> SizeField:
    """Return the field that a method drives the mesher with: the first stage alone.

    Raises
    ------
    InputError
        If the method is unknown.
    """
    _check_method(method)
    options = study.options
    given = study.source.field
    if method in ("size-preserving", GUARANTEED):
        return preserved(given, options.preserve, threads=options.threads, monitor=monitor)
    asked = given if options.beta == 1.0 else given.with_sizes(options.beta * given.sizes)
    if method == "gradient-limiting":
        return limited(asked, options.limit, threads=options.threads, monitor=monitor)
    return asked


def _check_method(method: str) -> None:
    if method not in METHODS:
        raise InputError(f"method {method!r} is unknown; choose one of {', '.join(METHODS)}")


def _completed(study: Study, method: str, monitor: Monitor) -> MethodRun:
    run = study.runs.get(method, MethodRun())
    steps: tuple[Callable[[Study, str, MethodRun, Monitor], MethodRun], ...] = (_field, _mesh, _smooth, _judge)
    for stage, step, result in zip(STAGES, steps, ("target", "raw", "mesh", "report"), strict=True):
        if getattr(run, result) is not None:
            continue
        part = SubMonitor(monitor, *_SHARE[stage])
        part.step(0.0, f"{METHOD_WORDS[method]}: {stage}")
        began = time.perf_counter()
        run = step(study, method, run, part)
        run = replace(run, seconds={**run.seconds, stage: time.perf_counter() - began})
    monitor.step(1.0)
    return run


def _field(study: Study, method: str, run: MethodRun, monitor: Monitor) -> MethodRun:
    return replace(run, target=processed(study, method, monitor))


def _mesh(study: Study, method: str, run: MethodRun, monitor: Monitor) -> MethodRun:
    assert run.target is not None
    options, domain = _with_threads(study.options).mesh, study.source.domain
    if method != GUARANTEED:
        return replace(run, raw=generated(domain, run.target, options, monitor))
    tight = tightened(_asked(study), run.target)
    # the tight field holds the sizes that are needed: a scale on top would only spoil what it was made for
    return replace(run, tight=tight, raw=generated(domain, tight, replace(options, scale=1.0), monitor))


def _smooth(study: Study, method: str, run: MethodRun, monitor: Monitor) -> MethodRun:
    assert run.target is not None and run.raw is not None
    options = _with_threads(study.options).smooth
    if method == GUARANTEED:
        assert run.tight is not None
        wanted = GuaranteeOptions(smooth=options)
        meshing = _with_threads(study.options).mesh
        best = promised(study.source.domain, _asked(study), run.tight, run.raw, meshing, wanted, monitor)
        return replace(run, tight=best.tight, raw=best.raw, mesh=best.mesh, guarantee=best.report)
    if not study.options.smoothing:
        return replace(run, mesh=run.raw)
    return replace(run, mesh=improved(run.raw, study.source.domain, run.target, options, monitor))


def _judge(study: Study, method: str, run: MethodRun, monitor: Monitor) -> MethodRun:
    assert run.target is not None and run.mesh is not None
    options, source = study.options, study.source
    ideal = ideal_count(run.target, source.domain)
    report = judged(
        run.mesh, source.reference, beta=options.beta, ideal=ideal, threads=options.threads, monitor=monitor
    )
    return replace(run, report=report)


def _asked(study: Study) -> SizeFunction:
    """Return the sizes that R = 1 means: beta times the user's, eq. (3)."""
    beta, reference = study.options.beta, study.source.reference
    if beta == 1.0:
        return reference
    field = study.source.field.with_sizes(beta * study.source.field.sizes)
    if not isinstance(reference, AnalyticSize):
        return field
    return replace(reference, function=lambda x, y: beta * reference.function(x, y), field=field)


def _with_threads(options: StudyOptions) -> StudyOptions:
    if options.threads is None:
        return options
    mesh, smooth = replace(options.mesh, threads=options.threads), replace(options.smooth, threads=options.threads)
    return replace(options, mesh=mesh, smooth=smooth)
