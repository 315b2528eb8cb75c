"""
Sizes on a line
===============

What a size field is, why a mesh misses it, and two remedies, on an interval (section 2 of the paper). In the window
this is *Learn → Lesson: sizes on a line*, where the field can be dragged with the mouse.
"""

# %%
# A wish for every place
# ----------------------
#
# A size field :math:`h(x)` says how long an element may be at :math:`x`. The paper's example, eq. (1), allows 0.5
# nearly everywhere but only 0.1 at :math:`x = 0.75`:
#
# .. math:: h(x) = \min(0.5,\; 0.1 + 3\,|x - 0.75|).

import matplotlib.pyplot as plt
import numpy as np

from sizeviz.sizing.line import LimitedLine, PreservedLine, advanced, paper_valley, ratios_on_line

h = paper_valley()
x = np.linspace(0, 1, 801)
figure, axes = plt.subplots(figsize=(7, 2.6))
axes.plot(x, h.at(x), color="#222222")
axes.set(xlabel="x", ylabel="size", ylim=(0, 0.6), title="h: how long may an element be?")
figure.tight_layout()

# %%
# A mesh that misses it
# ---------------------
#
# An advancing front starts at 0, asks for the size there, and places its next node that far away. It looks only where
# it stands. An element is judged by R, its length over the *smallest* size within it, eq. (3):
#
# .. math:: R(e) = \frac{\mu(e)}{\beta\,\min_{x \in e} h(x)} \le 1.

nodes = advanced(h, 0.0, 1.0)
print("nodes", nodes, " R", ratios_on_line(h, nodes))
assert ratios_on_line(h, nodes).max() == 5.0

# %%
# The second element is five times as long as its smallest size allows: the front stood at 0.5, where h is still 0.5.
#
# Limit the slope, or keep room
# -----------------------------
#
# *Gradient limiting* lowers h until it grows nowhere faster than ε. *Size preserving* looks before it steps: h* is
# the largest size such that nothing smaller is asked for within α elements of that size.

fields = {
    "as given": h,
    "gradient limiting, ε = 1": LimitedLine(h, 1.0),
    "size preserving, α = 1": PreservedLine(h, 1.0),
}
colors = ("#222222", "#b8430a", "#1f5fa8")
figure, (top, bottom) = plt.subplots(2, 1, figsize=(7, 5), sharex=True)
for (name, field), color in zip(fields.items(), colors, strict=True):
    nodes = advanced(field, 0.0, 1.0)
    ratios = ratios_on_line(h, nodes)
    top.plot(x, field.at(x), color=color, label=name)
    bottom.stairs(ratios, nodes, baseline=None, color=color, lw=2)
    print(f"{name}: {len(ratios)} elements, largest R {ratios.max():.2f}")
top.legend(frameon=False)
top.set(ylabel="size")
bottom.axhline(1.0, color="#8a8a8a", lw=0.8)
bottom.set(xlabel="x", ylabel="R(e)")
figure.tight_layout()

assert ratios.max() <= 1 + 1e-9  # the last of them, size preserving

# %%
# Why it always works
# -------------------
#
# An element as long as h* at its end lies within the distance that was looked at, if :math:`\alpha \ge \beta`. So no
# smaller size can hide in it, whatever h is. Two hundred random fields:

from sizeviz.sizing.line import LineField

rng = np.random.default_rng(1)
worst = 0.0
for _ in range(200):
    places = np.concatenate([[0.0], np.sort(rng.random(6)), [1.0]])
    anything = LineField(places, rng.uniform(0.03, 0.6, 8))
    nodes = advanced(PreservedLine(anything, 1.0), 0.0, 1.0, stretch_last=False)
    worst = max(worst, ratios_on_line(anything, nodes).max())
print("largest R of all", worst)
assert worst <= 1 + 1e-9
