"""A long session of random but seeded actions at the real window: nothing fails, stalls, or grows.

    python tests/app/soak.py --minutes 30 --seed 0

Without a display it starts a virtual one. Stalls are judged by the clock, which needs a machine with nothing else to
do; under load (``--loaded``, and in the tests) by the processor time that the window's own thread used in one go.
A minute of a session opens sources, paints, undoes, zooms, saves and cancels some two hundred times.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import logging
import os
import random
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

SCREEN = "1700x1100x24"
SIZE = (1500, 940)
LONGEST_STALL = 0.25
"""Seconds that the window may be deaf."""

MOST_GROWTH = 50.0
"""Megabytes that a session may grow by after its warm-up."""

SOURCES = (
    "valley",
    "expr:min(0.1, max(0.02, abs(x - 0.4 - 0.2*y)))",
    "expr:0.03 + 0.1*abs(hypot(x - 0.5, y - 0.5) - 0.3)",
    "ring",
    "phantom",
    "no-such-source",
)
"""What is opened: quick to mesh, one slow enough to be cancelled or outlived, one that is an error."""


@dataclass
class Record:
    """What a session showed.

    Parameters
    ----------
    errors : list of str
        Tracebacks of whatever was raised in the window's thread, and records of the log that should not be.
    stalls : list
        Seconds by the clock, seconds of the thread's own processor time, the action, and where the thread was.
    memory, files : list
        Megabytes resident, and open file descriptors, at every rest.
    actions : Counter
        How often each was done.
    """

    errors: list[str] = field(default_factory=list)
    stalls: list[tuple[float, float, str, str]] = field(default_factory=list)
    memory: list[float] = field(default_factory=list)
    files: list[int] = field(default_factory=list)
    actions: Counter[str] = field(default_factory=Counter)

    @property
    def longest(self) -> float:
        """The longest time by the clock that the window was deaf."""
        return max((stall[0] for stall in self.stalls), default=0.0)

    @property
    def busiest(self) -> float:
        """The most processor time that the window's thread used without looking up."""
        return max((stall[1] for stall in self.stalls), default=0.0)

    @property
    def growth(self) -> float:
        """Megabytes from the end of the warm-up, a third of the session, to the most afterwards."""
        warm = len(self.memory) // 3
        return max(self.memory[warm:]) - self.memory[warm]


class Watch:
    """Notices when the event loop does not come round, and where the thread is meanwhile."""

    def __init__(self, record: Record) -> None:
        from qtpy.QtCore import Qt, QTimer

        self.action, self._record = "start", record
        self._timer = QTimer()
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._tick)
        self._main, self._where, self._stop = threading.get_ident(), "", threading.Event()
        self.reset()
        self._timer.start(5)
        self._thread = threading.Thread(target=self._look, daemon=True)
        self._thread.start()

    def reset(self) -> None:
        self._last, self._used = time.perf_counter(), time.thread_time()

    def stop(self) -> None:
        self._timer.stop()
        self._stop.set()
        self._thread.join()

    def _tick(self) -> None:
        now, used = time.perf_counter(), time.thread_time()
        gap, busy = now - self._last, used - self._used
        if gap > 0.1:
            self._record.stalls.append((gap, busy, self.action, self._where))
        self._last, self._used, self._where = now, used, ""

    def _look(self) -> None:
        while not self._stop.wait(0.05):
            if time.perf_counter() - self._last > 0.15:
                frame = sys._current_frames().get(self._main)
                lines = [f"{Path(f.filename).name}:{f.lineno} {f.name}" for f in traceback.extract_stack(frame)]
                self._where = " < ".join(reversed(lines[-7:]))
                del frame  # it would keep the thread's painters alive


class Soak:
    """One session.

    Parameters
    ----------
    seed : int
        Chooses the actions.
    folder : Path
        For settings, autosaves, studies and pictures.
    """

    def __init__(self, seed: int, folder: Path) -> None:
        from app.driver import Person

        from sizeviz.app.engine import PipelineEngine
        from sizeviz.app.settings import Settings
        from sizeviz.app.window import MainWindow

        self.draw, self.folder, self.record = random.Random(seed), folder, Record()
        self.window = MainWindow(PipelineEngine(), Settings(str(folder / "settings.ini")))
        self.window.resize(*SIZE)
        self.window.show()
        self.window.activateWindow()
        self.person = Person(self.window)
        self.actions = self._all_actions()

    def play(self, seconds: float, rest: float) -> Record:
        """Act for a time; every ``rest`` seconds come to rest and look at memory and descriptors."""
        handler = _Errors(self.record)
        logging.getLogger().addHandler(handler)
        before, sys.excepthook = sys.excepthook, self._raised
        watch = Watch(self.record)
        try:
            self._rest(watch)
            self.record.stalls.clear()  # what is done once, at the start: imports, the first picture
            end = time.perf_counter() + seconds
            while time.perf_counter() < end:
                until = min(time.perf_counter() + rest, end)
                while time.perf_counter() < until:
                    self._act(watch)
                self._rest(watch)
        finally:
            watch.stop()
            sys.excepthook = before
            logging.getLogger().removeHandler(handler)
            self.window.close()
        return self.record

    # -- inside ----------------------------------------------------------------------------------------------------

    def _act(self, watch: Watch) -> None:
        names = list(self.actions)
        name = self.draw.choices(names, [self.actions[n][0] for n in names])[0]
        watch.action = name
        self.record.actions[name] += 1
        try:
            self.actions[name][1]()
            self.person.rest(self.draw.choice((0, 10, 40, 150)))
        except Exception:
            self.record.errors.append(f"{name}\n{traceback.format_exc()}")

    def _rest(self, watch: Watch) -> None:
        """Bring the window to where it began: its size, one study with its options, an empty history; then measure.

        What the memory is compared with is then the same in all but time.
        """
        from sizeviz.study import StudyOptions

        window, person = self.window, self.person
        watch.action = "rest"
        window.actions_["paint"].setChecked(False)
        window.controller.cancel()
        person.wait(lambda: not window.controller.jobs.is_busy, 120)
        window.resize(*SIZE)
        window.actions_["panes-2"].trigger()
        window.controller.open_source("valley")
        person.wait(lambda: not window.controller.jobs.is_busy, 120)
        window.controller.change(lambda options: StudyOptions(), "Reset")
        person.wait_settled(120)
        window.controller.store.stack.clear()
        person.rest(200)
        self._measure()
        watch.reset()

    def _measure(self) -> None:
        for _ in range(3):
            gc.collect()
        ctypes.CDLL(None).malloc_trim(0)
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        self.record.memory.append(pages * os.sysconf("SC_PAGESIZE") / 1e6)
        self.record.files.append(len(os.listdir("/proc/self/fd")))

    def _raised(self, kind: type[BaseException], error: BaseException, trace: object) -> None:
        self.record.errors.append("".join(traceback.format_exception(error)))

    def _all_actions(self) -> dict[str, tuple[float, Callable[[], object]]]:
        """Return every action with how often it is done."""
        window, trigger = self.window, self._trigger
        plain = ("undo", "redo", "fit", "swap", "link", "shared-range", "zoom-in", "zoom-out", "worst-ratio", "unpin",
                 "worst-quality", "copy-table", "brush-smaller", "brush-larger", "apply", "cancel", "copy-command",
                 "copy-python", "theme", "color-ratio", "color-quality", "color-size", "color-prescribed",
                 "color-target", "panes-1", "panes-2", "panes-3", "panes-4", "log")  # fmt: skip
        actions: dict[str, tuple[float, Callable[[], object]]] = {name: (1.0, trigger(name)) for name in plain}
        actions["theme"] = (0.2, trigger("theme"))
        actions |= {
            "open": (0.6, self._open),
            "canvas": (0.3, trigger("canvas")),
            "paint": (3.0, self._paint),
            "alpha": (1.0, lambda: window.size_panel.alpha.spin.setValue(self.draw.uniform(1.0, 6.0))),
            "beta": (0.5, lambda: window.size_panel.beta.spin.setValue(self.draw.uniform(0.6, 1.0))),
            "seed": (0.3, lambda: window.mesh_panel.seed.setValue(self.draw.randrange(9))),
            "smoothing": (0.2, window.smooth_panel.smoothing.toggle),
            "measure": (0.3, self._measure_shown),
            "drag": (3.0, self._drag),
            "wheel": (3.0, self._wheel),
            "hover": (4.0, self._hover),
            "click": (2.0, self._click),
            "select": (1.0, self._select),
            "worst row": (1.0, self._row),
            "save": (0.3, lambda: window.files.save(self.folder / "a.sizeviz")),
            "open study": (0.3, self._open_study),
            "autosave": (0.5, window.files.autosave),
            "resize": (0.3, self._resize),
            "palette": (0.3, self._palette),
            "escape": (0.5, self._escape),
        }
        return actions

    def _trigger(self, name: str) -> Callable[[], object]:
        return lambda: self.window.actions_[name].trigger()

    def _pane(self):
        return self.draw.choice(self.window.board.visible_panes)

    def _place(self) -> tuple[float, float]:
        return self.draw.uniform(0.02, 0.98), self.draw.uniform(0.02, 0.98)

    def _seen(self, pane) -> tuple[float, float]:
        """Return a place that the pane shows."""
        camera, glass = pane.surface.camera, pane.surface.glass
        u, v = self._place()
        return camera.to_model(u * glass.width(), v * glass.height(), glass.width(), glass.height())

    def _open(self) -> None:
        self.window.controller.open_source(self.draw.choice(SOURCES))

    def _open_study(self) -> None:
        if (self.folder / "a.sizeviz").exists():
            self.window.controller.open_source(str(self.folder / "a.sizeviz"))

    def _paint(self) -> None:
        from qtpy.QtCore import Qt

        window, draw = self.window, self.draw
        window.actions_["paint"].setChecked(True)
        if not window.tool.active:
            return
        window.paint.set_mode(draw.choice(list(window.paint.modes)))
        shape = draw.choice(("freehand", "freehand", "line", "polygon"))
        window.paint.shape.setCurrentIndex(window.paint.shape.findData(shape))
        pane = self._pane()
        path = [self._seen(pane) for _ in range(draw.randint(2, 4))]
        if shape == "freehand":
            self.person.drag(pane, path)
        else:
            for corner in path:
                self.person.click(pane, *corner)
            pane.surface.glass.setFocus()
            self.person.key(Qt.Key.Key_Return)
            window.tool.finish()
        if draw.random() < 0.5:
            window.actions_["paint"].setChecked(False)

    def _drag(self) -> None:
        pane = self._pane()
        self.person.drag(pane, [self._seen(pane), self._seen(pane)])

    def _wheel(self) -> None:
        pane = self._pane()
        self.person.wheel(pane, *self._seen(pane), self.draw.choice((-3, -1, 1, 2, 4)))

    def _hover(self) -> None:
        pane = self._pane()
        for _ in range(self.draw.randint(1, 6)):
            self.person.hover(pane, *self._seen(pane))

    def _click(self) -> None:
        pane = self._pane()
        self.person.click(pane, *self._seen(pane))

    def _measure_shown(self) -> None:
        box = self.window.judge_panel.measure
        box.setCurrentIndex(self.draw.randrange(box.count()))

    def _select(self) -> None:
        self.draw.choice(self.window.histograms).set_range(*sorted((self.draw.uniform(0.3, 1.5), 0.9)))

    def _row(self) -> None:
        if len(self.window.worst.elements):
            self.window.worst.view.selectRow(self.draw.randrange(min(len(self.window.worst.elements), 20)))

    def _resize(self) -> None:
        self.window.resize(self.draw.randint(1250, 1650), self.draw.randint(760, 1050))

    def _palette(self) -> None:
        self.window.palette_.open()
        self.person.rest(20)
        self.window.palette_.close()

    def _escape(self) -> None:
        from qtpy.QtCore import Qt

        self.person.key(Qt.Key.Key_Escape)


class _Errors(logging.Handler):
    """Keeps what the log calls an error, but for what a wrong input is expected to say."""

    def __init__(self, record: Record) -> None:
        super().__init__(logging.ERROR)
        self._record = record

    def emit(self, record: logging.LogRecord) -> None:
        words = record.getMessage()
        if "there is no such example or file" not in words:
            self._record.errors.append(words)


def told(record: Record) -> str:
    """Return a session in words."""
    worst = sorted(record.stalls, reverse=True)[:8]
    lines = [
        f"{sum(record.actions.values()):,} actions of {len(record.actions)} kinds, {len(record.errors)} errors",
        f"longest stall {record.longest:.3f} s by the clock, {record.busiest:.3f} s of the thread's own time",
        *(f"  {wall:.3f} s ({own:.3f} s own) in {action}: {where}" for wall, own, action, where in worst),
        f"memory {record.memory[0]:.0f} MB at first, {record.memory[len(record.memory) // 3]:.0f} MB warm, "
        f"{record.memory[-1]:.0f} MB at the end; growth {record.growth:.1f} MB",
        f"open files {record.files[len(record.files) // 3]} warm, {record.files[-1]} at the end",
        *record.errors[:5],
    ]
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--stall", type=float, default=LONGEST_STALL, help="most seconds that the window may be deaf")
    parser.add_argument("--growth", type=float, default=MOST_GROWTH, help="most megabytes to grow by after warm-up")
    parser.add_argument("--loaded", action="store_true", help="other work runs on this machine")
    options = parser.parse_args()
    if not os.environ.get("DISPLAY"):
        runner = shutil.which("xvfb-run")
        if runner is None:
            print("a session needs a display; install a virtual one: apt-get install xvfb xauth", file=sys.stderr)
            return 1
        screen = f"-screen 0 {SCREEN} -dpi 96"
        return subprocess.run([runner, "-a", "-s", screen, sys.executable, *sys.argv], check=False).returncode
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from sizeviz.app.launch import SWITCH_SECONDS, application

    sys.setswitchinterval(SWITCH_SECONDS)
    app = application()
    with tempfile.TemporaryDirectory() as folder:
        record = Soak(options.seed, Path(folder)).play(60.0 * options.minutes, min(60.0, 6.0 * options.minutes))
    app.processEvents()
    print(told(record))
    stall = record.busiest if options.loaded else record.longest
    passed = not record.errors and stall <= options.stall and record.growth < options.growth
    print("passed" if passed else "failed")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
