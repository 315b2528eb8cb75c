"""A hash of points by place and size: one grid of cells for every power of two of the size.

A cell of level k has the side 2^k, and holds the points with sizes from 2^k to 2^(k + 1). Cells come in blocks of
8 x 8, so that a query touches few places of memory; only blocks that hold a point exist.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

BLOCK_BITS = 3
BLOCK = 1 << BLOCK_BITS
CELLS = BLOCK * BLOCK
EMPTY = np.uint64(0xFFFFFFFFFFFFFFFF)


@njit(nogil=True, cache=True, _nrt=False)
def level_of(h):
    """Return k with 2^k <= h < 2^(k + 1)."""
    return math.frexp(h)[1] - 1


@njit(nogil=True, cache=True, _nrt=False)
def _key(level, bx, by):
    return (np.uint64(level & 0xFF) << np.uint64(56)) | (np.uint64(by) << np.uint64(28)) | np.uint64(bx)


@njit(nogil=True, cache=True, _nrt=False)
def _slot(key, keys):
    """Return where a key is in the table, or the empty place where it would go."""
    mask = np.uint64(len(keys) - 1)
    z = key * np.uint64(0x9E3779B97F4A7C15)
    i = (z ^ (z >> np.uint64(29))) & mask
    while keys[i] != key and keys[i] != EMPTY:
        i = (i + np.uint64(1)) & mask
    return i


@njit(nogil=True, cache=True, _nrt=False)
def block_at(level, bx, by, keys, values):
    """Return the number of a block, -1 where there is none."""
    i = _slot(_key(level, bx, by), keys)
    return values[i] if keys[i] != EMPTY else -1


@njit(nogil=True, cache=True, _nrt=False)
def cell_for(level, ix, iy, keys, values, cells, n_blocks):
    """Return a cell's place in ``cells`` and the number of blocks, making its block if it is new."""
    key = _key(level, ix >> BLOCK_BITS, iy >> BLOCK_BITS)
    i = _slot(key, keys)
    if keys[i] == EMPTY:
        keys[i] = key
        values[i] = n_blocks
        cells[n_blocks * CELLS : (n_blocks + 1) * CELLS] = -1
        n_blocks += 1
    return values[i] * CELLS + ((iy & (BLOCK - 1)) << BLOCK_BITS) + (ix & (BLOCK - 1)), n_blocks


@njit(nogil=True, cache=True, _nrt=True)
def rehashed(keys, values, size):
    """Return the table copied into one of ``size`` places, a power of two."""
    new_keys = np.full(size, EMPTY, dtype=np.uint64)
    new_values = np.empty(size, dtype=np.int32)
    for k in range(len(keys)):
        if keys[k] != EMPTY:
            i = _slot(keys[k], new_keys)
            new_keys[i] = keys[k]
            new_values[i] = values[k]
    return new_keys, new_values
