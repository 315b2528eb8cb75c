"""Tables 1 and 2 as published.

Ruiz-Girones, Roca, Sarrate (2013), DOI 10.1007/978-3-319-02335-9. Its text gives other numbers in two places: 2.11 s
for gradient limiting, and a largest R of 1.08 for size preserving, both in Section 5.2. The percentage of Table 2's
gradient limiting is printed as 81.33; its own counts give 82.88.
"""

from __future__ import annotations

ROWS: tuple[str, ...] = (
    "total faces",
    "correct faces",
    "correct faces (%)",
    "max R(e)",
    "min quality",
    "max quality",
    "mean quality",
    "quality deviation",
)
"""The rows that both tables have, in their order."""

STRICT: tuple[str, ...] = ("max R(e), longest edge", "correct faces, longest edge (%)")
"""Rows that only our columns have: both by the strictest size of an element."""

SECONDS = "time (s)"
"""The last row of Table 2: how long the field takes."""


def _column(*values: float) -> dict[str, float]:
    return dict(zip((*ROWS, SECONDS), values, strict=False))


PUBLISHED: dict[str, dict[str, dict[str, float]]] = {
    "table-1": {
        "gradient-limiting": _column(64845, 51506, 79.42, 1.268, 0.333, 0.999, 0.843, 0.121),
        "size-preserving": _column(111092, 110847, 99.77, 1.046, 0.356, 0.999, 0.895, 0.107),
    },
    "table-2": {
        "gradient-limiting": _column(64918, 53804, 81.33, 1.92, 0.05, 0.99, 0.78, 0.14, 1.05),
        "size-preserving": _column(192121, 191734, 99.79, 1.11, 0.35, 0.99, 0.90, 0.09, 6.67),
    },
}
"""Columns by table and method."""
