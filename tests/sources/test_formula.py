"""The formula parser: values against Python's own, refusals, and random text."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sizeviz.errors import InputError
from sizeviz.sources import Formula

NAMES = {name: getattr(math, name) for name in ("sqrt", "hypot", "exp", "log", "sin", "cos", "tan", "atan2", "pi")}


@pytest.mark.parametrize(
    "text",
    [
        "1 + 2*x - y/4",
        "-x**2",
        "2**-x",
        "2**3**0.5*x",
        "-(-x) + +y",
        "min(x, y, 0.3) + max(x)",
        "atan2(y, x) * pi",
        "hypot(x - 0.5, y - .5) + 1e-3 + 2.E2",
        "sqrt(abs(x - 7)) * exp(-y) + log(3) - tan(sin(cos(x)))",
    ],
)
def test_values_are_those_of_arithmetic(text):
    formula = Formula(text)
    for x, y in ((0.3, 0.7), (1.9, 0.2)):
        unary_max = text.replace("max(x)", "x")
        wanted = eval(unary_max, {"__builtins__": {}}, {**NAMES, "x": x, "y": y, "min": min, "max": max, "abs": abs})
        assert formula(np.array([x]), np.array([y]))[0] == pytest.approx(wanted, rel=1e-14)
    assert pickle.loads(pickle.dumps(formula)) == formula


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "ends too soon"),
        ("x +", "ends too soon"),
        ("x y", "operator is missing"),
        ("(x", "not closed"),
        ("z + 1", "unknown name 'z'.*hypot"),
        ("__import__('os')", "not allowed|unknown name"),
        ("x.real", "not allowed|does not fit"),
        ("sqrt(x, y)", "takes 1 argument, got 2"),
        ("sqrt x", "write sqrt"),
        ("min()", "out of place"),
        ("(" * 500 + "x" + ")" * 500, "nested"),
        ("x + " * 2000 + "x", "too many"),
    ],
)
def test_refusals_say_what_is_wrong(text, words):
    with pytest.raises(InputError, match=words) as caught:
        Formula(text)
    assert "\n" not in str(caught.value)


@given(st.text(alphabet="xyzpi0123456789.eE+-*/(), sqrtminaxhypo_\n\t;'[]", max_size=60))
def test_random_text_parses_or_is_refused_in_one_line(text):
    try:
        value = Formula(text)(np.array([0.2, 0.8]), np.array([0.4, 0.1]))
    except InputError as refusal:
        assert str(refusal).startswith("formula:")
    else:
        assert value.shape == (2,)


@pytest.mark.parametrize("text", ["0.1" + " + 0.2*x" * 500, "1" + "/x*x" * 900, "x" + "**1" * 50])
def test_a_long_row_of_operations_is_no_deep_nesting(text: str) -> None:
    x = np.linspace(0.5, 1.0, 5)
    value = Formula(text)(x, x)
    assert np.allclose(value, eval(text, {"x": x}), rtol=1e-12)
