"""Throw damaged files at every reader: each must give a valid value or one line of error, soon and in little memory.

Run by itself, ``python tests/files/reader_fuzz.py --count 20000`` damages the small files of ``reader_seeds`` in every
way it knows, in worker processes with a time limit per case and a limit on memory, and prints what came of it.
"""

from __future__ import annotations

import argparse
import io
import multiprocessing
import random
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
import zipfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
from files.reader_seeds import FORMULAS, Seed, seeds
from files.reader_structures import STRUCTURAL

from sizeviz.errors import InputError
from sizeviz.files import registry

TABLES = {
    "field": registry.FIELD_READERS,
    "image": registry.IMAGE_READERS,
    "mesh": registry.MESH_READERS,
    "domain": registry.DOMAIN_READERS,
    "study": {".sizeviz": "read_study"},
}
SECONDS = 5.0
"""A case that takes longer hangs."""

MEMORY = 2 * 2**30
"""A case that asks for more memory than this blows up."""

STRUCTURED = 0.4
"""Share of the cases whose damage keeps the file's structure; in the others bytes are damaged."""

NUMBER = re.compile(rb"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
ODD_NUMBERS = [
    *(b"0", b"-1", b"1", b"2", b"3", b"7", b"255", b"65536", b"2147483647", b"2147483648", b"4294967296"),
    *(b"99999999999", b"9223372036854775807", b"18446744073709551615", b"1" * 40, b"1" * 5000),
    *(b"nan", b"inf", b"-inf", b"1e308", b"1e309", b"-1e308", b"1e-320", b"1e40", b"0.5", b"1_0", b"0x10", b"1,5"),
]
ODD_BYTES = [
    b"\0",
    b"\xff",
    b"\n",
    b" ",
    b"(",
    b")",
    b"{",
    b"<",
    b">",
    b'"',
    b"%",
    b"\\",
    b"\xf0\x9f\x92\xa9",
    b"../" * 9,
]
ODD_WORDS = [
    b"<!DOCTYPE x>",
    b"<!ENTITY a 'b'>",
    b"$EndNodes",
    b"LOOKUP_TABLE",
    b"METADATA",
    b"End",
    b"Polygon",
    b"[" * 3000,
]


@dataclass(frozen=True)
class Outcome:
    """What came of one case: ``value``, ``error``, or what must not happen, with its story."""

    kind: str
    reader: str
    story: str = ""


class Hung(BaseException):
    """The time limit of a case has passed."""


def mutated(data: bytes, other: bytes, draw: random.Random) -> bytes:
    """Return the data damaged once to four times."""
    for _ in range(draw.choice((1, 1, 1, 2, 3, 4))):
        data = draw.choice(DAMAGES)(data, other, draw)
    return data[: 2**20]


def _place(data: bytes, draw: random.Random) -> int:
    """Return a place, half of the time near the start, where headers are."""
    return draw.randrange(max(1, min(len(data), 200 if draw.random() < 0.5 else len(data))))


def flip_bits(data: bytes, other: bytes, draw: random.Random) -> bytes:
    damaged = bytearray(data)
    for _ in range(draw.choice((1, 1, 2, 8))):
        if damaged:
            damaged[_place(data, draw)] ^= 1 << draw.randrange(8)
    return bytes(damaged)


def set_bytes(data: bytes, other: bytes, draw: random.Random) -> bytes:
    at, length = _place(data, draw), draw.choice((1, 2, 4, 8))
    return data[:at] + draw.choice((b"\0", b"\xff", b"\x7f", b"\x80")) * length + data[at + length :]


def cut_end(data: bytes, other: bytes, draw: random.Random) -> bytes:
    return data[: _place(data, draw)]


def cut_out(data: bytes, other: bytes, draw: random.Random) -> bytes:
    at = _place(data, draw)
    return data[:at] + data[at + draw.choice((1, 2, 8, 50, 1000)) :]


def repeat(data: bytes, other: bytes, draw: random.Random) -> bytes:
    at, length = _place(data, draw), draw.choice((1, 8, 50, 400))
    return data[:at] + data[at : at + length] * draw.choice((2, 3, 100)) + data[at + length :]


def insert(data: bytes, other: bytes, draw: random.Random) -> bytes:
    at = _place(data, draw)
    return data[:at] + draw.choice(ODD_BYTES + ODD_WORDS) * draw.choice((1, 1, 20)) + data[at:]


def splice(data: bytes, other: bytes, draw: random.Random) -> bytes:
    return data[: _place(data, draw)] + other[_place(other, draw) :]


def change_number(data: bytes, other: bytes, draw: random.Random) -> bytes:
    start = _place(data, draw)
    found = NUMBER.search(data, start) or NUMBER.search(data)
    if found is None:
        return flip_bits(data, other, draw)
    return data[: found.start()] + draw.choice(ODD_NUMBERS) + data[found.end() :]


def swap_lines(data: bytes, other: bytes, draw: random.Random) -> bytes:
    lines = data.split(b"\n")
    i, j = draw.randrange(len(lines)), draw.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return b"\n".join(lines)


def nothing_but_noise(data: bytes, other: bytes, draw: random.Random) -> bytes:
    return data[: draw.choice((0, 4, 16, 64))] + draw.randbytes(draw.choice((1, 30, 1000)))


DAMAGES = [
    *[flip_bits, set_bytes, cut_end, cut_out, repeat, insert, splice, swap_lines, nothing_but_noise],
    *[change_number] * 4,
]


def cases(count: int, seed: int) -> Iterator[tuple[int, str, str, bytes, bytes | None]]:
    """Yield numbered cases: table (or ``formula``), suffix, damaged content, and what lies beside the file."""
    pool: dict[str, list[Seed]] = {}
    for sound in seeds():
        pool.setdefault(sound.suffix, []).append(sound)
    formulas = [formula.encode() for formula in FORMULAS]
    for number in range(count):
        draw = random.Random(f"{seed} {number}")
        if draw.random() < 0.08:
            text = draw.choice(formulas)
            odd = draw.random() < STRUCTURED
            text = STRUCTURAL["formula"](text, draw) if odd else mutated(text, draw.choice(formulas), draw)
            yield number, "formula", "", text[:5000], None
            continue
        same = pool[draw.choice(list(pool))]
        taken: Seed = draw.choice(same)
        table = draw.choice([name for name, readers in TABLES.items() if taken.suffix in readers])
        if draw.random() < STRUCTURED:
            damaged = STRUCTURAL[taken.suffix](taken.data, draw)
        else:
            damaged = mutated(taken.data, draw.choice(same).data, draw)
        if taken.suffix == ".sizeviz" and draw.random() < 0.5:
            damaged = with_damaged_member(taken.data, draw)
        beside = taken.beside
        if beside is not None and draw.random() < 0.3:
            beside = mutated(beside, taken.data, draw)
        yield number, table, taken.suffix, damaged, beside


def with_damaged_member(data: bytes, draw: random.Random) -> bytes:
    """Return a study with one member damaged before it was packed, so that its checksum is right."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    name = "study.json" if draw.random() < 0.7 else draw.choice(sorted(content))
    content[name] = mutated(content[name], content[name], draw)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for member, old in content.items():
            archive.writestr(zipfile.ZipInfo(member), old)
    return buffer.getvalue()


def tried(table: str, suffix: str, data: bytes, beside: bytes | None, folder: Path) -> Outcome:
    """Read one damaged file and say what came of it."""
    reader = f"{table} {suffix}".strip()
    began, before = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    try:
        if table == "formula":
            read_formula(data.decode("utf-8", "replace"))
        else:
            read_file(table, folder / f"case{suffix}", data, beside)
        outcome = Outcome("value", reader)
    except InputError as error:
        outcome = judged_message(str(error), reader, table, suffix)
    except Hung:
        outcome = Outcome("hang", reader, traceback.format_exc(limit=-3))
    except BaseException:
        outcome = Outcome("traceback", reader, traceback.format_exc(limit=-6))
    took, after = time.process_time() - began, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    if took > SECONDS:
        return Outcome("hang", reader, f"{took:.1f} s")
    if (after - before) * 1024 > MEMORY:
        return Outcome("memory", reader, f"{(after - before) >> 10} MiB")
    return outcome


def judged_message(text: str, reader: str, table: str, suffix: str) -> Outcome:
    """Say whether an error is one line that names the input."""
    if "\n" in text or len(text) > 700 or not text.isprintable():
        return Outcome("bad message", reader, repr(text))
    if table != "formula" and f"case{suffix}" not in text:
        return Outcome("bad message", reader, f"does not name the file: {text}")
    if "not enough memory" in text:
        return Outcome("memory", reader, text)
    return Outcome("error", reader, text)


def read_file(table: str, path: Path, data: bytes, beside: bytes | None) -> None:
    if beside is not None:
        path.with_suffix({".sol": ".mesh", ".mesh": ".sol"}[path.suffix]).write_bytes(beside)
    if table == "study":
        from sizeviz.study.storage import read_study

        path.write_bytes(data)
        read_study(path)
    else:
        registry.parsed(TABLES[table], data, path, "something")


def read_formula(text: str) -> None:
    from sizeviz.sources.formula import Formula

    x, y = np.meshgrid(np.linspace(0, 1, 20), np.linspace(0, 1, 20))
    assert Formula(text)(x, y).shape == (20, 20)


def worker(numbers: tuple[int, int, int, int]) -> list[tuple[int, Outcome]]:
    """Try every case of one share, each under an alarm and all under a limit of memory."""
    share, n_shares, count, seed = numbers
    limit_memory()
    for alarm in (signal.SIGALRM, signal.SIGPROF):
        signal.signal(alarm, on_alarm)
    outcomes = []
    with tempfile.TemporaryDirectory() as folder:
        for number, table, suffix, data, beside in cases(count, seed):
            if number % n_shares == share:
                outcomes.append((number, timed(table, suffix, data, beside, Path(folder))))
    return outcomes


def timed(table: str, suffix: str, data: bytes, beside: bytes | None, folder: Path) -> Outcome:
    """Read one damaged file under two alarms: one of processor time, one for waiting that never ends."""
    try:
        signal.setitimer(signal.ITIMER_PROF, SECONDS + 1)
        signal.setitimer(signal.ITIMER_REAL, 20 * SECONDS)
        return tried(table, suffix, data, beside, folder)
    except Hung:  # the alarm came when a library had just handed back
        return Outcome("hang", f"{table} {suffix}".strip(), "late")
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)


def on_alarm(number: int, frame: FrameType | None) -> None:
    raise Hung


def limit_memory() -> None:
    """Let this process have what it has, and twice what a case may take."""
    with open("/proc/self/statm") as file:
        now = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (now + 2 * MEMORY, resource.RLIM_INFINITY))


def run(count: int, seed: int, workers: int) -> list[tuple[int, Outcome]]:
    """Try ``count`` cases in worker processes; one that dies takes the run with it, and says so."""
    with multiprocessing.get_context("spawn").Pool(workers) as pool:
        waiting = pool.map_async(worker, [(k, workers, count, seed) for k in range(workers)])
        found = waiting.get(timeout=60 + count * SECONDS)
    return sorted(pair for share in found for pair in share)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--show", action="store_true", help="print one error of every kind")
    options = parser.parse_args()
    began = time.perf_counter()
    outcomes = run(options.count, options.seed, options.workers)
    counts = Counter(outcome.kind for _, outcome in outcomes)
    for number, outcome in outcomes:
        if outcome.kind not in ("value", "error"):
            print(f"case {number}: {outcome.kind} in {outcome.reader}\n{outcome.story}")
    if options.show:
        seen = {(o.reader, re.sub(r"[\d.e+-]+|'.*?'", "#", o.story)): o.story for _, o in outcomes if o.kind == "error"}
        print(*sorted({f"{reader}: {text}" for (reader, _), text in seen.items()}), sep="\n")
    readers = Counter(outcome.reader for _, outcome in outcomes)
    print(*(f"{name:14} {n}" for name, n in sorted(readers.items())), sep="\n")
    print(f"{len(outcomes)} cases in {time.perf_counter() - began:.0f} s: {dict(counts)}")
    return 0 if set(counts) <= {"value", "error"} else 1


if __name__ == "__main__":
    sys.exit(main())
