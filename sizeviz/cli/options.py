"""The options that commands share; nothing heavy is imported until a command runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from sizeviz.cli.terminal import notice
from sizeviz.cli.values import Place, Whole

if TYPE_CHECKING:
    from sizeviz.geometry import Domain
    from sizeviz.sources import Source
    from sizeviz.study import StudyOptions

MethodName = Literal["none", "gradient-limiting", "size-preserving"]
"""What is done to the field before it is meshed."""

DistanceName = Literal["euclidean", "edges"]
"""How far apart two places are: straight, or along edges of the background mesh."""

MesherName = Literal["frontal", "decomposition", "gmsh"]
"""Who makes the raw mesh."""

MeasureName = Literal["mean-edge", "sqrt-area", "max-edge"]
"""What the size of an element is."""

SourceArgument = Annotated[
    str,
    Parameter(help="An example (see sizeviz examples), a file, or expr:FORMULA in x and y."),
]
OutArgument = Annotated[Place, Parameter(name="--out", help="Folder for the results; created if need be.")]
FileArgument = Annotated[Place, Parameter(name=["--output", "-o"], help="File to write; its suffix is the format.")]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class FieldOptions:
    """How the size field is processed.

    Parameters
    ----------
    epsilon
        Largest slope of gradient limiting. Default 0.5; compare uses 1 / alpha.
    alpha
        Radius of the ball that must hold no smaller size, in elements.
    beta
        Scale of the size asked for; above 1 it permits sizes above the field.
    distance
        How distances are measured.
    domain
        File with the outline of the domain; by default the source's own.
    threads
        Worker threads; every core by default. The result does not depend on it.
    """

    epsilon: float | None = None
    alpha: float = 2.0
    beta: float = 1.0
    distance: DistanceName = "euclidean"
    domain: Place | None = None
    threads: Whole | None = None


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class PipelineOptions(FieldOptions):
    """How the size field is processed, meshed and smoothed.

    Parameters
    ----------
    mesher
        Who makes the raw mesh.
    mesh_scale
        Element size asked for, relative to the processed field; the default is calibrated, and serves every method
        but the guarantee, which finds its own.
    preset
        direct follows the field node by node; fast splits a mesh of twice the size.
    smooth
        Whether the mesh is cleaned up and smoothed.
    guarantee
        Whether every element is made correct by the longest edge. In run it replaces plain size preserving, in compare
        it is a row of its own; on by default where there is something to guarantee.
    measure
        Size of an element in pictures and in the ratio array; the report has all three.
    seed
        Chooses one of many equally good meshes.
    max_elements
        Refuse to begin a mesh of more elements.
    """

    mesher: MesherName = "frontal"
    mesh_scale: float | None = None
    preset: Literal["direct", "fast"] = "direct"
    smooth: bool = True
    guarantee: bool | None = None
    measure: MeasureName = "mean-edge"
    seed: Whole = 0
    max_elements: Whole = 5_000_000


def study_options(options: FieldOptions, *, comparable: bool = False) -> StudyOptions:
    """Return what the pipeline is asked to do.

    Parameters
    ----------
    options : FieldOptions
        As typed; a ``PipelineOptions`` sets the later stages too.
    comparable : bool
        Whether epsilon is 1 / alpha unless it was typed.

    Raises
    ------
    InputError
        If a value is out of range.
    """
    from sizeviz.meshing import MeshOptions
    from sizeviz.sizing import LimitOptions, PreserveOptions
    from sizeviz.study import StudyOptions

    preserve = PreserveOptions(alpha=options.alpha, beta=options.beta, distance=options.distance)
    epsilon = options.epsilon
    if epsilon is None:
        epsilon = 1.0 / options.alpha if comparable else LimitOptions().epsilon
    limit = LimitOptions(epsilon=epsilon, distance=options.distance)
    if not isinstance(options, PipelineOptions):
        return StudyOptions(limit=limit, preserve=preserve, threads=options.threads)
    mesh = MeshOptions(
        mesher=options.mesher,
        scale=MeshOptions().scale if options.mesh_scale is None else options.mesh_scale,
        seed=options.seed,
        preset=options.preset,
        max_elements=options.max_elements,
    )
    return StudyOptions(limit=limit, preserve=preserve, mesh=mesh, smoothing=options.smooth, threads=options.threads)


def loaded(source: str, options: FieldOptions) -> Source:
    """Return the source that was named, on the domain that was named.

    Raises
    ------
    InputError
        If either cannot be used.
    """
    from sizeviz.files import read_domain
    from sizeviz.sources import load

    domain: Domain | None = None if options.domain is None else read_domain(options.domain)
    for note in domain.notes if domain is not None else ():
        notice(f"{options.domain}: {note}")
    return load(source, domain)
