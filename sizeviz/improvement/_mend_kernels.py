"""Operations around elements that are too large or badly shaped, each tried, relaxed, measured exactly, and compared.

Unlike clean-up, which takes the first operation that lowers the energy, these are chosen by what the guarantee asks
for: no excess of R over 1, and no low quality. R is measured with the exact least size over every element of the
neighbourhood, after it has been relaxed with its edges held below those sizes.
"""

from __future__ import annotations

import numpy as np

from sizeviz.improvement._attempt_kernels import (
    aim_elements,
    build,
    collect_nodes,
    collect_region,
    inherit,
    memo,
    restore_places,
    save_places,
    settle,
)
from sizeviz.improvement._candidate_kernels import MOST_CANDIDATES, candidates, splits
from sizeviz.improvement._cavity_kernels import core_nodes, exchange, restore_links, save_links
from sizeviz.improvement._jit import allocating, compiled
from sizeviz.improvement._look_kernels import longest_squared
from sizeviz.improvement._star_kernels import gather
from sizeviz.improvement._step_kernels import node_step
from sizeviz.improvement._worst_kernels import lift_free, lift_sliding, quad_quality, star_quality
from sizeviz.sizing._minimum_kernels import quad_min

EDGE_WEIGHT = 200.0
"""Weight of the edge term around an operation."""
SWEEPS = 12
EVERY = 4
"""The least sizes are looked up again after so many sweeps."""
SETTLED = 0.01
"""Decrease of the objective in a sweep below which the surroundings have settled."""
HELD = 0.985
"""Edges are pulled below this share of the least size, so that they end below all of it."""
MET = 0.999
"""R up to this counts as met."""
EXCESS = 10.0
"""What one unit of squared excess weighs against one unit of quality."""
REGULAR = 0.002
"""What one unit of valence energy weighs."""
WORTH = 0.01
"""Least gain for which the connectivity is changed."""
LIFTS = 2
"""Passes that raise the qualities around an operation."""
STRETCH = 1.4
"""Longest edge over target that raising a quality may leave, unless it was longer."""
SPLITS, ALL = np.int64(0), np.int64(1)
"""Which operations are tried."""


@compiled
def limit_elements(region, n, patch, bound, share, searcher):
    """Hold the edges of elements below ``share`` of the least size over each of them, times ``HELD``."""
    xy, quads = patch[0], patch[1]
    for i in range(n):
        q = region[i]
        a, b, c, d = quads[q, 0], quads[q, 1], quads[q, 2], quads[q, 3]
        least = quad_min(
            searcher, xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], xy[d, 0], xy[d, 1]
        )  # fmt: skip
        held = HELD * share[q] * least
        bound[q] = 1.0 / (held * held)


@compiled
def grade(region, n, patch, bound, floor):
    """Return the demerit of elements and their lowest quality.

    What each lacks counts: of several bad ones side by side an operation seldom mends all.
    """
    xy, quads = patch[0], patch[1]
    excess, lack, lowest = 0.0, 0.0, 1.0
    for i in range(n):
        q = region[i]
        excess += max(0.0, longest_squared(q, xy, quads) * bound[q] * (HELD / MET) ** 2 - 1.0)
        quality = quad_quality(q, xy, quads)
        lack, lowest = lack + max(0.0, floor - quality), min(lowest, quality)
    return EXCESS * excess + lack, lowest


@compiled
def relax_held(nodes, n, n_core, region, n_region, patch, aims, law, rails, star, share, searcher):
    """Sweep the surroundings of an operation with their edges held below the sizes, until they settle."""
    for s in range(SWEEPS):
        step = 0.0
        for i in range(n_core if s < 2 else n):
            step += node_step(nodes[i], patch, aims[2], aims[4], law, rails, star)
        if s % EVERY == 1:
            limit_elements(region, n_region, patch, aims[4], share, searcher)
        elif s > EVERY and step < SETTLED:
            break


@compiled
def lift_nodes(nodes, n, patch, aims, rails, star, floor):
    """Move nodes beside elements below ``floor`` to where the worst around them is best, as far as limits let them."""
    xy = patch[0]
    for _ in range(LIFTS):
        for i in range(n):
            v = nodes[i]
            kind = rails[1][v]
            if kind < -1 or patch[3][v] == 0:
                continue
            m = gather(v, patch, aims[2], aims[4], star)
            if star_quality(star, m, xy[v, 0], xy[v, 1], 0.0)[0] >= floor:
                continue
            if kind == -1:
                lift_free(v, xy, star, m, 1.0 / STRETCH**2)
            else:
                lift_sliding(v, xy, star, m, 1.0 / STRETCH**2, rails[0], kind, rails[2])


@compiled
def hand_down(slots, n_new, n_old, share):
    """Give additional elements the smallest share among those they replace, whose rows are the first slots."""
    least = np.inf
    for i in range(min(n_old, n_new)):
        least = min(least, share[slots[i]])
    for i in range(n_old, n_new):
        share[slots[i]] = least


@compiled
def trial(op, keep, patch, topo, marks, aims, rails, law, searcher, share, goal, room, tops):
    """Try one operation (kind, code, argument, change of energy); return its gain and the nodes it kept moved.

    It is kept where it gains enough and ``keep`` says so, or where nothing is left to ask for; else it is undone, bit
    for bit, and the number of nodes is 0. ``goal`` is (quality asked for, quality that no
    operation may go below, demerit over that before which raising the qualities is not expected to make good).
    """
    old, new, spots, slots, core = room[0], room[1], room[2], room[4], room[5]
    nodes, region, births, star, kept, after = room[6], room[7], room[8], room[9], room[10], room[13]
    for i in range(4):
        births[i] = room[11][tops[0] - 1 - i] if tops[0] > i else -1
    n_old, n_new, n_spots = build(op[0], op[1], op[2], births, patch, topo, room)
    if n_old == 0:
        return -np.inf, 0
    n_core = core_nodes(old, n_old, new, n_new, patch[1], core)
    if n_core > len(core) or n_new - n_old > tops[1]:
        return -np.inf, 0
    for i in range(n_new):
        slots[i] = old[i] if i < n_old else room[12][tops[1] - 1 - (i - n_old)]
    tops[2] += 1
    n = collect_nodes(core, n_core, patch, marks, tops[2], nodes)
    n_before = collect_region(nodes, n, patch, marks, tops[2], region)
    if n < 0 or n_before + 8 > len(region):
        return -np.inf, 0
    before, worst = grade(region, n_before, patch, aims[4], goal[0])
    save_links(old, n_old, core, n_core, patch, kept)
    save_places(nodes, n, region, n_before, patch, rails, aims, kept)
    fits = exchange(old, n_old, new, n_new, slots, patch)
    for i in range(n_spots):
        v = int(spots[i, 0])
        patch[0][v, 0], patch[0][v, 1] = spots[i, 1], spots[i, 2]
    gain = -np.inf
    if fits:
        inherit(slots, n_new, n_old, aims[4])
        hand_down(slots, n_new, n_old, share)
        aim_elements(slots, n_new, patch, aims)
        tops[2] += 1
        n_after = collect_region(nodes, n, patch, marks, tops[2], after)
        if n_after <= len(after):
            relax_held(nodes, n, n_core, after, n_after, patch, aims, law, rails, star, share, searcher)
            limit_elements(after, n_after, patch, aims[4], share, searcher)
            demerit, quality = grade(after, n_after, patch, aims[4], goal[0])
            if 0.0 < demerit < before + goal[2]:
                lift_nodes(nodes, n, patch, aims, rails, star, goal[0])
                limit_elements(after, n_after, patch, aims[4], share, searcher)
                demerit, quality = grade(after, n_after, patch, aims[4], goal[0])
            gain = before - demerit - REGULAR * op[3]
            if quality < min(worst, goal[1]):
                gain = -np.inf
            if gain > WORTH and (keep or demerit <= 0.0):
                settle(op[0], n_old, n_new, n_core, patch[3], room, tops)
                return gain, n
    restore_links(old, n_old, core, n_core, slots, n_new, patch, kept)
    restore_places(nodes, n, region, n_before, patch, rails, aims, kept)
    return gain, 0


@compiled
def asks(v, patch, bound, floor):
    """Say whether an element around a node is too large or below the quality asked for."""
    xy, quads, ring, count = patch
    for j in range(count[v]):
        q = ring[v, j] >> 2
        if longest_squared(q, xy, quads) * bound[q] * HELD**2 > 1.0 or quad_quality(q, xy, quads) < floor:
            return True
    return False


@allocating
def mend(
    nodes, first, last, which, limit, patch, topo, marks, aims, rails, law, searcher, share, goal, notes, room, tops
):
    """At each of nodes[first:last] that asks for it apply the best operation, if one is worth it; return how many were.

    ``notes`` is (nodes that moved, what gained too little at each element, so that it is not tried again from another
    node before something near has changed).
    """
    changed, failed = notes
    found = np.empty((MOST_CANDIDATES, 4), np.int64)
    done = 0
    for i in range(first, last):
        v = nodes[i]
        if patch[3][v] == 0 or not asks(v, patch, aims[4], goal[0]):
            continue
        if which == SPLITS:
            n = splits(v, patch, topo, room[3], limit, found)
        else:
            n = candidates(v, patch, topo, room[3], limit, found)
        best, at, moved = WORTH, -1, 0
        for j in range(n):
            op = (found[j, 0], found[j, 1], found[j, 2], found[j, 3])
            q, bit = memo(op[0], op[1], op[2], patch)
            if failed[q] & bit:
                continue
            gain, moved = trial(op, False, patch, topo, marks, aims, rails, law, searcher, share, goal, room, tops)
            if moved > 0:
                break
            if gain <= WORTH:
                failed[q] |= bit
            if gain > best:
                best, at = gain, j
        if moved == 0 and at >= 0:
            op = (found[at, 0], found[at, 1], found[at, 2], found[at, 3])
            _, moved = trial(op, True, patch, topo, marks, aims, rails, law, searcher, share, goal, room, tops)
        if moved > 0:
            done += 1
            for j in range(moved):
                w = room[6][j]
                changed[w] = True
                for k in range(patch[3][w]):
                    failed[patch[2][w, k] >> 2] = 0
    return done
