"""R by the longest edge and shape quality of elements, with the exact least size over each."""

from __future__ import annotations

import math

from sizeviz.improvement._jit import compiled
from sizeviz.improvement._worst_kernels import quad_quality
from sizeviz.sizing._minimum_kernels import quad_min


@compiled
def longest_squared(q, xy, quads):
    """Return the square of an element's longest edge."""
    longest = 0.0
    for k in range(4):
        a, b = quads[q, k], quads[q, (k + 1) & 3]
        longest = max(longest, (xy[a, 0] - xy[b, 0]) ** 2 + (xy[a, 1] - xy[b, 1]) ** 2)
    return longest


@compiled
def look(first, last, rows, xy, quads, searcher, share, seen, least, ratio, quality):
    """Judge the elements rows[first:last] that are not where they were when they were judged last, ``seen``.

    ``share`` times the field's least size over an element is what its longest edge is measured against.
    """
    for i in range(first, last):
        q = rows[i]
        a, b, c, d = quads[q, 0], quads[q, 1], quads[q, 2], quads[q, 3]
        moved = False
        for k in range(4):
            v = quads[q, k]
            if seen[q, k, 0] != xy[v, 0] or seen[q, k, 1] != xy[v, 1]:
                moved = True
                seen[q, k, 0], seen[q, k, 1] = xy[v, 0], xy[v, 1]
        if not moved:
            continue
        least[q] = share[q] * quad_min(
            searcher, xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], xy[d, 0], xy[d, 1]
        )  # fmt: skip
        ratio[q] = math.sqrt(longest_squared(q, xy, quads)) / least[q]
        quality[q] = quad_quality(q, xy, quads)
