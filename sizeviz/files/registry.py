"""Which suffix is read and written by whom; the readers and writers are imported when they are first needed."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sizeviz.errors import InputError
from sizeviz.files.atomic import replacing

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from sizeviz.geometry import Domain, QuadMesh
    from sizeviz.sizing import SizeField


@dataclass(frozen=True, eq=False)
class MeshFile:
    """A mesh and the arrays that came with it.

    Parameters
    ----------
    mesh : QuadMesh
        The elements; boundary nodes are fixed, for a file does not say which curve they belong to.
    cell_data, point_data : mapping of str to (Q,) or (N,) float64
        Named values.
    """

    mesh: QuadMesh
    cell_data: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    point_data: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)


# suffix -> "module:function"
FIELD_READERS: dict[str, str] = {
    ".npy": "sizeviz.files.numpy_grids:read_field",
    ".npz": "sizeviz.files.numpy_grids:read_field",
    ".vtu": "sizeviz.files.vtu:read_field",
}
FIELD_WRITERS: dict[str, str] = {
    ".npy": "sizeviz.files.numpy_grids:write_field",
    ".npz": "sizeviz.files.numpy_grids:write_field",
    ".vtu": "sizeviz.files.vtu:write_field",
}
MESH_READERS: dict[str, str] = {".vtu": "sizeviz.files.vtu:read_mesh"}
MESH_WRITERS: dict[str, str] = {".vtu": "sizeviz.files.vtu:write_mesh"}
DOMAIN_READERS: dict[str, str] = {
    ".csv": "sizeviz.files.loops:read_domain",
    ".txt": "sizeviz.files.loops:read_domain",
}


def read_field(path: str | Path, domain: Domain | None = None) -> SizeField:
    """Return the size field in a file.

    Parameters
    ----------
    path : path-like
        A file whose suffix is one of ``FIELD_READERS``.
    domain : Domain, optional
        Its bounds are those of a grid that does not name its own.

    Raises
    ------
    InputError
        If the file is missing, corrupt, of an unknown kind, or holds no valid size field.
    """
    field_: SizeField = _chosen(FIELD_READERS, path, "read as a size field")(_existing(path), domain)
    return field_


def write_field(path: str | Path, field_: SizeField) -> Path:
    """Write a size field, whole or not at all, in the format of the suffix.

    Raises
    ------
    InputError
        If the format is unknown or cannot hold this field, or the place cannot be written.
    """
    return _written(_chosen(FIELD_WRITERS, path, "written as a size field"), path, field_)


def read_mesh(path: str | Path) -> MeshFile:
    """Return the quadrilateral mesh in a file, with its arrays.

    Raises
    ------
    InputError
        If the file is missing, corrupt, of an unknown kind, or holds other elements than quadrilaterals.
    """
    mesh: MeshFile = _chosen(MESH_READERS, path, "read as a mesh")(_existing(path))
    return mesh


def write_mesh(
    path: str | Path,
    mesh: QuadMesh,
    cell_data: Mapping[str, NDArray[np.float64]] | None = None,
    point_data: Mapping[str, NDArray[np.float64]] | None = None,
) -> Path:
    """Write a mesh and named values, whole or not at all, in the format of the suffix.

    Raises
    ------
    InputError
        If the format is unknown, or the place cannot be written.
    """
    writer = _chosen(MESH_WRITERS, path, "written as a mesh")
    return _written(writer, path, MeshFile(mesh, dict(cell_data or {}), dict(point_data or {})))


def read_domain(path: str | Path) -> Domain:
    """Return the domain that a file outlines.

    Raises
    ------
    InputError
        If the file is missing, corrupt or of an unknown kind, or an outline crosses itself.
    """
    domain: Domain = _chosen(DOMAIN_READERS, path, "read as a domain")(_existing(path))
    return domain


def require_writable_suffix(path: str | Path, writers: Mapping[str, str], purpose: str) -> None:
    """Raise InputError unless there is a writer for the suffix of ``path``."""
    _chosen(writers, path, purpose)


def _chosen(registry: Mapping[str, str], path: str | Path, purpose: str) -> Callable[..., Any]:
    suffix = Path(path).suffix.lower()
    if suffix not in registry:
        kind = f"files that end in {suffix}" if suffix else "files without a suffix"
        raise InputError(f"{path}: {kind} cannot be {purpose}; use one of {', '.join(sorted(registry))}")
    module, function = registry[suffix].split(":")
    chosen: Callable[..., Any] = getattr(import_module(module), function)
    return chosen


def _existing(path: str | Path) -> Path:
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: no such file; check the name")
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file in it")
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except OSError as problem:
        raise InputError(f"{path}: cannot be read ({problem.strerror}); check its permissions") from problem
    if empty:
        raise InputError(f"{path}: the file is empty; write it again")
    return path


def _written(writer: Callable[..., object], path: str | Path, *content: object) -> Path:
    with replacing(path) as part:
        writer(part, *content)
    return Path(path)
