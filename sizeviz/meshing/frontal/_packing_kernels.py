"""Packing of points at the distance the size field asks for, smallest size first.

Accepted points propose neighbours along their frame's axes; a proposal waits in a queue by size and is refused if an
accepted point lies nearer than ``CLOSE`` of their mean size, in the maximum norm of the frame. After Remacle et al.
(2013), "A frontal Delaunay quad mesh generator using the L-infinity norm", DOI 10.1002/nme.4458.

``_nrt=False``: a kernel that makes no array need not count references, which costs more than some of its calls.
"""

from __future__ import annotations

import math

from numba import njit

from sizeviz.meshing.frontal._hash_kernels import BLOCK, BLOCK_BITS, CELLS, block_at, cell_for, level_of
from sizeviz.meshing.frontal._region_kernels import within
from sizeviz.sizing._kernels import size_at

CLOSE = 0.7
CLOSE_IN_FIRST_LAYER = 0.5
CLEARANCE = 0.4
DECAY = 0.9
PER_OCTAVE = 4
N_BUCKETS = 1024

X, Y, SIZE, TURN, POINT_COLUMNS = 0, 1, 2, 3, 4
N_POINTS, N_BLOCKS, BUCKET, N_QUEUED, FREE, STATE_SIZE = 0, 1, 2, 3, 4, 5
SCALE, LOW_X, LOW_Y, ANGLE, RATIO, LOG_FINEST = 0, 1, 2, 3, 4, 5


@njit(nogil=True, cache=True, _nrt=False)
def bucket_of(h, log_finest):
    """Return the bucket of a size: ``PER_OCTAVE`` to a factor of two, the smallest size in bucket 1."""
    return min(max(int((math.log2(h) - log_finest) * PER_OCTAVE) + 1, 0), N_BUCKETS - 1)


@njit(nogil=True, cache=True, _nrt=False)
def _near_in_block(first, ix0, ix1, iy0, iy1, x, y, h, c, s, layer, cells, points, chain, layers):
    """Whether a point in a range of one block's cells is too near."""
    for iy in range(iy0, iy1 + 1):
        for ix in range(ix0, ix1 + 1):
            q = cells[first + (iy << BLOCK_BITS) + ix]
            while q >= 0:
                dx, dy = points[q, X] - x, points[q, Y] - y
                distance = max(abs(c * dx + s * dy), abs(c * dy - s * dx))
                close = CLOSE_IN_FIRST_LAYER if layer == 1 and layers[q] == 1 else CLOSE
                if distance < 0.5 * close * (h + points[q, SIZE]):
                    return True
                q = chain[q]
    return False


@njit(nogil=True, cache=True, _nrt=False)
def blocked(x, y, h, c, s, layer, setting, table, packing):
    """Whether an accepted point lies too near to a proposal of size h whose frame has the cosine c and sine s."""
    keys, values, cells = table
    points, chain, layers = packing
    ratio = setting[RATIO]
    low_x, low_y = x - setting[LOW_X], y - setting[LOW_Y]
    widest = abs(c) + abs(s)
    for level in range(level_of(h / ratio), level_of(h * ratio) + 1):
        per_side = 2.0**-level
        reach = 0.5 * CLOSE * (h + min(2.0 / per_side, h * ratio)) * widest
        ix0, ix1 = max(int((low_x - reach) * per_side), 0), int((low_x + reach) * per_side)
        iy0, iy1 = max(int((low_y - reach) * per_side), 0), int((low_y + reach) * per_side)
        for by in range(iy0 >> BLOCK_BITS, (iy1 >> BLOCK_BITS) + 1):
            for bx in range(ix0 >> BLOCK_BITS, (ix1 >> BLOCK_BITS) + 1):
                block = block_at(level, bx, by, keys, values)
                if block < 0:
                    continue
                jx, jy = bx << BLOCK_BITS, by << BLOCK_BITS
                left, right = max(ix0 - jx, 0), min(ix1 - jx, BLOCK - 1)
                low, high = max(iy0 - jy, 0), min(iy1 - jy, BLOCK - 1)
                first = block * CELLS
                if _near_in_block(first, left, right, low, high, x, y, h, c, s, layer, cells, points, chain, layers):
                    return True
    return False


@njit(nogil=True, cache=True, _nrt=False)
def accept(x, y, h, turn, layer, state, setting, table, packing):
    """Add a point to the packing and to the hash; return its number."""
    keys, values, cells = table
    points, chain, layers = packing
    p = state[N_POINTS]
    state[N_POINTS] = p + 1
    points[p, X], points[p, Y], points[p, SIZE], points[p, TURN] = x, y, h, turn
    layers[p] = layer
    level = level_of(h)
    per_side = 2.0**-level
    ix, iy = int((x - setting[LOW_X]) * per_side), int((y - setting[LOW_Y]) * per_side)
    cell, state[N_BLOCKS] = cell_for(level, max(ix, 0), max(iy, 0), keys, values, cells, state[N_BLOCKS])
    chain[p] = cells[cell]
    cells[cell] = p
    return p


@njit(nogil=True, cache=True, _nrt=False)
def _enqueue(x, y, h, turn, layer, hint, home, state, log_finest, waiting):
    """Put a proposal at the end of its bucket."""
    queue, links, heads, tails = waiting
    k = state[FREE]
    if k >= 0:
        state[FREE] = links[k, 0]
    else:
        k = state[N_QUEUED]
        state[N_QUEUED] = k + 1
    queue[k, X], queue[k, Y], queue[k, SIZE], queue[k, TURN] = x, y, h, turn
    links[k, 0], links[k, 1], links[k, 2], links[k, 3] = -1, layer, hint, home
    b = bucket_of(h, log_finest)
    if heads[b] < 0:
        heads[b] = k
    else:
        links[tails[b], 0] = k
    tails[b] = k
    if b < state[BUCKET]:
        state[BUCKET] = b


@njit(nogil=True, cache=True, _nrt=False)
def propose(p, hint, home, layer, sampler, region, state, setting, packing, waiting):
    """Propose the four neighbours of an accepted point, at the mean size of both ends."""
    points = packing[0]
    x, y, h, turn = points[p, X], points[p, Y], points[p, SIZE], points[p, TURN]
    angle = setting[ANGLE] + turn
    c, s = math.cos(angle), math.sin(angle)
    scale = setting[SCALE]
    for _ in range(4):
        far, hint = size_at(sampler, x + h * c, y + h * s, hint)
        slope = min(max((scale * far - h) / h, -0.9), 0.9)
        step = h / (1.0 - 0.5 * slope)
        qx, qy = x + step * c, y + step * s
        size, hint = size_at(sampler, qx, qy, hint)
        inside, home = within(region, qx, qy, CLEARANCE * scale * size, home)
        if inside:
            _enqueue(qx, qy, scale * size, DECAY * turn, layer, hint, home, state, setting[LOG_FINEST], waiting)
        c, s = -s, c


@njit(nogil=True, cache=True, _nrt=False)
def begin(rim, sizes, turns, sampler, region, state, setting, table, packing, waiting):
    """Accept the nodes of the outline, then let each propose its neighbours."""
    state[BUCKET] = N_BUCKETS
    for i in range(len(rim)):
        accept(rim[i, 0], rim[i, 1], sizes[i], turns[i], 0, state, setting, table, packing)
    hint, home = 0, 0
    for i in range(len(rim)):
        _, home = within(region, rim[i, 0], rim[i, 1], 0.0, home)
        propose(i, hint, home, 1, sampler, region, state, setting, packing, waiting)
    state[BUCKET] = 0


@njit(nogil=True, cache=True, _nrt=False)
def _next(state, waiting, seeds):
    """Move to the first bucket that is not empty; return its first proposal, or -2 - (a seed), or -1 at the end."""
    links, heads = waiting[1], waiting[2]
    seed_bucket, seed_at = seeds[1], seeds[2]
    b = state[BUCKET]
    while b < N_BUCKETS:
        k = heads[b]
        if k >= 0:
            heads[b] = links[k, 0]
            state[BUCKET] = b
            return k
        if seed_at[b] < seed_bucket[b + 1]:
            seed_at[b] += 1
            state[BUCKET] = b
            return -1 - seed_at[b]
        b += 1
    state[BUCKET] = b
    return -1


@njit(nogil=True, cache=True, _nrt=False)
def advance(most, sampler, region, state, setting, table, packing, waiting, seeds):
    """Accept up to ``most`` more points; return whether nothing is left to try."""
    queue, links = waiting[0], waiting[1]
    rows = seeds[0]
    stop = state[N_POINTS] + most
    while state[N_POINTS] < stop:
        k = _next(state, waiting, seeds)
        if k == -1:
            return True
        if k >= 0:
            x, y, h, turn = queue[k, X], queue[k, Y], queue[k, SIZE], queue[k, TURN]
            layer, hint, home = links[k, 1], links[k, 2], links[k, 3]
            links[k, 0] = state[FREE]
            state[FREE] = k
        else:
            x, y, h, turn = rows[-2 - k, 0], rows[-2 - k, 1], rows[-2 - k, 2], 0.0
            layer, hint, home = 2, 0, 0
        angle = setting[ANGLE] + turn
        if not blocked(x, y, h, math.cos(angle), math.sin(angle), layer, setting, table, packing):
            p = accept(x, y, h, turn, layer, state, setting, table, packing)
            propose(p, hint, home, 2, sampler, region, state, setting, packing, waiting)
    return False
