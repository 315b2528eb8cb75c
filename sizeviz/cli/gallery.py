"""``sizeviz examples``: the gallery."""

from __future__ import annotations


def examples() -> None:
    """List the examples: their names, and what they show."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from sizeviz.cli.tables import console
    from sizeviz.sources import examples as gallery

    table = Table(box=SIMPLE_HEAD)
    for heading in ("name", "what it is"):
        table.add_column(heading)
    for example in gallery():
        table.add_row(example.name, example.label)
    console().print(table)
    print("Try: sizeviz compare ring --out demo")
