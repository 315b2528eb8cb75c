"""The backgrounds of an adaptive process: the uniform mesh it starts from, and sizes on the previous mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from sizeviz.errors import MeshingError
from sizeviz.geometry import QuadMesh
from sizeviz.meshing import generated
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sizing import BackgroundMesh, Grid, SizeField

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import Domain
    from sizeviz.meshing import MeshOptions
    from sizeviz.sizing import SizeFunction

Sampling = Literal["refined", "nodes"]
"""Where on a mesh a function is asked: at nodes, edge middles and element middles, or at its nodes only."""


def background_of(mesh: QuadMesh, reference: SizeFunction, sampling: Sampling = "refined") -> SizeField:
    """Return the sizes that a function has on a mesh, linear on triangles that its quadrilaterals are cut into.

    Parameters
    ----------
    mesh : QuadMesh
        The previous mesh of an adaptive process.
    reference : SizeFunction
        The field the user gave.
    sampling : {'refined', 'nodes'}
        With 'nodes' each quadrilateral is cut in two, and the sizes are those at its corners; with 'refined' it is
        cut in eight, and the middles of its edges and its own are asked as well.
    """
    points, triangles = _cut_in_two(mesh) if sampling == "nodes" else _cut_in_eight(mesh)
    return SizeField(BackgroundMesh(points, triangles), reference.at(points), label="background")


def uniform_mesh(domain: Domain, cells: int, options: MeshOptions, monitor: Monitor = SILENT) -> QuadMesh:
    """Return a mesh of equal elements, ``cells`` along the domain's longer side; of a rectangle, a grid of squares.

    Raises
    ------
    MeshingError
        If it would have more than ``options.max_elements`` elements.
    """
    x0, y0, x1, y1 = domain.bounds
    h = max(x1 - x0, y1 - y0) / cells
    if domain.area / h / h > options.max_elements:
        raise MeshingError(
            f"the first mesh would have {domain.area / h / h:.3g} elements, {cells} along its longer side, more than "
            f"{options.max_elements}; begin with fewer (--cells), or raise the limit (--max-elements)"
        )
    if domain.holes or len(domain.outer) != 4 or not np.isclose(domain.area, (x1 - x0) * (y1 - y0), rtol=1e-12):
        box = BackgroundMesh.regular(Grid(x0, y0, (x1 - x0) / 2, (y1 - y0) / 2, 3, 3))
        return generated(domain, SizeField(box, np.full(9, h), label="uniform"), replace(options, scale=1.0), monitor)
    nx, ny = max(1, round((x1 - x0) / h)), max(1, round((y1 - y0) / h))
    points = BackgroundMesh.regular(Grid(x0, y0, (x1 - x0) / nx, (y1 - y0) / ny, nx + 1, ny + 1)).points
    corner = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    quads = np.column_stack([corner, corner + 1, corner + nx + 2, corner + nx + 1]).astype(np.int32)
    return QuadMesh(points, quads, np.full(len(points), -1, dtype=np.int32), np.zeros(len(points), dtype=bool))


def _cut_in_two(mesh: QuadMesh) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Cut along the diagonal whose smaller triangle is larger: it lies inside wherever the element is not convex."""
    a, b, c, d = (mesh.points[mesh.quads[:, k]] for k in range(4))
    along_ac = np.minimum(_twice_area(a, b, c), _twice_area(a, c, d))
    along_bd = np.minimum(_twice_area(a, b, d), _twice_area(b, c, d))
    order = np.where((along_bd > along_ac)[:, None], [1, 2, 3, 0], [0, 1, 2, 3])
    turned = np.take_along_axis(mesh.quads, order, axis=1)
    return mesh.points, np.vstack([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]])


def _cut_in_eight(mesh: QuadMesh) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Join the middle of each element to its corners and to the middles of its edges."""
    quads, n, count = mesh.quads.astype(np.int64), mesh.n_points, mesh.n_quads
    ahead = np.roll(quads, -1, axis=1)
    keys = np.minimum(quads, ahead) * n + np.maximum(quads, ahead)
    unique, edge = np.unique(keys, return_inverse=True)
    ends = np.column_stack([unique // n, unique % n])
    points = np.vstack([mesh.points, mesh.points[ends].mean(axis=1), mesh.points[quads].mean(axis=1)])
    middle = n + edge.reshape(quads.shape)
    centre = np.broadcast_to((n + len(unique) + np.arange(count))[:, None], quads.shape)
    first, second = np.stack([quads, middle, centre], axis=2), np.stack([middle, ahead, centre], axis=2)
    return points, np.vstack([first.reshape(-1, 3), second.reshape(-1, 3)]).astype(np.int32)


def _twice_area(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> NDArray[np.float64]:
    u, v = b - a, c - a
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
