"""Sweeps over blocks of nodes, and the targets they aim at."""

from __future__ import annotations

import math

import numpy as np

from sizeviz.improvement._jit import allocating, compiled
from sizeviz.improvement._star_kernels import star_size
from sizeviz.improvement._step_kernels import STIRRED, node_step, wake
from sizeviz.sizing._kernels import size_at


@allocating
def sweep_blocks(first, last, blocks, size, patch, inv, bound, law, rails, awake, gain):
    """Move the nodes of blocks[first:last] that are awake once, in order; ``gain[b]`` gets the objective's decrease.

    A node that has moved falls asleep until it or a neighbour moves by more than a little.
    """
    star = np.empty(star_size(patch[2].shape[1]))
    for i in range(first, last):
        b = blocks[i]
        total = 0.0
        for v in range(b * size, min((b + 1) * size, len(patch[3]))):
            if awake[v]:
                awake[v] = False
                step = node_step(v, patch, inv, bound, law, rails, star)
                if step > STIRRED:
                    wake(v, patch, awake)
                total += step
        gain[b] = total


@allocating
def sweep_nodes(nodes, patch, inv, bound, law, rails):
    """Move the nodes of a list once, in order; return the objective's decrease."""
    star = np.empty(star_size(patch[2].shape[1]))
    total = 0.0
    for i in range(len(nodes)):
        total += node_step(nodes[i], patch, inv, bound, law, rails, star)
    return total


@compiled
def centre_sizes(first, last, xy, quads, sampler, hint, sizes):
    """Write the field's size at the centre of each element of a range; dead elements keep theirs."""
    guess = hint[first]
    for q in range(first, last):
        if quads[q, 0] < 0:
            continue
        x = y = 0.0
        for k in range(4):
            x += 0.25 * xy[quads[q, k], 0]
            y += 0.25 * xy[quads[q, k], 1]
        if hint[q] >= 0:
            guess = hint[q]
        sizes[q], guess = size_at(sampler, x, y, guess)
        hint[q] = guess


@compiled
def element_area(q, xy, quads):
    """Return the signed area of an element."""
    a, b, c, d = quads[q, 0], quads[q, 1], quads[q, 2], quads[q, 3]
    return 0.5 * ((xy[c, 0] - xy[a, 0]) * (xy[d, 1] - xy[b, 1]) - (xy[c, 1] - xy[a, 1]) * (xy[d, 0] - xy[b, 0]))


@compiled
def scale_targets(xy, quads, sizes, inv):
    """Write 1 / (c size)^2 of each element and return the target scale c = sqrt(sum A_e / size_e^2 / elements)."""
    total, alive = 0.0, 0
    for q in range(len(quads)):
        if quads[q, 0] >= 0:
            total += element_area(q, xy, quads) / (sizes[q] * sizes[q])
            alive += 1
    c2 = total / max(alive, 1)
    if not c2 > 0.0:
        c2 = 1.0
    for q in range(len(quads)):
        if quads[q, 0] >= 0:
            inv[q] = 1.0 / (c2 * sizes[q] * sizes[q])
    return math.sqrt(c2)
