"""The loop over the irregular nodes of one tile."""

from __future__ import annotations

import numpy as np

from sizeviz.improvement._attempt_kernels import attempt
from sizeviz.improvement._candidate_kernels import MOST_CANDIDATES, candidates
from sizeviz.improvement._jit import allocating, compiled
from sizeviz.improvement._operation_kernels import NONE, PILLOW
from sizeviz.improvement._worst_kernels import quad_quality


@compiled
def enqueue(v, queue, queued, tops):
    """Append a node to the tile's queue unless it waits there already; ``tops[3:5]`` is (head, length)."""
    if not queued[v]:
        queued[v] = True
        queue[(tops[3] + tops[4]) % len(queue)] = v
        tops[4] += 1


@compiled
def seed_queue(first, last, patch, topo, marks, queue, queued, visits, tops):
    """Queue the irregular nodes of an index range that the tile owns, and count visits from zero."""
    for v in range(first, last):
        visits[v] = 0
        if patch[3][v] > 0 and marks[0][v] == marks[1] and patch[3][v] != topo[0][v]:
            enqueue(v, queue, queued, tops)


@compiled
def worst_around(v, patch):
    """Return the lowest shape quality around a node and the code of the corner it is found at."""
    _, quads, ring, count = patch
    worst, code = 2.0, ring[v, 0]
    for j in range(count[v]):
        quality = quad_quality(ring[v, j] >> 2, patch[0], quads)
        if quality < worst:
            worst, code = quality, ring[v, j]
    return worst, code


@compiled
def wanted(v, patch, topo, marks, demand):
    """Say whether a node is worth a visit.

    In clean-up it is where it is irregular; in a rescue, beside an element below the quality demanded.
    """
    if patch[3][v] == 0 or marks[0][v] != marks[1]:
        return False
    if demand > 0.0:
        return worst_around(v, patch)[0] < demand
    return patch[3][v] != topo[0][v]


@compiled
def offered(v, patch, topo, work, limit, tries, demand, found):
    """List the operations that a visit tries; return their number."""
    n = min(candidates(v, patch, topo, work, limit, found), tries)
    if demand > 0.0:
        # what is left when nothing else helps: room around the worst element
        found[n, 0], found[n, 1], found[n, 2], found[n, 3] = PILLOW, worst_around(v, patch)[1], NONE, NONE
        n += 1
    return n


@allocating
def clean_tile(budget, most, limit, tries, patch, topo, marks, aims, rails, law, room, tops, queue, queued, visits):
    """Visit up to ``budget`` queued nodes and apply at each the first operation that stands; return how many did.

    A node is visited up to ``most`` times. ``limit`` is the largest change of valence energy considered, ``tries`` how
    many operations a visit may test, fewer than ``MOST_CANDIDATES``.
    """
    found = np.empty((MOST_CANDIDATES, 4), np.int64)
    done = 0
    nodes = room[6]
    for _ in range(budget):
        if tops[4] == 0:
            break
        v = queue[tops[3]]
        tops[3] = (tops[3] + 1) % len(queue)
        tops[4] -= 1
        queued[v] = False
        if visits[v] >= most or not wanted(v, patch, topo, marks, law[4]):
            continue
        visits[v] += 1
        n = offered(v, patch, topo, room[3], limit, tries, law[4], found)
        for i in range(n):
            near = attempt(
                found[i, 0], found[i, 1], found[i, 2], found[i, 3],
                patch, topo, marks, aims, rails, law, room, tops,
            )  # fmt: skip
            if near > 0:
                done += 1
                for j in range(near):
                    w = nodes[j]
                    if wanted(w, patch, topo, marks, law[4]):
                        enqueue(w, queue, queued, tops)
                break
    return done
