"""Size, mesh, smooth, judge: the options of the pipeline, each as an intent to change it."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from qtpy.QtCore import QSignalBlocker, Signal
from qtpy.QtWidgets import QCheckBox, QHBoxLayout, QPushButton, QSpinBox, QVBoxLayout, QWidget

from sizeviz.app.panels.controls import Form, LogNumber, choice, choose, hint, number
from sizeviz.scene.subject import MEASURE_TITLES

if TYPE_CHECKING:
    from sizeviz.study import StudyOptions


MESHERS = ("frontal", "decomposition", "gmsh")
"""The generators' names; the generators themselves are not imported, for the window is there before numba is."""


class OptionsPanel(Form):
    """A panel that changes the study's options.

    Signals
    -------
    changed(callable, str, str)
        How to make the new options of the old, words for the history, and a key under which quick changes melt.
    """

    changed = Signal(object, str, str)

    @abstractmethod
    def show_options(self, options: StudyOptions) -> None:
        """Show the options as they are, without telling."""

    def _tell(self, stage: str, name: str, value: Any, words: str) -> None:
        def make(options: StudyOptions) -> StudyOptions:
            changes: dict[str, Any] = {stage: replace(getattr(options, stage), **{name: value})}
            return replace(options, **changes)

        self.changed.emit(make, words, f"{stage}.{name}")


class SizePanel(OptionsPanel):
    """Gradient limiting and size preserving."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.alpha = LogNumber(0.25, 8.0, 2.0)
        self.beta = LogNumber(0.25, 1.0, 1.0)
        self.epsilon = LogNumber(0.05, 2.0, 0.5)
        self.comparable = QCheckBox("Comparable: ε = 1/α")
        self.comparable.setChecked(True)
        self.distance = choice([("straight", "euclidean"), ("along edges", "edges")])
        self.note = hint()
        self.add("α  radius", self.alpha, "Size preserving: no smaller size within a ball of α elements, Algorithm 1")
        self.add("β  scale", self.beta, "Size asked for, relative to the field, eq. (3); below 1 is stricter")
        self.add("ε  slope", self.epsilon, "Gradient limiting: |h(x) − h(y)| ≤ ε |x − y|, eq. (2)")
        self.comparable.setToolTip("Both methods then let sizes grow alike, so that they are compared like with like")
        self.add_wide(self.comparable)
        self.add("Distance", self.distance, "Straight lines are exact; along edges follows Algorithms 1 and 2")
        self.add_wide(self.note)
        self.alpha.changed.connect(self._alpha)
        self.beta.changed.connect(lambda v: self._tell("preserve", "beta", v, f"β = {v:g}"))
        self.epsilon.changed.connect(lambda v: self._tell("limit", "epsilon", v, f"ε = {v:g}"))
        self.comparable.toggled.connect(self._comparable)
        self.distance.currentIndexChanged.connect(self._distance)

    def show_options(self, options: StudyOptions) -> None:
        """Show α, β, ε, and slope, growth and α side by side."""
        limit, preserve = options.limit, options.preserve
        self.alpha.set_value(preserve.alpha)
        self.beta.set_value(preserve.beta)
        self.epsilon.set_value(limit.epsilon)
        with QSignalBlocker(self.comparable):
            self.comparable.setChecked(abs(limit.epsilon * preserve.alpha - 1.0) < 1e-3)
        self.epsilon.setEnabled(not self.comparable.isChecked())
        choose(self.distance, preserve.distance)
        slope = preserve.beta / preserve.alpha
        self.note.setText(
            f"Limited: slope {limit.epsilon:.3g}, growth × {1 + limit.epsilon:.3g}<br>"
            f"Preserved: α {preserve.alpha:.3g}, slope ≤ {slope:.3g}, growth × {1 + slope:.3g}"
        )

    def _alpha(self, value: float) -> None:
        comparable = self.comparable.isChecked()

        def make(options: StudyOptions) -> StudyOptions:
            changed = replace(options, preserve=replace(options.preserve, alpha=value))
            return changed.with_comparable_slope() if comparable else changed

        self.changed.emit(make, f"α = {value:g}", "preserve.alpha")

    def _comparable(self, on: bool) -> None:
        self.epsilon.setEnabled(not on)
        if on:
            self.changed.emit(lambda options: options.with_comparable_slope(), "ε = 1/α", "")

    def _distance(self) -> None:
        value = self.distance.currentData()

        def make(options: StudyOptions) -> StudyOptions:
            limit, preserve = replace(options.limit, distance=value), replace(options.preserve, distance=value)
            return replace(options, limit=limit, preserve=preserve)

        self.changed.emit(make, f"distance {self.distance.currentText()}", "")


class MeshPanel(OptionsPanel):
    """The mesher."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        meshers = [name for name in MESHERS if name != "gmsh" or find_spec("gmsh") is not None]
        self.mesher = choice([(name, name) for name in meshers])
        self.scale = number(0.87, 0.1, 4.0, 3)
        self.preset = choice([("direct", "direct"), ("fast: split in four", "fast")])
        self.seed = QSpinBox()
        self.seed.setRange(0, 9999)
        self.add("Mesher", self.mesher, "How quadrilaterals are made; every mesh is quadrilaterals only")
        self.add("Mesh scale", self.scale, "Element size asked for, relative to the field; one for every method")
        self.add("Preset", self.preset, "Direct places every node by the field; fast splits a mesh of twice the size")
        self.add("Seed", self.seed, "The same seed gives the same mesh")
        self.mesher.currentIndexChanged.connect(lambda: self._menu("mesher", self.mesher))
        self.preset.currentIndexChanged.connect(lambda: self._menu("preset", self.preset))
        self.scale.valueChanged.connect(lambda v: self._tell("mesh", "scale", v, f"mesh scale {v:g}"))
        self.seed.valueChanged.connect(lambda v: self._tell("mesh", "seed", v, f"seed {v}"))

    def show_options(self, options: StudyOptions) -> None:
        """Show the mesher's options."""
        choose(self.mesher, options.mesh.mesher)
        choose(self.preset, options.mesh.preset)
        with QSignalBlocker(self.scale), QSignalBlocker(self.seed):
            self.scale.setValue(options.mesh.scale)
            self.seed.setValue(options.mesh.seed)

    def _menu(self, name: str, box: Any) -> None:
        self._tell("mesh", name, box.currentData(), f"{name} {box.currentData()}")


class SmoothPanel(OptionsPanel):
    """Clean-up and smoothing."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.smoothing = QCheckBox("Smooth and clean up")
        self.cleanup = QCheckBox("Improve the connectivity")
        self.sweeps, self.rounds = QSpinBox(), QSpinBox()
        self.sweeps.setRange(0, 200)
        self.rounds.setRange(0, 20)
        self.floor = number(0.78, 0.0, 0.99, 2)
        self.objective = choice(
            [("size and shape", "reciprocal"), ("size and shape, eq. (7)", "paper"), ("shape alone", "shape")]
        )
        self.smoothing.setToolTip("Off shows the raw mesh as the generator left it")
        self.cleanup.setToolTip("Fewer irregular nodes, by local operations on the mesh")
        self.add_wide(self.smoothing)
        self.add_wide(self.cleanup)
        self.add("Objective", self.objective, "Distortion that is lowered: section 4, eq. (7)")
        self.add("Sweeps", self.sweeps, "Passes over all nodes at the end")
        self.add("Clean-up rounds", self.rounds, "Passes of wide clean-up, each followed by three sweeps")
        self.add("Quality floor", self.floor, "The worst elements are raised to this quality where moves can")
        self.smoothing.toggled.connect(self._smoothing)
        self.cleanup.toggled.connect(lambda on: self._tell("smooth", "cleanup", on, f"clean-up {_on(on)}"))
        self.sweeps.valueChanged.connect(lambda v: self._tell("smooth", "sweeps", v, f"{v} sweeps"))
        self.rounds.valueChanged.connect(lambda v: self._tell("smooth", "rounds", v, f"{v} clean-up rounds"))
        self.floor.valueChanged.connect(lambda v: self._tell("smooth", "floor", v, f"quality floor {v:g}"))
        self.objective.currentIndexChanged.connect(self._objective)

    def show_options(self, options: StudyOptions) -> None:
        """Show the smoother's options; with smoothing off the rest is out of reach."""
        smooth = options.smooth
        shown = ((self.smoothing, options.smoothing), (self.cleanup, smooth.cleanup))
        for box, on in shown:
            with QSignalBlocker(box):
                box.setChecked(on)
        for spin, value in ((self.sweeps, smooth.sweeps), (self.rounds, smooth.rounds), (self.floor, smooth.floor)):
            with QSignalBlocker(spin):
                spin.setValue(value)
            spin.setEnabled(options.smoothing)
        choose(self.objective, smooth.objective)
        for control in (self.cleanup, self.objective):
            control.setEnabled(options.smoothing)

    def _smoothing(self, on: bool) -> None:
        self.changed.emit(lambda options: replace(options, smoothing=on), f"smoothing {_on(on)}", "")

    def _objective(self) -> None:
        value = self.objective.currentData()
        self._tell("smooth", "objective", value, f"objective: {self.objective.currentText()}")


class JudgePanel(Form):
    """How elements are measured, and when the pipeline runs."""

    measure_chosen = Signal(str)
    automatic_toggled = Signal(bool)
    apply_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.measure = choice([(words, name) for name, words in MEASURE_TITLES.items()])
        self.automatic = QCheckBox("Update by itself while quick")
        self.automatic.setChecked(True)
        self.apply = QPushButton("Apply")
        self.apply.setProperty("primary", True)
        self.apply.setEnabled(False)
        self.note = hint("Up to date")
        self.add("Size of an element", self.measure, "μ(e) of R(e) = μ(e) / (β min h over e), eq. (3)")
        self.footer = QWidget()
        self.automatic.setToolTip("Studies whose last run took up to 3 s run again after every change")
        self.apply.setToolTip("Run what is stale (F5)")
        self._lay_out_footer()
        self.measure.currentIndexChanged.connect(lambda: self.measure_chosen.emit(self.measure.currentData()))
        self.automatic.toggled.connect(self.automatic_toggled)
        self.apply.clicked.connect(self.apply_requested)

    def _lay_out_footer(self) -> None:
        """Keep Apply, and what it would do, in sight under the panels, however far they are scrolled."""
        self.footer.setObjectName("footer")
        column = QVBoxLayout(self.footer)
        column.setContentsMargins(14, 9, 14, 10)
        column.setSpacing(7)
        row = QHBoxLayout()
        row.setSpacing(10)
        row.addWidget(self.apply)
        row.addWidget(self.note, 1)
        column.addLayout(row)
        column.addWidget(self.automatic)

    def show_state(self, missing: int, busy: bool) -> None:
        """Say whether what is shown is up to date."""
        self.apply.setEnabled(missing > 0 and not busy)
        self.note.setText("Running…" if busy and missing else "Stale: press Apply" if missing else "Up to date")


def _on(on: bool) -> str:
    return "on" if on else "off"
