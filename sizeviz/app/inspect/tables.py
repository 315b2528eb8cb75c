"""The table of the paper as plain data, and as CSV, Markdown or LaTeX."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sizeviz.scene.subject import MEASURE_TITLES, METHOD_TITLES
from sizeviz.scene.verdict import percent

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sizeviz.conformity import Measure, MeshReport
    from sizeviz.study import Study


@dataclass(frozen=True)
class Table:
    """Words in rows and columns; the first column names the rows.

    Parameters
    ----------
    header : tuple of str
        Heads of the columns.
    rows : tuple of tuple of str
        Each as long as the header.
    """

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def statistics(
    study: Study | None, methods: Sequence[str], measure: Measure, stale: Mapping[str, MeshReport] | None = None
) -> Table:
    """Return counts, conformity and quality of some methods, a column each; empty cells where nothing was run.

    Where the study has no run but ``stale`` an older report, its numbers stay, and the column's head says so.
    """
    older = dict(stale or {})
    titles = {name: METHOD_TITLES.get(name, name) + (" (stale)" if name in older else "") for name in methods}
    header = ("", *titles.values())
    columns = [
        dict(zip(_row_names(measure), report_cells(older[name], measure), strict=False))
        if name in older
        else _column(study, name, measure)
        for name in methods
    ]
    names = _row_names(measure)
    rows = tuple((name, *(column.get(name, "") for column in columns)) for name in names)
    return Table(header, rows)


def as_csv(table: Table) -> str:
    """Return the table as comma-separated values."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([table.header, *table.rows])
    return out.getvalue()


def as_markdown(table: Table) -> str:
    """Return the table as Markdown, numbers to the right."""
    lines = [table.header, ("---", *("---:" for _ in table.header[1:])), *table.rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def as_latex(table: Table) -> str:
    """Return the table as a LaTeX tabular with booktabs rules."""
    body = [" & ".join(_latex(cell) for cell in row) + r" \\" for row in table.rows]
    head = " & ".join(_latex(cell) for cell in table.header) + r" \\"
    columns = "l" + "r" * (len(table.header) - 1)
    lines = [
        rf"\begin{{tabular}}{{{columns}}}",
        r"\toprule",
        head,
        r"\midrule",
        *body,
        r"\bottomrule",
        r"\end{tabular}",
    ]
    return "\n".join(lines) + "\n"


FORMATS = {"CSV": as_csv, "Markdown": as_markdown, "LaTeX": as_latex}
"""What the table can be copied as."""


def _row_names(measure: Measure) -> tuple[str, ...]:
    words = MEASURE_TITLES[measure]
    return (
        "Elements", "Nodes", "Ideal count", "Elements / ideal", f"Correct, {words}", f"Largest R, {words}",
        "Quality, smallest", "Quality, mean", "Quality, deviation", "Irregular nodes", "Inverted", "Seconds",
    )  # fmt: skip


def _column(study: Study | None, method: str, measure: Measure) -> dict[str, str]:
    run = None if study is None else study.runs.get(method)
    if run is None or run.report is None:
        return {}
    cells = report_cells(run.report, measure)
    return dict(zip(_row_names(measure), (*cells, f"{run.total_seconds:.2f}"), strict=True))


def report_cells(report: MeshReport, measure: Measure) -> tuple[str, ...]:
    """Return a report's numbers as the table's cells, all but the seconds."""
    ratios, quality = report.ratios[measure], report.quality
    ideal = report.ideal_quads
    return (
        f"{report.n_quads:,}",
        f"{report.n_nodes:,}",
        "" if ideal is None else f"{ideal:,.0f}",
        "" if ideal is None else f"{report.n_quads / ideal:.2f}",
        percent(int((ratios <= 1.0 + 1e-9).sum()), len(ratios)),
        f"{ratios.max():.3f}",
        f"{quality.min():.3f}",
        f"{quality.mean():.3f}",
        f"{quality.std():.3f}",
        f"{report.irregular_percent:.1f} %",
        f"{report.n_inverted:,}",
    )


def _latex(cell: str) -> str:
    for plain, escaped in (("%", r"\%"), ("√", r"$\sqrt{}$"), ("&", r"\&"), ("#", r"\#")):
        cell = cell.replace(plain, escaped)
    return cell
