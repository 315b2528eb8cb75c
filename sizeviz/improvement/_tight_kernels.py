"""Least nodal sizes within a distance of each node of a grid, from minima over squares of 2^k nodes; slopes, counts."""

from __future__ import annotations

import math

from sizeviz.improvement._jit import compiled


@compiled
def double_windows(minima, width):
    """Turn minima over squares of ``width`` nodes, named by their first, into those of twice the width."""
    rows, columns = minima.shape
    for i in range(rows):
        for j in range(columns):
            right = min(j + width, columns - 1)
            minima[i, j] = min(minima[i, j], minima[i, right])
    for i in range(rows):
        above = min(i + width, rows - 1)
        for j in range(columns):
            minima[i, j] = min(minima[i, j], minima[above, j])


@compiled
def window(minima, width, i, j):
    """Return the least size over the square of nodes from (i, j) on, as far as it lies on the grid."""
    rows, columns = minima.shape
    first, left = max(min(i, rows - 1), 0), max(min(j, columns - 1), 0)
    return minima[first, left]


@compiled
def ball_minima(width, minima, reach, least):
    """Lower ``least`` at the nodes whose ``reach``, in cells, is ``width`` or more and below twice that.

    Twelve squares fill the circle: four in the middle, four that touch it on the diagonals, four on the axes.
    """
    rows, columns = minima.shape
    for i in range(rows):
        for j in range(columns):
            r = reach[i, j]
            if r < width or r >= 2 * width:
                continue
            best = least[i, j]
            near, middle, far = math.floor(0.42 * r), math.floor(0.707 * r), math.floor(0.92 * r)
            half = width // 2
            for up in (-1, 1):
                low_near = i - near if up < 0 else i + near - width + 1
                low_middle = i - middle if up < 0 else i + middle - width + 1
                low_far = i - far if up < 0 else i + far - width + 1
                best = min(best, window(minima, width, low_far, j - half))
                left_far = j - far if up < 0 else j + far - width + 1
                best = min(best, window(minima, width, i - half, left_far))
                for side in (-1, 1):
                    left_near = j - near if side < 0 else j + near - width + 1
                    left_middle = j - middle if side < 0 else j + middle - width + 1
                    best = min(best, window(minima, width, low_near, left_near))
                    best = min(best, window(minima, width, low_middle, left_middle))
            least[i, j] = best


@compiled
def slopes(points, triangles, sizes, out):
    """Write the slope of a piecewise-linear field on each triangle."""
    for t in range(len(triangles)):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
        bx, by = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1]
        a, b = sizes[j] - sizes[i], sizes[k] - sizes[i]
        out[t] = math.hypot(a * by - b * ay, b * ax - a * bx) / abs(ax * by - ay * bx)


@compiled
def asked(points, triangles, sizes, out):
    """Write about how many elements each triangle of a piecewise-linear field asks for."""
    for t in range(len(triangles)):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
        bx, by = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1]
        mean = (sizes[i] + sizes[j] + sizes[k]) / 3.0
        out[t] = 0.5 * abs(ax * by - ay * bx) / (mean * mean)
