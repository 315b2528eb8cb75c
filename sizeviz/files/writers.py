"""Fields and meshes written in the mesh formats: what they mean, then the format's own writer, as chunks of bytes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.files import foreign, gmsh_msh, medit, vtk_legacy, vtk_xml
from sizeviz.files.convert import raw_field, raw_mesh

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from sizeviz.files.meshfile import MeshFile
    from sizeviz.files.raw import RawMesh
    from sizeviz.sizing import SizeField

_CHUNK = 100_000


def _field(write: Callable[[RawMesh], Iterable[bytes]]) -> Callable[[SizeField], Iterable[bytes]]:
    return lambda field: write(raw_field(field))


def _mesh(write: Callable[[RawMesh], Iterable[bytes]]) -> Callable[[MeshFile], Iterable[bytes]]:
    return lambda content: write(raw_mesh(content.mesh, content.cell_data, content.point_data))


def _foreign(suffix: str) -> Callable[[MeshFile], Iterable[bytes]]:
    return lambda content: foreign.written(content, suffix)


vtu_field, vtu_mesh = _field(vtk_xml.written), _mesh(vtk_xml.written)
vtk_field, vtk_mesh = _field(vtk_legacy.written), _mesh(vtk_legacy.written)
msh_field, msh_mesh = _field(gmsh_msh.written), _mesh(gmsh_msh.written)
medit_field, medit_mesh = _field(medit.written_mesh), _mesh(medit.written_mesh)
avs_mesh, dat_mesh, inp_mesh, mdpa_mesh, ply_mesh = map(_foreign, (".avs", ".dat", ".inp", ".mdpa", ".ply"))


def medit_sizes(field: SizeField) -> Iterable[bytes]:
    """Return the .sol file of a field."""
    return medit.written_solution(field.sizes)


def obj_mesh(content: MeshFile) -> Iterator[bytes]:
    """Yield the parts of a Wavefront .obj file; coordinates are written to the last bit."""
    mesh = content.mesh
    for start in range(0, mesh.n_points, _CHUNK):
        yield "".join(f"v {x!r} {y!r} 0\n" for x, y in mesh.points[start : start + _CHUNK].tolist()).encode()
    for start in range(0, mesh.n_quads, _CHUNK):
        rows = (mesh.quads[start : start + _CHUNK] + 1).tolist()
        yield "".join(f"f {a} {b} {c} {d}\n" for a, b, c, d in rows).encode()
