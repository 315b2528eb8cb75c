"""The paper's examples run again: their numbers beside the published ones."""

from sizeviz.study.paper.adaptation import Adaptation, adaptations
from sizeviz.study.paper.images import ImageRun, image_runs
from sizeviz.study.paper.line import LineExample, line_example
from sizeviz.study.paper.options import MESHERS, PaperOptions
from sizeviz.study.paper.published import PUBLISHED, ROWS
from sizeviz.study.paper.tables import Table, image_table, ring_table

__all__ = [
    "MESHERS",
    "PUBLISHED",
    "ROWS",
    "Adaptation",
    "ImageRun",
    "LineExample",
    "PaperOptions",
    "Table",
    "adaptations",
    "image_runs",
    "image_table",
    "line_example",
    "ring_table",
]
