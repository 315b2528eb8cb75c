"""A pipeline that answers at once, or as slowly as a test wants, and a canvas without OpenGL."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np
from qtpy.QtWidgets import QWidget
from scene.fakes import fake_report, lattice, ring_sizes

from sizeviz.app.engine import Example
from sizeviz.errors import InputError
from sizeviz.geometry import Domain
from sizeviz.monitor import SILENT, Monitor
from sizeviz.sizing import BackgroundMesh, SizeField
from sizeviz.sources.source import Source
from sizeviz.study import MethodRun, Study, StudyOptions

SCALES = {"none": 1.4, "gradient-limiting": 1.1, "size-preserving": 0.8, "guaranteed": 2.5}


def fake_source(name: str = "ring", nodes: int = 65, floor: float = 0.02) -> Source:
    background = BackgroundMesh.unit_square_grid(nodes, nodes)
    sizes = SizeField(background, ring_sizes(background.points, floor), name)
    return Source(
        name=name,
        label=name.capitalize(),
        domain=Domain.unit_square(),
        field=sizes,
        reference=sizes,
        image=None,
        provenance={},
    )


@dataclass(eq=False)
class FakeEngine:
    """Meshes are bent lattices; ``seconds`` is how long a run takes, ``fail`` what it raises."""

    seconds: float = 0.0
    fail: Exception | None = None
    n: int = 24
    nodes: int = 65
    calls: list[str] = field(default_factory=list)
    threads: set[int] = field(default_factory=set)

    def examples(self) -> list[Example]:
        return [Example("ring", "Ring", "a steep valley round a circle"), Example("mri", "MRI", "a slice of a head")]

    def load(self, spec: str, monitor: Monitor = SILENT) -> Source:
        self.calls.append(f"load {spec}")
        if "nan" in spec:
            raise InputError(f"{spec}: 3 of 9 sizes are NaN; element sizes must be finite and positive")
        return fake_source(spec.split("/")[-1], self.nodes)

    def canvas(self, nodes: int, size: float) -> Source:
        background = BackgroundMesh.unit_square_grid(nodes, nodes)
        sizes = SizeField(background, np.full(nodes * nodes, size), "canvas")
        return Source(
            name="canvas",
            label="Blank canvas",
            domain=Domain.unit_square(),
            field=sizes,
            reference=sizes,
            image=None,
            provenance={},
        )

    def run(self, study: Study, method: str, monitor: Monitor = SILENT) -> Study:
        self.calls.append(f"run {method}")
        began = time.perf_counter()
        steps = max(int(self.seconds / 0.02), 1)
        for k in range(steps):
            monitor.step(k / steps, f"{method}: mesh")
            time.sleep(self.seconds / steps)
        if self.fail is not None:
            raise self.fail
        mesh = lattice(self.n, 0.05)
        centres = mesh.points[mesh.quads].mean(axis=1)
        asked = (0.8 + np.hypot(*(centres - 0.5).T)) / self.n / SCALES[method] * study.options.preserve.alpha / 2
        target = study.source.field.with_sizes(study.source.field.sizes * 0.9)
        done = time.perf_counter() - began
        run = MethodRun(target, mesh, mesh, fake_report(mesh, asked), {"mesh": done})
        return study.with_run(method, run)

    def targets(self, sizes: SizeField, options: StudyOptions, since=None, monitor: Monitor = SILENT):
        self.calls.append("targets")
        return {
            "gradient-limiting": sizes.with_sizes(sizes.sizes * 0.95),
            "size-preserving": sizes.with_sizes(sizes.sizes * 0.7),
        }

    def default_options(self) -> StudyOptions:
        return StudyOptions().with_comparable_slope()


class FlatCanvas:
    """Remembers what it was shown."""

    is_ready = True
    is_drawing = False

    def __init__(self, parent: QWidget) -> None:
        self._widget = QWidget(parent)
        self.spec = None
        self.camera = None
        self.edges = False
        self.disposed = False

    def preparations(self):
        return []

    def widget(self) -> QWidget:
        return self._widget

    def show_scene(self, spec) -> None:
        self.spec = spec

    def clear(self) -> None:
        self.spec = None

    def look(self, camera) -> None:
        self.camera = camera

    def show_edges(self, visible: bool) -> None:
        self.edges = visible

    def dispose(self) -> None:
        self.disposed = True
