"""The verdict on a mesh: R(e) for every element, and the rows of Tables 1 and 2."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from sizeviz.conformity.measures import MEASURES, Measure, all_element_sizes, irregular_fraction, shape_quality
from sizeviz.errors import InputError
from sizeviz.geometry.arrays import read_only
from sizeviz.monitor import SILENT, Monitor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from sizeviz.geometry import QuadMesh
    from sizeviz.sizing.analytic import SizeFunction

TOLERANCE = 1e-9
"""How far above 1 a ratio may lie by rounding and still count as correct."""


@dataclass(frozen=True, eq=False)
class MeshReport:
    """How well a mesh reproduces prescribed sizes, and how well its elements are shaped.

    R(e) = mu(e) / (beta min over e of h), eq. (3) of Ruiz-Gironés, Roca, Sarrate, 22nd International Meshing
    Roundtable, 2013, DOI 10.1007/978-3-319-02335-9; the minimum is over the whole element.

    Parameters
    ----------
    least : (Q,) float64
        Least prescribed size over each element, in model units.
    sizes : mapping of measure to (Q,) float64
        Size of each element by each measure, in model units.
    quality : (Q,) float64
        Shape quality, 0 to 1.
    n_nodes : int
        Number of nodes.
    irregular : float
        Share of interior nodes without four elements.
    beta : float
        Scale of the prescribed size.
    ideal_quads : float or None
        The count of elements that the field asks for, if it was given.
    """

    least: NDArray[np.float64]
    sizes: Mapping[Measure, NDArray[np.float64]]
    quality: NDArray[np.float64]
    n_nodes: int
    irregular: float
    beta: float = 1.0
    ideal_quads: float | None = None

    @property
    def n_quads(self) -> int:
        """Number of elements."""
        return len(self.least)

    @property
    def n_inverted(self) -> int:
        """Number of elements with a flat or inverted corner."""
        return int(np.count_nonzero(self.quality <= 0.0))

    @cached_property
    def ratios(self) -> dict[Measure, NDArray[np.float64]]:
        """R(e) of each element by each measure, ``(Q,)``."""
        return {measure: read_only(size / (self.beta * self.least)) for measure, size in self.sizes.items()}

    def ratio(self, measure: Measure = "mean-edge") -> NDArray[np.float64]:
        """Return R(e) of each element by one measure, ``(Q,)``.

        Raises
        ------
        InputError
            If the measure is unknown.
        """
        if measure not in self.ratios:
            raise InputError(f"measure {measure!r} is unknown; choose one of {', '.join(MEASURES)}")
        return self.ratios[measure]

    def correct(self, measure: Measure = "mean-edge") -> NDArray[np.bool_]:
        """Return whether each element is correct, R(e) <= 1 up to rounding, ``(Q,)``."""
        return self.ratio(measure) <= 1.0 + TOLERANCE

    @cached_property
    def correct_count(self) -> dict[Measure, int]:
        """Number of correct elements by each measure."""
        return {measure: int(np.count_nonzero(self.correct(measure))) for measure in self.ratios}

    @property
    def correct_percent(self) -> dict[Measure, float]:
        """Share of correct elements by each measure, in percent; 100 only where all are."""
        return {measure: 100.0 * count / max(self.n_quads, 1) for measure, count in self.correct_count.items()}

    @cached_property
    def max_ratio(self) -> dict[Measure, float]:
        """Largest R(e) by each measure."""
        return {measure: float(ratio.max(initial=0.0)) for measure, ratio in self.ratios.items()}

    @property
    def irregular_percent(self) -> float:
        """Share of interior nodes without four elements, in percent."""
        return 100.0 * self.irregular

    @property
    def efficiency(self) -> float | None:
        """Elements for each one that the field asks for."""
        return None if self.ideal_quads is None else self.n_quads / self.ideal_quads

    @cached_property
    def quality_summary(self) -> dict[str, float]:
        """Least, greatest and mean quality, and its standard deviation: ``min``, ``max``, ``mean``, ``std``."""
        if not self.n_quads:
            return dict.fromkeys(("min", "max", "mean", "std"), math.nan)
        quality = self.quality
        return {
            "min": float(quality.min()),
            "max": float(quality.max()),
            "mean": float(quality.mean()),
            "std": float(quality.std()),
        }

    def worst(
        self, n: int = 10, by: Literal["ratio", "quality"] = "ratio", measure: Measure = "mean-edge"
    ) -> NDArray[np.int64]:
        """Return the worst elements, worst first: of greatest R(e), or of least quality.

        Parameters
        ----------
        n : int
            How many at most.
        by : {'ratio', 'quality'}
            What to rank by; ties go to the lower number.
        measure : Measure
            Which ratio.
        """
        score = self.quality if by == "quality" else -self.ratio(measure)
        return np.argsort(score, kind="stable")[: max(n, 0)]

    def summary(self) -> dict[str, Any]:
        """Return the figures of a report file: plain numbers under plain names, measures with underscores."""
        return {
            "n_quads": self.n_quads,
            "n_nodes": self.n_nodes,
            "n_inverted": self.n_inverted,
            "ideal_quads": self.ideal_quads,
            "correct_percent": {_key(m): value for m, value in self.correct_percent.items()},
            "max_ratio": {_key(m): value for m, value in self.max_ratio.items()},
            "quality": dict(self.quality_summary),
            "irregular_percent": self.irregular_percent,
        }

    def table(self, measure: Measure = "mean-edge") -> dict[str, float]:
        """Return the rows of Tables 1 and 2, in their order and under their names."""
        quality = self.quality_summary
        return {
            "total faces": self.n_quads,
            "correct faces": self.correct_count[measure],
            "correct faces (%)": self.correct_percent[measure],
            "max R(e)": self.max_ratio[measure],
            "min quality": quality["min"],
            "max quality": quality["max"],
            "mean quality": quality["mean"],
            "quality deviation": quality["std"],
        }

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows, a column for each measure."""
        head = "".join(f"<th>{measure.replace('-', ' ')}</th>" for measure in MEASURES)
        tables = [self.table(measure) for measure in MEASURES]
        lines = []
        for name in tables[0]:
            values = [table[name] for table in tables]
            words = [f"{v:,}" if isinstance(v, int) else f"{v:.4g}" for v in values]
            cells = "".join(f'<td style="text-align: right">{word}</td>' for word in words)
            lines.append(f"<tr><th style='text-align: left'>{name}</th>{cells}</tr>")
        return f"<table><thead><tr><th></th>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>"


def _key(measure: str) -> str:
    return measure.replace("-", "_")


def judged(
    mesh: QuadMesh,
    reference: SizeFunction,
    *,
    beta: float = 1.0,
    ideal: float | None = None,
    threads: int | None = None,
    monitor: Monitor = SILENT,
) -> MeshReport:
    """Judge a mesh against prescribed sizes.

    Parameters
    ----------
    mesh : QuadMesh
        The elements.
    reference : SizeFunction
        The sizes that the user asked for, before limiting or preserving.
    beta : float
        Scale of the prescribed size, above 0.
    ideal : float, optional
        The count of elements that the field asks for, to be kept in the report.
    threads : int, optional
        Worker threads; every core by default.
    monitor : Monitor
        Told of progress; may cancel.

    Raises
    ------
    InputError
        If beta is not a number above 0.
    """
    if not (math.isfinite(beta) and beta > 0):
        raise InputError(f"beta is {beta}; it must be a number above 0, such as 1")
    least = reference.min_over(mesh.points, mesh.quads, threads, monitor)
    return MeshReport(
        least=read_only(least),
        sizes={measure: read_only(sizes) for measure, sizes in all_element_sizes(mesh).items()},
        quality=read_only(shape_quality(mesh)),
        n_nodes=mesh.n_points,
        irregular=irregular_fraction(mesh),
        beta=beta,
        ideal_quads=ideal,
    )
