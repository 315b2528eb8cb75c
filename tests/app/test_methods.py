from __future__ import annotations

import pytest

from sizeviz.app.panels.controls import ElidedLabel
from sizeviz.app.panels.options import MESHERS, MeshPanel
from sizeviz.meshing import GENERATORS
from sizeviz.study import METHODS


def choose(pane, method: str) -> None:
    pane.method.setCurrentIndex(pane.method.findData(method))
    pane.method.activated.emit(pane.method.currentIndex())


def test_a_pane_offers_every_method_and_runs_the_guaranteed_one_when_asked(qtbot, opened, engine) -> None:
    pane = opened.board.panes[0]
    assert tuple(pane.method.itemData(k) for k in range(pane.method.count())) == METHODS
    assert "run guaranteed" not in engine.calls
    with qtbot.waitSignal(opened.controller.settled, timeout=5000):
        choose(pane, "guaranteed")
    assert engine.calls[-1] == "run guaranteed"
    assert "% correct by the longest edge, worst R = " in pane.verdict.text()
    table = opened.statistics.model.table
    assert table.header[1] == "Guaranteed" and table.rows[0][1] == "576"


def test_every_mesher_that_is_installed_is_offered(qtbot, monkeypatch) -> None:
    assert tuple(GENERATORS) == MESHERS
    for found in (object(), None):
        monkeypatch.setattr("sizeviz.app.panels.options.find_spec", lambda name, found=found: found)
        panel = MeshPanel()
        qtbot.addWidget(panel)
        offered = [panel.mesher.itemData(k) for k in range(panel.mesher.count())]
        assert offered == [name for name in GENERATORS if name != "gmsh" or found is not None]


@pytest.mark.parametrize("size", [(1600, 1000), (1280, 800)])
def test_a_pane_has_room_for_its_own_head(qtbot, opened, size) -> None:
    opened.resize(*size)
    qtbot.wait(50)
    for pane in opened.board.visible_panes:
        assert pane.detail.text() and pane.detail.shown == pane.detail.text()
        if size[0] == 1600:
            assert pane.method.width() >= pane.method.sizeHint().width()
            assert pane.quantity.width() >= pane.quantity.sizeHint().width()


def test_words_without_room_end_in_an_ellipsis(qtbot) -> None:
    label = ElidedLabel("99.98 % correct, worst R = 1.03 at element 8123")
    qtbot.addWidget(label)
    label.resize(120, 20)
    assert label.shown.endswith("…") and label.text().endswith("8123")
    label.resize(900, 20)
    assert label.shown == label.text()
