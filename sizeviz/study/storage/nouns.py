"""Fields, domains, meshes and judgements as a study file keeps them, and back."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.conformity import MeshReport
from sizeviz.errors import InputError
from sizeviz.files import Image
from sizeviz.files.guard import MAX_NODES, check_nodes
from sizeviz.geometry import Domain, QuadMesh
from sizeviz.improvement.guarantee import GuaranteeReport
from sizeviz.sizing import BackgroundMesh, Grid, SizeField
from sizeviz.sizing.analytic import AnalyticSize
from sizeviz.sources import Formula
from sizeviz.study.study import MethodRun

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sizeviz.sizing.analytic import SizeFunction
    from sizeviz.study.storage.archive import ArrayReader, ArrayWriter
    from sizeviz.study.storage.schema import (
        BackgroundText,
        DomainText,
        FieldText,
        GuaranteeText,
        ImageText,
        MeshText,
        ReferenceText,
        ReportText,
        RunText,
    )

FLOATS, WHOLE, LONG, FLAGS = "<f8", "<i4", "<i8", "|b1"


class Packer:
    """Turns values into plain text, their arrays put aside; what is shared is stored once."""

    def __init__(self, writer: ArrayWriter) -> None:
        self.writer = writer
        self.backgrounds: dict[str, dict[str, Any]] = {}
        self._names: dict[int, str] = {}

    def background(self, mesh: BackgroundMesh) -> str:
        """Return the name of a background mesh."""
        if id(mesh) not in self._names:
            name = f"b{len(self.backgrounds)}"
            self._names[id(mesh)] = name
            text: dict[str, Any] = {"grid": None if mesh.grid is None else asdict(mesh.grid)}
            if mesh.grid is None or not _is_regular(mesh):
                text |= {"points": self.writer.stored(mesh.points), "triangles": self.writer.stored(mesh.triangles)}
            self.backgrounds[name] = text
        return self._names[id(mesh)]

    def field(self, field: SizeField) -> dict[str, Any]:
        """Return a size field as text."""
        sizes = self.writer.stored(field.sizes)
        return {"background": self.background(field.background), "sizes": sizes, "label": field.label}

    def domain(self, domain: Domain) -> dict[str, Any]:
        """Return a domain as text."""
        return {
            "loops": [self.writer.stored(loop) for loop in domain.loops],
            "corners": [self.writer.stored(marks) for marks in domain.corners],
            "lines": [self.writer.stored(line) for line in domain.lines],
            "fixed_points": self.writer.stored(domain.fixed_points),
            "label": domain.label,
        }

    def reference(self, reference: SizeFunction, field: SizeField) -> dict[str, Any]:
        """Return what R is measured against as text.

        Raises
        ------
        InputError
            If it is a Python function, which a file cannot hold.
        """
        if reference is field:
            return {"kind": "source"}
        if isinstance(reference, SizeField):
            return {"kind": "field", "field": self.field(reference), "label": reference.label}
        if isinstance(reference, AnalyticSize) and isinstance(reference.function, Formula):
            text = reference.function.text
            return {"kind": "formula", "formula": text, "field": self.field(reference.field), "label": reference.label}
        raise InputError(
            f"{reference.label}: sizes given by a Python function cannot be saved; give a formula or a field"
        )

    def image(self, image: Image | None) -> dict[str, Any] | None:
        """Return an image as text."""
        if image is None:
            return None
        values = self.writer.stored(image.values)
        return {"values": values, "spacing": list(image.spacing), "origin": list(image.origin), "label": image.label}

    def mesh(self, mesh: QuadMesh | None) -> dict[str, Any] | None:
        """Return a mesh as text."""
        if mesh is None:
            return None
        return {name: self.writer.stored(getattr(mesh, name)) for name in ("points", "quads", "curve", "fixed")}

    def report(self, report: MeshReport | None) -> dict[str, Any] | None:
        """Return a judgement as text."""
        if report is None:
            return None
        return {
            "least": self.writer.stored(report.least),
            "sizes": {measure: self.writer.stored(sizes) for measure, sizes in report.sizes.items()},
            "quality": self.writer.stored(report.quality),
            "n_nodes": report.n_nodes,
            "irregular": float(report.irregular),
            "beta": float(report.beta),
            "ideal_quads": None if report.ideal_quads is None else float(report.ideal_quads),
        }

    def guarantee(self, guarantee: GuaranteeReport | None) -> dict[str, Any] | None:
        """Return what the guarantee reached as text."""
        if guarantee is None:
            return None
        reasons = sorted(set(guarantee.reasons))
        return {
            "n_quads": guarantee.n_quads,
            "elements": self.writer.stored(guarantee.elements.astype(LONG)),
            "ratios": self.writer.stored(guarantee.ratios),
            "reasons": reasons,
            "reason": self.writer.stored(np.array([reasons.index(r) for r in guarantee.reasons], dtype=WHOLE)),
        }

    def run(self, run: MethodRun) -> dict[str, Any]:
        """Return one method's results as text."""
        return {
            "target": None if run.target is None else self.field(run.target),
            "raw": self.mesh(run.raw),
            "mesh": self.mesh(run.mesh),
            "report": self.report(run.report),
            "tight": None if run.tight is None else self.field(run.tight),
            "guarantee": self.guarantee(run.guarantee),
            "seconds": {stage: float(seconds) for stage, seconds in run.seconds.items()},
        }


class Unpacker:
    """Turns text back into values; what was shared is shared again.

    Parameters
    ----------
    reader : ArrayReader
        The arrays.
    backgrounds : mapping of str to BackgroundText
        The background meshes by name.
    """

    def __init__(self, reader: ArrayReader, backgrounds: Mapping[str, BackgroundText]) -> None:
        self.reader = reader
        self._texts = backgrounds
        self._backgrounds: dict[str, BackgroundMesh] = {}
        self._fields: dict[tuple[str, str, str], SizeField] = {}

    def background(self, name: str) -> BackgroundMesh:
        """Return a background mesh by name."""
        if name not in self._backgrounds:
            if name not in self._texts:
                raise InputError(f"study.json: backgrounds.{name} is missing; the file is corrupt")
            self._backgrounds[name] = self._built(self._texts[name], f"backgrounds.{name}")
        return self._backgrounds[name]

    def _built(self, text: BackgroundText, where: str) -> BackgroundMesh:
        grid = None if text.grid is None else Grid(**text.grid.model_dump())
        if grid is not None:
            check_nodes(grid.nx * grid.ny, f"nodes in {where}", MAX_NODES)
        if text.points is None or text.triangles is None:
            if grid is None:
                raise InputError(
                    f"study.json: {where} has neither a grid nor points and triangles; the file is corrupt"
                )
            return BackgroundMesh.regular(grid)
        points = self.reader.array(text.points, FLOATS, f"{where}.points")
        triangles = self.reader.array(text.triangles, WHOLE, f"{where}.triangles")
        if grid is not None and len(points) != grid.nx * grid.ny:
            raise InputError(f"study.json: {where}.grid does not fit its points; the file is corrupt")
        return BackgroundMesh(points, triangles, grid)

    def field(self, text: FieldText, where: str) -> SizeField:
        """Return a size field."""
        key = (text.background, text.sizes, text.label)
        if key not in self._fields:
            sizes = self.reader.array(text.sizes, FLOATS, f"{where}.sizes")
            grid = self._texts[text.background].grid if text.background in self._texts else None
            if grid is not None and sizes.shape != (grid.nx * grid.ny,):  # asked before the grid is built
                found = f"{sizes.shape} for a grid of {grid.nx} x {grid.ny} nodes"
                raise InputError(f"study.json: {where}.sizes has shape {found}; the file is corrupt")
            self._fields[key] = SizeField(self.background(text.background), sizes, text.label)
        return self._fields[key]

    def domain(self, text: DomainText) -> Domain:
        """Return a domain."""
        arrays = self.reader
        loops = [arrays.array(name, FLOATS, "domain.loops") for name in text.loops]
        corners = tuple(arrays.array(name, FLAGS, "domain.corners") for name in text.corners)
        lines = tuple(arrays.array(name, FLOATS, "domain.lines") for name in text.lines)
        fixed = arrays.array(text.fixed_points, FLOATS, "domain.fixed_points")
        return Domain(loops[0], tuple(loops[1:]), corners, lines, fixed, text.label)

    def reference(self, text: ReferenceText | None, field: SizeField) -> SizeFunction:
        """Return what R is measured against."""
        if text is None or text.kind == "source":
            return field
        if text.field is None or (text.kind == "formula" and text.formula is None):
            raise InputError(f"study.json: source.reference of kind {text.kind!r} is incomplete; the file is corrupt")
        other = self.field(text.field, "source.reference.field")
        return other if text.kind == "field" else AnalyticSize(Formula(text.formula or ""), other, text.label)

    def image(self, text: ImageText | None) -> Image | None:
        """Return an image."""
        if text is None:
            return None
        return Image(self.reader.array(text.values, FLOATS, "source.image"), text.spacing, text.origin, text.label)

    def mesh(self, text: MeshText | None, where: str) -> QuadMesh | None:
        """Return a mesh."""
        if text is None:
            return None
        kinds = {"points": FLOATS, "quads": WHOLE, "curve": WHOLE, "fixed": FLAGS}
        return QuadMesh(**{n: self.reader.array(getattr(text, n), kind, f"{where}.{n}") for n, kind in kinds.items()})

    def report(self, text: ReportText | None, where: str, n_quads: int) -> MeshReport | None:
        """Return a judgement."""
        if text is None:
            return None
        least = self._by_element(text.least, f"{where}.least", n_quads)
        quality = self._by_element(text.quality, f"{where}.quality", n_quads)
        sizes = {m: self._by_element(name, f"{where}.sizes.{m}", n_quads) for m, name in text.sizes.items()}
        if len(sizes) != 3:
            raise InputError(f"study.json: {where}.sizes has {len(sizes)} of 3 measures; the file is corrupt")
        return MeshReport(least, sizes, quality, text.n_nodes, text.irregular, text.beta, text.ideal_quads)

    def run(self, text: RunText, method: str) -> MethodRun:
        """Return one method's results; none may stand without those before it."""
        where = f"runs.{method}"
        parts = (text.target, text.raw, text.mesh, text.report)
        missing = [part is None for part in parts]
        if missing != sorted(missing):
            raise InputError(f"study.json: {where} has a result without the one that it came from; the file is corrupt")
        raw, mesh = self.mesh(text.raw, f"{where}.raw"), self.mesh(text.mesh, f"{where}.mesh")
        target = None if text.target is None else self.field(text.target, f"{where}.target")
        report = self.report(text.report, f"{where}.report", 0 if mesh is None else mesh.n_quads)
        tight = None if text.tight is None else self.field(text.tight, f"{where}.tight")
        reached = self.guarantee(text.guarantee, f"{where}.guarantee")
        return MethodRun(target, raw, mesh, report, text.seconds, tight, reached)

    def guarantee(self, text: GuaranteeText | None, where: str) -> GuaranteeReport | None:
        """Return what the guarantee reached."""
        if text is None:
            return None
        elements = self.reader.array(text.elements, LONG, f"{where}.elements")
        ratios = self.reader.array(text.ratios, FLOATS, f"{where}.ratios")
        reason = self.reader.array(text.reason, WHOLE, f"{where}.reason")
        in_range = ((elements >= 0) & (elements < text.n_quads)).all()
        known = ((reason >= 0) & (reason < len(text.reasons))).all()
        if not (elements.ndim == 1 and elements.shape == ratios.shape == reason.shape and in_range and known):
            raise InputError(f"study.json: {where} does not fit together; the file is corrupt")
        return GuaranteeReport(text.n_quads, elements, ratios, tuple(text.reasons[k] for k in reason))

    def _by_element(self, name: str, where: str, count: int) -> Any:
        values = self.reader.array(name, FLOATS, where)
        if values.shape != (count,):
            raise InputError(f"study.json: {where} has shape {values.shape} for {count} elements; the file is corrupt")
        return values


def _is_regular(mesh: BackgroundMesh) -> bool:
    assert mesh.grid is not None
    again = BackgroundMesh.regular(mesh.grid)
    return np.array_equal(again.points, mesh.points) and np.array_equal(again.triangles, mesh.triangles)
