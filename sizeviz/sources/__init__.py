"""Where size fields come from: examples, formulas, pictures, arrays and meshes in files, painting."""

from sizeviz.files import Image
from sizeviz.sources.formula import Formula
from sizeviz.sources.gallery import Example, examples, load
from sizeviz.sources.source import Source

__all__ = ["Example", "Formula", "Image", "Source", "examples", "load"]
