"""Arrays and their checks, planar domains, quad meshes, predicates, triangulation, search structures."""

from sizeviz.geometry.domain import Curve, Domain
from sizeviz.geometry.quadmesh import QuadMesh

__all__ = ["Curve", "Domain", "QuadMesh"]
