"""Packing of points at the distance the size field asks for, smallest size first.

Accepted points propose neighbours along their frame's axes; a proposal waits in a queue by size and is refused if an
accepted point lies nearer than ``CLOSE`` of their mean size, in the maximum norm of the frame. After Remacle et al.
(2013), "A frontal Delaunay quad mesh generator using the L-infinity norm", DOI 10.1002/nme.4458. On plateaus of the
field proposals move to one lattice, so that fronts that meet there fit together.

A front may be confined to a part of the domain; proposals near its cuts are parked in a bucket of their own, for the
last front, which knows the points of all parts.

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
PARKED = N_BUCKETS
MARGIN, KNOWN = 1.5, 8.0
PLATEAU = 1.08
PLATEAU_WIDTH = 3.0
NEAR_LATTICE = 0.1
LATER = 2
RIM, FIRST, INNER, POSTPONED = 0, 1, 2, 3
REFUSE, ACCEPT, POSTPONE = 0, 1, 2
STRAIGHT = 0.05

X, Y, SIZE, TURN, POINT_COLUMNS = 0, 1, 2, 3, 4
N_POINTS, N_BLOCKS, BUCKET, N_QUEUED, FREE, STATE_SIZE = 0, 1, 2, 3, 4, 5
SCALE, LOW_X, LOW_Y, ANGLE, RATIO, LOG_FINEST, LEFT, BOTTOM, RIGHT, TOP = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
NEXT, LAYER, HINT, HOME, CAME, LINK_COLUMNS = 0, 1, 2, 3, 4, 5


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
                close = CLOSE_IN_FIRST_LAYER if layer == FIRST and layers[q] == FIRST else CLOSE
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
    own, low_level = level_of(h), level_of(h / ratio)
    for k in range(low_level - 1, level_of(h * ratio) + 1):
        # the points of the same size first: they are what blocks most proposals
        level = own if k < low_level else k
        if k == own:
            continue
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
def _enqueue(x, y, h, turn, layer, hint, home, came, state, b, waiting):
    """Put a proposal at the end of bucket b."""
    queue, links, heads, tails = waiting
    k = state[FREE]
    if k >= 0:
        state[FREE] = links[k, NEXT]
    else:
        k = state[N_QUEUED]
        state[N_QUEUED] = k + 1
    queue[k, X], queue[k, Y], queue[k, SIZE], queue[k, TURN] = x, y, h, turn
    links[k, NEXT], links[k, LAYER], links[k, HINT], links[k, HOME], links[k, CAME] = -1, layer, hint, home, came
    if heads[b] < 0:
        heads[b] = k
    else:
        links[tails[b], NEXT] = k
    tails[b] = k
    if b < state[BUCKET]:
        state[BUCKET] = b


@njit(nogil=True, cache=True, _nrt=False)
def _on_lattice(x, y, setting, plateaus, k):
    """Return the node of a plateau's lattice that is nearest to a point."""
    c, s = math.cos(setting[ANGLE]), math.sin(setting[ANGLE])
    dx, dy = x - plateaus[k, 3], y - plateaus[k, 4]
    u = math.floor((c * dx + s * dy) / plateaus[k, 1] + 0.5) * plateaus[k, 1]
    v = math.floor((c * dy - s * dx) / plateaus[k, 2] + 0.5) * plateaus[k, 2]
    return plateaus[k, 3] + c * u - s * v, plateaus[k, 4] + s * u + c * v


@njit(nogil=True, cache=True, _nrt=False)
def _plateau_of(h, plateaus):
    """Return the plateau that a size belongs to, -1 if none."""
    for k in range(len(plateaus)):
        if plateaus[k, 0] * (1.0 - 1e-9) <= h <= plateaus[k, 0] * PLATEAU:
            return k
    return -1


@njit(nogil=True, cache=True, _nrt=False)
def _wide_plateau(x, y, h, turn, sampler, setting, plateaus, hint):
    """Return the plateau that a point and its surroundings belong to, -1 if none."""
    k = _plateau_of(h, plateaus)
    if k >= 0 and abs(turn) < STRAIGHT:
        for i in range(4):
            away = PLATEAU_WIDTH * h * (1.0 - 2.0 * (i & 1))
            far, hint = size_at(sampler, x + away * (i < 2), y + away * (i >= 2), hint)
            if setting[SCALE] * far > plateaus[k, 0] * PLATEAU:
                return -1
        return k
    return -1


@njit(nogil=True, cache=True, _nrt=False)
def propose(p, hint, home, came, layer, sampler, region, state, setting, packing, waiting):
    """Propose the neighbours of an accepted point, but the one it came from, at the mean size of both ends."""
    points = packing[0]
    x, y, h, turn = points[p, X], points[p, Y], points[p, SIZE], points[p, TURN]
    angle = setting[ANGLE] + turn
    c, s = math.cos(angle), math.sin(angle)
    scale = setting[SCALE]
    for k in range(4):
        if k != came:
            size, hint = size_at(sampler, x + h * c, y + h * s, hint)
            size *= scale
            step = h
            if size != h:
                step = h / (1.0 - 0.5 * min(max((size - h) / h, -0.9), 0.9))
                size, hint = size_at(sampler, x + step * c, y + step * s, hint)
                size *= scale
            qx, qy = x + step * c, y + step * s
            inside, home = within(region, qx, qy, CLEARANCE * size, home)
            if inside:
                back = (k + 2) & 3
                b = bucket_of(size, setting[LOG_FINEST])
                _enqueue(qx, qy, size, DECAY * turn, layer, hint, home, back, state, b, waiting)
        c, s = -s, c


@njit(nogil=True, cache=True, _nrt=False)
def begin(rim, sizes, turns, sampler, region, state, setting, table, packing, waiting):
    """Accept the nodes of the outline, then let each propose its neighbours."""
    state[BUCKET] = N_BUCKETS
    for i in range(len(rim)):
        accept(rim[i, 0], rim[i, 1], sizes[i], turns[i], RIM, state, setting, table, packing)
    hint, home = 0, 0
    for i in range(len(rim)):
        x, y = rim[i, 0], rim[i, 1]
        if not (setting[LEFT] <= x < setting[RIGHT] and setting[BOTTOM] <= y < setting[TOP]):
            continue
        _, home = within(region, x, y, 0.0, home)
        propose(i, hint, home, -1, FIRST, sampler, region, state, setting, packing, waiting)
    state[BUCKET] = 0


@njit(nogil=True, cache=True, _nrt=False)
def _near_cut(x, y, gap, setting):
    """Whether a point lies less than ``gap`` from a cut of its part, or beyond."""
    across = x - gap < setting[LEFT] or x + gap >= setting[RIGHT]
    return across or y - gap < setting[BOTTOM] or y + gap >= setting[TOP]


@njit(nogil=True, cache=True, _nrt=False)
def take_over(given, given_setting, given_packing, given_waiting, first, state, setting, table, packing, waiting):
    """Accept a front's points near its cuts, from the ``first`` on, and take up the proposals it has parked."""
    points, _, layers = given_packing
    queue, links, heads, _ = given_waiting
    for p in range(first, given[N_POINTS]):
        x, y, h, turn = points[p, X], points[p, Y], points[p, SIZE], points[p, TURN]
        if layers[p] == RIM or _near_cut(x, y, KNOWN * h, given_setting):
            accept(x, y, h, turn, layers[p], state, setting, table, packing)
    k = heads[PARKED]
    while k >= 0:
        h, layer = queue[k, SIZE], links[k, LAYER]
        b = bucket_of(h, setting[LOG_FINEST])
        if layer == POSTPONED:
            b = min(b + LATER, N_BUCKETS - 1)
        _enqueue(
            queue[k, X], queue[k, Y], h, queue[k, TURN], layer, links[k, HINT], links[k, HOME], links[k, CAME],
            state, b, waiting,
        )  # fmt: skip
        k = links[k, NEXT]


@njit(nogil=True, cache=True, _nrt=False)
def _next(state, waiting, seeds):
    """Move to the first bucket that is not empty; return its first proposal, or -2 - (a seed), or -1 at the end."""
    links, heads = waiting[1], waiting[2]
    seed_bucket, seed_at = seeds[1], seeds[2]
    b = state[BUCKET]
    while b < N_BUCKETS:
        k = heads[b]
        if k >= 0:
            heads[b] = links[k, NEXT]
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
def _try(x, y, h, turn, layer, sampler, hint, setting, table, packing, region, plateaus, home):
    """Return what to do with a proposal, ``ACCEPT``, ``REFUSE`` or ``POSTPONE``, and where its point would be.

    On a plateau the lattice comes first; what does not fit into it waits until the lattice is complete.
    """
    angle = setting[ANGLE] + turn
    c, s = math.cos(angle), math.sin(angle)
    if blocked(x, y, h, c, s, layer, setting, table, packing):
        return REFUSE, x, y
    k = -1
    if layer == INNER and len(plateaus) > 0:
        k = _wide_plateau(x, y, h, turn, sampler, setting, plateaus, hint)
    if k < 0:
        return ACCEPT, x, y
    lx, ly = _on_lattice(x, y, setting, plateaus, k)
    inside, home = within(region, lx, ly, CLEARANCE * h, home)
    if inside and not blocked(lx, ly, h, c, s, layer, setting, table, packing):
        return ACCEPT, lx, ly
    return (REFUSE if max(abs(lx - x), abs(ly - y)) < NEAR_LATTICE * h else POSTPONE), x, y


@njit(nogil=True, cache=True, _nrt=False)
def advance(most, sampler, region, state, setting, table, packing, waiting, seeds, plateaus):
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
            layer, hint, home, came = links[k, LAYER], links[k, HINT], links[k, HOME], links[k, CAME]
            links[k, NEXT] = state[FREE]
            state[FREE] = k
        else:
            x, y, h, turn = rows[-2 - k, 0], rows[-2 - k, 1], rows[-2 - k, 2], 0.0
            layer, hint, home, came = INNER, 0, 0, -1
        if _near_cut(x, y, MARGIN * h, setting):
            _enqueue(x, y, h, turn, layer, hint, home, came, state, PARKED, waiting)
            continue
        fate, x, y = _try(x, y, h, turn, layer, sampler, hint, setting, table, packing, region, plateaus, home)
        if fate == POSTPONE:
            b = min(bucket_of(h, setting[LOG_FINEST]) + LATER, N_BUCKETS - 1)
            _enqueue(x, y, h, turn, POSTPONED, hint, home, came, state, b, waiting)
        elif fate == ACCEPT:
            p = accept(x, y, h, turn, layer, state, setting, table, packing)
            propose(p, hint, home, came, INNER, sampler, region, state, setting, packing, waiting)
    return False
