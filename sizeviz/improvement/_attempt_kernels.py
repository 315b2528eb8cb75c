"""One operation tried: applied, relaxed around, judged, and kept or undone bit for bit."""

from __future__ import annotations

import math

from sizeviz.improvement._cavity_kernels import core_nodes, exchange, restore_links, save_links
from sizeviz.improvement._energy_kernels import BARRIER, delta_squared, value
from sizeviz.improvement._jit import compiled
from sizeviz.improvement._mesh_kernels import find_next
from sizeviz.improvement._operation_kernels import (
    COLLAPSE,
    DOUBLET,
    OPEN,
    PILLOW,
    ROTATE,
    SWAP,
    build_collapse,
    build_doublet,
    build_open,
    build_pillow,
    build_rotate,
    build_swap,
)
from sizeviz.improvement._step_kernels import STIRRED, node_step, wake
from sizeviz.sizing._kernels import size_at

CORE_SWEEPS = 2
"""Sweeps of the cavity alone."""
SWEEPS = 10
"""Most sweeps of the cavity and its ring after that; further ones were measured to change no verdict."""
AFTER_SWEEPS = 8
"""Most sweeps around an operation that stands."""
REACHABLE = (20.0, 1.0, 1.7, 4.0, 8.0)
"""Decrease that may still be missing after the core sweeps, and after each sweep more, over that of the last sweep.

Measured on 23,000 trials: of the operations that stand in the end, 1 in 100 is given up; of the others, 9 in 10.
"""
TURNED = (1 << 3) | (1 << 7)
"""The notes of both turns of the edge that a swap has made: it lies behind the third corner of both its elements."""
LAST_DEMAND = 0.01
"""Quality demanded below which a rescue may leave some of the elements below it, if it leaves fewer of them."""
RELAXED = 0.1
"""Decrease of a sweep at which the surroundings of an operation have settled."""


@compiled
def corner_sums(q, xy, quads, scale, objective, delta2):
    """Return an element's distortion, smallest sigma, sum of |S|^2 / sigma and longest edge^2 over target^2."""
    total, low, shape, longest = 0.0, math.inf, 0.0, 0.0
    for k in range(4):
        v, w, p = quads[q, k], quads[q, (k + 1) & 3], quads[q, (k + 3) & 3]
        ax, ay, bx, by = xy[w, 0] - xy[v, 0], xy[w, 1] - xy[v, 1], xy[p, 0] - xy[v, 0], xy[p, 1] - xy[v, 1]
        sigma = (ax * by - ay * bx) * scale
        a2 = (ax * ax + ay * ay) * scale
        square = a2 + (bx * bx + by * by) * scale
        low, longest = min(low, sigma), max(longest, a2)
        shape += square / sigma
        total += square * value(sigma, objective, delta2)
    return total, low, shape, longest


@compiled
def element_measures(q, patch, inv, objective):
    """Return an element's distortion above 4, smallest sigma, shape quality and longest edge^2 over target^2."""
    xy, quads = patch[0], patch[1]
    total, low, shape, longest = corner_sums(q, xy, quads, inv[q], objective, 0.0)
    delta2 = delta_squared(low)
    if delta2 > 0.0:
        total = corner_sums(q, xy, quads, inv[q], objective, delta2)[0]
    return total - 4.0, low, 8.0 / shape if low > 0.0 else 0.0, longest


@compiled
def measure(region, n, patch, aims, objective):
    """Return total distortion, smallest sigma, worst quality and largest stretch of a region's elements."""
    total, low, quality, longest = 0.0, math.inf, 1.0, 0.0
    for i in range(n):
        t = element_measures(region[i], patch, aims[2], objective)
        total += t[0]
        low, quality, longest = min(low, t[1]), min(quality, t[2]), max(longest, t[3])
    return total, low, quality, longest


@compiled
def collect_nodes(core, n_core, patch, marks, stamp, nodes):
    """List the core nodes and the nodes of elements around them that the tile owns; -1 where a core node is not.

    ``marks`` is (zone, tile, node marks, element marks, nodes awake, notes of what failed at each element).
    """
    _, quads, ring, count = patch
    zone, tile, seen = marks[0], marks[1], marks[2]
    n = 0
    for i in range(n_core):
        v = core[i]
        if zone[v] != tile:
            return -1
        seen[v] = stamp
        nodes[n] = v
        n += 1
    for i in range(n_core):
        v = core[i]
        for j in range(count[v]):
            for k in range(4):
                w = quads[ring[v, j] >> 2, k]
                if zone[w] == tile and seen[w] != stamp:
                    if n >= len(nodes):
                        return -1
                    seen[w] = stamp
                    nodes[n] = w
                    n += 1
    return n


@compiled
def collect_region(nodes, n_nodes, patch, marks, stamp, region):
    """List the elements around nodes, each once; return their number, which may exceed the room."""
    ring, count, seen = patch[2], patch[3], marks[3]
    n = 0
    for i in range(n_nodes):
        v = nodes[i]
        for j in range(count[v]):
            q = ring[v, j] >> 2
            if seen[q] != stamp:
                seen[q] = stamp
                if n < len(region):
                    region[n] = q
                n += 1
    return n


@compiled
def aim_elements(region, n, patch, aims):
    """Look up the target of each element of a region; ``aims`` is (sampler, sizes, inv, hint, bound, c^2)."""
    xy, quads = patch[0], patch[1]
    sampler, sizes, inv, hint, _, scale2 = aims
    for i in range(n):
        q = region[i]
        x = y = 0.0
        for k in range(4):
            x += 0.25 * xy[quads[q, k], 0]
            y += 0.25 * xy[quads[q, k], 1]
        size, there = size_at(sampler, x, y, max(hint[q], 0))
        sizes[q], hint[q] = size, there
        inv[q] = 1.0 / (scale2 * size * size)


@compiled
def sweep_awake(nodes, n, patch, inv, bound, law, rails, star, awake):
    """Move those of ``n`` listed nodes around which something has moved since they last did; return the decrease."""
    total = 0.0
    for i in range(n):
        v = nodes[i]
        if awake[v]:
            awake[v] = False
            step = node_step(v, patch, inv, bound, law, rails, star)
            if step > STIRRED:
                wake(v, patch, awake)
            total += step
    return total


@compiled
def relax(nodes, n, n_core, region, n_region, patch, awake, aims, law, rails, star, needed, patient):
    """Sweep the cavity, then the cavity and its ring, until the nodes settle or what is missing is out of reach.

    ``needed`` is what the distortion of the region must fall below. Returns whether it stayed within reach, which one
    that is ``patient`` does not ask. While elements are inverted their distortion says little, and is not asked.
    """
    for i in range(n):
        awake[nodes[i]] = True
    total, low, _, _ = measure(region, n_region, patch, aims, law[0])
    for s in range(CORE_SWEEPS + SWEEPS):
        step = sweep_awake(nodes, n_core if s < CORE_SWEEPS else n, patch, aims[2], aims[4], law, rails, star, awake)
        total -= step
        if s >= CORE_SWEEPS and step < RELAXED:
            break
        if patient or s < CORE_SWEEPS - 1:
            continue
        if low < BARRIER:
            total, low, _, _ = measure(region, n_region, patch, aims, law[0])
        reach = REACHABLE[min(s - CORE_SWEEPS + 1, len(REACHABLE) - 1)]
        if low >= BARRIER and total - needed > reach * step:
            return False
    return True


@compiled
def finish(nodes, n, patch, awake, aims, law, rails, star):
    """Let the surroundings of an operation that stands settle, which makes room for the next one."""
    for _ in range(AFTER_SWEEPS):
        if sweep_awake(nodes, n, patch, aims[2], aims[4], law, rails, star, awake) < 2.0 * RELAXED:
            break


@compiled
def build(kind, code, arg, births, patch, topo, room):
    """Fill old, new and spots of ``room`` for one operation; return their lengths."""
    guard, boundary = topo[1], topo[2]
    old, new, spots, work = room[0], room[1], room[2], room[3]
    if kind == DOUBLET:
        return build_doublet(code, patch, old, new)
    if kind == COLLAPSE:
        return build_collapse(code, patch, guard, old, new, spots)
    if kind == ROTATE:
        return build_rotate(code, patch, guard, boundary, old, new, work)
    if kind == OPEN:
        return build_open(code, arg, births[0], patch, guard, boundary, old, new, spots, work)
    if kind == PILLOW:
        return build_pillow(code, births, patch, old, new, spots)
    return build_swap(code, arg, patch, guard, topo[3], old, new, spots)


@compiled
def save_places(nodes, n, region, n_region, patch, rails, aims, kept):
    """Copy positions of nodes and targets of elements before they change."""
    for i in range(n):
        v = nodes[i]
        kept[3][i, 0], kept[3][i, 1], kept[3][i, 2] = patch[0][v, 0], patch[0][v, 1], rails[2][v]
    for i in range(n_region):
        q = region[i]
        kept[4][i, 0], kept[4][i, 1], kept[4][i, 2] = aims[1][q], aims[2][q], aims[4][q]
        kept[5][i] = aims[3][q]


@compiled
def restore_places(nodes, n, region, n_region, patch, rails, aims, kept):
    """Put back, bit for bit, what ``save_places`` copied."""
    for i in range(n):
        v = nodes[i]
        patch[0][v, 0], patch[0][v, 1], rails[2][v] = kept[3][i, 0], kept[3][i, 1], kept[3][i, 2]
    for i in range(n_region):
        q = region[i]
        aims[1][q], aims[2][q], aims[4][q] = kept[4][i, 0], kept[4][i, 1], kept[4][i, 2]
        aims[3][q] = kept[5][i]


@compiled
def better(before, after, change, law):
    """Judge (distortion, sigma, quality, stretch) after an operation against before; law holds the guards.

    ``law`` is (objective, worth of one unit of valence energy, lowest quality, largest squared stretch, quality that
    a rescue demands or 0, gain that is asked for).
    """
    if law[4] > 0.0:
        return after[2] >= law[4] and after[3] <= max(before[3], law[3])
    if after[1] <= 0.0 and before[1] > 0.0:
        return False
    if after[2] < min(before[2], law[2]) or after[3] > max(before[3], law[3]):
        return False
    return after[0] - before[0] + law[1] * change < -law[5]


@compiled
def number_below(demand, region, n, patch, inv, objective):
    """Return how many elements of a region have a shape quality below the one demanded of a last rescue.

    Above ``LAST_DEMAND`` it is not asked, and 0.
    """
    low = 0
    if 0.0 < demand < LAST_DEMAND:
        for i in range(n):
            low += element_measures(region[i], patch, inv, objective)[2] < demand
    return low


@compiled
def memo(kind, code, arg, patch):
    """Return an element and the bit of its note that a swap or a collapse has been tried, or bit 0 for the others.

    A swap is noted at the lower one of its two elements, so that it is the same from both.
    """
    q, k = code >> 2, code & 3
    if kind == COLLAPSE:
        return q, 1 << (8 + (k & 1))
    if kind != SWAP:
        return q, 0
    _, quads, ring, count = patch
    other = find_next(quads[q, (k + 1) & 3], quads[q, k], quads, ring, count)
    if other >= 0 and other >> 2 < q:
        q, k = other >> 2, other & 3
    return q, 1 << (4 * arg + k)


@compiled
def attempt(kind, code, arg, change, patch, topo, marks, aims, rails, law, room, tops):
    """Try one operation unless it failed before and nothing around it has changed since; return as ``tried_out``."""
    q, bit = memo(kind, code, arg, patch)
    if marks[5][q] & bit and law[4] == 0.0:
        return 0
    near = tried_out(kind, code, arg, change, patch, topo, marks, aims, rails, law, room, tops)
    if near == 0:
        marks[5][q] |= bit
    elif kind == SWAP and law[5] < 0.0:
        # the way back would often look better, and be gone to and fro
        marks[5][min(room[4][0], room[4][1])] |= TURNED
    return near


@compiled
def tried_out(kind, code, arg, change, patch, topo, marks, aims, rails, law, room, tops):
    """Try one operation; return the number of nodes around it that were kept moved, or 0 where it was undone.

    ``room`` is (old, new, spots, fan room, slots, core, nodes, region, births, star, kept, free nodes, free elements,
    region afterwards); ``tops`` is (free nodes left, free elements left, stamp, ...).
    """
    old, new, spots, slots, core = room[0], room[1], room[2], room[4], room[5]
    nodes, region, births, kept = room[6], room[7], room[8], room[10]
    for i in range(4):
        births[i] = room[11][tops[0] - 1 - i] if tops[0] > i else -1
    n_old, n_new, n_spots = build(kind, code, arg, births, patch, topo, room)
    if n_old == 0:
        return 0
    n_core = core_nodes(old, n_old, new, n_new, patch[1], core)
    extra = n_new - n_old
    if n_core > len(core) or extra > tops[1]:
        return 0
    for i in range(n_new):
        slots[i] = old[i] if i < n_old else room[12][tops[1] - 1 - (i - n_old)]
    tops[2] += 1
    n = collect_nodes(core, n_core, patch, marks, tops[2], nodes)
    n_before = collect_region(nodes, n, patch, marks, tops[2], region)
    if n < 0 or n_before + 8 > len(region):
        return 0
    before = measure(region, n_before, patch, aims, law[0])
    low = number_below(law[4], region, n_before, patch, aims[2], law[0])
    save_links(old, n_old, core, n_core, patch, kept)
    save_places(nodes, n, region, n_before, patch, rails, aims, kept)
    fits = exchange(old, n_old, new, n_new, slots, patch)
    for i in range(n_spots):
        v = int(spots[i, 0])
        patch[0][v, 0], patch[0][v, 1] = spots[i, 1], spots[i, 2]
    if fits and relaxed_better(
        before, low, change, n_core, n, n_old, n_new, patch, marks, aims, rails, law, room, tops
    ):  # fmt: skip
        settle(kind, n_old, n_new, n_core, patch[3], room, tops)
        return n
    restore_links(old, n_old, core, n_core, slots, n_new, patch, kept)
    restore_places(nodes, n, region, n_before, patch, rails, aims, kept)
    return 0


@compiled
def inherit(slots, n_new, n_old, bound):
    """Give the new elements the strictest limit among the old ones, whose rows are the first slots."""
    most = 0.0
    for i in range(min(n_old, n_new)):
        most = max(most, bound[slots[i]])
    for i in range(n_new):
        bound[slots[i]] = most


@compiled
def relaxed_better(before, low, change, n_core, n, n_old, n_new, patch, marks, aims, rails, law, room, tops):
    """Relax around a change just made and judge it.

    Where inverted elements lie side by side no single operation mends all of them; the last rescue, before which
    ``low`` elements were below what it demands, takes one that leaves fewer.
    """
    slots, nodes, region, star = room[4], room[6], room[13], room[9]
    inherit(slots, n_new, n_old, aims[4])
    aim_elements(slots, n_new, patch, aims)
    tops[2] += 1
    n_after = collect_region(nodes, n, patch, marks, tops[2], region)
    if n_after > len(region):
        return False
    pull = law[0], 0.0
    needed = before[0] - law[1] * change - law[5]
    if not relax(
        nodes, n, n_core, region, n_after, patch, marks[4], aims, pull, rails, star, needed, law[4] != 0.0
    ):  # fmt: skip
        return False
    aim_elements(region, n_after, patch, aims)
    if not better(before, measure(region, n_after, patch, aims, law[0]), change, law) and (
        low == 0 or number_below(law[4], region, n_after, patch, aims[2], law[0]) >= low
    ):
        return False
    finish(nodes, n, patch, marks[4], aims, pull, rails, star)
    for i in range(n_after):
        marks[5][region[i]] = 0
    return True


@compiled
def settle(kind, n_old, n_new, n_core, count, room, tops):
    """Take rows and nodes that were used off the free lists, and put those that became free on them."""
    if n_new > n_old:
        tops[1] -= n_new - n_old
    for i in range(n_new, n_old):
        room[12][tops[1]] = room[0][i]
        tops[1] += 1
    if kind == OPEN:
        tops[0] -= 1
    elif kind == PILLOW:
        tops[0] -= 4
    for i in range(n_core):
        if count[room[5][i]] == 0:
            room[11][tops[0]] = room[5][i]
            tops[0] += 1
