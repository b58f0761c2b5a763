"""``$(eval ...)``: Python's expressions over a launch file's arguments, and nothing beyond them.

An expression is read by Python and worked out here, part by part, so that it reaches only what is
listed here. It cannot take long or much memory: texts, lists and numbers are kept small.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

Names: TypeAlias = Mapping[str, Any]
"""What an expression may name: values, and functions, which are called."""

MOST_CHARACTERS = 10_000
"""Of an expression."""
MOST_BITS = 4096
"""Of a whole number."""
MOST_DIGITS = 400
"""That a number is rounded to."""
MOST_ITEMS = 10_000
"""Of a list and those in it, each as often as it is there, and characters of their texts."""

_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
_UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
}
_COMPARE: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda item, container: item in container,
    ast.NotIn: lambda item, container: item not in container,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
}
_METHODS: dict[type, set[str]] = {
    str: {
        *("lower", "upper", "capitalize", "title", "strip", "lstrip", "rstrip", "split"),
        *("rsplit", "splitlines", "startswith", "endswith", "find", "count", "index", "replace"),
        *("isdigit", "isalpha", "isalnum", "isnumeric", "islower", "isupper", "isspace", "join"),
        *("partition", "rpartition"),
    },
    list: {"index", "count"},
    dict: {"get", "keys", "values", "items"},
}
"""The methods that values have here: none that changes them, writes files or repeats texts."""

_GROWING = ("factorial", "comb", "perm", "prod", "lcm")
"""What makes large numbers of small ones."""
_WIDTH = re.compile(r"(?:\*|\d{4})[.\d*]*+[hlL]?[a-zA-Z%]")
"""A field of a format that is very wide."""


def _of_little(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, for small numbers alone."""

    def guarded(*arguments: Any) -> Any:
        if not all(map(_is_little, arguments)):
            raise ValueError("it has a number that is too large")
        return function(*arguments)

    return guarded


_MATH = {name: each for name, each in vars(math).items() if not name.startswith("_")}
_MATH.update((name, _of_little(_MATH[name])) for name in _GROWING)


def _round(number: Any, digits: int | None = None) -> Any:
    if digits is not None and abs(digits) > MOST_DIGITS:
        raise ValueError("it has a number that is too large")
    return round(number, digits)


BUILT_IN: Names = {
    **_MATH,
    "true": True,
    "false": False,
    "list": list,
    "dict": dict,
    "map": lambda function, *items: list(map(function, *items)),
    "str": str,
    "float": float,
    "int": int,
    "bool": bool,
    "abs": abs,
    "all": all,
    "any": any,
    "len": len,
    "max": max,
    "min": min,
    "round": _round,
    "sorted": sorted,
    "sum": sum,
}
"""What every expression may name."""


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
        return _small(self._value(part))

    def _value(self, part: ast.expr) -> Any:
        match part:
            case ast.Constant(value=bool() | int() | float() | str() | None):
                return part.value
            case ast.Name():
                return self._named(part.id)
            case ast.BinOp():
                return self._binary(part)
            case ast.UnaryOp():
                return _UNARY[type(part.op)](self.value(part.operand))
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
        operation = type(part.op)
        if operation not in _BINARY:
            raise ValueError(f"this is not known here: {ast.unparse(part)}")
        if operation in (ast.Pow, ast.LShift) and _is_whole(left) and _is_whole(right):
            # 1 and -1 stay small to any power, and a negative one makes a fraction.
            bits = left.bit_length() * right if abs(left) > 1 else 1
            if operation is ast.LShift:
                bits = left.bit_length() + right
            if bits > MOST_BITS:
                raise ValueError("it has a number that is too large")
        elif operation is ast.Mult and not (_is_number(left) and _is_number(right)):
            times, repeated = (left, right) if _is_number(left) else (right, left)
            if not _is_whole(times) or _weight(repeated) * times > MOST_ITEMS:
                raise ValueError("it has a text or a list that is too long")
        elif operation is ast.Mod and isinstance(left, str) and _WIDTH.search(left):
            raise ValueError("it has a text that is too long")
        return _BINARY[operation](left, right)

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
            result = _COMPARE[type(operation)](left, right)
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
        if part.attr not in _METHODS.get(type(value), ()):
            raise ValueError(f"this is not known here: {ast.unparse(part)}()")
        if part.attr in ("replace", "join"):
            pieces = len(value) + 1 if part.attr == "replace" else sum(map(len, arguments), 1)
            longest = max([len(value), *(len(each) for each in arguments[-1:])])
            if pieces * longest > MOST_ITEMS * 100:
                raise ValueError("it has a text that is too long")
        found = getattr(value, part.attr)(*arguments)
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


def _small(value: Any) -> Any:
    """The value, if it is not too large."""
    if isinstance(value, int) and value.bit_length() > MOST_BITS:
        raise ValueError("it has a number that is too large")
    if isinstance(value, str | list | dict) and _weight(value) > MOST_ITEMS:
        raise ValueError("it has a text or a list that is too long")
    return value


def _weight(value: Any) -> int:
    """How many items and characters a value has; more than `MOST_ITEMS` are not told apart."""
    weight = 0
    parts = [value]
    while parts and weight <= MOST_ITEMS:
        part = parts.pop()
        weight += 1
        if isinstance(part, str):
            weight += len(part) - 1
        elif isinstance(part, list | dict):
            weight += len(part) - 1
            parts += [*part, *part.values()] if isinstance(part, dict) else part
    return weight


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int)


def _is_little(value: Any) -> bool:
    if isinstance(value, list):
        return len(value) <= 100 and all(map(_is_little, value))
    return isinstance(value, int | float) and abs(value) <= 1000
