"""The table of a study on the terminal: a row a number of Tables 1 and 2, a column a method."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from collections.abc import Mapping

MEASURES: dict[str, str] = {"mean_edge": "mean edge", "sqrt_area": "√area", "max_edge": "longest edge"}
"""The measures' keys in a report, and their names."""

TITLES: dict[str, str] = {
    "none": "field as given",
    "gradient-limiting": "gradient limiting",
    "size-preserving": "size preserving",
    "guaranteed": "guaranteed",
}
"""The methods in words."""


def print_report(report: Mapping[str, Any]) -> None:
    """Print the table of a report, as ``report.json`` holds it."""
    methods = report["methods"]
    title = str(report["source"]["label"])
    if set(methods) != {"guaranteed"}:  # which finds a scale of its own
        title += f" · mesh scale {report['options']['mesh_scale']:g}"
    table = Table(box=SIMPLE_HEAD)
    table.add_column("")
    for method in methods:
        table.add_column(TITLES.get(method, method), justify="right")
    columns = [_cells(entry) for entry in methods.values()]
    for label in columns[0]:
        table.add_row(label, *(column[label] for column in columns))
    out = console()
    out.print(title, style="bold", highlight=False)
    out.print(table)


def console() -> Console:
    """Return the console of standard output; what is piped is not cut to a terminal's width."""
    return Console() if sys.stdout.isatty() else Console(width=120)


def _cells(entry: Mapping[str, Any]) -> dict[str, str]:
    ideal, quality = entry["ideal_quads"], entry["quality"]
    cells = {
        "quadrilaterals": f"{entry['n_quads']:,}",
        "ideal count ∫dA/h*²": f"{ideal:,.0f}",
        "  of the ideal": f"{entry['n_quads'] / ideal:.2f} ×",
        "nodes": f"{entry['n_nodes']:,}",
        "inverted": f"{entry['n_inverted']:,}",
    }
    for key, words in MEASURES.items():
        cells[f"R ≤ 1, {words}"] = f"{_floor(entry['correct_percent'][key])} %"
    for key, words in MEASURES.items():
        cells[f"largest R, {words}"] = f"{entry['max_ratio'][key]:.3f}"
    cells["quality, smallest"] = f"{quality['min']:.3f}"
    cells["quality, mean"] = f"{quality['mean']:.4f}"
    cells["quality, deviation"] = f"{quality['std']:.4f}"
    cells["irregular nodes"] = f"{entry['irregular_percent']:.2f} %"
    cells["seconds"] = f"{entry['seconds']['total']:.2f}"
    return cells


def _floor(percent: float) -> str:
    """Return a share rounded down, so that only all of them make 100."""
    return "100" if percent >= 100.0 else f"{int(percent * 1000) / 1000:.3f}"
