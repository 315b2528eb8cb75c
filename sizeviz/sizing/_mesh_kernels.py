"""Both envelopes on any triangulation: branch and bound over the tree of bounding boxes."""

import numpy as np
from numba import njit

from sizeviz.sizing._envelope_kernels import (
    BASE,
    LEAST,
    SLOPE_X,
    SLOPE_Y,
    block_may_improve,
    join_bounds,
    on_triangle,
    plane_of,
    start_bounds,
)
from sizeviz.sizing._tree_kernels import FANOUT, uncounted


@njit(nogil=True, cache=True)
def tree_bounds(cells, boxes, children):
    """Return the bounds of every tree node, ``(M, 5)``: the columns of ``_envelope_kernels``.

    ``cells`` is (T, 12) as in ``SizeField.sampler``, ``boxes`` (M, 4) and ``children`` (M, 2) as in ``TriangleTree``.
    """
    n_leaves = (len(cells) + FANOUT - 1) // FANOUT
    bounds = np.empty((len(children), 5))
    for node in range(len(children)):
        first, last = children[node, 0], children[node, 1]
        if node < n_leaves:
            _bound_leaf(bounds, node, cells, boxes, first, last)
        else:
            _bound_inner(bounds, node, boxes, first, last)
    return bounds


@uncounted
def _bound_leaf(bounds, node, cells, boxes, first, last):
    slope_x, slope_y = 0.0, 0.0
    for t in range(first, last):
        gx, gy = _gradient(cells, t)
        slope_x += gx / (last - first)
        slope_y += gy / (last - first)
    start_bounds(bounds, node, slope_x, slope_y)
    x, y = 0.5 * (boxes[node, 0] + boxes[node, 2]), 0.5 * (boxes[node, 1] + boxes[node, 3])
    for t in range(first, last):
        for k in range(3):
            size = cells[t, 6 + k]
            base = size - slope_x * (cells[t, 2 * k] - x) - slope_y * (cells[t, 2 * k + 1] - y)
            bounds[node, BASE] = min(bounds[node, BASE], base)
            bounds[node, LEAST] = min(bounds[node, LEAST], size)


@uncounted
def _gradient(cells, t):
    ax, ay, ha = cells[t, 0], cells[t, 1], cells[t, 6]
    return plane_of(
        cells[t, 2] - ax, cells[t, 3] - ay, cells[t, 7] - ha, cells[t, 4] - ax, cells[t, 5] - ay, cells[t, 8] - ha
    )


@uncounted
def _bound_inner(bounds, node, boxes, first, last):
    slope_x, slope_y = 0.0, 0.0
    for child in range(first, last):
        slope_x += bounds[child, SLOPE_X] / (last - first)
        slope_y += bounds[child, SLOPE_Y] / (last - first)
    start_bounds(bounds, node, slope_x, slope_y)
    x, y = 0.5 * (boxes[node, 0] + boxes[node, 2]), 0.5 * (boxes[node, 1] + boxes[node, 3])
    for child in range(first, last):
        half_x, half_y = 0.5 * (boxes[child, 2] - boxes[child, 0]), 0.5 * (boxes[child, 3] - boxes[child, 1])
        join_bounds(bounds, node, child, boxes[child, 0] + half_x - x, boxes[child, 1] + half_y - y, half_x, half_y)


@njit(nogil=True, cache=True)
def envelope_nodes(kind, coefficient, scale, points, sizes, order, cells, boxes, children, bounds, out, start, stop):
    """Fill the entries ``order[start:stop]`` of ``out`` with ``scale`` times the envelope."""
    stack = np.empty(128, dtype=np.int64)
    tested = np.empty(128)
    found = 0
    for k in range(start, stop):
        i = order[k]
        x, y = points[i, 0], points[i, 1]
        # the last node's triangle is nearly this node's: most boxes are then skipped at once
        best = _on_cell(kind, coefficient, cells, found, x, y, sizes[i])
        best, found = _search(kind, coefficient, cells, boxes, children, bounds, x, y, best, stack, tested, found)
        out[i] = scale * best


@uncounted
def _search(kind, coefficient, cells, boxes, children, bounds, x, y, best, stack, tested, found):
    """Descend into every box that may lower the envelope at (x, y); return it and the triangle that was best."""
    n_leaves = (len(cells) + FANOUT - 1) // FANOUT
    stack[0], tested[0] = len(children) - 1, np.inf
    top = 1
    while top > 0:
        top -= 1
        node = stack[top]
        if best < tested[top] and not _may_improve(kind, coefficient, boxes, bounds, node, x, y, best):
            continue
        if node < n_leaves:
            for t in range(children[node, 0], children[node, 1]):
                lower = _on_cell(kind, coefficient, cells, t, x, y, best)
                if lower < best:
                    best, found = lower, t
            continue
        top = _push_children(kind, coefficient, boxes, children, bounds, node, x, y, best, stack, tested, top)
    return best, found


@uncounted
def _push_children(kind, coefficient, boxes, children, bounds, node, x, y, best, stack, tested, top):
    """Push the children that may improve, the one with the nearest centre last."""
    base = top
    for child in range(children[node, 0], children[node, 1]):
        if not _may_improve(kind, coefficient, boxes, bounds, child, x, y, best):
            continue
        distance2 = _centre_distance2(boxes, child, x, y)
        at = top
        while at > base and _centre_distance2(boxes, stack[at - 1], x, y) < distance2:
            stack[at] = stack[at - 1]
            at -= 1
        stack[at] = child
        tested[top] = best
        top += 1
    return top


@uncounted
def _centre_distance2(boxes, node, x, y):
    dx, dy = 0.5 * (boxes[node, 0] + boxes[node, 2]) - x, 0.5 * (boxes[node, 1] + boxes[node, 3]) - y
    return dx * dx + dy * dy


@uncounted
def _may_improve(kind, coefficient, boxes, bounds, node, x, y, best):
    half_x, half_y = 0.5 * (boxes[node, 2] - boxes[node, 0]), 0.5 * (boxes[node, 3] - boxes[node, 1])
    from_x, from_y = boxes[node, 0] + half_x - x, boxes[node, 1] + half_y - y
    return block_may_improve(kind, coefficient, bounds, node, from_x, from_y, half_x, half_y, best)


@uncounted
def _on_cell(kind, coefficient, cells, t, x, y, best):
    return on_triangle(
        kind, coefficient,
        cells[t, 0] - x, cells[t, 1] - y, cells[t, 6],
        cells[t, 2] - x, cells[t, 3] - y, cells[t, 7],
        cells[t, 4] - x, cells[t, 5] - y, cells[t, 8],
        best,
    )  # fmt: skip
