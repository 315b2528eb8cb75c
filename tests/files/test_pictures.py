"""Pictures and medical images: the right number at the right place, in the right unit."""

from __future__ import annotations

import gzip
import io
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from files.reader_seeds import dicom_bytes, nifti_bytes, pixels
from PIL import Image as Pillow

from sizeviz.errors import InputError
from sizeviz.files import Image, ReadOptions, read_image


def saved(array: np.ndarray, path: Path, **options: object) -> Path:
    Pillow.fromarray(array).save(path, **options)
    return path


@pytest.mark.parametrize("suffix", [".png", ".tif", ".TIFF"])
@pytest.mark.parametrize("dtype", ["u1", "u2"])
def test_grey_values_stay_as_they_are_and_the_picture_stands_upright(tmp_path: Path, suffix: str, dtype: str) -> None:
    image = read_image(saved(pixels(dtype), tmp_path / f"i{suffix}"))
    assert np.array_equal(image.values, pixels(dtype)[::-1])
    assert (image.spacing, image.origin, image.label) == ((1.0, 1.0), (0.0, 0.0), f"i{suffix}")


def test_real_numbers_in_a_tiff(tmp_path: Path) -> None:
    values = np.linspace(-1, 1, 12, dtype=np.float32).reshape(3, 4)
    assert np.array_equal(read_image(saved(values, tmp_path / "i.tif")).values, values[::-1])


@pytest.mark.parametrize("channels", [3, 4])
def test_colour_becomes_luminance(tmp_path: Path, channels: int) -> None:
    array = pixels(channels=channels)
    image = read_image(saved(array, tmp_path / "i.png"))
    luma = array[..., :3] @ np.array([0.2126, 0.7152, 0.0722])
    assert np.allclose(image.values, luma[::-1], rtol=0, atol=1e-10)


def test_grey_written_as_colour_is_the_same_grey(tmp_path: Path) -> None:
    image = read_image(saved(np.repeat(pixels()[..., None], 3, axis=2), tmp_path / "i.png"))
    assert np.array_equal(image.values, pixels()[::-1])


def test_a_palette_and_a_bitmap(tmp_path: Path) -> None:
    Pillow.fromarray(pixels()).convert("P").save(tmp_path / "p.png")
    assert np.array_equal(read_image(tmp_path / "p.png").values, pixels()[::-1])
    Pillow.fromarray(pixels() > 100).save(tmp_path / "b.png")
    assert np.array_equal(read_image(tmp_path / "b.png").values, 255.0 * (pixels() > 100)[::-1])


def test_a_jpeg_is_close(tmp_path: Path) -> None:
    smooth = np.add.outer(np.arange(32), np.arange(40)).astype(np.uint8) * 3
    image = read_image(saved(smooth, tmp_path / "i.jpg", quality=95))
    assert np.abs(image.values - smooth[::-1]).max() < 6


def test_a_turned_photograph_is_turned_back(tmp_path: Path) -> None:
    picture = Pillow.fromarray(pixels())
    exif = picture.getexif()
    exif[0x0112] = 6  # the camera was held upright: turn by 90 degrees
    picture.save(tmp_path / "i.png", exif=exif)
    assert np.array_equal(read_image(tmp_path / "i.png").values, np.rot90(pixels(), -1)[::-1])


def test_a_page_of_a_tiff_is_chosen(tmp_path: Path) -> None:
    first, second = Pillow.fromarray(pixels()), Pillow.fromarray(255 - pixels())
    first.save(tmp_path / "i.tif", save_all=True, append_images=[second])
    assert np.array_equal(read_image(tmp_path / "i.tif", ReadOptions(slice=1)).values, 255.0 - pixels()[::-1])
    with pytest.raises(InputError, match="page 2 does not exist; the picture has 2"):
        read_image(tmp_path / "i.tif", ReadOptions(slice=2))


def png_bomb(width: int, height: int) -> bytes:
    """Return a PNG of a few kilobytes that announces a picture of any size."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    body = zlib.compress(b"\0" * 10**6, 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


@pytest.mark.parametrize("size", [(9000, 9000), (60_000, 60_000), (2**31 - 1, 1)])
def test_enormous_pictures_are_refused_unread(tmp_path: Path, size: tuple[int, int]) -> None:
    (tmp_path / "i.png").write_bytes(png_bomb(*size))
    with pytest.raises(InputError, match="pixels"):
        read_image(tmp_path / "i.png")


def test_another_kind_of_file_is_no_picture(tmp_path: Path) -> None:
    Pillow.fromarray(pixels()).save(tmp_path / "i.gif")
    (tmp_path / "i.gif").rename(tmp_path / "i.png")
    with pytest.raises(InputError, match=r"i\.png: it is no PNG, TIFF or JPEG picture"):
        read_image(tmp_path / "i.png")


def test_an_image_must_be_made_of_finite_numbers() -> None:
    with pytest.raises(InputError, match="at least 2 x 2 pixels"):
        Image(np.ones((1, 5)))
    with pytest.raises(InputError, match="1 pixels are not finite"):
        Image(np.array([[1.0, np.nan], [1.0, 1.0]]))
    with pytest.raises(InputError, match="spacing"):
        Image(np.ones((2, 2)), (1.0, 0.0))


VOLUME = np.arange(60, dtype=np.int16).reshape(5, 4, 3)  # x, y, z


@pytest.mark.parametrize("suffix", [".nii", ".nii.gz"])
def test_a_slice_of_a_nifti_volume_in_millimetres(tmp_path: Path, suffix: str) -> None:
    data = nifti_bytes(VOLUME, (0.5, 0.25, 2.0))
    (tmp_path / f"i{suffix}").write_bytes(gzip.compress(data) if suffix == ".nii.gz" else data)
    image = read_image(tmp_path / f"i{suffix}")
    assert np.array_equal(image.values, VOLUME[:, :, 1].T)
    assert image.spacing == (0.5, 0.25)
    across_y = read_image(tmp_path / f"i{suffix}", ReadOptions(axis="y", slice=3))
    assert np.array_equal(across_y.values, VOLUME[:, 3, :].T)
    assert across_y.spacing == (0.5, 2.0)
    with pytest.raises(InputError, match="slice 3 does not exist; z has slices 0 to 2"):
        read_image(tmp_path / f"i{suffix}", ReadOptions(slice=3))


def test_scaled_values_and_frames_of_a_nifti_series(tmp_path: Path) -> None:
    series = np.linspace(0, 1, 40, dtype=np.float32).reshape(5, 4, 1, 2)
    (tmp_path / "i.nii").write_bytes(nifti_bytes(series, (1.0, 1.0, 1.0, 1.0)))
    assert np.array_equal(read_image(tmp_path / "i.nii", ReadOptions(frame=1)).values, series[:, :, 0, 1].T)
    with pytest.raises(InputError, match="frame 2 does not exist"):
        read_image(tmp_path / "i.nii", ReadOptions(frame=2))
    data = bytearray(nifti_bytes(VOLUME, (1.0, 1.0, 1.0)))
    data[112:120] = struct.pack("<ff", 0.5, -10.0)  # slope and intercept
    (tmp_path / "s.nii").write_bytes(bytes(data))
    assert np.array_equal(read_image(tmp_path / "s.nii").values, VOLUME[:, :, 1].T * 0.5 - 10.0)


def test_a_packed_nifti_is_unpacked_only_as_far_as_its_header_says(tmp_path: Path) -> None:
    (tmp_path / "i.nii.gz").write_bytes(gzip.compress(nifti_bytes(VOLUME, (1.0, 1.0, 1.0)) + bytes(2**24)))
    with pytest.raises(InputError, match="it unpacks to more than 1 MiB"):
        read_image(tmp_path / "i.nii.gz")
    damaged = bytearray(nifti_bytes(VOLUME, (1.0, 1.0, 1.0)))
    damaged[42:48] = np.array([32767, 32767, 3], "<i2").tobytes()
    (tmp_path / "i.nii.gz").write_bytes(gzip.compress(damaged))
    with pytest.raises(InputError, match="32767 x 32767 x 3 voxels should take"):
        read_image(tmp_path / "i.nii.gz")


def test_nifti_vectors_and_lies_are_refused(tmp_path: Path) -> None:
    (tmp_path / "v.nii").write_bytes(nifti_bytes(np.ones((3, 3, 3, 1, 3), np.float32), (1.0,) * 5))
    with pytest.raises(InputError, match=r"vectors, tensors or colours.*one number a voxel is supported"):
        read_image(tmp_path / "v.nii")
    data = bytearray(nifti_bytes(VOLUME, (1.0, 1.0, 1.0)))
    data[42:48] = struct.pack("<3h", 30_000, 30_000, 30_000)
    (tmp_path / "b.nii").write_bytes(bytes(data))
    with pytest.raises(InputError, match=r"30000 x 30000 x 30000 voxels.*cut or corrupt"):
        read_image(tmp_path / "b.nii")


FRAMES = np.arange(60, dtype=np.uint16).reshape(3, 4, 5)


def test_a_dicom_image_stands_upright_in_millimetres(tmp_path: Path) -> None:
    (tmp_path / "i.dcm").write_bytes(dicom_bytes(FRAMES[0], spacing=(0.7, 0.5)))
    image = read_image(tmp_path / "i.dcm")
    assert np.array_equal(image.values, FRAMES[0][::-1])
    assert image.spacing == (0.7, 0.5)


def test_dicom_frames_and_rescaling(tmp_path: Path) -> None:
    (tmp_path / "i.dcm").write_bytes(dicom_bytes(FRAMES, RescaleSlope=2, RescaleIntercept=-100))
    assert np.array_equal(read_image(tmp_path / "i.dcm").values, 2.0 * FRAMES[1][::-1] - 100)
    assert np.array_equal(read_image(tmp_path / "i.dcm", ReadOptions(slice=2)).values, 2.0 * FRAMES[2][::-1] - 100)
    with pytest.raises(InputError, match="slice 3 does not exist; there are slices 0 to 2"):
        read_image(tmp_path / "i.dcm", ReadOptions(slice=3))


def test_dicom_stored_inverted(tmp_path: Path) -> None:
    (tmp_path / "i.dcm").write_bytes(dicom_bytes(FRAMES[0], PhotometricInterpretation="MONOCHROME1"))
    assert np.array_equal(read_image(tmp_path / "i.dcm").values, 19.0 - FRAMES[0][::-1])


def test_dicom_that_is_cut_deflated_or_no_image(tmp_path: Path) -> None:
    path = tmp_path / "i.dcm"
    path.write_bytes(dicom_bytes(FRAMES, NumberOfFrames=50_000))
    with pytest.raises(InputError, match="its pixels should take"):
        read_image(path)
    path.write_bytes(dicom_bytes(FRAMES[0]).replace(b"1.2.840.10008.1.2.1\0", b"1.2.840.10008.1.2.1.99"))
    with pytest.raises(InputError, match="deflated"):
        read_image(path)
    path.write_bytes(b"no DICOM at all" * 20)
    with pytest.raises(InputError, match=r"i\.dcm"):
        read_image(path)


@pytest.mark.parametrize(("suffix", "module"), [(".dcm", "pydicom"), (".nii", "nibabel")])
def test_without_the_library_the_line_that_installs_it_is_given(tmp_path: Path, suffix: str, module: str) -> None:
    (tmp_path / f"i{suffix}").write_bytes(b"x" * 400)
    code = (
        f"import sys; sys.modules[{module!r}] = None\nfrom sizeviz.files import read_image\n"
        f"try:\n    read_image({str(tmp_path / f'i{suffix}')!r})\nexcept ImportError as error:\n    print(error)"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert f"{module} is not installed" in said and "pip install 'sizeviz[medical]'" in said


def test_arrays_are_images_too(tmp_path: Path) -> None:
    np.save(tmp_path / "i.npy", pixels())
    assert np.array_equal(read_image(tmp_path / "i.npy").values, pixels())
    np.savez(tmp_path / "i.npz", elevation=pixels(), dx=np.float64(3))
    assert np.array_equal(read_image(tmp_path / "i.npz").values, pixels())
    buffer = io.BytesIO()
    np.savez(buffer, a=pixels(), b=pixels())
    (tmp_path / "two.npz").write_bytes(buffer.getvalue())
    with pytest.raises(InputError, match=r"no array 'intensity' \(found: a, b\)"):
        read_image(tmp_path / "two.npz")
    assert np.array_equal(read_image(tmp_path / "two.npz", ReadOptions(array="b")).values, pixels())


def test_libtiff_does_not_talk_over_the_error(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    damaged = bytearray(saved(pixels(), tmp_path / "t.tif", compression="tiff_lzw").read_bytes())
    damaged[8:20] = b"\xff" * 12
    (tmp_path / "t.tif").write_bytes(bytes(damaged))
    with pytest.raises(InputError, match=r"t\.tif: not a readable"):
        read_image(tmp_path / "t.tif")
    assert capfd.readouterr().err == ""
