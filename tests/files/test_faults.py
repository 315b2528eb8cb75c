"""Disks that fill up, folders that refuse, pipes, links and broken files: one line of error, nothing half-written."""

from __future__ import annotations

import os
import resource
import signal
import stat
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from files.reader_seeds import grid_field, quad_mesh

from sizeviz.errors import Cancelled, InputError, MissingDependencyError
from sizeviz.files import ReadOptions, read_field, replacing, write_field, write_mesh
from sizeviz.files.guard import guarded, inflated, load, one_line
from sizeviz.files.registry import FIELD_READERS, FIELD_WRITERS, MESH_WRITERS


@pytest.mark.parametrize("suffix", sorted(MESH_WRITERS))
def test_a_full_disk_leaves_the_old_file(tmp_path: Path, suffix: str) -> None:
    path = write_mesh(tmp_path / f"m{suffix}", quad_mesh())
    before = path.read_bytes()
    code = (
        "import resource, signal, sys\nfrom files.reader_seeds import quad_mesh\n"
        "from sizeviz.errors import InputError\n"
        "from sizeviz.files import write_mesh\nimport meshio\nmesh = quad_mesh(200)\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\nresource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))\n"
        "try:\n    write_mesh(sys.argv[1], mesh)\nexcept InputError as error:\n    print(error)"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    command = [sys.executable, "-c", code, str(path)]
    said = subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout
    assert "cannot be written (the file would be larger than is allowed here" in said
    assert path.read_bytes() == before
    assert sorted(tmp_path.iterdir()) == [path]


def test_a_device_without_space() -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_field("/dev/full/x.vtu", grid_field())


def test_a_folder_that_is_gone_or_a_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the folder does not exist; create it first"):
        write_field(tmp_path / "none" / "f.vtu", grid_field())
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="not a folder"):
        write_field(tmp_path / "file" / "f.vtu", grid_field())
    (tmp_path / "folder.vtu").mkdir()
    with pytest.raises(InputError, match="it is a folder"):
        write_field(tmp_path / "folder.vtu", grid_field())
    with pytest.raises(InputError, match="name is too long"):
        write_field(tmp_path / ("x" * 300 + ".vtu"), grid_field())


def test_the_error_of_a_write_that_fails_inside_the_block(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the disk is full; free some space"), replacing(tmp_path / "f") as part:
        part.write_text("begun")
        raise OSError(28, "No space left on device")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("step", ["touch", "replace", "fsync", "chmod"])
def test_permission_lost_on_the_way_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    path = write_field(tmp_path / "f.npz", grid_field())
    before = path.read_bytes()

    def refused(*args: object, **kwargs: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(*((os, step) if step in ("replace", "fsync") else (Path, step)), refused)
    with pytest.raises(InputError, match="permission denied; choose a folder of your own"):
        write_field(path, grid_field().with_sizes(2 * grid_field().sizes))
    monkeypatch.undo()
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_permission_lost_before_reading(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_field(tmp_path / "f.npz", grid_field())

    def refused(*args: object, **kwargs: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", refused)
    with pytest.raises(InputError, match=r"cannot read .*f\.npz: no permission to read it"):
        read_field(path)


@pytest.mark.parametrize("suffix", sorted(set(FIELD_WRITERS) - {".sol", ".mesh"}))
def test_a_file_that_is_cut_or_grows_while_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    """Its size is asked first; what is read afterwards can be another. The answer is a field or one line of error."""
    path = write_field(tmp_path / f"f{suffix}", grid_field())
    whole = path.read_bytes()
    ask = os.fstat
    for after in (whole[: len(whole) // 2], whole + whole[: len(whole) // 3]):
        path.write_bytes(whole)

        def changed(handle: int, after: bytes = after) -> os.stat_result:
            status = ask(handle)
            path.write_bytes(after)
            return status

        with monkeypatch.context() as patch:
            patch.setattr(os, "fstat", changed)
            try:
                field = read_field(path)
            except InputError as error:
                assert str(path) in str(error) and "\n" not in str(error)
            else:
                assert np.isfinite(field.sizes).all()


def test_permissions_are_kept_and_links_followed(tmp_path: Path) -> None:
    real, link = tmp_path / "real.npy", tmp_path / "link.npy"
    write_field(real, grid_field())
    real.chmod(0o640)
    link.symlink_to(real)
    write_field(link, grid_field().with_sizes(2 * grid_field().sizes))
    assert link.is_symlink()
    assert np.array_equal(np.load(real).ravel(), 2 * grid_field().sizes)
    assert stat.S_IMODE(real.stat().st_mode) == 0o640


def test_a_writer_killed_at_any_moment_leaves_the_old_or_the_new_file(tmp_path: Path) -> None:
    path = write_field(tmp_path / "f.npz", grid_field())
    code = (
        "import sys\nfrom files.reader_seeds import grid_field\nfrom sizeviz.files import write_field\n"
        "f = grid_field()\nk = 0\nprint('ready', flush=True)\n"
        "while True:\n    k += 1\n    write_field(sys.argv[1], f.with_sizes(k * f.sizes))"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    draw = np.random.default_rng(0)
    for _ in range(8):
        with subprocess.Popen(
            [sys.executable, "-c", code, str(path)], stdout=subprocess.PIPE, env=environment
        ) as writer:
            assert writer.stdout is not None and writer.stdout.readline() == b"ready\n"
            try:
                writer.wait(timeout=draw.uniform(0.001, 0.05))
            except subprocess.TimeoutExpired:
                writer.send_signal(signal.SIGKILL)
        factor = read_field(path).sizes / grid_field().sizes
        assert np.allclose(factor, np.round(factor[0]), rtol=1e-14)


@pytest.mark.parametrize("suffix", sorted(FIELD_READERS))
def test_what_is_no_file_is_refused(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"f{suffix}"
    with pytest.raises(InputError, match="there is no such file; check the path"):
        read_field(path)
    path.mkdir()
    with pytest.raises(InputError, match="this is a folder"):
        read_field(path)
    path.rmdir()
    os.mkfifo(path)
    with pytest.raises(InputError, match="not an ordinary file"):
        read_field(path)
    path.unlink()
    path.symlink_to(path)
    with pytest.raises(InputError, match="go round in a circle"):
        read_field(path)
    path.unlink()
    path.write_bytes(b"")
    with pytest.raises(InputError, match="the file is empty"):
        read_field(path)


def test_a_name_with_a_null_character() -> None:
    with pytest.raises(InputError, match="null character"):
        read_field("a\0.vtu")


def test_a_file_beyond_the_limit_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "f.vtu"
    with path.open("wb") as file:
        file.truncate(2**31)
    with pytest.raises(InputError, match="2048 MiB exceeds the limit of 1024 MiB"):
        read_field(path)
    with pytest.raises(InputError, match="2048 MiB exceeds the limit of 100 bytes"):
        load(path, limit=100)


def test_whatever_goes_wrong_in_a_parser_is_one_line() -> None:
    for problem in (
        KeyError("a\nb"),
        IndexError(),
        MemoryError(),
        RecursionError("deep"),
        ZeroDivisionError("x" * 5000),
    ):
        with pytest.raises(InputError) as caught, guarded("dir/f.vtu", ".vtu file"):
            raise problem
        text = str(caught.value)
        assert text.startswith("dir/f.vtu: ") and "\n" not in text and len(text) < 500
        assert caught.value.__cause__ is problem


def test_what_is_not_the_files_fault_passes_a_parser_unchanged() -> None:
    for problem in (Cancelled(), MissingDependencyError("pip install x"), KeyboardInterrupt()):
        with pytest.raises(type(problem)) as caught, guarded("f", "file"):
            raise problem
        assert caught.value is problem


def test_names_are_shown_without_control_characters() -> None:
    assert one_line("a\n\x1b[31mb\u202e\t c") == "a [31mb c"
    assert one_line("x" * 999, 10) == "xxxxxxxxx…"


def test_unpacking_stops_at_the_limit() -> None:
    packed = zlib.compress(b"\0" * 10**8, 9)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match="unpacks to more than"):
        inflated(packed, 10**6)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000
    assert inflated(packed, 10**8) == b"\0" * 10**8
    with pytest.raises(InputError, match="end too early"):
        inflated(packed[:-9], 10**9)


def test_unknown_suffixes_are_refused_before_the_file_is_looked_for() -> None:
    with pytest.raises(InputError, match=r"files that end in \.xyz cannot be read as a size field; use one of \.mesh"):
        read_field("nowhere.xyz")
    with pytest.raises(InputError, match=r"files without a suffix cannot be written as a size field"):
        write_field("nowhere", grid_field())
    assert ".npy" in FIELD_WRITERS


@pytest.mark.parametrize(
    ("option", "value"),
    [("axis", "w"), ("slice", -1), ("frame", -1), ("part", 0), ("tolerance", 0.0), ("extent", (0, 0, 0, 1))],
)
def test_options_are_checked(option: str, value: object) -> None:
    with pytest.raises(InputError, match=option):
        ReadOptions(**{option: value})
