"""Clean-up and smoothing of raw quad meshes, and the guarantee R <= 1."""

from sizeviz.improvement.chain import improved
from sizeviz.improvement.cleanup import cleaned
from sizeviz.improvement.options import Objective, SmoothOptions
from sizeviz.improvement.smoothing import smoothed

__all__ = ["Objective", "SmoothOptions", "cleaned", "improved", "smoothed"]
