"""``summary.md``: published, ours by decomposition, ours by the frontal mesher, side by side and in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.study.paper.images import EQUAL_COUNT
from sizeviz.study.paper.published import PUBLISHED, SECONDS
from sizeviz.study.paper.tables import image_table, ring_table, shown
from sizeviz.study.report import versions

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sizeviz.study.paper.adaptation import Adaptation
    from sizeviz.study.paper.images import ImageRun
    from sizeviz.study.paper.line import LineExample
    from sizeviz.study.paper.options import PaperOptions

Norms = dict[tuple[str, str, str], dict[str, float]]
"""Interpolation errors in percent, ``mean``, ``rms`` and ``max``, by source, mesher and method."""


def summary(
    options: PaperOptions,
    line: LineExample,
    ring: Sequence[Adaptation],
    images: Mapping[str, Sequence[ImageRun]],
    norms: Norms,
) -> str:
    """Return the summary as Markdown."""
    parts = [
        "# The paper's examples, published and ours\n",
        "E. Ruiz-Gironés, X. Roca, J. Sarrate (2013), Combining Size-Preserving and Smoothing Procedures for Adaptive "
        "Quadrilateral Mesh Generation, Proceedings of the 22nd International Meshing Roundtable, "
        "DOI 10.1007/978-3-319-02335-9.\n",
        f"Plain mode: the processed field alone drives mesher and smoother. One mesh scale, {options.scale:g}, serves "
        "both methods and every mesher. The size of an element is its mean edge, and its R uses the least prescribed "
        "size over the whole element. *decomposition* is the paper's kind of mesher, *frontal* is ours. The column "
        "*guaranteed* is size preserving with sizeviz's guarantee, at scale 1: there the size of an element is its "
        "longest edge, the strictest measure, by which two rows judge every column.\n",
        _line_part(line),
        "## Section 5.1: the adaptive process (Figures 4 and 5, Table 1)\n",
        ring_table(ring).as_markdown() + "\n",
        *(_process_words(one) for one in ring),
    ]
    for k, found in enumerate(images.values()):
        parts += _image_part(found, norms, numbered=k == 0)
    parts.append("\n" + ", ".join(f"{name} {version}" for name, version in versions().items()) + "\n")
    return "\n".join(parts)


def _line_part(line: LineExample) -> str:
    rows = [
        f"| {method} | {len(line.nodes[method]) - 1} | {line.ratios[method].max():.4f} |"
        for method in ("none", "gradient-limiting", "size-preserving")
    ]
    head = "## Section 2: one dimension (Figures 1 to 3)\n\n| sizes | elements | largest R(e) |\n|---|---:|---:|\n"
    return head + "\n".join(rows) + "\n"


def _process_words(one: Adaptation) -> str:
    evolution = one.evolution
    count, last = len(evolution.iterations) - 1, evolution.iterations[-1]
    seconds = sum(row.seconds for row in evolution.iterations)
    lowest = min(row.background_ratio for row in evolution.iterations[1:]) if count else last.background_ratio
    verdict = f"{'converged' if evolution.converged else 'did not converge'} in {count} iteration{'s' * (count != 1)}"
    published = {
        "size-preserving": " (the paper: 4)",
        "gradient-limiting": " (the paper: not in 50, never below 1.28 against the background)",
    }.get(one.method, f": no longest edge above {evolution.limit:g} times the size")
    return (
        f"- {one.method}, {one.mesher}: {verdict}{published}; {last.n_quads:,} elements, largest R "
        f"against the analytic function {last.analytic_ratio:.3f}; lowest largest R against a background {lowest:.3f}; "
        f"{last.irregular:.1f} % irregular nodes; {seconds:.0f} s.\n"
    )


def _image_part(found: Sequence[ImageRun], norms: Norms, *, numbered: bool) -> list[str]:
    source = found[0].source
    table = image_table(found)
    where = " (Figures 6 to 8, Table 2)" if numbered else ""
    parts = [
        f"\n## Section 5.2: {source.label}{where}\n",
        "The published columns are of the paper's own image, which is not available: compare shares and qualities, "
        "not counts.\n",
        table.as_markdown() + "\n",
        _field_words(found),
        "Interpolation error of the image, in percent of its range of intensities:\n",
        "| mesh | elements | mean | root mean square | largest element |\n|---|---:|---:|---:|---:|",
    ]
    for one in found:
        for method, run in one.runs.items():
            assert run.mesh is not None
            norm = norms[source.name, one.mesher, method]
            numbers = " | ".join(f"{norm[name]:.4f}" for name in ("mean", "rms", "max"))
            parts.append(f"| {method}, {one.mesher} | {run.mesh.n_quads:,} | {numbers} |")
    parts.append("")
    parts += [_error_words(one, norms) for one in found]
    return parts


def _field_words(found: Sequence[ImageRun]) -> str:
    seconds = found[0].field_seconds["size-preserving"]
    published = PUBLISHED["table-2"]["size-preserving"][SECONDS]
    nodes = len(found[0].source.field.sizes)
    return (
        f"h* took {shown(SECONDS, seconds)} s on {nodes:,} background nodes: {published / seconds:.0f} times faster "
        f"than the published {published} s.\n"
    )


def _error_words(one: ImageRun, norms: Norms) -> str:
    def rms(method: str) -> float:
        return norms[one.source.name, one.mesher, method]["rms"]

    ours = rms("size-preserving")
    return (
        f"- {one.mesher}: size preserving's root mean square error is {_share(ours, rms('gradient-limiting'))} than "
        f"gradient limiting's at one mesh scale, and {_share(ours, rms(EQUAL_COUNT))} at equal element counts.\n"
    )


def _share(ours: float, other: float) -> str:
    change = 100.0 * (ours / other - 1.0)
    return f"{abs(change):.1f} % {'smaller' if change < 0 else 'larger'}"
