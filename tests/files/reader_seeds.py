"""Small sound files of every kind that sizeviz reads, made by the libraries that others use."""

from __future__ import annotations

import gzip
import io
import json
import tempfile
import warnings
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from sizeviz.files import write_field, write_mesh
from sizeviz.geometry import QuadMesh
from sizeviz.sizing import BackgroundMesh, Grid, SizeField

FORMULAS = (
    "0.1 + 0.2*x",
    "0.02 + 0.3*sqrt((x - 0.5)**2 + (y - 0.5)**2)",
    "where(x < 0.5, 0.1, 0.2)",
    "min(0.25, abs(hypot(x-.5, y-.5) - .2575) + .25e-3)",
    "maximum(0.01, 0.1*exp(-x*y) + sin(pi*x)**2)",
)


@dataclass(frozen=True)
class Seed:
    """A sound file, and the one that must lie beside it."""

    suffix: str
    data: bytes
    beside: bytes | None = None


def grid_field() -> SizeField:
    """Return a field on a small grid."""
    grid = Grid(-0.5, 1.25, 0.1, 0.2, 6, 5)
    return SizeField(BackgroundMesh.regular(grid), 0.1 + np.random.default_rng(1).random(30))


def triangle_field() -> SizeField:
    """Return a field on a small triangulation that is no grid."""
    flat = grid_field()
    bent = flat.background.points * np.pi + 0.03 * np.sin(7 * flat.background.points[:, ::-1])
    return SizeField(BackgroundMesh(bent, flat.background.triangles), flat.sizes)


def quad_mesh(n: int = 4) -> QuadMesh:
    """Return a small mesh of bent quadrilaterals, its boundary nodes on curve 0 and its corners fixed."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1.5, n)))
    bubble = 0.1 * np.sin(np.pi * x) * np.sin(np.pi * y / 1.5)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.column_stack([corner, corner + 1, corner + n + 1, corner + n]).astype(np.int32)
    on_edge = (x == 0) | (x == 1) | (y == 0) | (y == 1.5)
    fixed = ((x == 0) | (x == 1)) & ((y == 0) | (y == 1.5))
    points = np.column_stack([x + bubble, y - bubble / 3])
    return QuadMesh(points, quads, np.where(on_edge, 0, -1).astype(np.int32), fixed)


@cache
def seeds() -> tuple[Seed, ...]:
    """Return every seed."""
    with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        folder = Path(name)
        return (
            *_own(folder),
            *_studies(folder),
            *_vtk(folder),
            *_pictures(),
            *_medical(folder),
            *_arrays(),
            *_drawings(),
            *_written_out(),
        )


def _own(folder: Path) -> list[Seed]:
    found = []
    for suffix in (".vtu", ".vtk", ".msh", ".pos", ".npz", ".npy"):
        for field in (grid_field(), triangle_field()):
            if suffix != ".npy" or field.background.grid is not None:
                found.append(Seed(suffix, write_field(folder / f"f{suffix}", field).read_bytes()))
    write_field(folder / "f.sol", triangle_field())
    mesh, sizes = (folder / "f.mesh").read_bytes(), (folder / "f.sol").read_bytes()
    found += [Seed(".mesh", mesh, sizes), Seed(".sol", sizes, mesh)]
    for suffix in (".vtu", ".vtk", ".msh", ".mesh"):
        quads = quad_mesh()
        arrays = {"ratio": np.linspace(0, 1, 9)}, {"h": np.linspace(1, 2, 16)}
        found.append(Seed(suffix, write_mesh(folder / f"m{suffix}", quads, *arrays).read_bytes()))
    return found


def _studies(folder: Path) -> list[Seed]:
    """Return a study with one finished run and two strokes."""
    from sizeviz.conformity import MeshReport
    from sizeviz.geometry import Domain
    from sizeviz.sources.painting import Brush, Stroke
    from sizeviz.sources.source import Source
    from sizeviz.study import MethodRun, Study
    from sizeviz.study.storage import StudyFile, write_study

    field, mesh = grid_field(), quad_mesh()
    ones = np.ones(mesh.n_quads)
    report = MeshReport(ones, {"mean-edge": ones, "sqrt-area": ones, "max-edge": ones}, ones, mesh.n_points, 0.0)
    source = Source("s", "seed", Domain.rectangle(*field.background.bounds), field, field)
    run = MethodRun(triangle_field(), mesh, mesh, report, {"mesh": 1.0})
    strokes = (Stroke(Brush(), np.ones((2, 2))), Stroke(Brush(mask=(0.0, 1.0)), np.zeros((3, 2)), "line"))
    content = StudyFile(Study(source).with_run("none", run), strokes, field, {"dark": True})
    return [Seed(".sizeviz", write_study(folder / "s.sizeviz", content).read_bytes())]


def vtk_grid(with_quads: bool = False) -> object:
    """Return a vtkUnstructuredGrid of a line and triangles or quadrilaterals, with sizes at its points."""
    import pyvista

    if with_quads:
        points, rows, kind = quad_mesh().points, quad_mesh().quads, 9
    else:
        points, rows, kind = triangle_field().background.points, triangle_field().background.triangles, 5
    cells = np.concatenate([[2, 0, 1], np.insert(rows, 0, rows.shape[1], axis=1).ravel()])
    space = np.column_stack([points, np.full(len(points), 0.5)])
    grid = pyvista.UnstructuredGrid(cells, [3] + [kind] * len(rows), space)
    grid.point_data["size"] = np.linspace(0.5, 1.5, len(points))
    grid.cell_data["ratio"] = np.arange(len(rows) + 1.0)
    return grid


def vtk_image() -> object:
    """Return a vtkImageData volume of 5 x 4 x 3 points."""
    import pyvista

    image = pyvista.ImageData(dimensions=(5, 4, 3), spacing=(0.5, 0.25, 2.0), origin=(1.0, 2.0, 3.0))
    image.point_data["values"] = np.arange(60, dtype=np.float32) + 1
    return image


def vtk_bytes(data: object, suffix: str, folder: Path, mode: str = "Appended", compressor: str = "ZLib") -> bytes:
    """Return a VTK data set as VTK's own writer stores it.

    Parameters
    ----------
    data : vtkDataSet
        What to write.
    suffix : str
        ``.vtu``, ``.vtp``, ``.vti`` or ``.vtk``.
    folder : Path
        Where to write it for a moment.
    mode : str
        ``Ascii``, ``Binary`` or ``Appended``; of a legacy file, ``Ascii42``, ``Binary42``, ``Ascii51`` or ``Binary51``.
    compressor : str
        ``None``, ``ZLib``, ``LZMA`` or ``LZ4``.
    """
    from vtkmodules import vtkIOLegacy, vtkIOXML

    if suffix == ".vtk":
        writer = vtkIOLegacy.vtkDataSetWriter()
        writer.SetFileVersion(int(mode[-2:]))
        writer.SetFileType(1 if mode.startswith("Ascii") else 2)
    else:
        kind = {".vtu": "UnstructuredGrid", ".vtp": "PolyData", ".vti": "ImageData"}[suffix]
        writer = getattr(vtkIOXML, f"vtkXML{kind}Writer")()
        getattr(writer, f"SetDataModeTo{mode}")()
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
    path = folder / f"v{suffix}"
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    assert writer.Write() == 1
    return path.read_bytes()


def vtk_surface(grid: object) -> object:
    """Return the vtkPolyData of a grid's cells."""
    return grid.extract_surface(algorithm=None, pass_pointid=False, pass_cellid=False)


def _vtk(folder: Path) -> list[Seed]:
    image = vtk_image()
    found = []
    for grid in (vtk_grid(), vtk_grid(with_quads=True)):
        surface = vtk_surface(grid)
        for mode in ("Ascii", "Binary", "Appended"):
            for compressor in ("None", "ZLib", "LZMA"):
                found.append(Seed(".vtu", vtk_bytes(grid, ".vtu", folder, mode, compressor)))
            found.append(Seed(".vtp", vtk_bytes(surface, ".vtp", folder, mode)))
            found.append(Seed(".vti", vtk_bytes(image, ".vti", folder, mode)))
        for mode in ("Ascii42", "Binary42", "Ascii51", "Binary51"):
            found += [Seed(".vtk", vtk_bytes(data, ".vtk", folder, mode)) for data in (grid, surface, image)]
    return found


def pixels(dtype: str = "u1", channels: int = 1) -> np.ndarray:
    """Return a small picture of numbers, ``(7, 9)`` or ``(7, 9, channels)``."""
    top = 255 if dtype == "u1" else 65535
    shape = (7, 9) if channels == 1 else (7, 9, channels)
    return np.random.default_rng(2).integers(0, top, shape).astype(dtype)


def _pictures() -> list[Seed]:
    from PIL import Image

    found = []
    for suffix, kind in ((".png", "PNG"), (".tif", "TIFF"), (".jpg", "JPEG")):
        for array in (pixels(), pixels("u2"), pixels(channels=3), pixels(channels=4)):
            if kind != "JPEG" or (array.dtype == np.uint8 and array.shape[2:] != (4,)):
                buffer = io.BytesIO()
                Image.fromarray(array).save(buffer, kind)
                found.append(Seed(suffix, buffer.getvalue()))
    return found


def nifti_bytes(values: np.ndarray, zooms: tuple[float, ...]) -> bytes:
    """Return an array indexed by x, y, z as a NIfTI file."""
    import nibabel

    image = nibabel.Nifti1Image(values, np.diag([*zooms[:3], 1.0]))
    image.header.set_zooms(zooms)
    return image.to_bytes()


def dicom_bytes(values: np.ndarray, spacing: tuple[float, float] = (0.7, 0.5), **tags: object) -> bytes:
    """Return frames of 16-bit pixels, ``(rows, columns)`` or ``(frames, rows, columns)``, as a DICOM file."""
    import pydicom
    from pydicom.dataset import FileDataset, FileMetaDataset
    from pydicom.uid import ExplicitVRLittleEndian, SecondaryCaptureImageStorage, generate_uid

    meta = FileMetaDataset()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    meta.MediaStorageSOPClassUID = SecondaryCaptureImageStorage
    meta.MediaStorageSOPInstanceUID = generate_uid(prefix="1.2.3.", entropy_srcs=["sizeviz"])
    file = FileDataset(None, {}, file_meta=meta, preamble=b"\0" * 128)
    file.Rows, file.Columns = values.shape[-2:]
    if values.ndim == 3:
        file.NumberOfFrames = len(values)
    file.SamplesPerPixel, file.PhotometricInterpretation = 1, "MONOCHROME2"
    file.BitsAllocated = file.BitsStored = 16
    file.HighBit, file.PixelRepresentation = 15, 0
    file.PixelSpacing = [spacing[1], spacing[0]]
    file.PixelData = values.astype("<u2").tobytes()
    for name, value in tags.items():
        setattr(file, name, value)
    buffer = io.BytesIO()
    pydicom.dcmwrite(buffer, file, enforce_file_format=True)
    return buffer.getvalue()


def _medical(folder: Path) -> list[Seed]:
    volume = np.arange(60, dtype=np.int16).reshape(5, 4, 3)
    nifti = nifti_bytes(volume, (0.5, 0.25, 2.0))
    frames = np.arange(60, dtype=np.uint16).reshape(3, 4, 5)
    return [
        Seed(".nii", nifti),
        Seed(".nii", nifti_bytes(np.linspace(0, 1, 40, dtype=np.float32).reshape(5, 4, 1, 2), (1.0, 1.0, 1.0, 1.0))),
        Seed(".nii.gz", gzip.compress(nifti, mtime=0)),
        Seed(".dcm", dicom_bytes(frames[0])),
        Seed(".dcm", dicom_bytes(frames, RescaleSlope=2, RescaleIntercept=-100)),
    ]


def _arrays() -> list[Seed]:
    found = []
    for array in (np.ones((3, 4)), pixels("u2"), np.asfortranarray(np.ones((3, 4), ">f4")), pixels(channels=3)):
        buffer = io.BytesIO()
        np.save(buffer, array)
        found.append(Seed(".npy", buffer.getvalue()))
    buffer = io.BytesIO()
    np.savez_compressed(buffer, sizes=np.ones((2, 3)), x=np.arange(3.0), y=np.arange(2.0))
    return [*found, Seed(".npz", buffer.getvalue())]


SVG = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 80" width="100" height="80">
<g transform="translate(5,5) scale(0.9 1)"><path d="M10,0 h70 q20,0 20,20 t-5,20 a15 10 30 1 0 -10,20
c-5,5 -10,5 -15,0 s-10,-5 -15,2 L0 70 V10z m10,5 v5 h5 v-5 z"/></g>
<circle cx="40" cy="30" r="4"/><ellipse cx="25" cy="50" rx="2" ry="3" style="fill:red"/>
<rect x="20" y="30" width="4" height="3" rx="1"/><g transform="rotate(3 40 20)"><polygon
points="50,20 55,20 52,25"/></g><text x="3" y="4">hello</text></svg>"""


def geojson() -> bytes:
    """Return two regions that touch, one with a hole, a line and a point."""
    square = [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]
    hole = [[0.5, 0.5], [0.5, 1], [1, 1], [1, 0.5], [0.5, 0.5]]
    right = [[2, 0], [3, 0], [3, 2], [2, 2], [2, 0]]
    geometries = [
        {"type": "MultiPolygon", "coordinates": [[square, hole], [right]]},
        {"type": "LineString", "coordinates": [[2.2, 0.5], [2.8, 1.5]]},
        {"type": "Point", "coordinates": [1.5, 1.5, 9.0]},
    ]
    features = [{"type": "Feature", "properties": {"name": "x"}, "geometry": geometry} for geometry in geometries]
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


def _drawings() -> list[Seed]:
    loops = b"x,y\n0,0\n4,0\n4,3\n0,3\n\n1,1\n2,1\n2,2\n1,2\n"
    return [Seed(".svg", SVG.encode()), Seed(".geojson", geojson()), Seed(".json", geojson()), Seed(".csv", loops)]


MSH_TEXT = """$MeshFormat
4.1 0 8
$EndMeshFormat
$Nodes
2 5 1 9
0 1 0 1
9
0 0 0
2 1 1 4
1
2
3
4
1 0 0 1 0
1 1 0 1 1
0 1 0 0 1
.5 .5 0 .5 .5
$EndNodes
$Elements
2 5 1 5
1 1 1 1
1 9 1
2 1 2 4
2 9 1 4
3 1 2 4
4 2 3 4
5 3 9 4
$EndElements
$NodeData
1
"size"
1
0.0
3
0
1
5
9 0.1
1 0.2
2 0.3
3 0.4
4 0.05
$EndNodeData
"""

POS_TEXT = """/* sizes */ View "h" {
SQ(0,0,0, 1,0,0, 1,1,0, 0,1,0){.1,.2,.3,.4};
ST(1,0,0, 2,0,0, 1,1,0){.2,.5,.3}; // the right half
};"""


def _written_out() -> list[Seed]:
    return [Seed(".msh", MSH_TEXT.encode()), Seed(".pos", POS_TEXT.encode()), Seed(".txt", b"0 0\n1 0\n0 1\n")]
