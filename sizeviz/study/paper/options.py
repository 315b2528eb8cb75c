"""What the reproduction of the paper is asked to do."""

from __future__ import annotations

from dataclasses import dataclass

from sizeviz.errors import InputError
from sizeviz.meshing import GENERATORS, MeshOptions
from sizeviz.sizing import LimitOptions, PreserveOptions
from sizeviz.study.options import StudyOptions
from sizeviz.study.pipeline import COMPARED, GUARANTEED

MESHERS: tuple[str, ...] = ("decomposition", "frontal")
"""The paper's own kind of mesher, and ours."""

GUARANTEEING = "frontal"
"""The mesher whose meshes are also made with the guarantee."""


@dataclass(frozen=True, kw_only=True)
class PaperOptions:
    """How the examples of Section 5 are run; alpha is 2 and epsilon 1/2, as in the paper.

    Parameters
    ----------
    scale : float
        Element size asked for relative to the processed field; one for both methods. Default 0.83.
    iterations : int
        Most iterations of the adaptive processes. Default 50, as in the paper.
    meshers : tuple of str
        Keys of ``GENERATORS``.
    threads : int, optional
        Worker threads of each mesher; every core by default. The meshers run side by side: while one works on a single
        core, the other has the rest.

    Raises
    ------
    InputError
        If a mesher is unknown or a value out of range.
    """

    scale: float = 0.83
    iterations: int = 50
    meshers: tuple[str, ...] = MESHERS
    threads: int | None = None

    def __post_init__(self) -> None:
        unknown = [name for name in self.meshers if name not in GENERATORS]
        if unknown or not self.meshers:
            raise InputError(
                f"mesher {unknown[:1] or 'none'} is not known; choose among {', '.join(sorted(GENERATORS))}"
            )
        if self.iterations < 1:
            raise InputError(f"iterations is {self.iterations}; at least 1 is needed")

    def study(self, mesher: str) -> StudyOptions:
        """Return the options of every stage, for one mesher."""
        return StudyOptions(
            limit=LimitOptions(epsilon=0.5),
            preserve=PreserveOptions(alpha=2.0),
            mesh=MeshOptions(mesher=mesher, scale=self.scale),
            threads=self.threads,
        )

    def methods(self, mesher: str) -> tuple[str, ...]:
        """Return the methods that a mesher's meshes are made with."""
        return (*COMPARED, GUARANTEED) if mesher == GUARANTEEING else COMPARED
