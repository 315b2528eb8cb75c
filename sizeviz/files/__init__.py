"""Readers and writers by suffix; what is written appears whole or not at all."""

from sizeviz.files.atomic import output_folder, replacing, require_writable_file
from sizeviz.files.image import Image
from sizeviz.files.meshfile import MeshFile
from sizeviz.files.options import ReadOptions
from sizeviz.files.registry import read_domain, read_field, read_image, read_mesh, write_field, write_mesh

__all__ = [
    "Image",
    "MeshFile",
    "ReadOptions",
    "output_folder",
    "read_domain",
    "read_field",
    "read_image",
    "read_mesh",
    "replacing",
    "require_writable_file",
    "write_field",
    "write_mesh",
]
