"""The window's figures: stalls, Cancel, idling, the brush, panning, memory, the first page, exit codes.

    python benchmarks/window.py [--quick] [stalls|cancel|idle|brush|pan|memory|first|endings ...]

Needs a display; without one it starts a virtual one (``xvfb-run``). ``--quick`` takes four times larger elements on
the MRI slice. Each line gives the figure, what is aimed at, and whether it was reached.
"""

from __future__ import annotations

import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ENDINGS = ROOT / "tests" / "app" / "endings.py"
KEPT: list[object] = []
WAYS = ("button", "key", "terminate", "interrupt", "error", "run", "painted")


def main(arguments: list[str]) -> int:
    if not os.environ.get("DISPLAY") and sys.platform.startswith("linux"):
        runner = shutil.which("xvfb-run")
        if runner is None:
            print("this needs a display; install a virtual one: apt-get install xvfb xauth", file=sys.stderr)
            return 1
        command = [runner, "-a", "-s", "-screen 0 1700x1100x24 -dpi 96", sys.executable, __file__, *arguments]
        return subprocess.run(command, check=False).returncode
    sys.path.insert(0, str(ROOT / "tests"))
    quick = "--quick" in arguments
    names = [name for name in arguments if not name.startswith("-")] or list(PARTS)
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            PARTS[name](Path(folder), quick)
    return 0


def tell(words: str, value: float, unit: str, limit: float, at_least: bool = False) -> None:
    good = value >= limit if at_least else value <= limit
    sign = "≥" if at_least else "≤"
    print(f"{words:<58} {value:9.3g} {unit:<8} {sign} {limit:<6g} {'reached' if good else 'MISSED'}", flush=True)


def open_window(folder: Path, engine=None, size=(1500, 940)):
    from app.driver import Person

    from sizeviz.app.engine import PipelineEngine
    from sizeviz.app.launch import SWITCH_SECONDS, application
    from sizeviz.app.settings import Settings
    from sizeviz.app.window import MainWindow

    KEPT[:] = [application()]  # Qt ends with it
    sys.setswitchinterval(SWITCH_SECONDS)
    window = MainWindow(engine or PipelineEngine(), Settings(str(folder / "settings.ini")))
    window.resize(*size)
    window.show()
    window.activateWindow()
    person = Person(window)
    window.preparation.start()
    person.wait(lambda: window.preparation.is_done, 60)
    person.rest(400)
    return window, person


def coarse(quick: bool):
    from dataclasses import replace

    from sizeviz.app.engine import PipelineEngine

    class Coarse(PipelineEngine):
        def load(self, spec, monitor):
            source = super().load(spec, monitor)
            field = source.field.with_sizes(4.0 * source.field.sizes)
            return replace(source, field=field, reference=field)

    return Coarse() if quick else PipelineEngine()


def stalls(folder: Path, quick: bool) -> None:
    """Find the longest time the event loop did not come round, in a first and a second run of MRI by both methods."""
    from app.driver import Heartbeat

    window, person = open_window(folder, coarse(quick))
    beat = Heartbeat()
    for words in ("first", "second"):
        beat.reset()
        began, cpu = time.perf_counter(), time.process_time()
        window.controller.open_source("mri")
        person.rest(100)
        person.wait_settled(3600)
        took, cpu = time.perf_counter() - began, time.process_time() - cpu
        worst = sorted(beat.gaps)[-3:][::-1]
        tell(f"longest stall, {words} run ({took:.0f} s, {cpu:.0f} CPU s)", 1000 * worst[0], "ms", 50)
        print(f"    three longest: {', '.join(f'{1000 * gap:.0f} ms' for gap in worst)}; ", end="")
        print(f"the window's thread itself works at most {1000 * max(beat.works):.0f} CPU ms in one")
    beat.stop()
    window.close()


def cancel(folder: Path, quick: bool) -> None:
    """Find the longest time from Cancel to idle, over moments spread over a run of MRI."""
    window, person = open_window(folder, coarse(quick))
    controller = window.controller
    controller.automatic = False
    controller.open_source("mri")
    person.wait(lambda: controller.study is not None, 600)
    controller.cancel()
    person.wait(lambda: not controller.jobs.is_busy, 60)
    longest, words = 0.0, ""
    for share in (0.02, 0.06, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45):
        controller.apply()
        person.wait(lambda share=share: window.progress.bar.value() >= 1000 * share, 3600)
        stage = window.progress.words.text()
        began = time.perf_counter()
        controller.cancel()
        while controller.jobs.is_busy:
            person.window.thread().msleep(1)
            process()
        took = time.perf_counter() - began
        if took > longest:
            longest, words = took, f"{stage} at {share:.0%}"
    tell(f"Cancel to idle, the longest of 10 ({words})"[:58], longest, "s", 0.2)
    window.close()


def idle(folder: Path, quick: bool) -> None:
    """Measure what an idle window costs."""
    from app.fakes import FakeEngine
    from qtpy.QtCore import QEventLoop, QTimer

    window, person = open_window(folder, FakeEngine())
    window.controller.open_source("ring")
    person.wait_settled()
    person.rest(1000)
    loop = QEventLoop()
    QTimer.singleShot(4000, loop.quit)
    cpu = time.process_time()
    loop.exec() if hasattr(loop, "exec") else loop.exec_()
    tell("CPU of an idle window", 100 * (time.process_time() - cpu) / 4.0, "%", 1.0)
    window.close()


def brush(folder: Path, quick: bool) -> None:
    """Time from a brush event to the repaint, and to the limited and preserved fields, on 513 x 513 nodes."""
    from app.fakes import FakeEngine
    from qtpy.QtCore import QPoint
    from qtpy.QtTest import QTest

    from sizeviz.app.engine import PipelineEngine

    engine = FakeEngine()
    real = PipelineEngine()
    engine.targets = real.targets  # the meshes are not what is measured
    window, person = open_window(folder, engine)
    controller = window.controller
    controller.open_canvas(513, 0.06)
    person.wait_settled()
    window.actions_["paint"].trigger()
    window.paint.value.set_value(0.004)
    window.paint.radius.set_value(0.035)
    first, second = window.board.visible_panes
    person.rest(500)
    repaints, cpus, previews = [], [], []
    shown = []
    first.surface.canvas.view.frameSwapped.connect(lambda: shown.append(time.perf_counter()))
    preview = []
    controller.painting.changed.connect(lambda: preview.append(controller.painting.preview))
    glass = first.surface.glass
    person.drag(first, [(0.2, 0.2), (0.25, 0.25)], lift=False)
    for k in range(24):
        person.wait(lambda: not controller.jobs.is_busy, 300)
        person.rest(60)
        at = person.spot(first, 0.26 + 0.02 * k, 0.26 + 0.015 * k)
        before = (
            None if controller.painting.preview is None else controller.painting.preview.targets.get("size-preserving")
        )
        shown.clear()
        began, cpu = time.perf_counter(), time.process_time()
        QTest.mouseMove(glass, at + QPoint(0, 0))
        spin(lambda: shown)
        repaints.append(shown[0] - began)
        cpus.append(time.process_time() - cpu)
        spin(lambda before=before: controller.painting.preview.targets.get("size-preserving") is not before)
        frames = second.surface.canvas.view.frames
        for _ in range(200):
            if second.surface.canvas.view.frames > frames:
                break
            process()
        previews.append(time.perf_counter() - began)
    tell("brush event to repaint, median", 1000 * statistics.median(repaints), "ms", 33)
    tell("  the same in CPU time of the process", 1000 * statistics.median(cpus), "ms", 33)
    tell("limited and preserved at 513², median", 1000 * statistics.median(previews), "ms", 100)
    controller.painting.abort()
    window.close()


def pan(folder: Path, quick: bool) -> None:
    """Drag two panes of 200,000 elements, dragged; and what drawing them anew takes."""
    from app.fakes import FakeEngine

    window, person = open_window(folder, FakeEngine(n=448))
    window.controller.open_source("ring")
    person.wait_settled()
    person.rest(500)
    panes = window.board.visible_panes
    surface = panes[0].surface
    views = [pane.surface.canvas.view for pane in panes]
    swapped = []
    views[1].frameSwapped.connect(lambda: swapped.append(1))
    began, cpu = time.perf_counter(), time.process_time()
    for k in range(30):
        surface.move_camera(surface.camera.panned(3 if k % 20 < 10 else -3, 1, surface.height()))
        swapped.clear()
        spin(lambda: swapped)
    took, cpu = time.perf_counter() - began, time.process_time() - cpu
    tell("panning two panes of 200k elements", 30 / took, "fps", 5, at_least=True)
    print(f"    {1000 * cpu / 30:.0f} CPU ms a frame, moved; ", end="")
    person.rest(600)
    began, cpu = time.perf_counter(), time.process_time()
    for _ in range(5):
        for view in views:
            view.redraw()
        swapped.clear()
        spin(lambda: swapped)
    took, cpu = time.perf_counter() - began, time.process_time() - cpu
    print(f"{1000 * took / 5:.0f} ms, {1000 * cpu / 5:.0f} CPU ms drawn anew")
    window.close()


def memory(folder: Path, quick: bool) -> None:
    """Measure what 60 updates leave behind."""
    from app.fakes import FakeEngine, fake_source

    window, person = open_window(folder, FakeEngine(n=120))
    controller = window.controller
    controller.open_source("ring")
    person.wait_settled()
    sizes = []
    for k in range(90):
        controller.store.amend(controller.study.with_source(fake_source(f"s{k}")))
        controller.apply()
        person.wait_settled(60)
        sizes.append(resident())
    tell("memory over 60 updates", sizes[-1] - sizes[29], "MB", 40)
    window.close()


def first(folder: Path, quick: bool) -> None:
    """Time from the command to the first page on the screen, the second time."""
    for _ in range(3):
        environment = apart(folder) | {"SIZEVIZ_STARTED": str(time.time())}
        command = [sys.executable, str(ENDINGS), "first"]
        out = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
    tell("first window, warm", float(out.split()[-1]), "s", 2.5)


def endings(folder: Path, quick: bool) -> None:
    """List the exit codes."""
    for way in WAYS:
        command = [sys.executable, str(ENDINGS), way]
        code = subprocess.run(command, env=apart(folder), capture_output=True, check=False).returncode
        tell(f"exit code, {way}", code, "", 0)


def apart(folder: Path) -> dict[str, str]:
    """Return an environment in which a window finds nobody's settings."""
    return dict(os.environ) | {"XDG_CONFIG_HOME": str(folder / "config"), "XDG_STATE_HOME": str(folder / "state")}


def resident() -> float:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6


def spin(ready, seconds: float = 10.0) -> None:
    """Let the event loop go round, without a pause, until something is so."""
    end = time.perf_counter() + seconds
    while not ready():
        assert time.perf_counter() < end, "it never came"
        process()


def process() -> None:
    from qtpy.QtWidgets import QApplication

    QApplication.processEvents()


PARTS = {
    "first": first, "idle": idle, "pan": pan, "brush": brush, "memory": memory, "stalls": stalls, "cancel": cancel,
    "endings": endings,
}  # fmt: skip

if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
