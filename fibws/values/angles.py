"""Angles as parameter files may have them: ``deg(180)``, ``rad(pi/2)``."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable

_OPERATIONS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
}


def degrees(text: str) -> float:
    """The radians of ``deg(180)``, or of ``180``; it raises `ValueError` if it is no number."""
    inner = _within("deg", text)
    try:
        return math.radians(float(inner))
    except ValueError:
        raise ValueError(f"{text!r} is no angle in degrees: write deg(180)") from None


def radians(text: str) -> float:
    """The value of ``rad(2*pi)``, or of ``2*pi``; it raises `ValueError` if that is no sum."""
    try:
        return _value(ast.parse(_within("rad", text), mode="eval").body)
    except (SyntaxError, ValueError, ArithmeticError, RecursionError, MemoryError):
        raise ValueError(f"{text!r} is no angle in radians: write rad(pi/2)") from None


def _within(word: str, text: str) -> str:
    text = text.strip()
    return text[len(word) + 1 : -1] if text.startswith(f"{word}(") else text


def _value(term: ast.expr) -> float:
    match term:
        case ast.Constant(int() | float() as number):
            return float(number)
        case ast.Name("pi"):
            return math.pi
        case ast.UnaryOp(ast.USub(), operand):
            return -_value(operand)
        case ast.BinOp(left, operation, right) if type(operation) in _OPERATIONS:
            return _OPERATIONS[type(operation)](_value(left), _value(right))
        case _:
            raise ValueError
