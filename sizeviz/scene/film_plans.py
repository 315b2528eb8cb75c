"""The two films there are: an adaptive process, iteration by iteration; and what turning α does to both methods."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files import read_mesh
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.scene.figures.sheet import COLORS
from sizeviz.scene.film import Curve, Film, Take
from sizeviz.scene.subject import METHOD_TITLES, StoredSubject
from sizeviz.scene.view import ViewState
from sizeviz.study.evolution import Iteration, read_evolution
from sizeviz.study.pipeline import COMPARED, run

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sizeviz.conformity import Measure
    from sizeviz.study import Study


def adaptive_film(folder: str | Path, *, dark: bool = False) -> Film:
    """Return the film of an adaptive process: R and quality of every mesh, over the R-evolution.

    Parameters
    ----------
    folder : path-like
        Where ``sizeviz adapt`` or ``sizeviz.adapt`` left the process.
    dark : bool
        Dark ground.

    Raises
    ------
    InputError
        If the folder holds no process.
    """
    folder = Path(folder)
    evolution = read_evolution(folder)
    if evolution is None or not evolution.iterations:
        raise InputError(f"{folder}: holds no adaptive process; make one with sizeviz adapt SOURCE --out {folder}")
    method = str(evolution.options.get("method"))
    title = METHOD_TITLES.get(method, method)
    measure = evolution.options.get("measure", "mean-edge")
    views = [ViewState(color_by=kind, measure=measure, dark=dark) for kind in ("ratio", "quality")]
    rows = evolution.iterations
    takes = [_iteration(folder, row, title) for row in rows]
    lines = {
        "against the given field": ([row.analytic_ratio for row in rows], COLORS.get(method, "#1f5fa8")),
        "against its own background": ([row.background_ratio for row in rows], "#8a8a8a"),
    }
    x = [float(row.number) for row in rows]
    curve = Curve(x, lines, "iteration", "largest R", levels=(1.0, evolution.limit), log=True)
    return Film(f"{evolution.source}: adaptive process", views, takes, curve, 0.8)


def alpha_film(
    study: Study,
    alphas: Sequence[float],
    *,
    methods: Sequence[str] = COMPARED,
    measure: Measure = "mean-edge",
    dark: bool = False,
    monitor: Monitor = SILENT,
) -> Film:
    """Return the film of a turning α, with ε = 1/α: R of the methods side by side, over the share of correct elements.

    Every α is a run of the whole pipeline, made here.

    Parameters
    ----------
    study : Study
        Its source and its other options.
    alphas : sequence of float
        In the order of the film.
    methods : sequence of str
        Which methods, from left to right.
    measure : {'mean-edge', 'sqrt-area', 'max-edge'}
        Size of an element.
    dark : bool
        Dark ground.
    monitor : Monitor
        Told of every run; may cancel.

    Raises
    ------
    InputError
        If there is no α, or one is out of range.
    """
    if not alphas:
        raise InputError("a film of a turning alpha needs at least one alpha")
    takes: list[Take] = []
    shares: dict[str, list[float]] = {method: [] for method in methods}
    for k, alpha in enumerate(alphas):
        options = replace(study.options, preserve=replace(study.options.preserve, alpha=alpha)).with_comparable_slope()
        part = SubMonitor(monitor, k / len(alphas), (k + 1) / len(alphas))
        done = run(study.with_options(options), methods, part)
        panes = tuple(_kept(done, method, measure) for method in methods)
        for method, pane in zip(methods, panes, strict=True):
            shares[method].append(100.0 * float(np.mean(pane.ratio <= 1.0 + 1e-9)))
        takes.append(Take(partial(tuple, panes), alpha, f"α = {alpha:.2f}"))
    views = [ViewState(method=method, measure=measure, dark=dark) for method in methods]
    fallback = "#1f7750"
    lines = {METHOD_TITLES[m]: (values, COLORS.get(m, fallback)) for m, values in shares.items()}
    curve = Curve(list(alphas), lines, "α", "correct (%)", levels=(100.0,))
    return Film(study.source.label, views, takes, curve, 0.25)


def _iteration(folder: Path, row: Iteration, title: str) -> Take:
    def panes() -> tuple[StoredSubject, StoredSubject]:
        content = read_mesh(folder / row.mesh)
        detail = f"{content.mesh.n_quads:,} elements"
        shown = StoredSubject(title=title, detail=detail, mesh=content.mesh, ratio=content.cell_data["ratio"])
        return shown, shown

    return Take(panes, float(row.number), f"iteration {row.number}")


def _kept(study: Study, method: str, measure: Measure) -> StoredSubject:
    """Return what a film shows of a run, without all that it does not."""
    result = study.runs[method]
    assert result.mesh is not None and result.report is not None
    slope = f"ε = {study.options.limit.epsilon:.2f}"
    words = slope if method == "gradient-limiting" else f"α = {study.options.preserve.alpha:.2f}"
    return StoredSubject(
        title=METHOD_TITLES[method],
        detail=f"{words} · {result.mesh.n_quads:,} elements",
        mesh=result.mesh,
        domain=study.source.domain,
        ratio=result.report.ratio(measure),
    )
