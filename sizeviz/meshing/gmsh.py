"""Gmsh as a mesher: the field handed over as a background view, the result quadrilaterals alone.

What a size-preserving field does for an independent mesher is the paper's point: h* needs no change to the mesher.
Gmsh is an optional extra (GPL); it runs in a process of its own, which is ended when the work is cancelled.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import MeshingError, MissingDependencyError
from sizeviz.geometry import QuadMesh
from sizeviz.meshing.leftovers import merged
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sizing import ideal_count

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.geometry import Domain
    from sizeviz.meshing.options import MeshOptions
    from sizeviz.sizing import SizeField

WORKER = Path(__file__).with_name("_gmsh_worker.py")
"""What runs in the other process: by its path, so that the package need not be imported again."""

POLL_SECONDS = 0.05
"""How often the other process is looked at; cancelling takes no longer."""

MISSED = 0.1
"""A mesh with less than this share of the elements asked for did not see the field."""


@dataclass(frozen=True)
class GmshGenerator:
    """One of Gmsh's ways to quadrilaterals.

    Parameters
    ----------
    name : str
        What the registry calls it.
    algorithm : int
        Gmsh's ``Mesh.Algorithm``: 8 is Frontal-Delaunay for quads, 6 Frontal-Delaunay.
    recombination : int
        Gmsh's ``Mesh.RecombinationAlgorithm``: 1 is Blossom (Remacle et al. 2012, DOI 10.1002/nme.3279), 3 Blossom
        full-quad.
    structured: bool
        Whether a field on a grid is handed over as Gmsh's Structured field, bilinear and found by arithmetic, rather
        than as a view of triangles, which Gmsh searches for every query.
    """

    name: str = "gmsh"
    algorithm: int = 8
    recombination: int = 1
    structured: bool = False

    def generate(self, domain: Domain, size: SizeField, options: MeshOptions, monitor: Monitor = SILENT) -> QuadMesh:
        """Return the raw mesh, leftover triangles merged.

        Raises
        ------
        MissingDependencyError
            If gmsh is not installed.
        MeshingError
            If Gmsh fails, leaves triangles that cannot be merged, would make more than ``options.max_elements``, or
            passed the smallest sizes by: it looks at the field from its coarse side.
        Cancelled
            If the monitor says so; the other process is ended at once.
        """
        asked = _require_room(domain, size, options)
        found = self.answer(domain, size, options, monitor)
        quads = merged(found["points"], found["triangles"], found["quads"])
        if len(quads) < MISSED * asked:
            raise MeshingError(
                f"gmsh made {len(quads):,} quadrilaterals where {size.label} asks for about {asked:,.0f}: it passed "
                "the smallest sizes by; lower --mesh-scale, or try --mesher frontal"
            )
        return _packed(domain, found["points"], quads, found["curve"])

    def answer(
        self, domain: Domain, size: SizeField, options: MeshOptions, monitor: Monitor = SILENT
    ) -> dict[str, NDArray[Any]]:
        """Return what Gmsh made, as it made it: points, triangles, quads, curve, and seconds of meshing alone."""
        if find_spec("gmsh") is None:
            raise MissingDependencyError("the gmsh mesher is not installed; install it: pip install 'sizeviz[gmsh]'")
        with tempfile.TemporaryDirectory(prefix="sizeviz-") as folder:
            request, result = Path(folder, "request.npz"), Path(folder, "result.npz")
            content: dict[str, Any] = self._request(domain, size, options)
            np.savez(request, **content)
            _run([sys.executable, "-P", str(WORKER), str(request), str(result)], monitor)
            with np.load(result) as arrays:
                return {name: arrays[name] for name in arrays.files}

    def _request(self, domain: Domain, size: SizeField, options: MeshOptions) -> dict[str, NDArray[Any]]:
        curves = [np.vstack([c.points, c.points[:1]]) if c.closed else c.points for c in domain.curves]
        return {
            "curve_points": np.vstack(curves),
            "curve_starts": np.cumsum([0, *(len(curve) for curve in curves)]),
            "loop_starts": _loop_starts(domain),
            "inner_points": domain.fixed_points,
            "points": size.background.points,
            "triangles": size.background.triangles,
            "sizes": options.scale * size.sizes,
            "algorithm": np.array(self.algorithm),
            "recombination": np.array(self.recombination),
            "seed": np.array(options.seed),
            **self._grid(size),
        }

    def _grid(self, size: SizeField) -> dict[str, NDArray[Any]]:
        grid = size.background.grid
        if grid is None or not self.structured:
            return {}
        return {
            "grid_frame": np.array([grid.x0, grid.y0, 0.0, grid.dx, grid.dy, 1.0]),
            "grid_counts": np.array([grid.nx, grid.ny, 1], dtype=np.int32),
        }


def _require_room(domain: Domain, size: SizeField, options: MeshOptions) -> float:
    """Return about how many elements the field asks for, after a check that they are not too many."""
    asked = ideal_count(size, domain) / options.scale**2
    if asked > options.max_elements:
        raise MeshingError(
            f"{size.label}: at mesh scale {options.scale:g} it asks for about {asked:,.0f} elements, more than "
            f"{options.max_elements:,}; raise the sizes, --mesh-scale or --max-elements"
        )
    return asked


def _run(command: list[str], monitor: Monitor) -> None:
    """Wait for the other process, and end it if the monitor raises."""
    began = time.monotonic()
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors)
        try:
            while process.poll() is None:
                elapsed = time.monotonic() - began
                # Gmsh does not say how far it is: the bar nears its end without reaching it.
                monitor.step(elapsed / (elapsed + 30.0), f"gmsh at work for {elapsed:.0f} s")
                time.sleep(POLL_SECONDS)
        finally:
            if process.poll() is None:
                process.kill()
            process.wait()
        if process.returncode:
            errors.seek(0)
            lines = errors.read().decode(errors="replace").strip().splitlines()
            why = lines[-1] if lines else f"exit code {process.returncode}"
            raise MeshingError(f"gmsh could not mesh the domain ({why}); check its outline, or try --mesher frontal")


def _loop_starts(domain: Domain) -> NDArray[np.int64]:
    """Return where each loop's curves begin among ``domain.curves``, and where the inner lines do."""
    counts = [max(1, int(np.count_nonzero(marks))) for marks in domain.corners]
    return np.cumsum([0, *counts])


def _packed(
    domain: Domain, points: NDArray[np.float64], quads: NDArray[np.int32], curve: NDArray[np.int32]
) -> QuadMesh:
    """Return the mesh without nodes that no element uses, corners and prescribed points fixed."""
    used = np.unique(quads)
    order = np.full(len(points), -1, dtype=np.int32)
    order[used] = np.arange(len(used), dtype=np.int32)
    corners = [loop[marks] for loop, marks in zip(domain.loops, domain.corners, strict=True)]
    ends = [line[[0, -1]] for line in domain.lines]
    wanted = {(float(x), float(y)) for x, y in np.vstack([*corners, *ends, domain.fixed_points])}
    kept = points[used]
    fixed = np.array([(float(x), float(y)) in wanted for x, y in kept])
    return QuadMesh(kept, order[quads], curve[used], fixed)
