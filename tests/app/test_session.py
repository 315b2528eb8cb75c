"""One session as a person would have it, on the real pipeline, by mouse and keyboard, judged by what is seen."""

from __future__ import annotations

import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from app.driver import Heartbeat, Person, blue_share, orange_share
from qtpy.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from qtpy.QtGui import QDropEvent
from qtpy.QtWidgets import QToolButton

from sizeviz.app.engine import PipelineEngine
from sizeviz.app.settings import Settings
from sizeviz.app.window import MainWindow
from sizeviz.monitor import SILENT

pytestmark = pytest.mark.display

COARSER = 4.0
"""How much larger the session asks for elements, so that the whole of it takes seconds."""


class CoarseEngine(PipelineEngine):
    """The real pipeline, fed with larger sizes; it notes on which threads it works."""

    def __init__(self) -> None:
        self.threads: set[int] = set()

    def load(self, spec, monitor=SILENT):
        source = super().load(spec, monitor)
        if spec != "mri":
            return source
        field = source.field.with_sizes(COARSER * source.field.sizes)
        return replace(source, field=field, reference=field)

    def run(self, study, method, monitor):
        self.threads.add(threading.get_ident())
        return super().run(study, method, monitor)


@pytest.fixture
def gl_window(qtbot, tmp_path):
    window = MainWindow(CoarseEngine(), Settings(str(tmp_path / "settings.ini")))
    qtbot.addWidget(window)
    window.resize(1500, 940)
    window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow, timeout=5000)
    window.preparation.start()  # as the application does, while the person reads the first page
    qtbot.waitUntil(lambda: window.preparation.is_done, timeout=60_000)
    yield window
    window.close()


def table(window) -> dict[str, tuple[str, ...]]:
    return {row[0]: row[1:] for row in window.statistics.model.table.rows}


@pytest.mark.slow
def test_a_session(gl_window, tmp_path) -> None:
    window, person = gl_window, Person(gl_window)
    controller, board = window.controller, window.board
    beat, measured = Heartbeat(), {}

    # open MRI from the gallery, wait for both methods
    card = next(b for b in window.welcome.findChildren(QToolButton) if b.accessibleName().endswith("MRI"))
    beat.reset()
    card.click()
    person.wait_settled()
    measured["longest gap, first run (ms)"] = round(1000 * beat.longest)
    limited, preserved = board.visible_panes
    shares = [orange_share(person.look_at(pane)) for pane in (limited, preserved)]
    assert shares[0] > 2 * shares[1] and blue_share(person.look_at(preserved)) > 0.2
    assert "correct, worst R" in limited.verdict.text()

    # linked zoom at the cursor: both panes show the same place, and the point under the cursor stays
    before = preserved.surface.camera
    person.wheel(limited, 0.6, 0.5, 6)
    assert limited.surface.camera == preserved.surface.camera != before
    assert limited.surface.camera.height < before.height / 2.5

    # go to the worst element, pin it by a click
    person.key(Qt.Key.Key_W)
    ratios = limited.subject.report.ratios["mean-edge"]
    worst = int(ratios.argmax())
    assert window.inspector.pin == ("gradient-limiting", worst)
    assert orange_share(person.look_at(limited)) > 0.001
    person.key(Qt.Key.Key_P)
    person.click(limited, limited.surface.camera.x, limited.surface.camera.y)
    assert window.inspector.pin == ("gradient-limiting", worst)

    # paint three strokes, undo two, redo one
    person.key(Qt.Key.Key_F)
    person.key(Qt.Key.Key_B)
    window.judge_panel.automatic.setChecked(False)
    fields = [controller.study.source.field]
    beat.reset()
    for y in (0.3, 0.5, 0.7):
        person.drag(limited, [(0.2, y), (0.5, y + 0.05), (0.8, y)])
        person.wait(lambda: controller.painting.stroke is None)
        fields.append(controller.study.source.field)
    measured["longest gap, painting (ms)"] = round(1000 * beat.longest)
    assert len({id(field) for field in fields}) == 4 and controller.store.stack.count() == 3
    for _ in range(2):
        person.key(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert controller.study.source.field is fields[1]
    person.key(Qt.Key.Key_Y, Qt.KeyboardModifier.ControlModifier)
    assert controller.study.source.field is fields[2]
    person.key(Qt.Key.Key_B)
    person.wait(lambda: not window.is_settling)
    assert not limited.badge.isHidden()  # painted over, not run yet

    # cancel a run half-way
    window.judge_panel.apply.click()
    person.wait(lambda: window.progress.bar.value() > 50)
    began = time.perf_counter()
    window.progress.button.click()
    person.wait(lambda: not controller.jobs.is_busy, 5.0)
    idle = time.perf_counter() - began
    measured["cancel to idle (ms)"] = round(1000 * idle)
    assert idle < 1.0  # 0.2 s on a machine of one's own; tests share theirs
    person.wait(lambda: not window.is_settling)
    assert controller.missing() and not limited.badge.isHidden()

    # change alpha, see the table change
    rows = table(window)
    window.judge_panel.automatic.setChecked(True)
    person.type_number(window.size_panel.alpha.spin, "1")
    window.judge_panel.apply.click()
    person.wait_settled()
    assert controller.missing() == () and limited.badge.isHidden()
    assert table(window)["Elements"] != rows["Elements"]
    assert controller.study.options.limit.epsilon == pytest.approx(1.0)

    # drop a file
    path = tmp_path / "sizes.npy"
    np.save(path, np.full((9, 9), 0.08))
    _drop(window, path)
    person.wait(lambda: controller.study.source.name == "sizes")
    person.wait_settled()
    assert "100 %" in preserved.verdict.text() or "correct" in preserved.verdict.text()

    # all work was done off the window's thread; close during a run
    engine = controller.engine
    assert engine.threads and threading.get_ident() not in engine.threads
    controller.open_source("mri")
    person.wait(lambda: controller.jobs.is_busy)
    person.rest(100)
    beat.stop()
    window.close()
    print(measured)
    assert not window.isVisible() and controller.jobs.n_at_work == 0


def _drop(window, path) -> None:
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(path))])
    where = QPointF(300, 300) if hasattr(QDropEvent, "position") else QPoint(300, 300)
    buttons, keys = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    window.dropEvent(QDropEvent(where, Qt.DropAction.CopyAction, mime, buttons, keys))
