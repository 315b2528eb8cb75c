"""A quadtree over the domain whose leaves are no larger than the size at their centres."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sizeviz.meshing.frontal._packing_kernels import CLEARANCE, N_BUCKETS, bucket_of
from sizeviz.meshing.frontal._region_kernels import outside, within
from sizeviz.sizing._kernels import size_at

LEAF = 0.9
HIDDEN = 0.7
STACK = 256


@njit(nogil=True, cache=True, _nrt=False)
def leaves(most, sampler, region, scale, slope, stack, depth, out, hints, around):
    """Split cells from the stack until ``most`` leaves with their centre inside the domain are in ``out``.

    A leaf's side is at most ``LEAF`` of the size at its centre, and so small that, at the given slope, no size below
    about ``1 - HIDDEN`` of that can hide in it. ``around`` is room for ``outside``. Returns the depth of the stack, the
    number of leaves in ``out``, and the number of elements that the leaves ask for.
    """
    count, asked = 0, 0.0
    box = region[0]
    limit = min(LEAF, HIDDEN / max(slope, 1e-12) * 1.4142135623730951)
    while depth > 0 and count < most:
        depth -= 1
        x, y, side = stack[depth, 0], stack[depth, 1], stack[depth, 2]
        half = 0.5 * side
        if x + half <= box[0] or x - half >= box[2] or y + half <= box[1] or y - half >= box[3]:
            continue
        size, hints[0] = size_at(sampler, x, y, hints[0])
        size *= scale
        if side > limit * size:
            # small sizes beyond the boundary are nobody's concern, but would take more cells than the mesh has elements
            beyond, hints[1] = outside(region, x, y, half, hints[1], around)
            if beyond:
                continue
            for k in range(4):
                stack[depth, 0] = x + (half - side * (k & 1)) * 0.5
                stack[depth, 1] = y + (half - side * (k >> 1)) * 0.5
                stack[depth, 2] = half
                depth += 1
            continue
        inside, hints[1] = within(region, x, y, 0.0, hints[1])
        if inside:
            asked += (side / size) ** 2
            inside, hints[1] = within(region, x, y, CLEARANCE * size, hints[1])
        if inside:
            out[count, 0], out[count, 1], out[count, 2] = x, y, size
            count += 1
    return depth, count, asked


@njit(nogil=True, cache=True, _nrt=True)
def by_bucket(seeds, log_finest):
    """Return the seeds sorted by bucket, in the order of the quadtree within each, and where each bucket begins."""
    start = np.zeros(N_BUCKETS + 1, dtype=np.int64)
    for i in range(len(seeds)):
        start[bucket_of(seeds[i, 2], log_finest) + 1] += 1
    for b in range(N_BUCKETS):
        start[b + 1] += start[b]
    at = start.copy()
    out = np.empty_like(seeds)
    for i in range(len(seeds)):
        b = bucket_of(seeds[i, 2], log_finest)
        out[at[b]] = seeds[i]
        at[b] += 1
    return out, start


@njit(nogil=True, cache=True, _nrt=False)
def largest_slope(points, triangles, sizes):
    """Return the largest gradient of a piecewise-linear field."""
    steepest = 0.0
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        vx, vy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
        det = ux * vy - uy * vx
        if det != 0.0:
            du, dv = sizes[b] - sizes[a], sizes[c] - sizes[a]
            gx, gy = du * vy - dv * uy, dv * ux - du * vx
            steepest = max(steepest, (gx * gx + gy * gy) / (det * det))
    return np.sqrt(steepest)


@njit(nogil=True, cache=True, _nrt=False)
def flat_sizes(points, triangles, sizes, values, counts):
    """Add up, for each size that whole triangles have, the elements that those triangles ask for; return the rest's.

    ``values`` and ``counts`` are a hash table, a power of two long and 0 to begin with; a size that finds no place
    in it is left out.
    """
    mask = len(values) - 1
    rest = 0.0
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        h = sizes[a]
        area = (points[b, 0] - points[a, 0]) * (points[c, 1] - points[a, 1])
        area -= (points[b, 1] - points[a, 1]) * (points[c, 0] - points[a, 0])
        asked = 0.5 * abs(area) / (h * h)
        if sizes[b] != h or sizes[c] != h:
            rest += asked
            continue
        k = (int(math.frexp(h)[0] * 9007199254740992.0) * 2654435761 >> 20) & mask
        for _ in range(8):
            if values[k] == h or values[k] == 0.0:
                values[k] = h
                counts[k] += asked
                break
            k = (k + 1) & mask
    return rest
