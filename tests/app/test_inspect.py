"""Hovering, pinning, the worst elements, histograms, the table."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from app.driver import at, glass
from qtpy.QtCore import QPoint, Qt
from qtpy.QtWidgets import QApplication

from sizeviz.app.inspect.judge import worst


def test_hover_reads_and_click_pins_the_element_under_the_cursor(qtbot, opened) -> None:
    mesh = opened.board.panes[0].subject.mesh
    centre = mesh.points[mesh.quads[300]].mean(axis=0)
    where = at(opened, *centre)
    qtbot.mouseMove(glass(opened), where + QPoint(40, 40))  # a pointer that is there already would not move
    qtbot.mouseMove(glass(opened), where)
    qtbot.waitUntil(lambda: "element 300" in opened.readout.text(), timeout=5000)
    assert "h*" in opened.readout.text()
    assert "hover" in glass(opened).marks
    qtbot.mouseClick(glass(opened), Qt.MouseButton.LeftButton, pos=where)
    assert opened.inspector.pin == ("gradient-limiting", 300)
    assert "pin" in glass(opened).marks and "pin" not in glass(opened, 1).marks
    qtbot.mouseClick(glass(opened), Qt.MouseButton.LeftButton, pos=where)
    assert opened.inspector.pin is None


def test_the_worst_element_is_gone_to_and_marked_in_the_list(opened) -> None:
    opened.actions_["worst-ratio"].trigger()
    pane = opened.board.active
    ratios = pane.subject.report.ratios["mean-edge"]
    element = int(ratios.argmax())
    assert opened.inspector.pin == (pane.view.method, element)
    x, y = pane.subject.mesh.points[pane.subject.mesh.quads[element]].mean(axis=0)
    assert (pane.surface.camera.x, pane.surface.camera.y) == pytest.approx((x, y))
    assert opened.worst.view.selectionModel().selectedRows()[0].row() == 0
    assert list(opened.worst.elements) == list(np.argsort(-ratios, kind="stable")[:100])


def test_a_row_of_the_list_leads_to_its_element(opened) -> None:
    opened.worst.view.selectRow(7)
    assert opened.inspector.pin == (opened.board.active.view.method, int(opened.worst.elements[7]))


def test_a_range_of_the_histogram_selects_exactly_those_elements(opened) -> None:
    histogram = opened.histograms[0]
    histogram.set_range(1.1, 1.2)
    ratios = opened.board.active.subject.report.ratios["mean-edge"]
    expected = np.flatnonzero((ratios >= 1.1) & (ratios <= 1.2))
    assert len(expected) and list(opened.board.selection.elements) == list(expected)
    lines = next(layer for layer in opened.board.panes[0].spec.layers if layer.name == "selected")
    assert len(lines.segments) == 4 * len(expected)
    histogram.clear_button.setChecked(False)
    assert opened.board.selection is None


def test_the_table_is_copied_in_three_formats(opened) -> None:
    beginnings = {"CSV": ",Gradient limiting", "Markdown": "|  | Gradient", "LaTeX": r"\begin{tabular}{lrr}"}
    for name, first in beginnings.items():
        opened.statistics.copy(name)
        assert QApplication.clipboard().text().startswith(first)
    opened.statistics.copy("CSV")
    rows = list(csv.reader(io.StringIO(QApplication.clipboard().text())))
    assert len(rows) == 13 and rows[1] == ["Elements", "576", "576"]


def test_the_worst_are_worst_first_and_ties_go_by_number() -> None:
    values = np.array([0.5, 0.1, 0.9, 0.1, 0.3])
    assert list(worst(values, 3)) == [1, 3, 4] and list(worst(values, 99)) == [1, 3, 4, 0, 2]
