"""
h* against gradient limiting
============================

The same valley in the plane, meshed with quadrilaterals by both methods and judged against what was asked for.
"""

# %%
# One field, two remedies
# -----------------------
#
# With ε = 1/α both methods let sizes grow alike, so that they are compared like with like.

import matplotlib.pyplot as plt
import numpy as np

import sizeviz

source = sizeviz.load("expr:min(0.12, 0.015 + abs(hypot(x - 0.5, y - 0.5) - 0.3))")
alpha = 2.0
fields = {
    "gradient limiting": sizeviz.limit(source, epsilon=1 / alpha),
    "size preserving": sizeviz.preserve(source, alpha=alpha),
}
limited, preserved = fields.values()
assert (preserved.sizes <= limited.sizes + 1e-12).all() and (limited.sizes <= 2 * preserved.sizes + 1e-12).all()

# %%
# Along a line from the middle outwards: gradient limiting keeps the valley's depth but not its width. Size preserving
# gives it a floor on which elements of the size fit.

across = np.column_stack([np.linspace(0.5, 1.0, 400), np.full(400, 0.5)])
figure, axes = plt.subplots(figsize=(7, 2.8))
axes.plot(across[:, 0], source.reference.at(across), color="#222222", label="h")
for (name, field), color in zip(fields.items(), ("#b8430a", "#1f5fa8"), strict=True):
    axes.plot(across[:, 0], field.at(across), color=color, label=name)
axes.set(xlabel="x at y = 0.5", ylabel="size")
axes.legend(frameon=False)
figure.tight_layout()

# %%
# Meshed and judged
# -----------------

meshes = {name: sizeviz.smooth(source, sizeviz.mesh(source, field), field) for name, field in fields.items()}
reports = {name: sizeviz.report(source, mesh) for name, mesh in meshes.items()}
for name, report in reports.items():
    correct, worst = report.correct_percent["mean-edge"], report.max_ratio["mean-edge"]
    print(f"{name}: {report.n_quads:,} elements, {correct:.2f} % correct, largest R {worst:.2f}")

first, second = reports.values()
assert second.correct_percent["mean-edge"] > max(98.0, first.correct_percent["mean-edge"])
assert second.max_ratio["mean-edge"] < first.max_ratio["mean-edge"]

# %%
# Blue elements keep to the field, orange ones are too large for it; the colour breaks exactly at R = 1.

from matplotlib.collections import PolyCollection

from sizeviz.scene import ratio_scale

scale = ratio_scale(0.4, 2.0)
figure, panels = plt.subplots(1, 2, figsize=(9, 4.6))
for axes, (name, mesh) in zip(panels, meshes.items(), strict=True):
    colors = scale.colors(reports[name].ratios["mean-edge"]) / 255
    corners = list(mesh.points[mesh.quads])
    axes.add_collection(PolyCollection(corners, facecolors=colors, edgecolors="#00000030", lw=0.2))
    axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xticks=[], yticks=[], title=name)
figure.tight_layout()
