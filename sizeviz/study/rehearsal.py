"""A tiny study that calls every kernel of the pipeline once, so that all are compiled before real work begins.

It can be played in parts, each in a process of its own (``python -m sizeviz.study.rehearsal PART``): compiling holds
the interpreter, so threads would not shorten it.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry import Domain, QuadMesh
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sizing import BackgroundMesh, LimitOptions, PreserveOptions, SizeField

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from sizeviz.study.study import Study


def rehearsed(monitor: Monitor = SILENT) -> Study:
    """Return the study of a valley on a small grid, run by the methods that are compared and with the guarantee.

    Raises
    ------
    Cancelled
        If the monitor says so.
    """
    from sizeviz.sources.source import Source
    from sizeviz.study.pipeline import COMPARED, GUARANTEED, run
    from sizeviz.study.report import mesh_arrays
    from sizeviz.study.study import Study

    field = valley()
    source = Source(name="rehearsal", label="rehearsal", domain=Domain.unit_square(), field=field, reference=field)
    methods = (*COMPARED, GUARANTEED)
    study = run(Study(source), methods, monitor)
    for method in methods:
        mesh_arrays(study, method)
    _play_triangles()
    return study


def valley(nodes: int = 33) -> SizeField:
    """Return sizes with a narrow valley, a slope and a plateau, so that every branch is taken."""
    background = BackgroundMesh.unit_square_grid(nodes, nodes)
    x, y = background.points.T
    return SizeField(background, np.clip(np.abs(x - 0.4 - 0.2 * y), 0.03, 0.12), label="rehearsal")


def on_triangles(field: SizeField) -> SizeField:
    """Return the same sizes on a background that is not known to be a grid, as formulas and files have."""
    return SizeField(BackgroundMesh(field.background.points, field.background.triangles), field.sizes, field.label)


def lattice(cells: int = 12) -> QuadMesh:
    """Return a skewed lattice on the unit square: a raw mesh that needs no mesher."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, cells + 1), np.linspace(0.0, 1.0, cells + 1))
    points = np.column_stack([x.ravel(), y.ravel()])
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    quads = np.column_stack([corner, corner + 1, corner + cells + 2, corner + cells + 1]).astype(np.int32)
    curve = _sides(points)
    inside = curve < 0
    points[inside] += 0.3 / cells * np.sin(9.0 * points[inside][:, ::-1])
    on_corner = [(x, y) in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)) for x, y in points]
    return QuadMesh(points, quads, curve, np.array(on_corner))


def _sides(points: NDArray[np.float64]) -> NDArray[np.int32]:
    """Return the side of the unit square that each point lies on: bottom, right, top, left, or -1."""
    x, y = points.T
    return np.select([y == 0.0, x == 1.0, y == 1.0, x == 0.0], [0, 1, 2, 3], -1).astype(np.int32)


def _play_field() -> None:
    from sizeviz.sizing import ideal_count, limited, preserved

    field = valley()
    limited(field, LimitOptions())
    ideal_count(preserved(field, PreserveOptions()), Domain.unit_square())
    _play_triangles()


def _play_triangles() -> None:
    from sizeviz.improvement import tightened
    from sizeviz.sizing import ideal_count, limited, preserved

    field = on_triangles(valley())
    limited(field, LimitOptions())
    ideal_count(tightened(field, preserved(field, PreserveOptions())), Domain.unit_square())
    field.min_over(lattice().points, lattice().quads)
    field.at(lattice().points)


def _play_mesh() -> None:
    from sizeviz.meshing import MeshOptions, generated

    generated(Domain.unit_square(), valley(), MeshOptions(preset="fast"))
    # so many nodes that they are packed in parts
    generated(Domain.unit_square(), valley(), MeshOptions(scale=0.12))


def _play_smooth() -> None:
    from sizeviz.improvement import guaranteed, tightened

    # the guarantee begins with everything that plain smoothing does
    guaranteed(lattice(), Domain.unit_square(), tightened(valley(), valley()), valley())


def _play_judge() -> None:
    from sizeviz.conformity import judged

    field = valley()
    judged(lattice(), field)
    field.at(lattice().points)


PARTS: dict[str, Callable[[], None]] = {
    "mesh": _play_mesh,
    "smooth": _play_smooth,
    "field": _play_field,
    "judge": _play_judge,
}
"""The parts, the longest first."""


if __name__ == "__main__":
    PARTS[sys.argv[1]]()
