"""Figures 1 to 3: sizes on a line, the nodes they give, and R of the elements between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.scene.figures.sheet import COLORS, FAINT, INK, WORDS, save, sheet, title

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from sizeviz.study.paper import LineExample

STYLES: dict[str, str] = {"none": "-", "gradient-limiting": "--", "size-preserving": ":"}
"""Line styles of R(e), those of the paper."""


def save_line_figures(example: LineExample, folder: Path) -> None:
    """Write Figures 1, 2 and 3."""
    figure, panels = sheet((1, 3), (3.2, 2.8))
    _nodes(panels[0], example, "none", "(a) original size, and its nodes")
    _nodes(panels[1], example, "gradient-limiting", f"(b) gradient limiting, ε = {example.epsilon:g}")
    _ratios(panels[2], example, ("none", "gradient-limiting"), "(c) R(e)")
    save(figure, folder, "figure-1")
    figure, panels = sheet((1, 2), (4.2, 3.0))
    _ball(panels[0], example, "(a) the element at x spans x ± h*(x)")
    _alphas(panels[1], example, "(b) h* for α = 0.25 to 4, from right to left")
    save(figure, folder, "figure-2")
    figure, panels = sheet((1, 2), (4.2, 3.0))
    _nodes(panels[0], example, "size-preserving", f"(a) size preserving, α = {example.alpha:g}, and its nodes")
    _ratios(panels[1], example, tuple(STYLES), "(b) R(e)")
    save(figure, folder, "figure-3")


def _sizes(axes: Any, example: LineExample) -> None:
    axes.plot(example.x, example.sizes["none"], color=INK, lw=1.8, label="h")
    axes.set(xlim=(0.0, 1.0), ylim=(-0.06, 0.68))
    axes.set_xlabel("x", fontsize=8)
    axes.set_ylabel("size", fontsize=8)


def _nodes(axes: Any, example: LineExample, method: str, words: str) -> None:
    """Draw h, what a method makes of it, and the nodes of the advancing front on the axis."""
    title(axes, words)
    _sizes(axes, example)
    if method != "none":
        label = "h*" if method == "size-preserving" else "limited"
        axes.plot(example.x, example.sizes[method], color=COLORS[method], lw=1.4, label=label)
        axes.legend(fontsize=7, frameon=False, loc="upper left")
    nodes = example.nodes[method]
    axes.axhline(0.0, color=FAINT, lw=0.8)
    axes.plot(nodes, np.zeros(len(nodes)), "o", ms=4, color=COLORS[method], clip_on=False, zorder=3)
    axes.annotate(f"{len(nodes) - 1} elements", (0.02, 0.0), xytext=(2, 5), textcoords="offset points", fontsize=7)


def _ratios(axes: Any, example: LineExample, methods: Sequence[str], words: str) -> None:
    """Draw R of each element as a step."""
    title(axes, words)
    for method in methods:
        axes.stairs(
            example.ratios[method], example.nodes[method], baseline=None, color=COLORS[method],
            ls=STYLES[method], lw=1.8, label=WORDS[method],
        )  # fmt: skip
    axes.axhline(1.0, color=FAINT, lw=0.8)
    top = max(float(example.ratios[method].max()) for method in methods)
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.15 * top))
    axes.set_xlabel("x", fontsize=8)
    axes.set_ylabel("R(e)", fontsize=8)
    axes.legend(fontsize=7, frameon=False)


def _ball(axes: Any, example: LineExample, words: str) -> None:
    """Draw, at one place, the interval in which h may nowhere be smaller than h* there."""
    title(axes, words)
    _sizes(axes, example)
    preserved = example.sizes["size-preserving"]
    axes.plot(example.x, preserved, color=COLORS["size-preserving"], lw=1.4, label="h*")
    at = 0.55
    size = float(np.interp(at, example.x, preserved))
    reach = example.alpha * size
    axes.fill_between([at - reach, at + reach], 0.0, size, color=COLORS["size-preserving"], alpha=0.15, lw=0)
    axes.annotate("", (at - reach, 0.03), (at + reach, 0.03), arrowprops={"arrowstyle": "<->", "lw": 0.8})
    for place, label in ((at, "x"), (at - reach, "x − αh*"), (at + reach, "x + αh*")):
        axes.plot([place, place], [0.0, size], color=FAINT, lw=0.6, ls=":")
        axes.annotate(label, (place, 0.0), xytext=(0, -9), textcoords="offset points", ha="center", fontsize=7)
    axes.legend(fontsize=7, frameon=False, loc="upper left")


def _alphas(axes: Any, example: LineExample, words: str) -> None:
    title(axes, words)
    _sizes(axes, example)
    for k, (alpha, sizes) in enumerate(sorted(example.by_alpha.items())):
        grey = str(0.6 - 0.5 * k / max(len(example.by_alpha) - 1, 1))
        axes.plot(example.x, sizes, color=grey, lw=1.2)
        # one above the other, each beside its own curve
        level = min(0.42 - 0.07 * k, float(sizes[0]))
        at = int(np.argmax(sizes <= level))
        place = (float(example.x[at]), float(sizes[at]))
        axes.annotate(
            f"{alpha:g}", place, xytext=(-3, -2) if at else (3, 4), textcoords="offset points", fontsize=7,
            color=grey, ha="right" if at else "left", va="top" if at else "bottom",
        )  # fmt: skip
