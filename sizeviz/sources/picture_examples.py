"""Examples made from data that matplotlib installs: a slice of a head, a fault's terrain, a coast."""

from __future__ import annotations

import gzip
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from sizeviz.errors import InputError, MissingDependencyError
from sizeviz.files import Image
from sizeviz.geometry import Domain
from sizeviz.sizing import BackgroundMesh, Grid, SizeField
from sizeviz.sources.pictures import extent, size_from_curvature
from sizeviz.sources.source import Source

KILOMETRES_A_DEGREE = 111.2

MRI_TOLERANCE = 1.22e-4
"""Share of the range of intensities: h* at alpha = 2 then asks for about 240,000 elements."""


def mri() -> Source:
    """Return the head of matplotlib's samples, 256 x 256 pixels over the unit square, sizes from 1/700 to 1/20."""
    with gzip.open(_sample("s1045.ima.gz")) as file:
        pixels = np.frombuffer(file.read(), dtype=">u2").reshape(256, 256)[::-1].astype(np.float64)
    image = Image(pixels, (1 / 256, 1 / 256), (1 / 512, 1 / 512), label="MRI slice")
    label = "MRI slice (as section 5.2): sizes from the curvature of an image of a head"
    field = size_from_curvature(image, tolerance=MRI_TOLERANCE, nodes_a_pixel=2)
    return _pictured("mri", label, image, field, Domain.unit_square())


def terrain() -> Source:
    """Return the Jacksboro fault of matplotlib's samples, sizes from the curvature of the ground; in kilometres."""
    with np.load(_sample("jacksboro_fault_dem.npz"), allow_pickle=False) as data:
        heights, south, north = data["elevation"].astype(np.float64)[::-1], float(data["ymin"]), float(data["ymax"])
        step_x, step_y = float(data["dx"]), float(data["dy"])
    east = KILOMETRES_A_DEGREE * np.cos(np.deg2rad(0.5 * (south + north)))
    spacing = float(step_x * east), step_y * KILOMETRES_A_DEGREE
    image = Image(heights, spacing, (0.5 * spacing[0], 0.5 * spacing[1]), label="Jacksboro fault")
    label = "Terrain: sizes from the curvature of the ground at the Jacksboro fault, in kilometres"
    field = size_from_curvature(image, finest=1 / 400, coarsest=1 / 15, tolerance=0.005)
    return _pictured("terrain", label, image, field)


def coast() -> Source:
    """Return the coast of matplotlib's samples: sizes grow steeply with the distance from the shore; in kilometres."""
    with np.load(_sample("topobathy.npz"), allow_pickle=False) as data:
        heights, x, y = (data[key].astype(np.float64) for key in ("topo", "longitude", "latitude"))
    east = KILOMETRES_A_DEGREE * np.cos(np.deg2rad(float(y.mean())))
    spacing = float(abs(x[1] - x[0]) * east), float(abs(y[1] - y[0]) * KILOMETRES_A_DEGREE)
    upright = heights[:: -1 if y[0] > y[-1] else 1]
    image = Image(upright, spacing, (0.5 * spacing[0], 0.5 * spacing[1]), label="coast")
    label = "Coast: sizes that grow with the distance from the shore, in kilometres"
    return _pictured("coast", label, image, _size_from_shore(image))


def _size_from_shore(image: Image, finer: int = 4) -> SizeField:
    """Return sizes of 1/600 of the longer side at height 0, growing with 0.8 of the distance, up to 1/12."""
    from scipy import ndimage  # here, so that listing the examples does not load it

    x0, y0, x1, y1 = extent(image).bounds
    (ny, nx), side = image.shape, max(x1 - x0, y1 - y0)
    count_x, count_y = finer * nx + 1, finer * ny + 1
    at = np.meshgrid(np.linspace(-0.5, ny - 0.5, count_y), np.linspace(-0.5, nx - 0.5, count_x), indexing="ij")
    heights = ndimage.map_coordinates(image.values, at, order=1, mode="nearest")
    grid = Grid(x0, y0, (x1 - x0) / (count_x - 1), (y1 - y0) / (count_y - 1), count_x, count_y)
    spacing = (grid.dy, grid.dx)
    land = heights >= 0.0
    if land.all() or not land.any():
        raise InputError(f"{image.label}: all heights lie on one side of 0, so there is no shore")
    inland = ndimage.distance_transform_edt(land, sampling=spacing)
    offshore = ndimage.distance_transform_edt(~land, sampling=spacing)
    # a node next to the shore is one spacing from the nearest node across it, and half a spacing from the shore
    distance = np.maximum(np.maximum(inland, offshore) - 0.5 * max(spacing), 0.0)
    sizes = np.minimum(side / 600 + 0.8 * distance, side / 12)
    return SizeField(BackgroundMesh.regular(grid), sizes.ravel(), f"size from {image.label}")


def _pictured(name: str, label: str, image: Image, field: SizeField, domain: Domain | None = None) -> Source:
    return Source(
        name=name,
        label=label,
        domain=extent(image) if domain is None else domain,
        field=field,
        reference=field,
        image=image,
        provenance={"kind": "example", "data": "matplotlib sample data"},
    )


def _sample(name: str) -> Path:
    """Return where matplotlib keeps one of its sample files, without importing it."""
    spec = find_spec("matplotlib")
    for folder in (spec.submodule_search_locations or []) if spec else []:
        path = Path(folder) / "mpl-data" / "sample_data" / name
        if path.exists():
            return path
    raise MissingDependencyError(f"matplotlib's sample {name} is not installed; run: python -m pip install matplotlib")
