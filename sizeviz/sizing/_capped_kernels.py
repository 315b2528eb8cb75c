"""The background triangle that holds each of some points."""

from __future__ import annotations

from numba import njit

from sizeviz.sizing._kernels import size_at


@njit(nogil=True, cache=True)
def triangles_into(sampler, points, out):
    """Fill ``out`` with the triangle that each of ``points`` lies in, or is nearest to."""
    grid = sampler[0]
    hint = 0
    for i in range(len(points)):
        if grid[4] > 0.0:
            nx, ny = int(grid[4]), int(grid[5])
            u = min(max((points[i, 0] - grid[0]) / grid[2], 0.0), nx - 1.0)
            v = min(max((points[i, 1] - grid[1]) / grid[3], 0.0), ny - 1.0)
            column, row = min(int(u), nx - 2), min(int(v), ny - 2)
            out[i] = 2 * (row * (nx - 1) + column) + (1 if v - row > u - column else 0)
        else:
            _, hint = size_at(sampler, points[i, 0], points[i, 1], hint)
            out[i] = hint
