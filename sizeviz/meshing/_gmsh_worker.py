"""Gmsh at work, in a process of its own: reads a request, meshes, writes the result. Started by ``gmsh.py``.

Gmsh keeps one global state, must not be entered by two threads, and cannot be interrupted; a process can be ended.
"""

from __future__ import annotations

import itertools
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

Arrays = dict[str, "NDArray[Any]"]


def meshed(request: Mapping[str, Any]) -> Arrays:
    """Return the nodes and elements that Gmsh makes of a request.

    Parameters
    ----------
    request : mapping
        ``curves``, ``inner_points`` and the background (``points``, ``triangles``, ``sizes``), with ``algorithm``
        and ``recombination``, Gmsh's own numbers.

    Returns
    -------
    dict
        ``points``, ``triangles``, ``quads``, ``curve`` and ``fixed``, and ``seconds``: meshing alone.
    """
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.add("domain")
        tags = _outline(gmsh, request)
        _background(gmsh, request)
        options = {
            "Mesh.MeshSizeFromPoints": 0,
            "Mesh.MeshSizeFromCurvature": 0,
            "Mesh.MeshSizeExtendFromBoundary": 0,
            "Mesh.MeshSizeMin": 0.0,
            "Mesh.RecombineAll": 1,
            "Mesh.Algorithm": int(request["algorithm"]),
            "Mesh.RecombinationAlgorithm": int(request["recombination"]),
            "Mesh.RandomSeed": int(request["seed"]) + 1,
            "General.NumThreads": 1,
        }
        for name, value in options.items():
            gmsh.option.setNumber(name, value)
        began = time.perf_counter()
        gmsh.model.mesh.generate(2)
        seconds = time.perf_counter() - began
        return {**_result(gmsh, request, tags), "seconds": np.array(seconds)}
    finally:
        gmsh.finalize()


def _outline(gmsh: Any, request: Mapping[str, Any]) -> list[int]:
    """Build the domain: a polyline a curve, so that nodes may lie anywhere along it; return the curves' tags."""
    geo = gmsh.model.geo
    known: dict[tuple[float, float], int] = {}

    def point(x: float, y: float) -> int:
        if (x, y) not in known:
            known[(x, y)] = geo.addPoint(x, y, 0.0)
        return known[(x, y)]

    tags = []
    for vertices in _split(request["curve_points"], request["curve_starts"]):
        ends = [point(float(x), float(y)) for x, y in vertices]
        tags.append(geo.addLine(*ends) if len(ends) == 2 else geo.addPolyline(ends))
    loops = [geo.addCurveLoop([tags[k] for k in range(a, b)]) for a, b in itertools.pairwise(request["loop_starts"])]
    surface = geo.addPlaneSurface(loops)
    inner = tags[int(request["loop_starts"][-1]) :]
    free = [point(float(x), float(y)) for x, y in request["inner_points"]]
    geo.synchronize()
    if inner:
        gmsh.model.mesh.embed(1, inner, 2, surface)
    if free:
        gmsh.model.mesh.embed(0, free, 2, surface)
    return tags


def _background(gmsh: Any, request: Mapping[str, Any]) -> None:
    """Hand the field over, and let it alone set the sizes."""
    field = _structured(gmsh, request) if "grid_frame" in request else _view(gmsh, request)
    gmsh.model.mesh.field.setAsBackgroundMesh(field)


def _view(gmsh: Any, request: Mapping[str, Any]) -> int:
    """Hand the field over as a view of linear triangles."""
    corners = request["points"][request["triangles"]]
    sizes = request["sizes"][request["triangles"]]
    rows = np.zeros((len(corners), 12))
    rows[:, 0:3], rows[:, 3:6], rows[:, 9:12] = corners[..., 0], corners[..., 1], sizes
    view = gmsh.view.add("sizes")
    gmsh.view.addListData(view, "ST", len(rows), rows.ravel())
    field = gmsh.model.mesh.field.add("PostView")
    gmsh.model.mesh.field.setNumber(field, "ViewTag", view)
    return int(field)


def _structured(gmsh: Any, request: Mapping[str, Any]) -> int:
    """Hand the field over as values on a grid, through the file that Gmsh wants them in."""
    nx, ny, _ = request["grid_counts"]
    with tempfile.NamedTemporaryFile(suffix=".dat", dir=request["folder"], delete=False) as file:
        file.write(request["grid_frame"].astype("<f8").tobytes() + request["grid_counts"].astype("<i4").tobytes())
        file.write(np.ascontiguousarray(request["sizes"].reshape(ny, nx).T, dtype="<f8").tobytes())
    field = gmsh.model.mesh.field.add("Structured")
    gmsh.model.mesh.field.setString(field, "FileName", file.name)
    gmsh.model.mesh.field.setNumber(field, "TextFormat", 0)
    return int(field)


def _result(gmsh: Any, request: Mapping[str, Any], tags: list[int]) -> Arrays:
    node_tags, flat, _ = gmsh.model.mesh.getNodes()
    order = np.full(int(node_tags.max()) + 1, -1, dtype=np.int64)
    order[node_tags] = np.arange(len(node_tags))
    curve = np.full(len(node_tags), -1, dtype=np.int32)
    for k, tag in enumerate(tags):
        curve[order[gmsh.model.mesh.getNodes(1, tag, includeBoundary=True)[0]]] = k
    cells = {kind: np.empty((0, kind), dtype=np.int64) for kind in (3, 4)}
    for element_type, corners in ((2, 3), (3, 4)):
        found = gmsh.model.mesh.getElementsByType(element_type)[1]
        cells[corners] = order[found].reshape(-1, corners)
    return {
        "points": flat.reshape(-1, 3)[:, :2].copy(),
        "triangles": cells[3].astype(np.int32),
        "quads": cells[4].astype(np.int32),
        "curve": curve,
    }


def _split(rows: NDArray[np.float64], starts: NDArray[np.int64]) -> list[NDArray[np.float64]]:
    return [rows[a:b] for a, b in itertools.pairwise(starts)]


def main(request: str, result: str) -> None:
    """Answer one request; both are ``.npz`` files."""
    with np.load(request) as arrays:
        content: dict[str, Any] = {name: arrays[name] for name in arrays.files}
    content["folder"] = str(Path(request).parent)
    answer: dict[str, Any] = meshed(content)
    np.savez(result, **answer)


if __name__ == "__main__":
    main(*sys.argv[1:])
