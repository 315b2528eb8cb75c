"""Readers and writers by suffix; what is written appears whole or not at all."""

from sizeviz.files.atomic import output_folder, replacing, require_writable_file
from sizeviz.files.registry import MeshFile, read_domain, read_field, read_mesh, write_field, write_mesh

__all__ = [
    "MeshFile",
    "output_folder",
    "read_domain",
    "read_field",
    "read_mesh",
    "replacing",
    "require_writable_file",
    "write_field",
    "write_mesh",
]
