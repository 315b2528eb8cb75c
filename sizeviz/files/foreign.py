"""The one place where meshio is called: mesh formats that it writes with every bit of the coordinates."""

from __future__ import annotations

import contextlib
import io
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from sizeviz.files.convert import in_space
from sizeviz.files.guard import load

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sizeviz.files.meshfile import MeshFile

FORMATS: dict[str, str] = {
    ".avs": "avsucd",
    ".dat": "tecplot",
    ".inp": "abaqus",
    ".mdpa": "mdpa",
    ".ply": "ply",
}
"""Suffixes, and meshio's name of each format."""


def written(content: MeshFile, suffix: str) -> Iterator[bytes]:
    """Yield the file that meshio writes for a mesh; formats that keep no arrays hold the mesh alone."""
    import meshio

    mesh = content.mesh
    keeps_arrays = suffix in (".dat", ".ply")
    points = {name: values for name, values in content.point_data.items() if keeps_arrays and values.ndim == 1}
    whole = meshio.Mesh(in_space(mesh.points), [("quad", mesh.quads)], point_data=points)
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        path = Path(folder) / f"mesh{suffix}"
        meshio.write(path, whole, file_format=FORMATS[suffix])
        yield load(path)
