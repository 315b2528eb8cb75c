"""What a study is asked to do, stage by stage."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from sizeviz.errors import InputError
from sizeviz.improvement import SmoothOptions
from sizeviz.meshing import MeshOptions
from sizeviz.sizing import LimitOptions, PreserveOptions


@dataclass(frozen=True, kw_only=True)
class StudyOptions:
    """The options of every stage; one set serves all methods, so that they are compared like with like.

    Parameters
    ----------
    limit : LimitOptions
        Gradient limiting.
    preserve : PreserveOptions
        Size preserving; its ``beta`` also scales the size that every method asks for and is judged against, eq. (3).
    mesh : MeshOptions
        The mesher, and the one mesh scale of every method.
    smooth : SmoothOptions
        Clean-up and smoothing.
    smoothing : bool
        Whether the raw mesh is improved at all. Default True.
    threads : int, optional
        Worker threads of every stage, above those stages' own setting; every core by default.
        The result does not depend on it.

    Raises
    ------
    InputError
        If ``threads`` is below 1.
    """

    limit: LimitOptions = field(default_factory=LimitOptions)
    preserve: PreserveOptions = field(default_factory=PreserveOptions)
    mesh: MeshOptions = field(default_factory=MeshOptions)
    smooth: SmoothOptions = field(default_factory=SmoothOptions)
    smoothing: bool = True
    threads: int | None = None

    def __post_init__(self) -> None:
        if self.threads is not None and self.threads < 1:
            raise InputError(f"threads is {self.threads}; give 1 or more, or none for every core")

    @property
    def beta(self) -> float:
        """Scale of the size asked for, of every method."""
        return self.preserve.beta

    def with_comparable_slope(self) -> StudyOptions:
        """Return the options with epsilon = 1 / alpha, the setting at which both methods grow sizes alike."""
        return replace(self, limit=replace(self.limit, epsilon=1.0 / self.preserve.alpha))

    def without_threads(self) -> StudyOptions:
        """Return the options with every thread count left open: what the result depends on."""
        mesh, smooth = replace(self.mesh, threads=None), replace(self.smooth, threads=None)
        return replace(self, mesh=mesh, smooth=smooth, threads=None)
