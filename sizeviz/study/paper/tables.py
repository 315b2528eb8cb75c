"""Tables 1 and 2: the published columns, and ours by each mesher."""

from __future__ import annotations

import csv
import io
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sizeviz.files import replacing
from sizeviz.study.paper.published import PUBLISHED, ROWS, SECONDS, STRICT
from sizeviz.study.pipeline import COMPARED, GUARANTEED

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from sizeviz.study.evolution import Evolution
    from sizeviz.study.paper.adaptation import Adaptation
    from sizeviz.study.paper.images import ImageRun


@dataclass(frozen=True, eq=False)
class Table:
    """One table, published and ours side by side.

    Parameters
    ----------
    name : str
        Name of its files.
    title : str
        Its caption.
    columns : dict of (str, str) to dict
        By method and by whose they are ('published', or a mesher); each has one number a row.
    """

    name: str
    title: str
    columns: dict[tuple[str, str], dict[str, float]]

    @property
    def rows(self) -> list[str]:
        """The rows that any column has, in the paper's order."""
        return [row for row in (*ROWS, *STRICT, SECONDS) if any(row in column for column in self.columns.values())]

    def cells(self, row: str) -> list[str]:
        """Return one row as text, a cell a column."""
        return [shown(row, column[row]) if row in column else "" for column in self.columns.values()]

    def write(self, folder: Path) -> None:
        """Write the table as CSV and as LaTeX."""
        for suffix, text in ((".csv", self.as_csv()), (".tex", self.as_latex())):
            with replacing(folder / f"{self.name}{suffix}") as part:
                part.write_text(text, encoding="utf-8")

    def as_csv(self) -> str:
        """Return the table with one line a row, two lines of headings."""
        out = io.StringIO()
        lines = csv.writer(out, lineterminator="\n")
        lines.writerow(["method", *(method for method, _ in self.columns)])
        lines.writerow(["mesher", *(whose for _, whose in self.columns)])
        for row in self.rows:
            lines.writerow([row, *self.cells(row)])
        return out.getvalue()

    def as_latex(self) -> str:
        """Return a ``table`` environment."""
        counts = Counter(method for method, _ in self.columns)
        lines = [
            r"\begin{table}",
            rf"\caption{{{_escaped(self.title)}}}",
            rf"\begin{{tabular}}{{l*{{{len(self.columns)}}}{{r}}}}",
        ]
        lines.append(
            " & ".join(["", *(rf"\multicolumn{{{n}}}{{c}}{{{method}}}" for method, n in counts.items())]) + r" \\"
        )
        lines.append(" & ".join(["", *(whose for _, whose in self.columns)]) + r" \\ \hline")
        lines += [" & ".join([_escaped(row), *self.cells(row)]) + r" \\" for row in self.rows]
        return "\n".join([*lines, r"\end{tabular}", r"\end{table}", ""])

    def as_markdown(self) -> str:
        """Return a pipe table."""
        heads = [f"{method}, {whose}" for method, whose in self.columns]
        lines = ["| | " + " | ".join(heads) + " |", "|---|" + "---:|" * len(heads)]
        lines += [f"| {row} | " + " | ".join(self.cells(row)) + " |" for row in self.rows]
        return "\n".join(lines)


def ring_table(found: Sequence[Adaptation]) -> Table:
    """Return Table 1: the last mesh of each adaptive process, judged against the analytic function."""
    ours = {(one.method, one.mesher): _last_row(one.evolution) for one in found}
    title = "Statistics for the meshes of the adaptive process at the last iteration"
    return _table("table-1", title, "table-1", ours)


def image_table(found: Sequence[ImageRun], name: str = "table-2") -> Table:
    """Return Table 2, or the same of another image."""
    ours = {
        (method, one.mesher): _run_column(one, method)
        for method in (*COMPARED, GUARANTEED)
        for one in found
        if method in one.runs
    }
    return _table(name, f"Statistics for the meshes generated for {found[0].source.label}", "table-2", ours)


def shown(row: str, value: float) -> str:
    """Return a number as the tables show it; shares are rounded down, so that only all elements make 100."""
    if row.endswith("faces"):
        return f"{value:.0f}"
    if row.endswith("(%)"):
        return "100" if value >= 100.0 else f"{int(value * 1000) / 1000:.3f}"
    return f"{value:.2f}" if row == SECONDS else f"{value:.3f}"


def _table(name: str, title: str, published: str, ours: dict[tuple[str, str], dict[str, float]]) -> Table:
    columns = {}
    for method in COMPARED:
        columns[method, "published"] = PUBLISHED[published][method]
        columns |= {key: column for key, column in ours.items() if key[0] == method}
    columns |= {key: column for key, column in ours.items() if key[0] == GUARANTEED}
    return Table(name, title, columns)


def _last_row(evolution: Evolution) -> dict[str, float]:
    last = evolution.iterations[-1]
    numbers = (
        last.n_quads,
        round(last.analytic_correct * last.n_quads / 100.0),
        last.analytic_correct,
        last.analytic_ratio,
        last.quality_min,
        last.quality_max,
        last.quality_mean,
        last.quality_std,
    )
    return dict(zip((*ROWS, *STRICT), (*numbers, last.strict_ratio, last.strict_correct), strict=True))


def _run_column(one: ImageRun, method: str) -> dict[str, float]:
    report = one.runs[method].report
    assert report is not None
    column = report.table("max-edge" if method == GUARANTEED else "mean-edge")
    column |= zip(STRICT, (report.max_ratio["max-edge"], report.correct_percent["max-edge"]), strict=True)
    return {**column, SECONDS: one.field_seconds[method]} if method in one.field_seconds else column


def _escaped(text: str) -> str:
    return text.replace("%", r"\%").replace("_", r"\_")
