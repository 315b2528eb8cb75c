"""What an adaptive process has done so far: one row an iteration, kept as JSON beside the meshes."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any

from sizeviz import __version__
from sizeviz.errors import InputError
from sizeviz.files import replacing
from sizeviz.files.guard import one_line

if TYPE_CHECKING:
    from pathlib import Path

RECORD = "evolution.json"
"""The record's name in the folder of the process."""

FINGERPRINT = "fingerprint"
"""Among the options, what tells one source from another of the same name; older records do not have it."""

LATER: tuple[str, ...] = ("strict_ratio", "strict_correct")
"""Columns that the records of older versions do not have; there they are not a number until the meshes are judged."""


@dataclass(frozen=True, kw_only=True)
class Iteration:
    """One mesh of an adaptive process and its judgement; number 0 is the uniform mesh it starts from.

    Parameters
    ----------
    number : int
        0, 1, 2, ...
    mesh : str
        Name of the mesh file in the folder.
    n_quads, n_nodes : int
        Size of the mesh.
    background_ratio, analytic_ratio : float
        Largest R against the sizes on the background that the mesh was made from, and against the field the user
        gave. The first mesh was made from no background: its ratio there is that against the given field.
    background_correct, analytic_correct : float
        Percentage of elements with R <= 1 against both.
    strict_ratio, strict_correct : float
        Largest R and percentage of correct elements against the given field by the longest edge, the strictest measure;
        not a number in the record of an older version that was only read.
    quality_min, quality_mean, quality_max, quality_std : float
        Shape quality, 0 to 1.
    irregular : float
        Percentage of irregular nodes.
    seconds : float
        Wall-clock time of the iteration.
    """

    number: int
    mesh: str
    n_quads: int
    n_nodes: int
    background_ratio: float
    analytic_ratio: float
    background_correct: float
    analytic_correct: float
    strict_ratio: float
    strict_correct: float
    quality_min: float
    quality_mean: float
    quality_max: float
    quality_std: float
    irregular: float
    seconds: float


@dataclass(frozen=True, kw_only=True)
class Evolution:
    """An adaptive process as far as it has come.

    Parameters
    ----------
    source : str
        Name of the source.
    options : dict
        What decides the meshes, by the names on the command line.
    limit : float
        The process has converged when no element's R against the given field exceeds this.
    iterations : tuple of Iteration
        In order.
    """

    source: str
    options: dict[str, Any] = field(default_factory=dict)
    limit: float = 1.1
    iterations: tuple[Iteration, ...] = ()

    @property
    def converged(self) -> bool:
        """Whether the last mesh keeps the limit."""
        return bool(self.iterations) and self.iterations[-1].analytic_ratio <= self.limit

    def differences(self, other: Evolution) -> list[str]:
        """Return what makes the other process another one, a few words each; none if it is the same, however far."""
        mine = {"source": self.source, "limit": self.limit, **self.options}
        others = {"source": other.source, "limit": other.limit, **other.options}
        prints = {values.pop(FINGERPRINT, None) for values in (mine, others)} - {None}
        found = []
        for name in dict.fromkeys([*mine, *others]):
            kept, asked = (values.get(name, "not recorded") for values in (mine, others))
            if kept != asked:
                found.append(f"{name.replace('_', '-')} {kept}, not {asked}")
        return [*found, *(["other sizes, or another domain"] if len(prints) > 1 else [])]


def write_evolution(folder: Path, evolution: Evolution) -> None:
    """Write the record into the process's folder, whole or not at all."""
    content = {**asdict(evolution), "converged": evolution.converged, "sizeviz": __version__}
    with replacing(folder / RECORD) as part:
        part.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def read_evolution(folder: Path) -> Evolution | None:
    """Return the record in a folder, None where there is none.

    Raises
    ------
    InputError
        If the record is not one.
    """
    path = folder / RECORD
    if not path.exists():
        return None
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        older = dict.fromkeys(LATER, math.nan)
        rows = tuple(
            Iteration(**{entry.name: {**older, **row}[entry.name] for entry in fields(Iteration)})
            for row in content["iterations"]
        )
        return Evolution(
            source=content["source"], options=dict(content["options"]), limit=float(content["limit"]), iterations=rows
        )
    except KeyError as problem:
        raise InputError(
            f"{path}: has no {one_line(problem, 40)}, as a record of sizeviz adapt does; choose another --out, or "
            "remove that file to begin anew"
        ) from problem
    except (OSError, ValueError, TypeError, AttributeError, RecursionError) as problem:
        raise InputError(
            f"{path}: is not the record of an adaptive process ({one_line(problem, 80)}); choose another --out, or "
            "remove that file to begin anew"
        ) from problem
