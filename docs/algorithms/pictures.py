"""Draw the pictures of these pages: ``python docs/algorithms/pictures.py``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.scene.figures.sheet import COLORS, FAINT, INK, sheet, title
from sizeviz.sizing import BackgroundMesh, PreserveOptions, SizeField, preserved

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FOLDER = Path(__file__).parent / "pictures"
BLUE, ORANGE = COLORS["size-preserving"], COLORS["gradient-limiting"]


def line_18() -> None:
    """Draw the radius after one node by its distance, and h* along a line through a valley."""
    figure, (left, right) = sheet((1, 2), (3.6, 3.0))
    title(left, "radius after a node with r' = 0.3 r")
    inside = np.linspace(0.3, 1.0, 50)
    left.plot([0, 0.3], [0.3, 0.3], color=INK, lw=1.5)
    left.plot([1, 1.3], [1, 1], color=INK, lw=1.5)
    left.plot(inside, 1.3 - inside, color=ORANGE, lw=1.5, ls="--", label="line 18 as printed: r + r' − d")
    left.plot(inside, inside, color=BLUE, lw=1.5, label="weights exchanged: d")
    left.set(xlim=(0, 1.3), ylim=(0, 1.5))
    left.set_xlabel("distance d / r", fontsize=8)
    left.set_ylabel("new r / r", fontsize=8)
    left.legend(fontsize=7, frameon=False)
    title(right, "h* along a grid line, α = 2")
    n = 65
    background = BackgroundMesh.unit_square_grid(n, n)
    sizes = np.full((n, n), 0.4)
    sizes[20, 15], sizes[40, 30], sizes[30, 48] = 0.01, 0.05, 0.02
    h = SizeField(background, sizes.ravel())
    x, row = background.points[:, 0], slice(26 * n, 27 * n)
    right.plot(x[row], h.sizes[row], color=FAINT, lw=1.0, label="h: three small sizes nearby")
    for distance, color, style, label in (
        ("edges-as-printed", ORANGE, "--", "along edges, as printed"),
        ("edges", BLUE, "-", "along edges, r ← d"),
        ("euclidean", INK, ":", "exact"),
    ):
        sizes = preserved(h, PreserveOptions(alpha=2.0, distance=distance)).sizes
        right.plot(x[row], sizes[row], color=color, lw=1.4, ls=style, label=label)
    right.set(xlim=(0, 1), ylim=(0, 0.62))
    right.set_xlabel("x", fontsize=8)
    right.legend(fontsize=7, frameon=False)
    _save(figure, "line-18")


def edges() -> None:
    """Draw the ratio of h* by edges to the exact one around one small size."""
    n = 81
    background = BackgroundMesh.unit_square_grid(n, n)
    sizes = np.full(n * n, 0.3)
    sizes[n // 2 * n + n // 2] = 0.005
    h = SizeField(background, sizes)
    exact = preserved(h, PreserveOptions(alpha=2.0)).sizes
    along = preserved(h, PreserveOptions(alpha=2.0, distance="edges")).sizes
    figure, (axes,) = sheet((1, 1), (4.2, 3.6))
    title(axes, "h* along edges / exact h*")
    image = axes.imshow(
        (along / exact).reshape(n, n), origin="lower", extent=(0, 1, 0, 1), cmap="cividis", vmin=1, vmax=2**0.5
    )
    bar = figure.colorbar(image, ax=axes)
    bar.set_ticks([1.0, 1.1, 1.2, 1.3, 2**0.5], labels=["1", "1.1", "1.2", "1.3", "√2"])
    _save(figure, "edges")


def beta() -> None:
    """Draw eq. (5) and Algorithm 1 in one dimension, with beta 1/2."""
    x = np.linspace(0, 1, 1001)
    h = np.minimum(0.5, 0.1 + 3 * np.abs(x - 0.75))
    apart = np.abs(x[:, None] - x)
    figure, (axes,) = sheet((1, 1), (4.6, 3.0))
    title(axes, "h of eq. (1), α = 1, β = 1/2")
    axes.plot(x, 0.5 * h, color=FAINT, lw=1.0, label="βh")
    axes.plot(
        x, np.maximum(0.5 * h, apart).min(axis=1), color=ORANGE, lw=1.4, ls="--", label="eq. (5): slope up to 1/α"
    )
    axes.plot(x, 0.5 * np.maximum(h, apart).min(axis=1), color=BLUE, lw=1.4, label="Algorithm 1: slope ≤ β/α")
    axes.set(xlim=(0, 1), ylim=(0, 0.3))
    axes.set_xlabel("x", fontsize=8)
    axes.legend(fontsize=7, frameon=False)
    _save(figure, "beta")


def _save(figure: Figure, name: str, folder: Path = FOLDER) -> None:
    from matplotlib import rc_context

    with rc_context({"svg.fonttype": "none", "svg.hashsalt": name}):
        figure.savefig(folder / f"{name}.svg", metadata={"Date": None})


if __name__ == "__main__":
    line_18()
    edges()
    beta()
