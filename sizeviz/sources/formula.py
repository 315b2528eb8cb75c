"""Formulas in x and y: parsed by a grammar of their own, never evaluated as Python."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Value = NDArray[np.float64]
    Node = Callable[[Value, Value], Value]

LONGEST = 5000
"""Characters in a formula."""

DEEPEST = 100
"""Nested brackets, signs and powers in a formula."""

FUNCTIONS: dict[str, tuple[Callable[..., Value], int | None]] = {
    "abs": (np.abs, 1),
    "sqrt": (np.sqrt, 1),
    "hypot": (np.hypot, 2),
    "exp": (np.exp, 1),
    "log": (np.log, 1),
    "sin": (np.sin, 1),
    "cos": (np.cos, 1),
    "tan": (np.tan, 1),
    "atan2": (np.arctan2, 2),
    "min": (np.minimum, None),
    "max": (np.maximum, None),
}
"""What may be called, and with how many arguments; None stands for one or more."""

ALLOWED = f"x, y, pi, numbers, + - * / **, brackets and {', '.join(FUNCTIONS)}"

_TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([A-Za-z_]\w*)|(\*\*|[-+*/(),]))")

_BINDING = {"+": 10, "-": 10, "*": 20, "/": 20, "**": 40}
"""How strongly each operator binds; signs bind between products and powers, so that -x**2 is -(x**2)."""

_SIGN = 30

_OPERATORS: dict[str, Callable[[Value, Value], Value]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "**": np.power,
}


@dataclass(frozen=True)
class Formula:
    """A parsed formula: call it with arrays of x and y.

    Parameters
    ----------
    text : str
        What was parsed; equal formulas have equal text.

    Raises
    ------
    InputError
        If the text is no formula; the message says where, and what is allowed.
    """

    text: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "_root", _Parser(self.text).parsed())

    def __call__(self, x: Value, y: Value) -> Value:
        """Return the value at each point; not a number where a function is not defined."""
        root: Node = self.__dict__["_root"]
        x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        with np.errstate(all="ignore"):
            return np.broadcast_to(root(x, y), np.broadcast_shapes(x.shape, y.shape)).astype(np.float64)

    def __reduce__(self) -> tuple[type[Formula], tuple[str]]:
        """Travel between processes as text, to be parsed again."""
        return Formula, (self.text,)


class _Parser:
    """A Pratt parser: each operator takes what binds more strongly than itself."""

    def __init__(self, text: str) -> None:
        self.text, self.at, self.depth = text, 0, 0
        if len(text) > LONGEST:
            raise InputError(f"formula: {len(text)} characters are too many; use at most {LONGEST}")
        self.tokens = self._split()

    def _split(self) -> list[tuple[str, str, int]]:
        """Return kind, text and position of every token, an end mark last."""
        tokens, at = [], 0
        end = len(self.text.rstrip())
        while at < end:
            match = _TOKEN.match(self.text, at)
            if match is None:
                at += len(self.text[at:]) - len(self.text[at:].lstrip())
                raise InputError(f"formula: {self.text[at]!r} at position {at + 1} is not allowed; use {ALLOWED}")
            kind = ("number", "name", "operator")[(match.lastindex or 1) - 1]
            tokens.append((kind, match.group(match.lastindex or 1), match.start(match.lastindex or 1)))
            at = match.end()
        return [*tokens, ("end", "", end)]

    def parsed(self) -> Node:
        """Return the whole formula as a function."""
        node = self._expression(0)
        kind, text, position = self.tokens[self.at]
        if kind != "end":
            raise InputError(f"formula: {text!r} at position {position + 1} does not fit; an operator is missing")
        return node

    def _next(self) -> tuple[str, str, int]:
        token = self.tokens[self.at]
        self.at = min(self.at + 1, len(self.tokens) - 1)
        return token

    def _expression(self, binding: int) -> Node:
        self.depth += 1
        if self.depth > DEEPEST:
            raise InputError(f"formula: it is nested more than {DEEPEST} deep; write it more simply")
        first = self._operand()
        rest: list[tuple[Callable[..., Value], Node]] = []
        while (strength := _BINDING.get(self.tokens[self.at][1], -1)) > binding:
            operator = self._next()[1]
            # a power takes powers to its right: 2**3**2 is 2**9
            right = self._expression(strength - 1 if operator == "**" else strength)
            rest.append((_OPERATORS[operator], right))
        self.depth -= 1
        return _chained(first, rest) if rest else first

    def _operand(self) -> Node:
        kind, text, position = self._next()
        if kind == "number":
            return _constant(float(text))
        if kind == "name":
            return self._named(text, position)
        if text == "(":
            inner = self._expression(0)
            self._close(position)
            return inner
        if text in ("+", "-"):
            operand = self._expression(_SIGN)
            return operand if text == "+" else _applied(np.negative, operand)
        what = "it ends too soon" if kind == "end" else f"{text!r} at position {position + 1} is out of place"
        raise InputError(f"formula: {what}; expected a number, x, y, pi, a function or a bracket")

    def _named(self, name: str, position: int) -> Node:
        if name == "x":
            return lambda x, y: x
        if name == "y":
            return lambda x, y: y
        if name == "pi":
            return _constant(np.pi)
        if name not in FUNCTIONS:
            raise InputError(f"formula: unknown name {name[:40]!r} at position {position + 1}; use {ALLOWED}")
        function, count = FUNCTIONS[name]
        arguments = self._arguments(name)
        if count is None:
            return lambda x, y: reduce(function, [argument(x, y) for argument in arguments])
        if len(arguments) != count:
            raise InputError(f"formula: {name} takes {count} argument{'s' * (count > 1)}, got {len(arguments)}")
        return _applied(function, *arguments)

    def _arguments(self, name: str) -> list[Node]:
        _, text, position = self._next()
        if text != "(":
            raise InputError(f"formula: {name} is a function; write {name}(...)")
        arguments = [self._expression(0)]
        while self.tokens[self.at][1] == ",":
            self._next()
            arguments.append(self._expression(0))
        self._close(position)
        return arguments

    def _close(self, opened: int) -> None:
        if self._next()[1] != ")":
            raise InputError(f"formula: the bracket opened at position {opened + 1} is not closed")


def _constant(value: float) -> Node:
    number = np.float64(value)
    return lambda x, y: np.asarray(number)


def _chained(first: Node, rest: list[tuple[Callable[..., Value], Node]]) -> Node:
    """Return a row of operations, carried out from left to right: a long one must not nest as deep as it is long."""

    def value(x: Value, y: Value) -> Value:
        result = first(x, y)
        for function, operand in rest:
            result = function(result, operand(x, y))
        return result

    return value


def _applied(function: Callable[..., Value], *arguments: Node) -> Node:
    return lambda x, y: function(*(argument(x, y) for argument in arguments))
