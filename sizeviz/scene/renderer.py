"""Show a scene in a pyvista plotter, on a screen or off it, touching only what has changed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.scene.spec import CellLayer, Color, ImageLayer, Layer, LineLayer, SceneSpec, TriangleLayer

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sizeviz.scene.camera import Camera2D

EDGE_OPACITY = 0.35
"""Element edges are drawn faintly, so that they never outweigh the colours."""

LIFT = 1e-6
"""How far each layer lies above the one below, relative to the height of view; seen from above it is invisible."""


class Renderer:
    """Keeps the actors of one plotter in step with the last scene shown.

    Parameters
    ----------
    plotter : pyvista.BasePlotter
        A ``Plotter`` or a ``QtInteractor``; it must be used by one renderer only, on the thread that made it.
    """

    def __init__(self, plotter: Any) -> None:
        self._plotter = plotter
        self._shown: dict[str, tuple[Layer, Any, Any]] = {}
        self.spec: SceneSpec | None = None
        self._edges = False
        plotter.camera_set = True  # it is set by ``look``; asked for unset, pyvista would fit it and draw
        plotter.enable_parallel_projection()
        plotter.remove_all_lights()

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
        for order, layer in enumerate(spec.layers):
            differs |= self._show_layer(layer, order)
        if edges is None:
            edges = any(isinstance(layer, CellLayer) and layer.edges is not None for layer in spec.layers)
        differs |= self.show_edges(edges)
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
        for order, name in enumerate(self._shown):
            self._shown[name][2].SetPosition(0.0, 0.0, order * LIFT * camera.height)

    def show_edges(self, visible: bool) -> bool:
        """Draw or hide the element edges, and what goes with them, composing nothing; return whether it differs."""
        differs = visible != self._edges
        self._edges = visible
        for layer, _, actor in self._shown.values():
            if isinstance(layer, CellLayer):
                actor.prop.SetEdgeVisibility(visible)
            elif isinstance(layer, LineLayer) and layer.near:
                actor.SetVisibility(visible)
        return differs

    def _show_layer(self, layer: Layer, order: int) -> bool:
        old = self._shown.get(layer.name)
        if old is not None and _same_geometry(old[0], layer):
            self._shown[layer.name] = (layer, *old[1:])
            if _same_look(old[0], layer):
                return False
            _recolor(layer, *old[1:])
            return True
        self._remove(layer.name)
        data, texture = _dataset(layer)
        actor = self._add(layer, data, texture)
        actor.SetPosition(0.0, 0.0, order * LIFT * 2.0 * self._plotter.camera.GetParallelScale())
        self._shown[layer.name] = (layer, data, actor)
        return True

    def _add(self, layer: Layer, data: Any, texture: Any) -> Any:
        """Add an actor by VTK's own means: pyvista's takes three times as long, for what is not used here."""
        import pyvista
        from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

        mapper = vtkPolyDataMapper()
        mapper.SetInputData(data)
        rgb = isinstance(layer, CellLayer | TriangleLayer) or (
            isinstance(layer, LineLayer) and layer.colors is not None
        )
        mapper.SetScalarVisibility(rgb)
        mapper.SetColorModeToDirectScalars()
        actor = pyvista.Actor(mapper=mapper, name=layer.name)
        actor.SetPickable(False)
        actor.prop.SetLighting(False)
        if texture is not None:
            actor.SetTexture(texture)
            actor.prop.SetColor(1.0, 1.0, 1.0)  # the texture is multiplied by it
        if isinstance(layer, LineLayer):
            actor.prop.SetColor(*_unit(layer.color))
            actor.prop.SetLineWidth(layer.width if layer.colors is None else 1.0)
        if isinstance(layer, CellLayer):
            actor.prop.SetEdgeColor(*_unit(layer.edges or (40, 40, 40)))
            actor.prop.SetEdgeOpacity(EDGE_OPACITY)
        self._plotter.renderer.AddActor(actor)
        return actor

    def _remove(self, name: str) -> None:
        if name in self._shown:
            self._plotter.renderer.RemoveActor(self._shown.pop(name)[2])


def _recolor(layer: Layer, data: Any, actor: Any) -> None:
    """Give what is shown of a layer its new colours."""
    if isinstance(layer, CellLayer):
        data.cell_data["rgb"] = layer.colors
        if layer.edges is not None:
            actor.prop.SetEdgeColor(*_unit(layer.edges))
    elif isinstance(layer, TriangleLayer):
        data.point_data["rgb"] = layer.colors
    elif isinstance(layer, ImageLayer):
        image = actor.GetTexture().GetInput()
        image.point_data["rgb"] = layer.colors.reshape(-1, 3)
    else:
        actor.prop.SetColor(*_unit(layer.color))
        actor.prop.SetLineWidth(layer.width)
        if layer.colors is not None:
            data.cell_data["rgb"] = layer.colors


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


def _dataset(layer: Layer) -> tuple[Any, Any]:
    """Return VTK's copy of a layer's geometry, and a texture for pictures. Nothing is shared with workers."""
    import pyvista

    if isinstance(layer, ImageLayer):
        return _picture_plane(layer), _texture(layer.colors)
    if isinstance(layer, LineLayer):
        used = np.zeros(len(layer.points), dtype=bool)
        used[layer.segments] = True
        renumbered = np.cumsum(used) - 1
        lines = np.empty((len(layer.segments), 3), dtype=np.int64)
        lines[:, 0], lines[:, 1:] = 2, renumbered[layer.segments]
        data = pyvista.PolyData(_raised(layer.points[used]), lines=lines.ravel())
        if layer.colors is not None:
            data.cell_data["rgb"] = layer.colors.copy()
        return data, None
    cells = layer.quads if isinstance(layer, CellLayer) else layer.triangles
    data = pyvista.PolyData.from_regular_faces(_raised(layer.points), cells)
    target = data.cell_data if isinstance(layer, CellLayer) else data.point_data
    target["rgb"] = layer.colors.copy()
    return data, None


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
