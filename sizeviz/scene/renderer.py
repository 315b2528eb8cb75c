"""Show a scene in a pyvista plotter, on a screen or off it, touching only what has changed."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.scene.spec import CellLayer, Color, ImageLayer, Layer, LineLayer, SceneSpec, TriangleLayer

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from sizeviz.scene.camera import Camera2D

EDGE_OPACITY = 0.35
"""Element edges are drawn faintly, so that they never outweigh the colours."""

LIFT = 1e-6
"""How far each layer lies above the one below, relative to the height of view; seen from above it is invisible."""

SLICE = 16_384
"""Cells of one actor. Larger layers become several, so that a window can draw them in pieces, a turn for each."""


@dataclass(frozen=True, eq=False)
class _Part:
    """A run of a layer's cells: rows ``start`` to ``stop``, VTK's copy of them, and the actor that draws it."""

    start: int
    stop: int
    data: Any
    actor: Any


@dataclass(frozen=True, eq=False)
class _Shown:
    """A layer and what draws it."""

    layer: Layer
    parts: tuple[_Part, ...]


class Renderer:
    """Keeps the actors of one plotter in step with the last scene shown.

    Parameters
    ----------
    plotter : pyvista.BasePlotter
        A ``Plotter`` or a ``QtInteractor``; it must be used by one renderer only, on the thread that made it.
    """

    def __init__(self, plotter: Any) -> None:
        self._plotter = plotter
        self._shown: dict[str, _Shown] = {}
        self._made: dict[str, _Shown] = {}
        self.spec: SceneSpec | None = None
        self._edges = False
        plotter.camera_set = True  # it is set by ``look``; asked for unset, pyvista would fit it and draw
        plotter.enable_parallel_projection()
        plotter.remove_all_lights()

    def prepare(self, spec: SceneSpec) -> Iterator[None]:
        """Make what a scene needs and is not there, a run of a layer's cells a step, for ``show`` to take.

        Until then the plotter shows what it showed. A preparation that is not gone through to its end is forgotten.

        Parameters
        ----------
        spec : SceneSpec
            What is to be shown next.
        """
        made: dict[str, _Shown] = {}
        for layer in spec.layers:
            old = self._shown.get(layer.name)
            if old is not None and _same_geometry(old.layer, layer):
                continue
            parts = []
            for part in _parts(layer, made.values()):
                parts.append(part)
                yield
            made[layer.name] = _Shown(layer, tuple(parts))
        self._made = made

    def show(self, spec: SceneSpec, edges: bool | None = None) -> bool:
        """Bring the plotter to a scene; the caller decides when to draw.

        Parameters
        ----------
        spec : SceneSpec
            What to show.
        edges : bool, optional
            Whether element edges are drawn; by default as the scene has it.

        Returns
        -------
        bool
            Whether there is anything to draw.
        """
        if spec is self.spec:
            return False
        differs = self.spec is None or spec.ground != self.spec.ground
        if differs:
            self._plotter.set_background([channel / 255.0 for channel in spec.ground])
        gone = self._shown.keys() - {layer.name for layer in spec.layers}
        for name in gone:
            self._remove(name)
        for layer in spec.layers:
            differs |= self._show_layer(layer)
        if edges is None:
            edges = any(isinstance(layer, CellLayer) and layer.edges is not None for layer in spec.layers)
        differs |= self.show_edges(edges)
        self._shown = {layer.name: self._shown[layer.name] for layer in spec.layers}  # back to front, old and new
        self._made = {}
        self._lift(2.0 * self._plotter.camera.GetParallelScale())
        self.spec = spec
        return differs or bool(gone)

    def look(self, camera: Camera2D) -> None:
        """Point the plotter's camera; the caller decides when to draw."""
        vtk_camera = self._plotter.camera
        vtk_camera.SetFocalPoint(camera.x, camera.y, 0.0)
        vtk_camera.SetPosition(camera.x, camera.y, camera.height)
        vtk_camera.SetViewUp(0.0, 1.0, 0.0)
        vtk_camera.SetParallelScale(0.5 * camera.height)
        vtk_camera.SetClippingRange(0.5 * camera.height, 1.5 * camera.height)
        self._lift(camera.height)

    def show_edges(self, visible: bool) -> bool:
        """Draw or hide the element edges, and what goes with them, composing nothing; return whether it differs."""
        differs = visible != self._edges
        self._edges = visible
        for shown in self._shown.values():
            for part in shown.parts:
                if isinstance(shown.layer, CellLayer):
                    part.actor.GetProperty().SetEdgeVisibility(visible)
                part.actor.SetVisibility(self._is_seen(shown.layer))
        return differs

    def pieces(self) -> list[list[Any]]:
        """Return the actors to be seen, in the pieces that a drawing can be made of: about ``SLICE`` cells each."""
        pieces: list[list[Any]] = [[]]
        room = SLICE
        for shown in self._shown.values():
            if not self._is_seen(shown.layer):
                continue
            for part in shown.parts:
                cells = part.stop - part.start
                if cells > room and pieces[-1]:
                    pieces.append([])
                    room = SLICE
                pieces[-1].append(part.actor)
                room -= cells
        return pieces

    @contextmanager
    def only(self, piece: list[Any]) -> Iterator[None]:
        """Show one piece and hide the others for a while."""
        wanted = set(map(id, piece))
        try:
            for shown in self._shown.values():
                for part in shown.parts:
                    part.actor.SetVisibility(id(part.actor) in wanted)
            yield
        finally:
            for shown in self._shown.values():
                for part in shown.parts:
                    part.actor.SetVisibility(self._is_seen(shown.layer))

    def _lift(self, height: float) -> None:
        for order, shown in enumerate(self._shown.values()):
            for part in shown.parts:
                part.actor.SetPosition(0.0, 0.0, order * LIFT * height)

    def _is_seen(self, layer: Layer) -> bool:
        return self._edges or not (isinstance(layer, LineLayer) and layer.near)

    def _show_layer(self, layer: Layer) -> bool:
        old = self._shown.get(layer.name)
        if old is not None and _same_geometry(old.layer, layer):
            self._shown[layer.name] = _Shown(layer, old.parts)
            if _same_look(old.layer, layer):
                return False
            _recolor(layer, old.parts)
            return True
        self._remove(layer.name)
        made = self._made.get(layer.name)
        if made is None or made.layer is not layer:
            made = _Shown(layer, tuple(_parts(layer, self._shown.values())))
        for part in made.parts:
            part.actor.GetProperty().SetEdgeVisibility(isinstance(layer, CellLayer) and self._edges)
            part.actor.SetVisibility(self._is_seen(layer))
            self._plotter.renderer.AddActor(part.actor)
        self._shown[layer.name] = made
        return True

    def _remove(self, name: str) -> None:
        if name in self._shown:
            for part in self._shown.pop(name).parts:
                self._plotter.renderer.RemoveActor(part.actor)


def is_large(spec: SceneSpec) -> bool:
    """Return whether a scene has more cells than one piece of a drawing, ``SLICE``."""
    return sum(len(_cells(layer)) for layer in spec.layers if not isinstance(layer, ImageLayer)) > SLICE


def _parts(layer: Layer, others: Iterable[_Shown]) -> Iterator[_Part]:
    """Make what draws a layer, a run of cells at a time; lines that one of the others draws already share its data."""
    twin = _twin(layer, others)
    for start, stop, data, texture in _datasets(layer) if twin is None else twin:
        yield _Part(start, stop, data, _actor(layer, data, texture))


def _twin(layer: Layer, others: Iterable[_Shown]) -> list[tuple[int, int, Any, Any]] | None:
    """Return what is there already of the same lines, where these have no colours of their own."""
    if not isinstance(layer, LineLayer) or layer.colors is not None:
        return None
    for shown in others:
        other = shown.layer
        if isinstance(other, LineLayer) and other.points is layer.points and other.segments is layer.segments:
            return [(part.start, part.stop, part.data, None) for part in shown.parts]
    return None


def _actor(layer: Layer, data: Any, texture: Any) -> Any:
    """Return an actor made by VTK's own means: pyvista's takes three times as long, for what is not used here."""
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    rgb = isinstance(layer, CellLayer | TriangleLayer) or (isinstance(layer, LineLayer) and layer.colors is not None)
    mapper.SetScalarVisibility(rgb)
    mapper.SetColorModeToDirectScalars()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.SetPickable(False)
    actor.GetProperty().SetLighting(False)
    if texture is not None:
        actor.SetTexture(texture)
        actor.GetProperty().SetColor(1.0, 1.0, 1.0)  # the texture is multiplied by it
    if isinstance(layer, LineLayer):
        actor.GetProperty().SetColor(*_unit(layer.color))
        actor.GetProperty().SetLineWidth(layer.width if layer.colors is None else 1.0)
    if isinstance(layer, CellLayer):
        actor.GetProperty().SetEdgeColor(*_unit(layer.edges or (40, 40, 40)))
        actor.GetProperty().SetEdgeOpacity(EDGE_OPACITY)
    return actor


def _recolor(layer: Layer, parts: tuple[_Part, ...]) -> None:
    """Give what is shown of a layer its new colours."""
    for part in parts:
        if isinstance(layer, ImageLayer):
            image = part.actor.GetTexture().GetInput()
            image.point_data["rgb"] = layer.colors.reshape(-1, 3)
            continue
        _color(part.data, layer, part.start, part.stop, None if part is parts[0] else parts[0].data)
        if isinstance(layer, CellLayer) and layer.edges is not None:
            part.actor.GetProperty().SetEdgeColor(*_unit(layer.edges))
        elif isinstance(layer, LineLayer):
            part.actor.GetProperty().SetColor(*_unit(layer.color))
            part.actor.GetProperty().SetLineWidth(layer.width)


def _color(data: Any, layer: CellLayer | TriangleLayer | LineLayer, start: int, stop: int, first: Any) -> None:
    """Give a run of a layer's cells its colours; those at points are the first run's, for all runs share the points."""
    if layer.colors is None:
        return
    if not isinstance(layer, TriangleLayer):
        data.GetCellData().SetScalars(_vtk_array(layer.colors[start:stop]))
    elif first is None:
        data.GetPointData().SetScalars(_vtk_array(layer.colors))
    else:
        data.GetPointData().SetScalars(first.GetPointData().GetScalars())


def _same_look(old: Layer, new: Layer) -> bool:
    """Return whether two layers of the same geometry have the same colours and lines."""
    if isinstance(old, LineLayer) and isinstance(new, LineLayer) and (old.color, old.width) != (new.color, new.width):
        return False
    if isinstance(old, CellLayer) and isinstance(new, CellLayer) and old.edges != new.edges:
        return False
    if old.colors is new.colors or old.colors is None or new.colors is None:
        return True
    # a view of the same read-only colours is the same picture
    return np.shares_memory(old.colors, new.colors) or np.array_equal(old.colors, new.colors)


def _same_geometry(old: Layer, new: Layer) -> bool:
    if isinstance(old, CellLayer) and isinstance(new, CellLayer):
        return old.points is new.points and old.quads is new.quads
    if isinstance(old, TriangleLayer) and isinstance(new, TriangleLayer):
        return old.points is new.points and old.triangles is new.triangles
    if isinstance(old, ImageLayer) and isinstance(new, ImageLayer):
        return old.bounds == new.bounds and old.colors.shape == new.colors.shape
    if isinstance(old, LineLayer) and isinstance(new, LineLayer):
        alike = (old.colors is None) == (new.colors is None)
        same_points = old.points is new.points or np.array_equal(old.points, new.points)
        return alike and same_points and np.array_equal(old.segments, new.segments)
    return False


def _datasets(layer: Layer) -> Iterator[tuple[int, int, Any, Any]]:
    """Yield VTK's copies of a layer's runs of cells, and a texture for pictures. Nothing is shared with workers.

    All runs of one layer share one array of points, which VTK hands to OpenGL once.
    """
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    if isinstance(layer, ImageLayer):
        yield 0, 1, _picture_plane(layer), _texture(layer.colors)
        return
    points, cells = layer.points, _cells(layer)
    if isinstance(layer, LineLayer):
        used = np.zeros(len(points), dtype=bool)
        used[cells] = True
        points, cells = points[used], (np.cumsum(used, dtype=np.int32) - 1)[cells]
    shared, first = vtkPoints(), None
    shared.SetData(_vtk_array(_raised(points)))
    for start in range(0, len(cells), SLICE):
        stop = min(start + SLICE, len(cells))
        data, run = vtkPolyData(), vtkCellArray()
        run.SetData(cells.shape[1], _vtk_array(cells[start:stop].ravel()))
        data.SetPoints(shared)
        if isinstance(layer, LineLayer):
            data.SetLines(run)
        else:
            data.SetPolys(run)
        _color(data, layer, start, stop, first)
        first = data if first is None else first
        yield start, stop, data, None


def _vtk_array(values: NDArray[Any]) -> Any:
    """Return VTK's own copy of an array; pyvista's way there takes as long for a thousand values as for a million."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    return numpy_to_vtk(values, deep=True)


def _cells(layer: CellLayer | TriangleLayer | LineLayer) -> NDArray[np.int32]:
    if isinstance(layer, CellLayer):
        return layer.quads
    return layer.triangles if isinstance(layer, TriangleLayer) else layer.segments


def _picture_plane(layer: ImageLayer) -> Any:
    """Return a rectangle whose texture coordinates put the outermost nodes at the centres of the outermost texels."""
    import pyvista

    x0, y0, x1, y1 = layer.bounds
    ny, nx = layer.colors.shape[:2]
    u, v = 0.5 / nx, 0.5 / ny
    plane = pyvista.PolyData(
        np.array([[x0, y0, 0.0], [x1, y0, 0.0], [x1, y1, 0.0], [x0, y1, 0.0]]), faces=[4, 0, 1, 2, 3]
    )
    plane.active_texture_coordinates = np.array([[u, v], [1 - u, v], [1 - u, 1 - v], [u, 1 - v]])
    return plane


def _texture(colors: NDArray[np.uint8]) -> Any:
    import pyvista

    rows, columns = colors.shape[:2]
    image = pyvista.ImageData(dimensions=(columns, rows, 1))
    image.point_data["rgb"] = colors.reshape(-1, 3)  # row 0 is the lowest here, and in VTK
    texture = pyvista.Texture()
    texture.SetInputDataObject(image)
    texture.SetInterpolate(True)
    texture.SetRepeat(False)
    return texture


def _raised(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.column_stack([points, np.zeros(len(points))])


def _unit(color: Color) -> tuple[float, float, float]:
    return color[0] / 255.0, color[1] / 255.0, color[2] / 255.0
