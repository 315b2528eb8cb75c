"""Kill a program again and again while it saves: the old or the new study must always open whole.

Run by itself, ``python tests/study/killed_saves.py --count 200`` kills that many programs at random moments.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from sizeviz.study.storage import read_study
from sizeviz.study.storage.autosave import leftovers

NURSERY = """
import os, sys
from dataclasses import replace
from study.cases import valley_source
from sizeviz.study import Study
from sizeviz.study.storage import StudyFile, write_study
from sizeviz.study.storage.autosave import Autosave
path, folder = sys.argv[1:]
source = valley_source(129)

def save_for_ever():
    autosave = Autosave(folder)
    k = 0
    while True:
        k += 1
        field = source.field.with_sizes(source.field.sizes * 2.0**-k if k % 2 else source.field.sizes)
        content = StudyFile(Study(replace(source, name=str(k), field=field, reference=field)))
        write_study(path, content)
        autosave.save(content, path)
        if k == 2:
            print(os.getpid(), flush=True)

for _ in sys.stdin:
    child = os.fork()
    if child == 0:
        save_for_ever()
    os.waitpid(child, 0)
    print("gone", flush=True)
"""


def killed(count: int, folder: Path, draw: random.Random) -> Iterator[int]:
    """Let programs save and autosave, kill each at a random moment, open what it left, and count."""
    path, autosaves = folder / "a.sizeviz", folder / "autosave"
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    command = [sys.executable, "-c", NURSERY, str(path), str(autosaves)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment, text=True, bufsize=1
    ) as nursery:
        assert nursery.stdin is not None and nursery.stdout is not None
        for number in range(count):
            nursery.stdin.write("another\n")
            program = int(nursery.stdout.readline())
            assert leftovers(autosaves) == [], "the autosave of a running program is its own"
            time.sleep(draw.uniform(0.0, 0.1))
            os.kill(program, signal.SIGKILL)
            assert nursery.stdout.readline() == "gone\n"
            check_what_is_left(path, autosaves)
            yield number + 1
        nursery.stdin.close()


def check_what_is_left(path: Path, autosaves: Path) -> None:
    """Open the study and its autosave, and clear up."""
    found = leftovers(autosaves)
    assert len(found) == 1
    recovered = found[0].read()
    assert recovered.origin == str(path)
    for content in (read_study(path), recovered):
        source, k = content.study.source, int(content.study.source.name)
        low = 0.015 * (2.0**-k if k % 2 else 1.0)
        assert k >= 2 and source.field.sizes.min() == low, "one save's name beside another's sizes"
    found[0].remove()
    assert leftovers(autosaves) == [] and not list(autosaves.iterdir()), "what a killed program left is cleared away"
    for part in path.parent.glob(".*.part*"):  # a save cut off leaves its half beside the study, under another name
        part.unlink()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        for number in killed(options.count, Path(name), random.Random(0)):
            print(f"\r{number} of {options.count} killed, each time the old or the new study opened", end="")
    print()


if __name__ == "__main__":
    main()
