"""Distances along background edges: Algorithms 1 and 2 of the paper, and limiting by Dijkstra's algorithm."""

import numpy as np
from numba import njit

from sizeviz.sizing._tree_kernels import uncounted


@uncounted
def heap_push(keys, nodes, count, key, node):
    """Insert into a binary min-heap held in two arrays; return the new count."""
    at = count
    while at > 0:
        above = (at - 1) // 2
        if keys[above] <= key:
            break
        keys[at], nodes[at] = keys[above], nodes[above]
        at = above
    keys[at], nodes[at] = key, node
    return count + 1


@uncounted
def heap_drop(keys, nodes, count):
    """Remove the least entry, which the caller has read from row 0; return the new count."""
    count -= 1
    key, node = keys[count], nodes[count]
    at = 0
    while 2 * at + 1 < count:
        below = 2 * at + 1
        if below + 1 < count and keys[below + 1] < keys[below]:
            below += 1
        if key <= keys[below]:
            break
        keys[at], nodes[at] = keys[below], nodes[below]
        at = below
    keys[at], nodes[at] = key, node
    return count


@uncounted
def settle(start, ends, lengths, epsilon, labels, keys, nodes, count, most):
    """Take up to ``most`` entries off Dijkstra's heap, relaxing labels by epsilon times length; return the count left.

    The edges of node i are ``start[i]`` to ``start[i + 1]``, leading to ``ends`` over ``lengths``. An entry that its
    node has bettered meanwhile is passed over.
    """
    for _ in range(most):
        if count == 0:
            break
        key, node = keys[0], nodes[0]
        count = heap_drop(keys, nodes, count)
        if key > labels[node]:
            continue
        for e in range(start[node], start[node + 1]):
            through = key + epsilon * lengths[e]
            if through < labels[ends[e]]:
                labels[ends[e]] = through
                count = heap_push(keys, nodes, count, through, ends[e])
    return count


@njit(nogil=True, cache=True)
def shrink_balls(start, ends, lengths, sizes, alpha, beta, printed, out, first, last):
    """Run Algorithm 1 at nodes ``first`` to ``last``."""
    distance = np.full(len(sizes), np.inf)
    reached = np.empty(len(sizes), dtype=np.int64)
    keys = np.empty(len(ends) + 1)
    nodes = np.empty(len(ends) + 1, dtype=np.int64)
    for node in range(first, last):
        radius = _shrink_ball(start, ends, lengths, sizes, alpha, printed, node, distance, reached, keys, nodes)
        out[node] = beta * radius / alpha


@uncounted
def _shrink_ball(start, ends, lengths, sizes, alpha, printed, origin, distance, reached, keys, nodes):
    """Return the ball's final radius at one node; leave ``distance`` infinite again."""
    distance[origin] = 0.0
    reached[0], n_reached = origin, 1
    count = heap_push(keys, nodes, 0, 0.0, origin)
    radius = alpha * sizes[origin]
    while count > 0:
        d, node = keys[0], nodes[0]
        count = heap_drop(keys, nodes, count)
        if d > distance[node]:
            continue
        radius, inside = next_radius(radius, alpha * sizes[node], d, printed)
        if not inside:
            continue
        for e in range(start[node], start[node + 1]):
            through, other = d + lengths[e], ends[e]
            if through < distance[other] and through < radius:
                if distance[other] == np.inf:
                    reached[n_reached] = other
                    n_reached += 1
                distance[other] = through
                count = heap_push(keys, nodes, count, through, other)
    for k in range(n_reached):
        distance[reached[k]] = np.inf
    return radius


@uncounted
def next_radius(radius, own, d, printed):
    """Return the ball's radius after a node, and whether the search goes on from there (lines 13 to 22).

    ``own`` is the radius that the node's size allows, ``d`` its distance. As printed, line 18 exchanges its two
    weights; mended it is the only radius for which the node lies on the ball's rim.
    """
    if own < radius:
        if d <= own:
            return own, True
        if d <= radius:
            if printed:
                return radius * (radius - d) / (radius - own) + own * (d - own) / (radius - own), False
            return d, False
        return radius, False
    return radius, d <= radius
