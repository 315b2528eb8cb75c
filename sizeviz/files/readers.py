"""The mesh formats read as fields, images, meshes and domains: a parser, then what its content means.

Every reader takes ``(data, path, options)``: the content, where it came from (which names the result and says where a
companion file is), and the choices that the file leaves open.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.errors import InputError
from sizeviz.files import gmsh_msh, gmsh_pos, medit, vtk_legacy, vtk_xml
from sizeviz.files.convert import field_of, image_of, mesh_of
from sizeviz.files.guard import load
from sizeviz.files.meshfile import MeshFile
from sizeviz.files.outlines import domain_of
from sizeviz.files.raw import RawGrid, RawMesh

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from sizeviz.files.image import Image
    from sizeviz.files.options import ReadOptions
    from sizeviz.geometry import Domain
    from sizeviz.sizing import SizeField


def _field(parse: Callable[[bytes], RawMesh | RawGrid]) -> Callable[[bytes, Path, ReadOptions], SizeField]:
    def read(data: bytes, path: Path, options: ReadOptions) -> SizeField:
        return field_of(parse(data), path.name, options)

    return read


def _image(parse: Callable[[bytes], RawMesh | RawGrid]) -> Callable[[bytes, Path, ReadOptions], Image]:
    def read(data: bytes, path: Path, options: ReadOptions) -> Image:
        return image_of(parse(data), path.name, options)

    return read


def _mesh(parse: Callable[[bytes], RawMesh | RawGrid]) -> Callable[[bytes, Path, ReadOptions], MeshFile]:
    def read(data: bytes, path: Path, options: ReadOptions) -> MeshFile:
        return MeshFile(*mesh_of(parse(data)))

    return read


def _domain(parse: Callable[[bytes], RawMesh | RawGrid]) -> Callable[[bytes, Path, ReadOptions], Domain]:
    def read(data: bytes, path: Path, options: ReadOptions) -> Domain:
        raw = parse(data)
        if isinstance(raw, RawGrid):
            raise InputError("it holds a grid of points, not a mesh with a boundary; give an outline or a mesh")
        return domain_of(raw, path.name, options)

    return read


vtk_xml_field, vtk_xml_image = _field(vtk_xml.parse), _image(vtk_xml.parse)
vtk_xml_mesh, vtk_xml_domain = _mesh(vtk_xml.parse), _domain(vtk_xml.parse)
vtk_legacy_field, vtk_legacy_image = _field(vtk_legacy.parse), _image(vtk_legacy.parse)
vtk_legacy_mesh, vtk_legacy_domain = _mesh(vtk_legacy.parse), _domain(vtk_legacy.parse)
msh_field, msh_mesh, msh_domain = _field(gmsh_msh.parse), _mesh(gmsh_msh.parse), _domain(gmsh_msh.parse)
pos_field = _field(gmsh_pos.parse)
medit_mesh, medit_domain = _mesh(medit.parse_mesh), _domain(medit.parse_mesh)


def medit_field(data: bytes, path: Path, options: ReadOptions) -> SizeField:
    """Return the field of a .mesh and the .sol beside it, whichever of the two ``path`` names.

    Raises
    ------
    InputError
        If the other file is missing, or the two do not fit together.
    """
    is_solution = path.suffix.lower() == ".sol"
    other = next(
        (
            p
            for p in (path.with_suffix(s) for s in ((".mesh", ".MESH") if is_solution else (".sol", ".SOL")))
            if p.exists()
        ),
        None,
    )
    if other is None:
        wanted = path.with_suffix(".mesh" if is_solution else ".sol")
        raise InputError(f"its {'mesh' if is_solution else 'sizes'} should be in {wanted.name} beside it; put it there")
    beside = load(other)
    solution, mesh = (data, beside) if is_solution else (beside, data)
    raw = medit.parse_mesh(mesh)
    sizes = medit.parse_solution(solution, len(raw.points))
    return field_of(RawMesh(raw.points, raw.cells, {"size": sizes}), path.name, options)
