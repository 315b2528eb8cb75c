"""
The shrinking ball
==================

How Algorithm 1 finds h* at one place, step by step. In the window: right-click a place of a pane, and ask why h* is
what it is there.
"""

# %%
# The ball
# --------
#
# Suppose the element at :math:`x` is as large as the size there. Then nothing smaller may lie within :math:`r =
# \alpha\,h(x)`. Look at the nodes around, the nearest first; where one asks for less, the ball shrinks, until
#
# .. math:: r = \alpha \min \{ h(y) : |x - y| \le r \}, \qquad h^* = \beta\,r/\alpha \qquad (6).

import matplotlib.pyplot as plt
import numpy as np

from sizeviz.sizing import BackgroundMesh, PreserveOptions, SizeField, preserved
from sizeviz.sizing.ball import ball_at

background = BackgroundMesh.unit_square_grid(41, 41)
valley = np.abs(np.hypot(*(background.points - 0.5).T) - 0.3)
h = SizeField(background, np.minimum(0.25, 0.02 + 2 * valley), "ring")

node = 20 * 41 + 15  # left of the middle
trace = ball_at(h, node, PreserveOptions(alpha=1.0))
for step in trace.steps:
    if step.after < step.before:
        print(f"case ({step.case}): d = {step.distance:.4f}, r' = {step.allowed:.4f}: r = {step.after:.4f}")
print("h* =", trace.size)

# %%
# Each line is a node that made the ball smaller. In case (i) the ball that the node's own size allows still reaches
# it; in case (ii) it does not, and the ball ends with the node on its rim.

figure, axes = plt.subplots(figsize=(5.4, 4.6))
picture = axes.imshow(h.sizes.reshape(41, 41), origin="lower", extent=(0, 1, 0, 1), cmap="GnBu_r")
figure.colorbar(picture, label="h")
seen = background.points[[step.node for step in trace.steps]]
axes.plot(*seen.T, ".", color="#444444", ms=2, label="looked at")
for radius, style in ((trace.start, ":"), (trace.radius, "-")):
    axes.add_patch(plt.Circle(trace.centre, radius, fill=False, ls=style, lw=1.6, color="#1f5fa8"))
axes.plot(*trace.blocking, "D", color="#b8430a", label="blocks")
axes.legend(frameon=True)
axes.set(xlim=(0, 1), ylim=(0, 1), title=f"α = 1: h* = {trace.size:.3f} at (0.375, 0.5)")
figure.tight_layout()

# %%
# Along edges, and straight
# -------------------------
#
# Algorithm 2 measures distances along the edges of the background, and Algorithm 1 looks at nodes only. A path along
# edges is longer than a straight line, so the answer can be too large. sizeviz goes straight, and looks between
# nodes, unless told otherwise:
#
# .. math:: h^*(x) = \beta \min_y \max\bigl( h(y),\; |x - y| / \alpha \bigr).

exact = preserved(h, PreserveOptions(alpha=1.0)).sizes
along = preserved(h, PreserveOptions(alpha=1.0, distance="edges")).sizes
print("along edges / exact: from", (along / exact).min(), "to", (along / exact).max())
assert np.isclose(trace.size, along[node]) and np.isclose(trace.exact_size, exact[node])
assert (along >= exact * (1 - 1e-12)).all()

# %%
# The slope bound follows at once: for a fixed y, the maximum above has slope at most 1/α, and so has the least of
# such.

slopes = [np.abs(np.diff(exact.reshape(41, 41), axis=axis)).max() * 40 for axis in (0, 1)]
print("steepest change of h*", max(slopes))
assert max(slopes) <= 1.0 + 1e-9
