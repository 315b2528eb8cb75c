"""sizeviz: see, limit, preserve and honour mesh size fields.

The public names are loaded on first use (PEP 562), so that ``import sizeviz`` pulls in neither numba, VTK nor Qt.
"""

from __future__ import annotations

from importlib import import_module

__version__ = "0.1.0"

_PUBLIC: dict[str, str] = {
    # ten functions for notebooks
    "load": "sizeviz.api",
    "paint": "sizeviz.api",
    "limit": "sizeviz.api",
    "preserve": "sizeviz.api",
    "mesh": "sizeviz.api",
    "smooth": "sizeviz.api",
    "report": "sizeviz.api",
    "show": "sizeviz.api",
    "screenshot": "sizeviz.api",
    "adapt": "sizeviz.api",
    # the values they take and return, and the verbs beneath
    "Domain": "sizeviz.geometry",
    "QuadMesh": "sizeviz.geometry",
    "BackgroundMesh": "sizeviz.sizing",
    "LimitOptions": "sizeviz.sizing",
    "PreserveOptions": "sizeviz.sizing",
    "SizeField": "sizeviz.sizing",
    "limited": "sizeviz.sizing",
    "preserved": "sizeviz.sizing",
    "MeshReport": "sizeviz.conformity",
    "judged": "sizeviz.conformity",
    "MeshOptions": "sizeviz.meshing",
    "generated": "sizeviz.meshing",
    "SmoothOptions": "sizeviz.improvement",
    "improved": "sizeviz.improvement",
    "read_domain": "sizeviz.files",
    "read_field": "sizeviz.files",
    "read_mesh": "sizeviz.files",
    "write_field": "sizeviz.files",
    "write_mesh": "sizeviz.files",
    "Source": "sizeviz.sources",
    "examples": "sizeviz.sources",
    "Study": "sizeviz.study",
    "StudyOptions": "sizeviz.study",
    "run": "sizeviz.study",
    "save_comparison": "sizeviz.scene",
    "save_page": "sizeviz.scene",
    "save_picture": "sizeviz.scene",
}

__all__ = ["__version__", *sorted(_PUBLIC)]


def __getattr__(name: str) -> object:
    try:
        module = _PUBLIC[name]
    except KeyError:
        raise AttributeError(f"module 'sizeviz' has no attribute {name!r}") from None
    return getattr(import_module(module), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_PUBLIC})
