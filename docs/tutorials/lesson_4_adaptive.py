"""
The adaptive process
====================

Often sizes are known only where a mesh already has nodes. Algorithm 3 meshes again and again, each mesh the background
of the next. In the window: *Learn → Lesson: the adaptive process*; on the command line: ``sizeviz adapt``.
"""

# %%
# A process, kept on disk
# -----------------------
#
# The process begins with equal elements. Each iteration writes its mesh and a row of ``evolution.json``, so that it
# can be stopped, taken up again, and opened in the window.

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import sizeviz
from sizeviz.study.adaptive import AdaptOptions

source = sizeviz.load("expr:min(0.2, 0.02 + abs(hypot(x - 0.5, y - 0.5) - 0.3))")
folder = Path(tempfile.mkdtemp())
evolution = sizeviz.adapt(source, folder, options=AdaptOptions(cells=10, iterations=6))
for row in evolution.iterations:
    print(f"iteration {row.number}: {row.n_quads:,} elements, largest R {row.analytic_ratio:.2f}")
assert evolution.converged and evolution.iterations[0].analytic_ratio > 2

# %%
# Judged twice
# ------------
#
# Against the sizes on the background it was made from, every mesh keeps what it was asked: that is size preserving.
# Against the field itself the first meshes cannot, for their background had not seen the valley yet. When both agree,
# the process is done.

figure, axes = plt.subplots(figsize=(7, 3))
numbers = [row.number for row in evolution.iterations]
against_field = [row.analytic_ratio for row in evolution.iterations]
against_background = [row.background_ratio for row in evolution.iterations[1:]]
axes.semilogy(numbers, against_field, "o-", color="#b8430a", label="against the field")
axes.semilogy(numbers[1:], against_background, "^-", color="#1f5fa8", label="against its background")
axes.axhline(evolution.limit, color="#8a8a8a", lw=0.8, ls="--")
axes.set(xlabel="iteration", ylabel="largest R", xticks=numbers)
axes.legend(frameon=False)
figure.tight_layout()

# %%
# The same folder, asked for again, is not begun anew:

again = sizeviz.adapt(source, folder, options=AdaptOptions(cells=10, iterations=6))
assert again == evolution
print(sorted(path.name for path in folder.iterdir()))
