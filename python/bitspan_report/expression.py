# SPDX-License-Identifier: Apache-2.0
"""Evaluates the expressions that a plan may have in place of a metric, as docs/study.md defines them."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

_NAME = re.compile(r"(?<![\w.])[A-Za-z_][\w.]*")
_FUNCTIONS: dict[str, Callable[..., Any]] = {"min": np.minimum, "max": np.maximum}  # a NaN stays one


def _quotient(a: Any, b: Any) -> Any:
    """Returns a / b, NaN for a division by zero."""
    return np.divide(a, np.where(np.equal(b, 0), np.nan, b))


_OPERATORS: dict[type[ast.operator], Callable[..., Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: _quotient,
}


def metrics_of(text: str) -> list[str]:
    """Returns the metrics that an expression names."""
    return [name for name in dict.fromkeys(_NAME.findall(text)) if name not in _FUNCTIONS]


def value_of(text: str, metrics: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Returns the expression's values over arrays of its metrics' values. Throws ValueError where it is none."""
    names = metrics_of(text)
    columns = {f"m{i}": metrics[name] for i, name in enumerate(names)}  # a metric's name is no name of Python's
    numbered = _NAME.sub(lambda found: found[0] if found[0] in _FUNCTIONS else f"m{names.index(found[0])}", text)

    def value(node: ast.expr) -> Any:
        match node:
            case ast.Constant(int() | float() as number):
                return float(number)
            case ast.Name(name) if name in columns:
                return columns[name]
            case ast.UnaryOp(ast.USub(), operand):
                return -value(operand)
            case ast.BinOp(left, operator, right) if type(operator) in _OPERATORS:
                return _OPERATORS[type(operator)](value(left), value(right))
            case ast.Call(ast.Name(name), [first, *others], []) if name in _FUNCTIONS:
                found = value(first)
                for other in others:
                    found = _FUNCTIONS[name](found, value(other))
                return found
        raise ValueError(f"{text}: no expression")

    try:
        return np.asarray(value(ast.parse(numbered.strip(), mode="eval").body), dtype=np.float64)
    except (SyntaxError, RecursionError, MemoryError):
        raise ValueError(f"{text}: no expression") from None
