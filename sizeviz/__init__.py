"""sizeviz: see, limit, preserve and honour mesh size fields.

The public names are loaded on first use (PEP 562), so that ``import sizeviz`` pulls in neither numba, VTK nor Qt.
"""

from __future__ import annotations

from importlib import import_module

__version__ = "0.1.0"

_PUBLIC: dict[str, str] = {
    "BackgroundMesh": "sizeviz.sizing",
    "Domain": "sizeviz.geometry",
    "QuadMesh": "sizeviz.geometry",
    "SizeField": "sizeviz.sizing",
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
