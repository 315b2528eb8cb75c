"""``mesh``, ``smooth``, ``report``: a mesh, a better one, what it is worth; ``adapt`` does it again and again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sizeviz.compiled import prepared
from sizeviz.conformity import MeshReport, judged
from sizeviz.improvement import SmoothOptions, improved
from sizeviz.meshing import MeshOptions, generated
from sizeviz.notebook import progress
from sizeviz.sources import Source
from sizeviz.study import StudyOptions
from sizeviz.study.adaptive import AdaptOptions, adapted

if TYPE_CHECKING:
    from pathlib import Path

    from sizeviz.geometry import QuadMesh
    from sizeviz.monitor import Monitor
    from sizeviz.sizing import SizeField
    from sizeviz.study.evolution import Evolution


def mesh(
    source: Source,
    field: SizeField | None = None,
    *,
    options: MeshOptions | None = None,
    monitor: Monitor | None = None,
) -> QuadMesh:
    """Return a raw mesh of quadrilaterals for the source's domain; ``smooth`` it next.

    Parameters
    ----------
    source : Source
        Whose domain.
    field : SizeField, optional
        The sizes to mesh by, such as those of ``limit`` or ``preserve``; the source's own by default.
    options : MeshOptions, optional
        Mesher, scale, seed and limit.
    monitor : Monitor, optional
        Told of progress.

    Raises
    ------
    MeshingError
        If no valid mesh could be made.
    """
    with progress(monitor) as bar:
        return generated(source.domain, source.field if field is None else field, options, prepared(bar))


def smooth(
    source: Source,
    mesh: QuadMesh,
    field: SizeField | None = None,
    *,
    options: SmoothOptions | None = None,
    monitor: Monitor | None = None,
) -> QuadMesh:
    """Return the mesh with better connectivity and shapes at the same sizes.

    Parameters
    ----------
    source : Source
        Whose domain it meshes.
    mesh : QuadMesh
        A raw mesh.
    field : SizeField, optional
        The sizes that it was made by; the source's own by default.
    options : SmoothOptions, optional
        What to do.
    monitor : Monitor, optional
        Told of progress.

    Raises
    ------
    InputError
        If the mesh does not belong to the domain.
    """
    with progress(monitor) as bar:
        return improved(mesh, source.domain, source.field if field is None else field, options, prepared(bar))


def report(
    source: Source | SizeField, mesh: QuadMesh, *, beta: float = 1.0, monitor: Monitor | None = None
) -> MeshReport:
    """Return the judgement of a mesh against the sizes asked for: R(e) of eq. (3), quality, Tables 1 and 2.

    Parameters
    ----------
    source : Source or SizeField
        What was asked for; of a formula, the formula itself.
    mesh : QuadMesh
        What came of it.
    beta : float
        Scale of the size asked for.
    monitor : Monitor, optional
        Told of progress.

    Raises
    ------
    InputError
        If beta is not a number above 0.
    """
    with progress(monitor) as bar:
        asked = source.reference if isinstance(source, Source) else source
        return judged(mesh, asked, beta=beta, monitor=prepared(bar))


def adapt(
    source: Source,
    out: str | Path,
    *,
    method: str = "size-preserving",
    options: AdaptOptions | None = None,
    monitor: Monitor | None = None,
) -> Evolution:
    """Run the adaptive process, Algorithm 3, and return its record; meshes and record are kept in a folder.

    Parameters
    ----------
    source : Source
        What is asked for.
    out : path-like
        Folder of the process; one that was stopped is taken up where it was left.
    method : str
        'none', 'gradient-limiting', 'size-preserving' or 'guaranteed'; only without ``options``.
    options : AdaptOptions, optional
        All that can be asked for; by default epsilon = 1/alpha, until no R exceeds 1.1, in at most 50 iterations.
    monitor : Monitor, optional
        Told of progress.

    Raises
    ------
    InputError
        If the folder cannot be written, or holds another process.
    MeshingError
        If an iteration makes no valid mesh.
    """
    asked = options or AdaptOptions(method=method, study=StudyOptions().with_comparable_slope())
    with progress(monitor) as bar:
        return adapted(source, asked, out, prepared(bar))
