"""Clean-up and smoothing of raw quad meshes, and the guarantee R <= 1."""

from sizeviz.improvement.chain import improved
from sizeviz.improvement.cleanup import cleaned
from sizeviz.improvement.guarantee import GuaranteeOptions, GuaranteeReport, guaranteed
from sizeviz.improvement.options import Objective, SmoothOptions
from sizeviz.improvement.smoothing import smoothed
from sizeviz.improvement.tight import TightOptions, tightened

__all__ = [
    "GuaranteeOptions",
    "GuaranteeReport",
    "Objective",
    "SmoothOptions",
    "TightOptions",
    "cleaned",
    "guaranteed",
    "improved",
    "smoothed",
    "tightened",
]
