"""Conditions on messages as rostopic's filters are written: ``m.data > 5 and m.name != ''``.

They are read as Python and never run as such: there is nothing in them but fields, values,
comparisons and a little arithmetic.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from typing import Any, TypeAlias

from fibws.errors import InvalidValue
from fibws.values.field_paths import Path
from fibws.values.printing import elements
from fibws.values.typedefs import FLOATS, Typedefs

Value: TypeAlias = Callable[[Any, Typedefs], Any]
"""Gives a value for a message and what its type is made of."""

_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.In: lambda part, all_: part in all_,
    ast.NotIn: lambda part, all_: part not in all_,
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: lambda a, b: operator.mul(_number(a), _number(b)),
    ast.Div: operator.truediv,
    ast.Mod: lambda a, b: operator.mod(_number(a), _number(b)),
    ast.Not: operator.not_,
    ast.USub: operator.neg,
}
"""Texts and lists are neither repeated nor formatted: a few characters would fill the memory."""
_FUNCTIONS: dict[str, Callable[[Any], Any]] = {"abs": abs, "len": len}


class Filter:
    """A condition on messages, which are called ``m`` in it.

    Raises:
        UsageError: it is none; the text says why.
    """

    def __init__(self, text: str) -> None:
        self._paths: list[Path] = []
        try:
            self._passes = self._value(ast.parse(text.strip(), mode="eval").body)
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            fault = getattr(error, "msg", None) or error
            raise InvalidValue(f"--filter {text!r} is no condition: {fault}") from None

    def check(self, typedefs: Typedefs) -> None:
        """See to it that messages of a type have the fields; else it raises `LookupError`."""
        for path in self._paths:
            path.field(typedefs)

    def passes(self, message: dict[str, Any], typedefs: Typedefs) -> bool:
        """Whether a message meets the condition.

        Raises:
            LookupError: an array is too short for that to be told.
            UsageError: its values cannot be compared or calculated with like that.
        """
        try:
            return bool(self._passes(message, typedefs))
        except (TypeError, ValueError, ArithmeticError, RecursionError) as error:
            raise InvalidValue(f"--filter cannot be told of a message: {error}") from None

    def _value(self, node: ast.expr) -> Value:
        match node:
            case ast.Constant(value) if isinstance(value, bool | int | float | str):
                return lambda message, typedefs: value
            case ast.Attribute() | ast.Subscript() if ast.unparse(node).startswith("m."):
                return self._field(ast.unparse(node).removeprefix("m.").replace(".", "/"))
            case ast.List(parts) | ast.Tuple(parts):
                return self._applied(lambda *values: values, *parts)
            case ast.BoolOp(ast.And(), parts):
                values = [self._value(part) for part in parts]
                return lambda m, typedefs: all(value(m, typedefs) for value in values)
            case ast.BoolOp(ast.Or(), parts):
                values = [self._value(part) for part in parts]
                return lambda m, typedefs: any(value(m, typedefs) for value in values)
            case ast.Compare(left, [op], [right]) | ast.BinOp(left, op, right) if (
                type(op) in _OPERATORS
            ):
                return self._applied(_OPERATORS[type(op)], left, right)
            case ast.Compare(left, [op, *ops], [right, *others]) if ops:  # 0 < m.x < 5
                rest = ast.Compare(right, ops, others)
                return self._value(ast.BoolOp(ast.And(), [ast.Compare(left, [op], [right]), rest]))
            case ast.UnaryOp(op, part) if type(op) in _OPERATORS:
                return self._applied(_OPERATORS[type(op)], part)
            case ast.Call(ast.Name(name), [part], []) if name in _FUNCTIONS:
                return self._applied(_FUNCTIONS[name], part)
        raise ValueError(f"there is no room for {ast.unparse(node)}; write as in m.data > 5")

    def _applied(self, function: Callable[..., Any], *parts: ast.expr) -> Value:
        values = [self._value(part) for part in parts]
        return lambda m, typedefs: function(*(value(m, typedefs) for value in values))

    def _field(self, text: str) -> Value:
        path = Path(text)
        self._paths.append(path)

        def value(message: Any, typedefs: Typedefs) -> Any:
            found, field = path.pick(message, typedefs), path.field(typedefs)
            if field.length is not None:
                return elements(found, field)
            # JSON has no NaN.
            return float("nan") if found is None and field.type in FLOATS else found

        return value


def _number(value: Any) -> Any:
    if not isinstance(value, int | float):
        raise TypeError(f"{value!r} is no number")
    return value
