"""The trace of Algorithm 1 against the algorithm itself and against the exact envelopes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sizeviz.errors import InputError
from sizeviz.sizing import PreserveOptions, preserved
from sizeviz.sizing.ball import BallStep, ball_at, ball_on_line, case_of
from sizeviz.sizing.line import paper_valley, preserved_on_line
from tests import fields

CATALOGUE = fields.catalogue()


def check_steps(trace):
    radius = trace.start
    for step in trace.steps:
        assert step.before == radius
        assert step.case == case_of(step.before, step.allowed, step.distance)
        wanted = {"i": step.allowed, "ii": step.distance}.get(step.case, step.before)
        assert step.after == wanted <= step.before
        radius = step.after
    assert trace.radius == radius
    distances = [step.distance for step in trace.steps]
    assert distances == sorted(distances)


@pytest.mark.parametrize("name", CATALOGUE)
@pytest.mark.parametrize("alpha", [0.7, 2.0])
def test_trace_ends_at_algorithm_1_and_blocks_at_the_exact_envelope(name, alpha):
    field = CATALOGUE[name]
    by_edges = preserved(field, PreserveOptions(alpha=alpha, beta=0.9, distance="edges")).sizes
    exact = preserved(field, PreserveOptions(alpha=alpha, beta=0.9)).sizes
    nodes = np.random.default_rng(3).choice(np.unique(field.background.triangles), 4)
    for node in nodes:
        trace = ball_at(field, int(node), PreserveOptions(alpha=alpha, beta=0.9))
        check_steps(trace)
        np.testing.assert_allclose(trace.size, by_edges[node], rtol=1e-13)
        np.testing.assert_allclose(trace.exact_size, exact[node], rtol=1e-12)
        # the blocking point attains what the ball is stopped by
        distance = np.hypot(*(trace.blocking - trace.centre))
        attained = max(field.at([trace.blocking])[0], distance / alpha)
        np.testing.assert_allclose(0.9 * attained, exact[node], rtol=1e-10)
        assert trace.exact_radius <= trace.start * (1 + 1e-15)


def test_printed_line_18_gives_another_radius():
    field = CATALOGUE["adaptive triangles"]  # no two distances are equal: the printed radius depends on the order
    printed = PreserveOptions(distance="edges-as-printed")
    made = preserved(field, printed).sizes
    traces = [ball_at(field, node, printed) for node in range(0, 150, 7)]
    np.testing.assert_allclose([trace.size for trace in traces], made[:150:7], rtol=1e-12)
    assert any(step.case == "ii" and step.after != step.distance for trace in traces for step in trace.steps)


@pytest.mark.parametrize("alpha", [0.5, 1.0, 3.0])
def test_on_a_line(alpha):
    field = paper_valley()
    wanted = preserved_on_line(field, alpha, 0.8, field.x)
    for node in range(len(field.x)):
        trace = ball_on_line(field, node, PreserveOptions(alpha=alpha, beta=0.8))
        check_steps(trace)
        np.testing.assert_allclose(trace.exact_size, wanted[node], rtol=1e-14)
        attained = max(field.at(trace.blocking)[0], abs(trace.blocking[0] - field.x[node]) / alpha)
        np.testing.assert_allclose(0.8 * attained, wanted[node], rtol=1e-12)
        assert trace.size >= trace.exact_size * (1 - 1e-14)  # only nodes are looked at


def test_every_case_is_told_apart_and_a_step_cannot_be_changed():
    cases = [case_of(2.0, 1.0, 0.5), case_of(2.0, 1.0, 1.5), case_of(2.0, 1.0, 3.0), case_of(2.0, 2.0, 1.0)]
    assert [*cases, case_of(2.0, 3.0, 2.5)] == ["i", "ii", "iii", "iv", "v"]
    with pytest.raises(dataclasses.FrozenInstanceError):
        BallStep(0, 0.0, 1.0, 1.0, 1.0, "iv").node = 1
    with pytest.raises(InputError, match="from 0 to 3"):
        ball_at(CATALOGUE["one cell"], 4, PreserveOptions())
