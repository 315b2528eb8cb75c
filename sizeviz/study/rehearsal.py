"""A tiny study that calls every kernel of the pipeline once, so that all are compiled before real work begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry import Domain
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sources.source import Source
from sizeviz.study.pipeline import COMPARED, run
from sizeviz.study.report import mesh_arrays
from sizeviz.study.study import Study

if TYPE_CHECKING:
    from numpy.typing import NDArray


def rehearsed(monitor: Monitor = SILENT) -> Study:
    """Return the study of a valley on a small grid, run by the methods that are compared.

    Raises
    ------
    Cancelled
        If the monitor says so.
    """
    background = BackgroundMesh.unit_square_grid(33, 33)
    field = SizeField(background, _valley(background.points), label="rehearsal")
    source = Source(name="rehearsal", label="rehearsal", domain=Domain.unit_square(), field=field, reference=field)
    study = run(Study(source), COMPARED, monitor)
    for method in COMPARED:
        mesh_arrays(study, method)
    return study


def _valley(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return sizes with a narrow valley, a slope and a plateau, so that every branch is taken."""
    return np.clip(np.abs(points[:, 0] - 0.4 - 0.2 * points[:, 1]), 0.03, 0.12)
