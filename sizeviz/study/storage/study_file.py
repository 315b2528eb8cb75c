"""Study files, ``.sizeviz``: everything that a session made, written whole or not at all and checked when read."""

from __future__ import annotations

import contextlib
import glob
import hashlib
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError
from sizeviz.files.guard import guarded, load, one_line
from sizeviz.sources import Source
from sizeviz.sources import load as load_source
from sizeviz.sources.painting import Brush, Stroke
from sizeviz.study.options import StudyOptions
from sizeviz.study.report import versions
from sizeviz.study.storage.archive import ArrayWriter, read_archive, write_archive
from sizeviz.study.storage.nouns import FLOATS, Packer, Unpacker
from sizeviz.study.storage.schema import FORMAT, VERSION, SourceText, StudyText, dataclass_of, validated
from sizeviz.study.study import Study

if TYPE_CHECKING:
    from sizeviz.sizing import SizeField

_OLD = 24 * 3600.0
"""Age in seconds at which a half-written file cannot belong to a running save."""

SUFFIX = ".sizeviz"
"""What the name of a study file ends in."""


@dataclass(frozen=True, eq=False)
class StudyFile:
    """What a study file holds.

    Parameters
    ----------
    study : Study
        The source, the options and the results.
    strokes : sequence of Stroke
        What was painted, in order.
    original : SizeField, optional
        The field before painting, which the erasing brush brings back.
    view : mapping
        How the study was looked at, and the layout of the window: plain values, kept apart from the study.
    origin : str, optional
        Of an autosave, the study file that it belongs to.
    """

    study: Study
    strokes: tuple[Stroke, ...] = ()
    original: SizeField | None = None
    view: Mapping[str, Any] = field(default_factory=dict)
    origin: str | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "strokes", tuple(self.strokes))
        object.__setattr__(self, "view", MappingProxyType(dict(self.view)))


def write_study(path: str | Path, content: StudyFile, *, embed: bool = True) -> Path:
    """Write a study file, whole or not at all; equal studies give equal bytes.

    Parameters
    ----------
    path : path-like
        Where to.
    content : StudyFile
        What.
    embed : bool
        Whether the source itself goes in, so that the file stands alone. Otherwise a source that was read from a file
        in the study's folder, and not painted on, is kept as its relative path and SHA-256. Default True.

    Raises
    ------
    InputError
        If the place cannot be written, or the study holds a Python function.
    """
    path = Path(path)
    _clear_old_halves(path)
    writer = ArrayWriter()
    packer = Packer(writer)
    study = content.study
    text = {
        "format": FORMAT,
        "version": VERSION,
        "versions": versions(),
        "source": _packed_source(path, content, packer, embed),
        "original": None if content.original is None else packer.field(content.original),
        "strokes": [_packed_stroke(stroke) for stroke in content.strokes],
        "stroke_points": None,
        "options": asdict(study.options),
        "runs": {method: packer.run(run) for method, run in study.runs.items()},
        "origin": content.origin,
        "backgrounds": packer.backgrounds,
    }
    if content.strokes:
        text["stroke_points"] = writer.stored(np.concatenate([stroke.path for stroke in content.strokes]))
    write_archive(path, text, dict(content.view), writer.arrays)
    return path


def read_study(path: str | Path) -> StudyFile:
    """Return what a study file holds; nothing in it is executed.

    Raises
    ------
    InputError
        If the file is missing, corrupt, too large or of a newer version, a value in it is wrong (the message names
        the field), or a file that it refers to is missing or has changed.
    """
    path = Path(path)
    with guarded(str(path), "sizeviz study"):
        tree, view, reader = read_archive(path)
        text = validated(tree)
        unpacker = Unpacker(reader, text.backgrounds)
        options = dataclass_of(StudyOptions, text.options, "study.json: options")
        runs = {method: unpacker.run(run, method) for method, run in text.runs.items()}
        original = None if text.original is None else unpacker.field(text.original, "original")
        study = Study(_source(path, text.source, unpacker), options, runs)
        return StudyFile(study, _strokes(text, unpacker), original, view, text.origin)


def _clear_old_halves(path: Path) -> None:
    """Remove what saves of this file left that were killed half-way, a day ago or earlier."""
    with contextlib.suppress(OSError):
        for half in path.parent.glob(f".{glob.escape(path.stem[:80])}.*.part{path.suffix}"):
            if time.time() - half.stat().st_mtime > _OLD:
                half.unlink(missing_ok=True)


def _packed_source(path: Path, content: StudyFile, packer: Packer, embed: bool) -> dict[str, Any]:
    source = content.study.source
    text: dict[str, Any] = {
        "name": source.name,
        "label": source.label,
        "provenance": {name: _plain(value) for name, value in source.provenance.items()},
        "domain": packer.domain(source.domain),
    }
    linked = None if embed or content.strokes else _link(path, source)
    if linked is not None:
        return {**text, "input": linked}
    reference = packer.reference(source.reference, source.field)
    return {**text, "field": packer.field(source.field), "reference": reference, "image": packer.image(source.image)}


def _link(path: Path, source: Source) -> dict[str, Any] | None:
    """Return the relative path and checksum of the file that a source was read from, if it lies with the study."""
    if source.provenance.get("kind") not in ("picture", "field") or source.provenance.get("strokes"):
        return None
    file, folder = Path(str(source.provenance.get("path"))).resolve(), path.resolve().parent
    if not file.is_relative_to(folder) or file.suffix.lower() in (".sol", ".mesh"):  # a pair has no one checksum
        return None
    link = {"path": file.relative_to(folder).as_posix(), "sha256": hashlib.sha256(load(file)).hexdigest()}
    return {**link, "image_size": str(source.provenance.get("image_size", "curvature"))}


def _source(path: Path, text: SourceText, unpacker: Unpacker) -> Source:
    domain = unpacker.domain(text.domain)
    if text.input is not None:
        file = _beside(path, text.input.path)
        if hashlib.sha256(load(file)).hexdigest() != text.input.sha256:
            raise InputError(f"its input {one_line(text.input.path)} has changed since; restore it, or open it anew")
        return load_source(str(file), domain, image_size=text.input.image_size)
    if text.field is None:
        raise InputError("study.json: source has neither field nor input; the file is corrupt")
    sizes = unpacker.field(text.field, "source.field")
    reference, image = unpacker.reference(text.reference, sizes), unpacker.image(text.image)
    return Source(text.name, text.label, domain, sizes, reference, image, text.provenance)


def _beside(path: Path, name: str) -> Path:
    """Return a file in the study's folder or below it, whatever links there are.

    Raises
    ------
    InputError
        If the name leads anywhere else.
    """
    relative = PurePosixPath(name)
    folder = path.resolve().parent
    file = (folder / relative).resolve()
    if relative.is_absolute() or ".." in relative.parts or "\\" in name or not file.is_relative_to(folder):
        raise InputError(f"its input {one_line(name)!r} lies outside the study's folder; put the file beside the study")
    return file


def _packed_stroke(stroke: Stroke) -> dict[str, Any]:
    return {"brush": asdict(stroke.brush), "shape": stroke.shape, "n_points": len(stroke.path)}


def _strokes(text: StudyText, unpacker: Unpacker) -> tuple[Stroke, ...]:
    if not text.strokes:
        return ()
    if text.stroke_points is None:
        raise InputError("study.json: stroke_points is missing; the file is corrupt")
    points = unpacker.reader.array(text.stroke_points, FLOATS, "stroke_points")
    stops = np.cumsum([stroke.n_points for stroke in text.strokes])
    if points.ndim != 2 or points.shape != (stops[-1], 2):
        raise InputError(f"study.json: stroke_points has shape {points.shape} for {stops[-1]} points; it is corrupt")
    paths = np.split(points, stops[:-1])
    brushes = [dataclass_of(Brush, s.brush, f"study.json: strokes.{k}.brush") for k, s in enumerate(text.strokes)]
    return tuple(Stroke(b, p, s.shape) for b, p, s in zip(brushes, paths, text.strokes, strict=True))


def _plain(value: Any) -> Any:
    """Return a provenance value as JSON can hold it."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {str(name): _plain(inner) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    return value if isinstance(value, str | int | float | bool | None) else str(value)
