"""A study as the command or the Python script that makes its meshes again, bit by bit."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError
from sizeviz.improvement import SmoothOptions
from sizeviz.meshing import MeshOptions
from sizeviz.sources import examples
from sizeviz.sources import load as load_source
from sizeviz.study.pipeline import COMPARED, GUARANTEED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sizeviz.conformity import Measure
    from sizeviz.geometry import Domain
    from sizeviz.sources import Source
    from sizeviz.study.options import StudyOptions
    from sizeviz.study.study import Study


def as_command(
    study: Study,
    methods: Sequence[str] = COMPARED,
    *,
    out: str = "results",
    field_file: str | Path | None = None,
    measure: Measure = "mean-edge",
) -> str:
    """Return the command that makes a study's meshes: ``compare`` where that does, else a ``run`` for each method.

    Parameters
    ----------
    study : Study
        What is to be made again.
    methods : sequence of str
        Which methods.
    out : str
        Folder for the results.
    field_file : path-like, optional
        Where the field of a source that has no name, such as a painted one, was exported to (``.npz`` or ``.npy``).
    measure : Measure
        Size of an element in the command's picture and ratio array; the meshes do not depend on it.

    Returns
    -------
    str
        One line for a shell, or one for each method.

    Raises
    ------
    InputError
        If the field needs exporting first, or there is no option for something that the study asks for.
    """
    source = _typed_source(study.source, field_file)
    options = _typed_options(study.options)
    if measure != "mean-edge":
        options += ["--measure", measure]
    plain = [method for method in methods if method != GUARANTEED]
    if not study.options.smoothing and GUARANTEED in methods:
        raise InputError("the command line guarantees smoothed meshes only; smooth, or copy as Python")
    if tuple(sorted(plain)) == tuple(sorted(COMPARED)):
        guarantee = "--guarantee" if GUARANTEED in methods else "--no-guarantee"
        return shlex.join(["sizeviz", "compare", source, "--out", out, *options, guarantee])
    lines = []
    for method in methods:
        folder = out if len(methods) == 1 else f"{out}/{method}"
        lines.append(shlex.join(["sizeviz", "run", source, "--out", folder, *_typed_method(method), *options]))
    return "\n".join(lines)


def as_python(study: Study, methods: Sequence[str] = COMPARED, *, study_file: str | Path | None = None) -> str:
    """Return a script that makes a study's meshes and leaves them in ``study.runs``.

    Parameters
    ----------
    study : Study
        What is to be made again.
    methods : sequence of str
        Which methods.
    study_file : path-like, optional
        Where a study whose source has no name, such as a painted one, was saved.

    Raises
    ------
    InputError
        If the study needs saving first.
    """
    spec = _spec(study.source)
    if spec is not None:
        image_size = study.source.provenance.get("image_size")
        extra = "" if image_size is None else f", image_size={image_size!r}"
        imported, source = "from sizeviz.sources import load", f"load({spec!r}{extra})"
    elif study_file is not None:
        imported, source = (
            "from sizeviz.study.storage import read_study",
            f"read_study({str(study_file)!r}).study.source",
        )
    else:
        raise InputError("the sizes were painted, so the script must refer to a study file; save the study first")
    stages = [f"    {name}={getattr(study.options, name)!r}," for name in ("limit", "preserve", "mesh", "smooth")]
    imports = [
        "from sizeviz.improvement import SmoothOptions",
        "from sizeviz.meshing import MeshOptions",
        "from sizeviz.sizing import LimitOptions, PreserveOptions",
        "from sizeviz.study import Study, StudyOptions, run",
        imported,
    ]
    return "\n".join(
        [
            *sorted(imports),
            "",
            "options = StudyOptions(",
            *stages,
            f"    smoothing={study.options.smoothing!r},",
            ")",
            f"study = run(Study({source}, options), {tuple(methods)!r})",
            "for method, result in study.runs.items():",
            "    print(method, result.report.n_quads, result.report.correct_percent, result.report.max_ratio)",
            "",
        ]
    )


def has_name(source: Source) -> bool:
    """Return whether a source can be had again by an example's name, a formula or the file it was read from."""
    return _spec(source) is not None


def _spec(source: Source) -> str | None:
    provenance = source.provenance
    kind = provenance.get("kind")
    if provenance.get("strokes"):
        return None
    if kind == "formula":
        return f"expr:{provenance['formula']}"
    if kind in ("picture", "field"):
        return str(Path(str(provenance["path"])).resolve())
    if kind in ("example", "synthetic") and source.name in {example.name for example in examples()}:
        return source.name
    return None


def _typed_source(source: Source, field_file: str | Path | None) -> str:
    spec = _spec(source)
    if spec is not None:
        if source.provenance.get("image_size", "curvature") != "curvature":
            raise InputError("the command line takes sizes from a picture's curvature only; copy as Python")
        return spec
    if field_file is None:
        raise InputError("the sizes were painted, so the command must refer to a file of them; save the study first")
    there = load_source(str(field_file))
    if not np.array_equal(there.field.sizes, source.field.sizes) or not _same_domain(there.domain, source.domain):
        raise InputError(f"{field_file}: would not give the same mesh on the command line; copy as Python")
    return str(field_file)


def _same_domain(one: Domain, other: Domain) -> bool:
    a, b = ([*d.loops, *d.corners, *d.lines, d.fixed_points] for d in (one, other))
    return len(a) == len(b) and all(np.array_equal(p, q) for p, q in zip(a, b, strict=True))


def _typed_method(method: str) -> list[str]:
    if method == GUARANTEED:
        return ["--method", "size-preserving", "--guarantee"]
    return ["--method", method, "--no-guarantee"]


def _typed_options(options: StudyOptions) -> list[str]:
    limit, preserve, mesh, default = options.limit, options.preserve, options.mesh, MeshOptions()
    if options.without_threads().smooth != SmoothOptions():
        raise InputError("the command line has no options for the smoother's parts; copy as Python")
    if limit.distance != preserve.distance:
        raise InputError("the command line has one distance for both methods; copy as Python")
    words = ["--epsilon", repr(limit.epsilon), "--alpha", repr(preserve.alpha), "--beta", repr(preserve.beta)]
    chosen = (
        ("--distance", preserve.distance, "euclidean"),
        ("--mesher", mesh.mesher, default.mesher),
        ("--mesh-scale", repr(mesh.scale), repr(default.scale)),
        ("--preset", mesh.preset, default.preset),
        ("--seed", str(mesh.seed), str(default.seed)),
        ("--max-elements", str(mesh.max_elements), str(default.max_elements)),
    )
    for name, value, usual in chosen:
        if value != usual:
            words += [name, value]
    return words if options.smoothing else [*words, "--no-smooth"]
