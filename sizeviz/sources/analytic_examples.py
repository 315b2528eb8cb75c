"""The two fields that the paper gives as formulas: eq. (1), drawn out over a square, and the ring of section 5.1."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sizeviz.geometry import Domain
from sizeviz.sources.approximation import approximated
from sizeviz.sources.formula import Formula
from sizeviz.sources.source import Source

if TYPE_CHECKING:
    from numpy.typing import NDArray

RING = Formula("min(0.25, abs(hypot(x - 0.5, y - 0.5) - 0.2575) + 0.00025)")
"""Section 5.1 of the paper."""

VALLEY = Formula("min(0.5, 0.1 + 3 * abs(x - 0.75))")
"""Equation (1) of the paper, constant in y."""

RADIUS, LEAST = 0.2575, 0.00025


def ring() -> Source:
    """Return the ring of section 5.1: sizes from 0.00025 on a circle to 0.25, over the unit square."""
    domain = Domain.unit_square()
    size = approximated(RING, domain, "ring", seeds=_circles())
    return Source(
        name="ring",
        label="Ring (section 5.1): a circular valley a thousand times finer than its surroundings",
        domain=domain,
        field=size.field,
        reference=size,
        provenance={"kind": "example", "formula": RING.text, "error": size.error},
    )


def valley() -> Source:
    """Return eq. (1) over the unit square: sizes from 0.1 along a line to 0.5."""
    domain = Domain.unit_square()
    size = approximated(VALLEY, domain, "valley")
    return Source(
        name="valley",
        label="Valley (equation (1)): the paper's one-dimensional example, drawn out over a square",
        domain=domain,
        field=size.field,
        reference=size,
        provenance={"kind": "example", "formula": VALLEY.text, "error": size.error},
    )


def _circles() -> NDArray[np.float64]:
    """Return nodes on circles about the centre, one size apart on each, half a size from one to the next."""
    # the sizes preserved with alpha = 2 bend at twice the least size: without nodes there their count is 3 % too low
    offsets = [0.0, 0.5 * LEAST, 1.2 * LEAST, 2.0 * LEAST]
    while offsets[-1] < 0.5:
        offsets.append(offsets[-1] + min(0.02, 0.5 * (LEAST + offsets[-1])))
    nodes = []
    for k, offset in enumerate(offsets):
        size = LEAST + offset
        along = 1.2 * size if offset > 2.0 * LEAST else min(1.2 * size, 1.4 * LEAST)  # edges must not cross the bend
        for radius in {RADIUS + offset, RADIUS - offset}:
            if radius <= 0.5 * size:
                continue
            # the chord of a circle leaves it by length^2 / 8 radius: 0.5 % of the size
            spacing = min(along, np.sqrt(0.04 * radius * size))
            count = max(6, int(np.ceil(2.0 * np.pi * radius / spacing)))
            angle = 2.0 * np.pi * (np.arange(count) + 0.5 * (k % 2)) / count
            nodes.append(np.column_stack([0.5 + radius * np.cos(angle), 0.5 + radius * np.sin(angle)]))
    return np.vstack(nodes)
