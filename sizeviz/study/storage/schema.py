"""What the text of a study file must look like, and how texts of older versions are brought up to date."""

from __future__ import annotations

import dataclasses
import json
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from sizeviz.errors import InputError
from sizeviz.files.guard import one_line

if TYPE_CHECKING:
    from collections.abc import Callable

FORMAT = "sizeviz-study"
VERSION = 1
"""The version that is written. A change that older programs would misread raises it and adds a migration."""

MIGRATIONS: dict[int, Callable[[dict[str, Any]], dict[str, Any]]] = {}
"""For each older version, what turns a text of that version into one of the next."""

ArrayName = Annotated[str, Field(pattern=r"^a\d{1,4}$")]
BackgroundName = Annotated[str, Field(pattern=r"^b\d{1,3}$")]
Text = Annotated[str, Field(max_length=4000)]
Plain = TypeVar("Plain")


class _Model(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


class GridText(_Model):
    """A regular grid of nodes."""

    x0: float
    y0: float
    dx: float
    dy: float
    nx: Annotated[int, Field(ge=2, le=1_000_000)]
    ny: Annotated[int, Field(ge=2, le=1_000_000)]


class BackgroundText(_Model):
    """A background mesh: a grid, or points and triangles."""

    grid: GridText | None = None
    points: ArrayName | None = None
    triangles: ArrayName | None = None


class FieldText(_Model):
    """A size field."""

    background: BackgroundName
    sizes: ArrayName
    label: Text


class DomainText(_Model):
    """A domain: loops, outer first, and what lies inside."""

    loops: Annotated[list[ArrayName], Field(min_length=1)]
    corners: list[ArrayName]
    lines: list[ArrayName]
    fixed_points: ArrayName
    label: Text


class ReferenceText(_Model):
    """What R is measured against: the source's own field, another one, or a formula approximated by a field."""

    kind: Literal["source", "field", "formula"]
    field: FieldText | None = None
    formula: Text | None = None
    label: Text = ""


class ImageText(_Model):
    """An image."""

    values: ArrayName
    spacing: tuple[float, float]
    origin: tuple[float, float]
    label: Text


class InputText(_Model):
    """A file beside the study that the source is read from again."""

    path: Annotated[str, Field(min_length=1, max_length=1000)]
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
    image_size: Literal["curvature", "intensity"] = "curvature"


class SourceText(_Model):
    """A source: embedded (``field`` and what belongs to it), or linked (``input``)."""

    name: Text
    label: Text
    provenance: dict[str, Any]
    domain: DomainText
    field: FieldText | None = None
    reference: ReferenceText | None = None
    image: ImageText | None = None
    input: InputText | None = None


class StrokeText(_Model):
    """A painted stroke; its path is that many of the points of all strokes."""

    brush: dict[str, Any]
    shape: Literal["freehand", "line", "polygon"]
    n_points: Annotated[int, Field(ge=1, le=10_000_000)]


class MeshText(_Model):
    """A mesh of quadrilaterals."""

    points: ArrayName
    quads: ArrayName
    curve: ArrayName
    fixed: ArrayName


class ReportText(_Model):
    """The judgement of a mesh."""

    least: ArrayName
    sizes: dict[Literal["mean-edge", "sqrt-area", "max-edge"], ArrayName]
    quality: ArrayName
    n_nodes: Annotated[int, Field(ge=0)]
    irregular: float
    beta: Annotated[float, Field(gt=0)]
    ideal_quads: float | None = None


class GuaranteeText(_Model):
    """What the guarantee reached; each element left over has the number of its reason."""

    n_quads: Annotated[int, Field(ge=0)]
    elements: ArrayName
    ratios: ArrayName
    reasons: list[Text]
    reason: ArrayName


class RunText(_Model):
    """One method's results."""

    target: FieldText | None = None
    raw: MeshText | None = None
    mesh: MeshText | None = None
    report: ReportText | None = None
    tight: FieldText | None = None
    guarantee: GuaranteeText | None = None
    seconds: dict[str, Annotated[float, Field(ge=0)]]


class StudyText(_Model):
    """The whole text."""

    format: Literal["sizeviz-study"]
    version: int
    versions: dict[str, Text]
    source: SourceText
    backgrounds: dict[BackgroundName, BackgroundText]
    original: FieldText | None = None
    strokes: list[StrokeText]
    stroke_points: ArrayName | None = None
    options: dict[str, Any]
    runs: dict[Annotated[str, Field(pattern=r"^[a-z-]{1,40}$")], RunText]
    origin: Annotated[str, Field(max_length=4000)] | None = None


def validated(tree: dict[str, Any]) -> StudyText:
    """Return the text of a study, brought up to date and checked.

    Raises
    ------
    InputError
        If it is no study's, of a newer version, or a value is missing, unknown or wrong; the message names the field.
    """
    if tree.get("format") != FORMAT:
        raise InputError(f"study.json: format is {one_line(tree.get('format'), 40)!r}, not {FORMAT!r}; it is no study")
    version = tree.get("version")
    if type(version) is not int or version < 1:
        raise InputError(f"study.json: version is {one_line(version, 40)!r}; a whole number from 1 was expected")
    if version > VERSION:
        raise InputError(f"it was written by a newer sizeviz (study version {version}, known up to {VERSION}); update")
    while version < VERSION:
        tree = {**MIGRATIONS[version](tree), "version": version + 1}
        version += 1
    try:
        return StudyText.model_validate_json(json.dumps(tree))
    except ValidationError as error:
        raise _named(error, "study.json") from None


def dataclass_of(kind: type[Plain], tree: Any, where: str) -> Plain:
    """Return an options dataclass from plain values; each is checked, and so is every name.

    Raises
    ------
    InputError
        If a value is missing, unknown or wrong; the message names the field.
    """
    _refuse_unknown(kind, tree, where)
    try:
        return TypeAdapter(kind).validate_json(json.dumps(tree), strict=True)
    except ValidationError as error:
        raise _named(error, where) from None


def _refuse_unknown(kind: Any, tree: Any, where: str) -> None:
    if not (dataclasses.is_dataclass(kind) and isinstance(tree, dict)):
        return
    fields = {field.name: field for field in dataclasses.fields(kind)}
    for name, value in tree.items():
        if name not in fields:
            raise InputError(f"{where}.{one_line(name, 40)}: there is no such option; the file is corrupt")
        factory = fields[name].default_factory
        if isinstance(factory, type):
            _refuse_unknown(factory, value, f"{where}.{name}")


def _named(error: ValidationError, where: str) -> InputError:
    first = error.errors(include_url=False, include_input=False)[0]
    name = ".".join([where, *(one_line(part, 40) for part in first["loc"])])
    more = f" (and {error.error_count() - 1} more)" if error.error_count() > 1 else ""
    return InputError(f"{name}: {one_line(first['msg'].removeprefix('Value error, '))}{more}")
