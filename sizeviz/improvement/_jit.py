"""How the kernels of this package are compiled.

``_nrt=False`` leaves out the counting of references: a kernel then cannot make an array, and costs far less to
compile and to call with arrays.
"""

from __future__ import annotations

from numba import njit

compiled = njit(nogil=True, cache=True, error_model="numpy", _nrt=False, no_cfunc_wrapper=True)
"""Decorator of a kernel that makes no array: no GIL, cached on disk, no check for division by zero."""

allocating = njit(nogil=True, cache=True, error_model="numpy")
"""Decorator of a kernel that makes arrays of its own."""

inlined = njit(nogil=True, cache=True, error_model="numpy", _nrt=False, no_cfunc_wrapper=True, forceinline=True)
"""Decorator of a small kernel that is copied into those that call it."""
