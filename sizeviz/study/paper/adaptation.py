"""Section 5.1: the adaptive process on the ring, by both methods and every mesher; and with the guarantee."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from sizeviz.files import read_mesh
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.sources import load
from sizeviz.study.adaptive import AdaptOptions, adapted
from sizeviz.study.paper.together import together
from sizeviz.study.pipeline import GUARANTEED

if TYPE_CHECKING:
    from pathlib import Path

    from sizeviz.files import MeshFile
    from sizeviz.sources import Source
    from sizeviz.study.evolution import Evolution
    from sizeviz.study.paper.options import PaperOptions

WEIGHT: dict[str, float] = {"gradient-limiting": 8.0, "size-preserving": 1.0, GUARANTEED: 1.0}
"""How the time is divided: one method uses all the iterations there are, the others a few."""


@dataclass(frozen=True, eq=False)
class Adaptation:
    """One adaptive process of Section 5.1.

    Parameters
    ----------
    mesher, method : str
        What made the meshes, and what was done to the sizes.
    evolution : Evolution
        One row an iteration.
    folder : Path
        Where the meshes are.
    """

    mesher: str
    method: str
    evolution: Evolution
    folder: Path

    def last_mesh(self) -> MeshFile:
        """Return the last mesh, with its cell arrays."""
        return read_mesh(self.folder / self.evolution.iterations[-1].mesh)


def adaptations(options: PaperOptions, folder: Path, monitor: Monitor = SILENT) -> list[Adaptation]:
    """Run the processes, or take them up where a folder of an earlier run holds them.

    Raises
    ------
    InputError
        If the folder holds processes of other options.
    Cancelled
        If the monitor says so; finished iterations stay.
    """
    source = load("ring")
    jobs = [partial(_by_mesher, source, mesher, options, folder) for mesher in options.meshers]
    return [one for found in together(jobs, monitor) for one in found]


def _by_mesher(
    source: Source, mesher: str, options: PaperOptions, folder: Path, monitor: Monitor = SILENT
) -> list[Adaptation]:
    found, begun, methods = [], 0.0, options.methods(mesher)
    whole = sum(WEIGHT[method] for method in methods)
    for method in methods:
        asked = AdaptOptions(method=method, study=options.study(mesher), iterations=options.iterations)
        place = folder / f"ring-{method}-{mesher}"
        share = SubMonitor(monitor, begun, begun + WEIGHT[method] / whole)
        found.append(Adaptation(mesher, method, adapted(source, asked, place, share), place))
        begun += WEIGHT[method] / whole
    monitor.step(1.0)
    return found
