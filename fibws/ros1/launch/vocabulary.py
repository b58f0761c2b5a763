"""What an expression of ``$(eval ...)`` may use: operators, functions and methods, each in bounds.

Nothing here takes long or much memory, whatever it is given.
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

MOST_BITS = 4096
"""Of a whole number."""
MOST_DIGITS = 400
"""That a number is rounded to."""
MOST_ITEMS = 10_000
"""Of a list and those in it, each as often as it is there, and characters of their texts."""

_GROWING = ("factorial", "comb", "perm", "prod", "lcm")
"""What makes large numbers of small ones."""
_WIDTH = re.compile(r"(?:\*|\d{4})[.\d*]*+[hlL]?[a-zA-Z%]")
"""A field of a format that is very wide."""


def small(value: Any) -> Any:
    """The value; it raises `ValueError` if it is too large."""
    if isinstance(value, int):
        _check_bits(value.bit_length())
    if isinstance(value, str | list | dict):
        _check_length(_weight(value))
    return value


def _check_bits(bits: int) -> None:
    if bits > MOST_BITS:
        raise ValueError("it has a number that is too large")


def _check_length(length: int, most: int = MOST_ITEMS) -> None:
    if length > most:
        raise ValueError("it has a text or a list that is too long")


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


def _power(base: Any, exponent: Any) -> Any:
    # 1 and -1 stay small to any power, and a negative one makes a fraction.
    if isinstance(base, int) and isinstance(exponent, int) and abs(base) > 1:
        _check_bits(base.bit_length() * exponent)
    return base**exponent


def _shifted(number: Any, bits: Any) -> Any:
    if isinstance(number, int) and isinstance(bits, int):
        _check_bits(number.bit_length() + bits)
    return number << bits


def _product(left: Any, right: Any) -> Any:
    for times, repeated in ((left, right), (right, left)):
        if isinstance(times, int) and isinstance(repeated, str | list):
            _check_length(_weight(repeated) * times)
    return left * right


def _modulo(left: Any, right: Any) -> Any:
    if isinstance(left, str) and _WIDTH.search(left):
        raise ValueError("it has a text that is too long")
    return left % right


BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _product,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: _modulo,
    ast.Pow: _power,
    ast.LShift: _shifted,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
}
COMPARE: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
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


def _replaced(text: str, old: str, new: str, *count: int) -> str:
    _check_length((len(text) + 1) * (len(new) + 1), MOST_ITEMS * 100)
    return text.replace(old, new, *count)


def _joined(text: str, parts: Any) -> str:
    _check_length(len(parts) * (len(text) + 1), MOST_ITEMS * 100)
    return text.join(parts)


_PLAIN: dict[type, set[str]] = {
    str: {
        *("lower", "upper", "capitalize", "title", "strip", "lstrip", "rstrip", "split"),
        *("rsplit", "splitlines", "startswith", "endswith", "find", "count", "index"),
        *("isdigit", "isalpha", "isalnum", "isnumeric", "islower", "isupper", "isspace"),
        *("partition", "rpartition"),
    },
    list: {"index", "count"},
    dict: {"get", "keys", "values", "items"},
}
"""The methods that values have here: none that changes them, writes files or repeats texts."""
METHODS: dict[tuple[type, str], Callable[..., Any]] = {
    (type_, name): getattr(type_, name) for type_, names in _PLAIN.items() for name in names
}
METHODS |= {(str, "replace"): _replaced, (str, "join"): _joined}


def _of_little(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, for small numbers alone."""

    def guarded(*arguments: Any) -> Any:
        if not all(map(_is_little, arguments)):
            raise ValueError("it has a number that is too large")
        return function(*arguments)

    return guarded


def _is_little(value: Any) -> bool:
    if isinstance(value, list):
        return len(value) <= 100 and all(map(_is_little, value))
    return isinstance(value, int | float) and abs(value) <= 1000


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
