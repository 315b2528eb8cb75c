"""The decomposition mesher of Sarrate and Huerta: loops split by chords down to quadrilaterals."""

from sizeviz.meshing.decomposition.generator import Decomposition

__all__ = ["Decomposition"]
