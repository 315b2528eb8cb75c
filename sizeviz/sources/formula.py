"""Formulas in x and y: parsed, never executed as Python."""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from sizeviz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Evaluator = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

MAX_LENGTH = 4000
"""Characters a formula may have."""

MAX_DEPTH = 60
"""How deep its brackets and operations may nest."""

FUNCTIONS: dict[str, tuple[Callable[..., Any], int]] = {
    "abs": (np.abs, 1),
    "sqrt": (np.sqrt, 1),
    "exp": (np.exp, 1),
    "log": (np.log, 1),
    "sin": (np.sin, 1),
    "cos": (np.cos, 1),
    "tan": (np.tan, 1),
    "hypot": (np.hypot, 2),
    "atan2": (np.arctan2, 2),
    "min": (np.minimum, 0),
    "max": (np.maximum, 0),
}
"""The functions, and how many arguments each takes; 0 stands for two or more."""

_OPERATORS: dict[type[ast.operator], Callable[..., Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
}

_ALLOWED = f"x, y, pi, numbers, + - * / **, {', '.join(FUNCTIONS)}"


@dataclass(frozen=True, eq=False)
class Formula:
    """A function of x and y.

    Parameters
    ----------
    text : str
        The formula as it was written.
    evaluate : callable
        Takes arrays x and y of one shape, returns an array of that shape; not a number where undefined.
    """

    text: str
    evaluate: Evaluator

    def __call__(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the value at each point; NaN or infinite where the formula has no value."""
        x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        with np.errstate(all="ignore"):
            value = self.evaluate(x, y)
        return np.broadcast_to(np.asarray(value, dtype=np.float64), np.broadcast_shapes(x.shape, y.shape))


def parsed(text: str) -> Formula:
    """Return a formula.

    Parameters
    ----------
    text : str
        Such as ``min(0.25, abs(hypot(x - 0.5, y - 0.5) - 0.2575) + 0.25e-3)``.

    Raises
    ------
    InputError
        If it is empty, too long, no expression, or holds anything but numbers, x, y, pi and the listed operations.
    """
    shown = text.strip() if len(text) <= 60 else text.strip()[:57] + "..."
    if not text.strip():
        raise InputError(f"the formula is empty; write sizes in x and y, such as 0.02 + 0.1*x, from {_ALLOWED}")
    if len(text) > MAX_LENGTH:
        raise InputError(f"formula {shown!r} has {len(text)} characters; at most {MAX_LENGTH} are read")
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except SyntaxError as error:
        where = f" near character {error.offset}" if error.offset else ""
        raise InputError(f"formula {shown!r} cannot be read{where}; write it from {_ALLOWED}") from None
    except (ValueError, RecursionError, MemoryError):
        raise InputError(f"formula {shown!r} cannot be read; write it from {_ALLOWED}") from None
    return Formula(text.strip(), _compiled(tree.body, shown, 0))


def _compiled(node: ast.expr, shown: str, depth: int) -> Evaluator:
    if depth > MAX_DEPTH:
        raise InputError(f"formula {shown!r} nests deeper than {MAX_DEPTH} operations; split or simplify it")
    if isinstance(node, ast.Constant):
        return _constant(node, shown)
    if isinstance(node, ast.Name):
        return _name(node.id, shown)
    if isinstance(node, ast.BinOp):
        return _binary(node, shown, depth)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        inner = _compiled(node.operand, shown, depth + 1)
        return inner if isinstance(node.op, ast.UAdd) else (lambda x, y: np.negative(inner(x, y)))
    if isinstance(node, ast.Call):
        return _call(node, shown, depth)
    raise InputError(f"formula {shown!r} holds {_words(node)}, which is not allowed; write it from {_ALLOWED}")


def _constant(node: ast.Constant, shown: str) -> Evaluator:
    if isinstance(node.value, bool) or not isinstance(node.value, int | float):
        raise InputError(f"formula {shown!r} holds {_words(node)}, which is no number; write it from {_ALLOWED}")
    try:
        value = float(node.value)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise InputError(f"formula {shown!r} holds a number beyond 1e308; use a smaller one")
    constant = np.float64(value)
    return lambda x, y: constant


def _name(name: str, shown: str) -> Evaluator:
    if name == "x":
        return lambda x, y: x
    if name == "y":
        return lambda x, y: y
    if name == "pi":
        return lambda x, y: np.float64(np.pi)
    what = "a function: give its arguments in brackets" if name in FUNCTIONS else "unknown"
    raise InputError(f"formula {shown!r}: the name {name[:40]!r} is {what}; write it from {_ALLOWED}")


def _binary(node: ast.BinOp, shown: str, depth: int) -> Evaluator:
    operator = _OPERATORS.get(type(node.op))
    if operator is None:
        hint = "; powers are written **" if isinstance(node.op, ast.BitXor) else ""
        raise InputError(f"formula {shown!r} holds {_words(node.op)}, which is not allowed{hint}; use {_ALLOWED}")
    left, right = _compiled(node.left, shown, depth + 1), _compiled(node.right, shown, depth + 1)
    return lambda x, y: operator(left(x, y), right(x, y))


def _call(node: ast.Call, shown: str, depth: int) -> Evaluator:
    name = node.func.id if isinstance(node.func, ast.Name) else None
    if name not in FUNCTIONS:
        raise InputError(f"formula {shown!r} calls {_words(node.func)}, which is unknown; write it from {_ALLOWED}")
    function, arity = FUNCTIONS[name]
    if node.keywords or any(isinstance(argument, ast.Starred) for argument in node.args):
        raise InputError(f"formula {shown!r}: give {name} plain arguments, parted by commas")
    if len(node.args) != arity and not (arity == 0 and len(node.args) >= 2):
        wanted = "two or more" if arity == 0 else str(arity)
        raise InputError(f"formula {shown!r}: {name} takes {wanted} arguments, not {len(node.args)}")
    inner = [_compiled(argument, shown, depth + 1) for argument in node.args]
    if arity == 1:
        only = inner[0]
        return lambda x, y: function(only(x, y))
    return lambda x, y: reduce(function, (part(x, y) for part in inner))


def _words(node: ast.AST) -> str:
    """Return what a piece of syntax is called in a message."""
    if isinstance(node, ast.Name):
        return repr(node.id[:40])
    if isinstance(node, ast.Constant):
        return repr(node.value)[:40]
    return f"{type(node).__name__.lower()} syntax"
