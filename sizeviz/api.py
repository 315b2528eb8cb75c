"""Ten functions for notebooks and scripts; each takes and returns values, and shows progress where somebody watches.

``load`` a source, ``paint`` on it, ``limit`` or ``preserve`` its sizes, ``mesh`` and ``smooth``, ``report`` on what
came of it, ``show`` it or take a ``screenshot``; or let it ``adapt``. They are the pipeline of the command line and the
window, stage by stage; ``sizeviz.run`` does all stages at once.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from sizeviz.compiled import prepared
from sizeviz.conformity import MeshReport, judged
from sizeviz.errors import InputError
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.improvement import SmoothOptions, improved
from sizeviz.meshing import MeshOptions, generated
from sizeviz.notebook import Shown, picture_page, progress
from sizeviz.sizing import BackgroundMesh, LimitOptions, PreserveOptions, SizeField, limited, preserved
from sizeviz.sources import Source
from sizeviz.sources import load as _load
from sizeviz.sources.approximation import approximated, shortfall
from sizeviz.sources.painting import Brush, Stroke, StrokeShape, painted, stroke_weights
from sizeviz.study import Study, StudyOptions
from sizeviz.study.adaptive import AdaptOptions, adapted

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from sizeviz.conformity import Measure
    from sizeviz.monitor import Monitor
    from sizeviz.scene import Subject
    from sizeviz.scene.view import Quantity
    from sizeviz.study.evolution import Evolution

    Function = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

MOST_ON_A_PAGE = 400_000
"""Elements that ``show`` puts on an interactive page; more are shown as a picture."""


def load(
    source: str | Path | Source | SizeField | ArrayLike | Function,
    domain: Domain | str | Path | None = None,
    *,
    image_size: Literal["curvature", "intensity"] = "curvature",
    monitor: Monitor | None = None,
) -> Source:
    """Return a source of sizes.

    Parameters
    ----------
    source : str, path-like, Source, SizeField, (ny, nx) array or callable
        An example's name, a file, ``expr:FORMULA``; a source or field as it is; sizes on a grid, row 0 at the smallest
        y; or a function of x and y, arrays of one shape, that returns the sizes.
    domain : Domain or path-like, optional
        What is to be meshed, or the file that outlines it; by default the source's own extent, the unit square for
        arrays and functions.
    image_size : {'curvature', 'intensity'}
        How a picture becomes sizes.
    monitor : Monitor, optional
        Told of progress; by default a bar in a notebook or on a terminal.

    Raises
    ------
    InputError
        If there is no such source, or its content cannot be used.
    """
    outline = _domain(domain)
    if isinstance(source, Source):
        return source if outline is None else replace(source, domain=outline)
    if isinstance(source, SizeField):
        return _of_field(source, outline or _bounds_of(source))
    if isinstance(source, str | Path):
        with progress(monitor) as bar:
            return _load(str(source), outline, image_size=image_size, monitor=bar)
    region = outline or Domain.unit_square()
    if callable(source):
        label = getattr(source, "__name__", "function")
        with progress(monitor) as bar:
            size = approximated(source, region, label, monitor=bar)
        words = label + shortfall(size)
        return Source("function", words, region, size.field, size, None, {"kind": "function", "error": size.error})
    return _of_field(_gridded(source, region), region)


def paint(
    source: Source,
    path: ArrayLike,
    *,
    size: float | None = None,
    factor: float | None = None,
    at_most: float | None = None,
    radius: float,
    hardness: float = 0.5,
    shape: StrokeShape = "freehand",
) -> Source:
    """Return a source after a stroke of the brush; R is then judged against what was painted.

    Parameters
    ----------
    source : Source
        What is painted on.
    path : (K, 2) array_like
        Where the brush goes, in model units.
    size, factor, at_most : float
        Exactly one of them: the size to set, the factor to multiply by, or the size not to exceed; above 0.
    radius : float
        Reach of the brush in model units, above 0.
    hardness : float
        Share of the radius with full effect, 0 to 1.
    shape : {'freehand', 'line', 'polygon'}
        Whether the path is the stroke, or outlines what it fills.

    Raises
    ------
    InputError
        If a value is out of range, not exactly one effect is given, or the stroke reaches no node.
    """
    effects = {"set": size, "multiply": factor, "at-most": at_most}
    given = [(mode, value) for mode, value in effects.items() if value is not None]
    if len(given) != 1:
        raise InputError(f"paint needs exactly one of size, factor and at_most; {len(given)} were given")
    mode, value = given[0]
    modes: dict[str, Literal["set", "multiply", "at-most"]] = {
        "set": "set",
        "multiply": "multiply",
        "at-most": "at-most",
    }
    stroke = Stroke(Brush(mode=modes[mode], radius=radius, value=value, hardness=hardness), np.asarray(path), shape)
    if not stroke_weights(source.field.background, stroke).any():
        raise InputError("the stroke reaches no node of the field; move it, widen the brush, or load a finer field")
    field = painted(source.field, stroke)
    strokes = int(source.provenance.get("strokes", 0)) + 1
    return replace(source, field=field, reference=field, provenance={**source.provenance, "strokes": strokes})


def limit(
    source: Source | SizeField,
    epsilon: float = 0.5,
    *,
    distance: Literal["euclidean", "edges"] = "euclidean",
    monitor: Monitor | None = None,
) -> SizeField:
    """Return the gradient-limited field: sizes that grow by at most ``epsilon`` per unit of distance, eq. (2).

    Parameters
    ----------
    source : Source or SizeField
        The sizes asked for.
    epsilon : float
        Largest slope, above 0.
    distance : {'euclidean', 'edges'}
        What the slope is measured over.
    monitor : Monitor, optional
        Told of progress.

    Raises
    ------
    InputError
        If a value is out of range.
    """
    options = LimitOptions(epsilon=epsilon, distance=distance)
    with progress(monitor) as bar:
        return limited(_field(source), options, monitor=prepared(bar))


def preserve(
    source: Source | SizeField,
    alpha: float = 2.0,
    beta: float = 1.0,
    *,
    distance: Literal["euclidean", "edges", "edges-as-printed"] = "euclidean",
    monitor: Monitor | None = None,
) -> SizeField:
    """Return the size-preserving field h*, Algorithm 1.

    Parameters
    ----------
    source : Source or SizeField
        The sizes asked for.
    alpha : float
        Radius of the ball that must hold no smaller size, in elements, above 0.
    beta : float
        Scale of the size asked for, above 0.
    distance : {'euclidean', 'edges', 'edges-as-printed'}
        What the ball is measured by.
    monitor : Monitor, optional
        Told of progress.

    Raises
    ------
    InputError
        If a value is out of range.
    """
    options = PreserveOptions(alpha=alpha, beta=beta, distance=distance)
    with progress(monitor) as bar:
        return preserved(_field(source), options, monitor=prepared(bar))


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


def show(
    source: Study | Source | QuadMesh,
    meshes: QuadMesh | Mapping[str, QuadMesh] | None = None,
    *,
    color_by: Quantity | None = None,
    measure: Measure = "mean-edge",
    dark: bool = False,
) -> Shown:
    """Show a study, meshes judged against a source, or a source's sizes; in a notebook, to zoom into and point at.

    Parameters
    ----------
    source : Study, Source or QuadMesh
        What is shown.
    meshes : QuadMesh or mapping of str to QuadMesh, optional
        Of a source: the meshes, by the words over them.
    color_by : {'ratio', 'quality', 'size', 'prescribed', 'target', 'error'}, optional
        What the colours mean at first; R by default, the sizes of a source without a mesh, else quality.
    measure : {'mean-edge', 'sqrt-area', 'max-edge'}
        Size of an element.
    dark : bool
        Dark ground.

    Returns
    -------
    Shown
        A notebook displays it; ``.open()`` shows it in a browser, ``.save(path)`` writes it.

    Raises
    ------
    InputError
        If there is nothing of that kind to show.
    MissingDependencyError
        If a picture is needed, for there is no mesh or too large a one, and OpenGL is missing.
    """
    from sizeviz.scene import ViewState
    from sizeviz.scene.page import page

    subjects, title = _subjects(source, meshes)
    count = sum(subject.mesh.n_quads for subject in subjects if subject.mesh is not None)
    if 0 < count <= MOST_ON_A_PAGE:
        panes = None if color_by is None else [ViewState(method=str(k), color_by=color_by) for k in (0, 1)]
        return Shown(title, page(subjects, panes=panes, measure=measure, title=title, dark=dark))
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "picture.png"
        _shoot(subjects, picture, color_by, measure, 1200, dark)
        return Shown(title, picture_page(title, picture.read_bytes()))


def screenshot(
    path: str | Path,
    source: Study | Source | QuadMesh,
    meshes: QuadMesh | Mapping[str, QuadMesh] | None = None,
    *,
    color_by: Quantity | None = None,
    measure: Measure = "mean-edge",
    width: int = 1400,
    dark: bool = False,
) -> Path:
    """Write a picture (.png .jpg .tif .webp), a vector figure (.svg .pdf) or an interactive page (.html).

    Of several meshes, a picture is the comparison of all, coloured by R and by quality; a vector figure shows one.

    Parameters
    ----------
    path : path-like
        Where to; the suffix says what.
    source, meshes, color_by, measure, dark
        As for ``show``.
    width : int
        Pixels across; a vector figure has 200 an inch.

    Returns
    -------
    Path
        Where it was written.

    Raises
    ------
    InputError
        If there is nothing of that kind to show, or the place cannot be written.
    MissingDependencyError
        If OpenGL is needed and missing.
    """
    from sizeviz.scene import ViewState, save_page
    from sizeviz.scene.page import PAGE_SUFFIXES

    path = Path(path)
    subjects, title = _subjects(source, meshes)
    if path.suffix.lower() not in PAGE_SUFFIXES:
        return _shoot(subjects, path, color_by, measure, width, dark)
    panes = None if color_by is None else [ViewState(method=str(k), color_by=color_by) for k in (0, 1)]
    return save_page(subjects, path, panes=panes, measure=measure, title=title, dark=dark)


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


def _field(source: Source | SizeField) -> SizeField:
    return source.field if isinstance(source, Source) else source


def _domain(domain: Domain | str | Path | None) -> Domain | None:
    from sizeviz.files import read_domain

    return read_domain(domain) if isinstance(domain, str | Path) else domain


def _of_field(field: SizeField, domain: Domain) -> Source:
    return Source("field", field.label, domain, field, field, None, {"kind": "values"})


def _bounds_of(field: SizeField) -> Domain:
    bounds = field.background.bounds
    return Domain.unit_square() if bounds == (0.0, 0.0, 1.0, 1.0) else Domain.rectangle(*bounds, label=field.label)


def _gridded(values: ArrayLike, domain: Domain) -> SizeField:
    """Return sizes on a grid over the domain's bounds."""
    from sizeviz.sizing import Grid

    sizes = np.asarray(values, dtype=np.float64)
    if sizes.ndim != 2 or min(sizes.shape) < 2:
        raise InputError(
            f"sizes of shape {sizes.shape}: give a grid (ny, nx), at least 2 by 2, row 0 at the smallest y"
        )
    (x0, y0, x1, y1), (ny, nx) = domain.bounds, sizes.shape
    grid = Grid(x0, y0, (x1 - x0) / (nx - 1), (y1 - y0) / (ny - 1), nx, ny)
    return SizeField(BackgroundMesh.regular(grid), sizes.ravel(), "array")


def _subjects(
    source: Study | Source | QuadMesh, meshes: QuadMesh | Mapping[str, QuadMesh] | None
) -> tuple[list[Subject], str]:
    """Return what is to be shown, judged, and a heading."""
    from sizeviz.scene import Subject
    from sizeviz.scene.compose import as_subject
    from sizeviz.scene.subject import subjects_of

    if isinstance(source, Study):
        if meshes is not None:
            raise InputError("a study has meshes of its own; leave meshes out, or give the study's source")
        done = [name for name, run in source.runs.items() if run.mesh is not None]
        if not done:
            return _subjects(source.source, None)
        return subjects_of(source, done)
    if isinstance(source, QuadMesh):
        if meshes is not None:
            raise InputError("meshes are judged against a source; give that first")
        return [as_subject(source, "")], "Mesh"
    bare = Subject(title=source.label, prescribed=source.field, domain=source.domain, image=source.image)
    named = {"Mesh": meshes} if isinstance(meshes, QuadMesh) else dict(meshes or {})
    subjects = [
        replace(bare, title=words, detail=f"{m.n_quads:,} elements", mesh=m, report=judged(m, source.reference))
        for words, m in named.items()
    ] or [bare]
    return subjects, source.label


def _shoot(
    subjects: Sequence[Subject], path: Path, color_by: Quantity | None, measure: Measure, width: int, dark: bool
) -> Path:
    from sizeviz.scene import save_comparison, save_picture
    from sizeviz.scene.opengl import require_gl
    from sizeviz.scene.vector import VECTOR_SUFFIXES

    vector = path.suffix.lower() in VECTOR_SUFFIXES
    if not vector:
        require_gl()
    if len(subjects) > 1 and color_by is None and not vector:
        return save_comparison(subjects, path, measure=measure, width=width, dark=dark)
    if len(subjects) > 1:
        raise InputError(f"{path}: shows one mesh; name one, or leave out color_by for a .png of all, or write .html")
    subject = subjects[0]
    usual: Quantity = "prescribed" if subject.mesh is None else "quality" if subject.report is None else "ratio"
    return save_picture(subject, path, color_by=color_by or usual, measure=measure, width=width, dark=dark)
