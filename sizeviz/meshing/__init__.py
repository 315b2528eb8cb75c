"""Raw all-quadrilateral meshes: one generator per folder behind one protocol."""

from sizeviz.meshing.generators import GENERATORS, Generator, generated
from sizeviz.meshing.options import MeshOptions, Preset

__all__ = ["GENERATORS", "Generator", "MeshOptions", "Preset", "generated"]
