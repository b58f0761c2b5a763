"""``$(eval ...)``: Python's expressions over a launch file's arguments, and nothing beyond them.

An expression is read by Python and worked out here, part by part, so that it reaches only what
`fibws.ros1.launch.vocabulary` has.
"""

from __future__ import annotations

import ast
from typing import Any

from fibws.ros1.launch.vocabulary import BINARY, BUILT_IN, COMPARE, METHODS, UNARY, Names, small

MOST_CHARACTERS = 10_000
"""Of an expression."""


def evaluate(expression: str, names: Names) -> Any:
    """The value of an expression.

    Args:
        expression: as Python has them: ``arg('speed') > 2``.
        names: what it may name besides `BUILT_IN`, which comes first.

    Raises:
        ValueError: it is no expression, or of a kind that is not known here, or it fails.
    """
    if len(expression) > MOST_CHARACTERS:
        raise ValueError(f"it has more than {MOST_CHARACTERS} characters")
    if "__" in expression:
        raise ValueError("it may not contain double underscores")
    try:
        tree = ast.parse(expression.strip(), mode="eval")
        value = _Evaluation(names).value(tree.body)
    except SyntaxError as error:
        raise ValueError(f"{error.msg}: {expression}") from None
    except (RecursionError, MemoryError):
        raise ValueError("it has too many parts in each other") from None
    except ValueError:
        raise
    except Exception as error:  # Whatever an operation has against its values.
        raise ValueError(f"{type(error).__name__}: {error}") from None
    if callable(value):
        raise ValueError("it is a function, which has no value until it is called")
    return value


class _Evaluation:
    """Works out one expression."""

    def __init__(self, names: Names) -> None:
        self._names = names

    def value(self, part: ast.expr) -> Any:
        return small(self._value(part))

    def _value(self, part: ast.expr) -> Any:
        match part:
            case ast.Constant(value=bool() | int() | float() | str() | None):
                return part.value
            case ast.Name():
                return self._named(part.id)
            case ast.BinOp():
                return self._binary(part)
            case ast.UnaryOp():
                return UNARY[type(part.op)](self.value(part.operand))
            case ast.BoolOp():
                return self._bool(part)
            case ast.Compare():
                return self._compare(part)
            case ast.IfExp():
                return self.value(part.body if self.value(part.test) else part.orelse)
            case ast.Call(keywords=[]):
                return self._call(part)
            case ast.List() | ast.Tuple():
                return [self.value(each) for each in part.elts]
            case ast.Dict():
                return self._dict(part)
            case ast.Subscript():
                return self._item(part)
        raise ValueError(f"this is not known here: {ast.unparse(part)}")

    def _named(self, name: str) -> Any:
        if name in BUILT_IN:
            return BUILT_IN[name]
        try:
            return self._names[name]
        except KeyError:
            fault = "neither a function here nor an <arg>"
            raise ValueError(f"nothing is called {name}: {fault}") from None

    def _binary(self, part: ast.BinOp) -> Any:
        left, right = self.value(part.left), self.value(part.right)
        if type(part.op) not in BINARY:
            raise ValueError(f"this is not known here: {ast.unparse(part)}")
        return BINARY[type(part.op)](left, right)

    def _bool(self, part: ast.BoolOp) -> Any:
        value: Any = None
        for each in part.values:
            value = self.value(each)
            if bool(value) is isinstance(part.op, ast.Or):
                break
        return value

    def _compare(self, part: ast.Compare) -> Any:
        left = self.value(part.left)
        result: Any = True
        for operation, each in zip(part.ops, part.comparators, strict=True):
            right = self.value(each)
            result = COMPARE[type(operation)](left, right)
            if not result:
                break
            left = right
        return result

    def _call(self, part: ast.Call) -> Any:
        arguments = [self.value(each) for each in part.args]
        if isinstance(part.func, ast.Attribute):
            return self._method(part.func, arguments)
        if not isinstance(part.func, ast.Name):
            raise ValueError(f"this is not known here: {ast.unparse(part)}")
        function = self._named(part.func.id)
        if not callable(function):
            raise ValueError(f"{part.func.id} is no function")
        return _listed(function(*arguments))

    def _method(self, part: ast.Attribute, arguments: list[Any]) -> Any:
        value = self.value(part.value)
        method = METHODS.get((type(value), part.attr))
        if method is None:
            raise ValueError(f"this is not known here: {ast.unparse(part)}()")
        found = method(value, *arguments)
        is_view = isinstance(value, dict) and part.attr != "get"
        return list(map(_listed, found)) if is_view else _listed(found)

    def _dict(self, part: ast.Dict) -> Any:
        keys = [self.value(key) for key in part.keys if key is not None]
        if len(keys) < len(part.keys):
            raise ValueError(f"this is not known here: {ast.unparse(part)}")
        return dict(zip(keys, map(self.value, part.values), strict=True))

    def _item(self, part: ast.Subscript) -> Any:
        value = self.value(part.value)
        if isinstance(part.slice, ast.Slice):
            bounds = (part.slice.lower, part.slice.upper, part.slice.step)
            return value[slice(*(each and self.value(each) for each in bounds))]
        return value[self.value(part.slice)]


def _listed(value: Any) -> Any:
    """A tuple as a list, so that there is one kind of it."""
    return list(value) if isinstance(value, tuple) else value
