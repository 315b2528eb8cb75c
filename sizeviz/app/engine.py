"""What the window asks of the rest of sizeviz: the same pipeline as the command line's, behind one small door.

Everything heavy is imported inside the calls, on the worker, so that the window is there before numba is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, Protocol

from sizeviz.compiled import prepared
from sizeviz.monitor import SILENT, Monitor, SubMonitor
from sizeviz.threads import default_threads

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sizeviz.sizing import SizeField
    from sizeviz.sources import Source
    from sizeviz.study import Study, StudyOptions

LIMITED, PRESERVED = "gradient-limiting", "size-preserving"
"""The methods whose fields follow the brush."""

LIVE_NODES = 512 * 512 + 2 * 512 + 1
"""Fields with at most so many nodes (513 x 513) are limited and preserved while the brush moves."""


@dataclass(frozen=True)
class Example:
    """An entry of the gallery."""

    name: str
    title: str
    words: str


@dataclass(frozen=True, eq=False)
class Preview:
    """What the brush shows before it is lifted; ``targets`` by method, as far as they were computed."""

    field: SizeField
    targets: dict[str, SizeField]

    @property
    def is_live(self) -> bool:
        """Whether the field is small enough for its processed fields to follow the brush."""
        return len(self.field.sizes) <= LIVE_NODES


@dataclass(frozen=True, eq=False)
class Processed:
    """Fields that were processed, to process the next ones from: ``targets`` are ``field``'s under ``options``."""

    field: SizeField
    options: StudyOptions
    targets: dict[str, SizeField]


class Engine(Protocol):
    """The pipeline as the window sees it."""

    def examples(self) -> Sequence[Example]:
        """Return the gallery."""

    def load(self, spec: str, monitor: Monitor = SILENT) -> Source:
        """Return an example, a file or a formula as a source."""

    def canvas(self, nodes: int, size: float) -> Source:
        """Return a blank canvas: one size everywhere on the unit square."""

    def run(self, study: Study, method: str, monitor: Monitor = SILENT) -> Study:
        """Return the study with one method complete."""

    def targets(
        self, field: SizeField, options: StudyOptions, since: Processed | None = None, monitor: Monitor = SILENT
    ) -> dict[str, SizeField]:
        """Return the limited and the preserved field, by method; from earlier ones where that is quicker."""

    def default_options(self) -> StudyOptions:
        """Return the options a new study starts from."""


class PipelineEngine:
    """The real pipeline."""

    def examples(self) -> Sequence[Example]:
        """Return the gallery of examples that every install can show."""
        from sizeviz.sources import examples

        return [
            Example(entry.name, title_of(entry.name), f"{entry.label}. {entry.description}") for entry in examples()
        ]

    def load(self, spec: str, monitor: Monitor = SILENT) -> Source:
        """Return an example, a file or ``expr:FORMULA`` as a source."""
        import_module("sizeviz.study")  # the window needs it next: loaded here, it does not hold the window up
        rest = prepared(monitor)
        from sizeviz.sources import load

        return load(spec, monitor=rest)

    def canvas(self, nodes: int, size: float) -> Source:
        """Return a blank canvas: one size everywhere on the unit square, ``nodes`` along each side."""
        import numpy as np

        from sizeviz.geometry import Domain
        from sizeviz.sizing import BackgroundMesh, SizeField
        from sizeviz.sources import Source

        background = BackgroundMesh.unit_square_grid(nodes, nodes)
        field = SizeField(background, np.full(nodes * nodes, size), "blank canvas")
        return Source(
            name="canvas",
            label="Blank canvas",
            domain=Domain.unit_square(),
            field=field,
            reference=field,
            image=None,
            provenance={"kind": "canvas", "nodes": nodes, "size": size},
        )

    def run(self, study: Study, method: str, monitor: Monitor = SILENT) -> Study:
        """Return the study with one method complete, as the command line would run it."""
        rest = prepared(monitor)
        from sizeviz.study import run

        return run(study, (method,), rest)

    def targets(
        self, field: SizeField, options: StudyOptions, since: Processed | None = None, monitor: Monitor = SILENT
    ) -> dict[str, SizeField]:
        """Return the limited and the preserved field, by method.

        Under a brush only what the newest change reaches is done again. One core is left to the window, which is
        drawing the stroke meanwhile.
        """
        monitor = prepared(monitor)
        from sizeviz.sizing.again import processed_again
        from sizeviz.sizing.envelopes import limited, preserved

        threads = options.threads or max(1, default_threads() - 1)
        first, second = SubMonitor(monitor, 0.0, 0.5), SubMonitor(monitor, 0.5, 1.0)
        asked = _asked(field, options)
        if since is None or since.options != options or set(since.targets) != {LIMITED, PRESERVED}:
            return {
                LIMITED: limited(asked, options.limit, threads, first),
                PRESERVED: preserved(field, options.preserve, threads, second),
            }
        before, targets = since.field, since.targets
        return {
            LIMITED: processed_again(asked, options.limit, _asked(before, options), targets[LIMITED], threads, first),
            PRESERVED: processed_again(field, options.preserve, before, targets[PRESERVED], threads, second),
        }

    def default_options(self) -> StudyOptions:
        """Return defaults with the comparable slope, epsilon = 1/alpha."""
        from sizeviz.study import StudyOptions

        return StudyOptions().with_comparable_slope()


def _asked(field: SizeField, options: StudyOptions) -> SizeField:
    """Return the sizes that limiting starts from: beta times the field."""
    return field if options.beta == 1.0 else field.with_sizes(options.beta * field.sizes)


def title_of(name: str) -> str:
    """Return an example's name as the gallery writes it."""
    return name.upper() if len(name) <= 3 else name.replace("-", " ").capitalize()


def with_field(source: Source, field: SizeField, strokes: int) -> Source:
    """Return a source whose sizes were painted over; R is then judged against what was painted."""
    return replace(source, field=field, reference=field, provenance={**source.provenance, "strokes": strokes})
