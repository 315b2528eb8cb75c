"""Whether a mesh reproduces prescribed sizes: R(e), shape quality, the report of Tables 1 and 2."""

from sizeviz.conformity.measures import (
    MEASURES,
    Measure,
    boundary_nodes,
    edge_lengths,
    element_sizes,
    irregular_fraction,
    shape_quality,
)
from sizeviz.conformity.report import TOLERANCE, MeshReport, judged

__all__ = [
    "MEASURES",
    "TOLERANCE",
    "Measure",
    "MeshReport",
    "boundary_nodes",
    "edge_lengths",
    "element_sizes",
    "irregular_fraction",
    "judged",
    "shape_quality",
]
