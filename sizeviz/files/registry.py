"""Which suffix is read and written by whom; the readers and writers are imported when they are first needed."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sizeviz.errors import InputError
from sizeviz.files.atomic import write_chunks
from sizeviz.files.guard import guarded, load, one_line
from sizeviz.files.meshfile import MeshFile
from sizeviz.files.options import ReadOptions

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from sizeviz.files.image import Image
    from sizeviz.geometry import Domain, QuadMesh
    from sizeviz.sizing import SizeField

_DEFAULT = ReadOptions()

# suffix -> "module:function" in sizeviz.files; what the functions take and return is said in `readers` and `writers`
FIELD_READERS: dict[str, str] = {
    ".mesh": "readers:medit_field",
    ".msh": "readers:msh_field",
    ".npy": "numpy_files:parse_field",
    ".npz": "numpy_files:parse_field",
    ".pos": "readers:pos_field",
    ".sol": "readers:medit_field",
    ".vti": "readers:vtk_xml_field",
    ".vtk": "readers:vtk_legacy_field",
    ".vtp": "readers:vtk_xml_field",
    ".vtu": "readers:vtk_xml_field",
}
IMAGE_READERS: dict[str, str] = {
    ".dcm": "medical:parse_dicom",
    ".jpeg": "pictures:parse",
    ".jpg": "pictures:parse",
    ".nii": "medical:parse_nifti",
    ".nii.gz": "medical:parse_nifti",
    ".npy": "numpy_files:parse_image",
    ".npz": "numpy_files:parse_image",
    ".png": "pictures:parse",
    ".tif": "pictures:parse",
    ".tiff": "pictures:parse",
    ".vti": "readers:vtk_xml_image",
    ".vtk": "readers:vtk_legacy_image",
}
MESH_READERS: dict[str, str] = {
    ".mesh": "readers:medit_mesh",
    ".msh": "readers:msh_mesh",
    ".vtk": "readers:vtk_legacy_mesh",
    ".vtp": "readers:vtk_xml_mesh",
    ".vtu": "readers:vtk_xml_mesh",
}
DOMAIN_READERS: dict[str, str] = {
    ".csv": "loops:parse",
    ".geojson": "geojson:parse",
    ".json": "geojson:parse",
    ".mesh": "readers:medit_domain",
    ".msh": "readers:msh_domain",
    ".svg": "svg:parse",
    ".txt": "loops:parse",
    ".vtk": "readers:vtk_legacy_domain",
    ".vtp": "readers:vtk_xml_domain",
    ".vtu": "readers:vtk_xml_domain",
}
FIELD_WRITERS: dict[str, str] = {
    ".mesh": "writers:medit_field",
    ".msh": "writers:msh_field",
    ".npy": "numpy_files:written_npy",
    ".npz": "numpy_files:written_npz",
    ".pos": "gmsh_pos:written",
    ".sol": "writers:medit_sizes",
    ".vtk": "writers:vtk_field",
    ".vtu": "writers:vtu_field",
}
MESH_WRITERS: dict[str, str] = {
    ".avs": "writers:avs_mesh",
    ".dat": "writers:dat_mesh",
    ".inp": "writers:inp_mesh",
    ".mdpa": "writers:mdpa_mesh",
    ".mesh": "writers:medit_mesh",
    ".msh": "writers:msh_mesh",
    ".obj": "writers:obj_mesh",
    ".ply": "writers:ply_mesh",
    ".vtk": "writers:vtk_mesh",
    ".vtu": "writers:vtu_mesh",
}


def read_field(path: str | Path, domain: Domain | None = None, options: ReadOptions = _DEFAULT) -> SizeField:
    """Return the size field in a file.

    Parameters
    ----------
    path : path-like
        A file whose suffix is one of ``FIELD_READERS``. Of a ``.mesh`` and its ``.sol``, either may be named.
    domain : Domain, optional
        Its bounds are those of a grid that does not name its own.
    options : ReadOptions
        Choices that the file leaves open.

    Raises
    ------
    InputError
        If the file is missing, corrupt, too large, of an unknown kind, or holds no valid isotropic plane size field.
    """
    if domain is not None and options.extent is None:
        options = replace(options, extent=domain.bounds)
    field: SizeField = _read(FIELD_READERS, path, "a size field", options)
    return field


def read_image(path: str | Path, options: ReadOptions = _DEFAULT) -> Image:
    """Return the image in a file: a picture, a slice of a medical image, or a grid of numbers.

    Raises
    ------
    InputError
        If the file is missing, corrupt, too large, of an unknown kind, or holds no image.
    MissingDependencyError
        If the library that reads this kind of medical image is not installed.
    """
    image: Image = _read(IMAGE_READERS, path, "an image", options)
    return image


def read_mesh(path: str | Path, options: ReadOptions = _DEFAULT) -> MeshFile:
    """Return the quadrilateral mesh in a file, with its arrays.

    Raises
    ------
    InputError
        If the file is missing, corrupt, of an unknown kind, or holds other elements than plane quadrilaterals.
    """
    mesh: MeshFile = _read(MESH_READERS, path, "a mesh", options)
    return mesh


def read_domain(path: str | Path, options: ReadOptions = _DEFAULT) -> Domain:
    """Return the domain that a file outlines: by loops, by a drawing, or by a mesh's boundary.

    Raises
    ------
    InputError
        If the file is missing, corrupt or of an unknown kind, or outlines no single region.
    """
    domain: Domain = _read(DOMAIN_READERS, path, "a domain", options)
    return domain


def write_field(path: str | Path, field: SizeField) -> Path:
    """Write a size field, whole or not at all, in the format of the suffix.

    A ``.sol`` needs its mesh: ``h.sol`` and ``h.mesh`` are written together, whichever of the two is named.

    Raises
    ------
    InputError
        If the format is unknown or cannot hold this field, or the place cannot be written.
    """
    target = Path(path)
    writer = _chosen(FIELD_WRITERS, target, "written as a size field")
    if suffix_of(target) in (".sol", ".mesh"):
        other = ".mesh" if suffix_of(target) == ".sol" else ".sol"
        write_chunks(target.with_suffix(other), _chosen(FIELD_WRITERS, f"x{other}", "")(field))
    return write_chunks(target, writer(field))


def write_mesh(
    path: str | Path,
    mesh: QuadMesh,
    cell_data: Mapping[str, NDArray[Any]] | None = None,
    point_data: Mapping[str, NDArray[Any]] | None = None,
) -> Path:
    """Write a mesh and named values, whole or not at all, in the format of the suffix.

    ``.vtu``, ``.vtk`` and ``.msh`` keep all arrays, ``.ply`` and ``.dat`` those of points, the others none.

    Raises
    ------
    InputError
        If the format is unknown, or the place cannot be written.
    """
    writer = _chosen(MESH_WRITERS, path, "written as a mesh")
    return write_chunks(path, writer(MeshFile(mesh, dict(cell_data or {}), dict(point_data or {}))))


def require_writable_suffix(path: str | Path, writers: Mapping[str, str], purpose: str) -> None:
    """Raise InputError unless there is a writer for the suffix of ``path``."""
    _chosen(writers, path, purpose)


def suffix_of(path: str | Path) -> str:
    """Return the suffix that says the format, in lower case; ``.nii.gz`` is one suffix."""
    name = Path(path).name.lower()
    return ".nii.gz" if name.endswith(".nii.gz") else Path(name).suffix


def parsed(
    readers: Mapping[str, str], data: bytes, path: str | Path, what: str, options: ReadOptions = _DEFAULT
) -> Any:
    """Return what a reader of ``readers`` makes of the content of a file, every failure one ``InputError``.

    Parameters
    ----------
    readers : mapping
        ``FIELD_READERS`` or another table.
    data : bytes
        The content.
    path : path-like
        Where it came from: says the format, and where a companion file would be.
    what : str
        What is expected, as in "a size field".
    options : ReadOptions
        Choices that the file leaves open.
    """
    path = Path(path)
    reader = _chosen(readers, path, f"read as {what}")
    with guarded(str(path), f"{suffix_of(path)} file"):
        return reader(data, path, options)


def _read(readers: Mapping[str, str], path: str | Path, what: str, options: ReadOptions) -> Any:
    _chosen(readers, path, f"read as {what}")
    return parsed(readers, load(path), path, what, options)


def _chosen(registry: Mapping[str, str], path: str | Path, purpose: str) -> Callable[..., Any]:
    suffix = suffix_of(path)
    if suffix not in registry:
        kind = f"files that end in {one_line(suffix, 40)}" if suffix else "files without a suffix"
        raise InputError(f"{one_line(path)}: {kind} cannot be {purpose}; use one of {', '.join(sorted(registry))}")
    module, function = registry[suffix].split(":")
    chosen: Callable[..., Any] = getattr(import_module(f"sizeviz.files.{module}"), function)
    return chosen
