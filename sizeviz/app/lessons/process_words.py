"""What the player of the adaptive process says of an iteration: pure, no Qt."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.scene.subject import METHOD_TITLES

if TYPE_CHECKING:
    from sizeviz.app.lessons.process import ProcessShown
    from sizeviz.study.evolution import Evolution, Iteration

INTRODUCTION = (
    "Often sizes are known only where a mesh already has nodes, as after a computation. <b>Algorithm 3</b> then "
    "meshes again "
    "and again: ask for sizes at the nodes of the last mesh, limit or preserve them, make the next mesh, until no "
    "element "
    "is too large.<br><br>Start it, and step through its meshes while it runs."
)
"""What is said before there is anything to show."""


def process_title(shown: ProcessShown) -> str:
    """Return the heading: which mesh is on show."""
    if not shown.count:
        return "Algorithm 3"
    return "The uniform mesh" if shown.number == 0 else f"Iteration {shown.number} of {shown.count - 1}"


def process_words(shown: ProcessShown) -> str:
    """Return what the iteration on show means, as rich text."""
    evolution = shown.evolution
    if evolution is None or not shown.count:
        waiting = "The first mesh is on its way." if shown.running else INTRODUCTION
        return waiting
    row = evolution.iterations[shown.number]
    return f"{_iteration_words(row, evolution)}<br><br>{verdict_words(shown)}"


def verdict_words(shown: ProcessShown) -> str:
    """Return how the process stands."""
    evolution = shown.evolution
    assert evolution is not None
    count, last = shown.count - 1, evolution.iterations[-1].analytic_ratio
    method = METHOD_TITLES.get(str(evolution.options.get("method")), "The process")
    if evolution.converged and count == 0:
        return f"No R is above {evolution.limit:g}: there was nothing to do. <b>Begin with a coarser first mesh.</b>"
    if evolution.converged:
        return f"{method} <b>converged in {count} iteration{'s' * (count != 1)}</b>: no R above {evolution.limit:g}."
    state = "so far" if shown.running else "when it stopped"
    return f"{method} has not converged: after {count} iterations the largest R is {last:.3g} {state}."


def process_rows(shown: ProcessShown) -> tuple[tuple[str, str, str], ...]:
    """Return symbols, plain words and numbers of the iteration on show."""
    if shown.evolution is None or not shown.count:
        return ()
    row = shown.evolution.iterations[shown.number]
    return (
        ("", "elements", f"{row.n_quads:,}"),
        ("max R", "against the field", f"{row.analytic_ratio:.3f}"),
        ("max R", "against its background", f"{row.background_ratio:.3f}"),
        ("R ≤ 1", "of the elements, field", f"{int(row.analytic_correct * 1000) / 1000:g} %"),
        ("q", "quality, least and mean", f"{row.quality_min:.2f}, {row.quality_mean:.3f}"),
        ("", "seconds", f"{row.seconds:.1f}"),
    )


def _iteration_words(row: Iteration, evolution: Evolution) -> str:
    if row.number == 0:
        return (
            "The process begins with equal elements, which know nothing of the field: the worst is "
            f"<b>{row.analytic_ratio:.3g} times</b> as large as asked for. Their nodes are where sizes are asked next."
        )
    captured = row.background_ratio <= evolution.limit
    text = (
        f"Made from the sizes at the nodes of mesh {row.number - 1}. Against <i>those</i> sizes the largest R is "
        f"{row.background_ratio:.3g}: what was asked for " + ("was kept. " if captured else "was <b>not</b> kept. ")
    )
    gap = row.analytic_ratio - row.background_ratio
    if row.analytic_ratio <= evolution.limit:
        return text + f"Against the field itself it is {row.analytic_ratio:.3g}: nothing is left to do."
    why = "the background had not yet seen the smallest sizes" if captured and gap > 0.05 else "elements are too large"
    return text + f"Against the field itself it is {row.analytic_ratio:.3g}: {why}."
