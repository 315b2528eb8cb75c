"""How the kernels of this package are compiled."""

from __future__ import annotations

from numba import njit

compiled = njit(nogil=True, cache=True, error_model="numpy")
"""Decorator of a kernel: no GIL, cached on disk, and no check for division by zero in every quotient."""
