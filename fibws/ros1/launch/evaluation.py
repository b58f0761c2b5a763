"""The value of ``$(eval ...)``: a Python expression over a launch file's arguments."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from typing import Any

from fibws.errors import InvalidValue
from fibws.values.expressions import FUNCTIONS, Expression, Names, Value, bounded


def _limited(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function for small numbers only."""

    def limited(*arguments: Any) -> Any:
        if not all(map(_is_small, arguments)):
            raise InvalidValue("number too large (limit: 1000)")
        return function(*arguments)

    return limited


def _is_small(value: Any) -> bool:
    if isinstance(value, list):
        return len(value) <= 100 and all(map(_is_small, value))
    return isinstance(value, int | float) and abs(value) <= 1000


_GROWING = ("factorial", "comb", "perm", "prod", "lcm")
"""Functions whose results are much larger than their arguments."""
_MATH = {name: each for name, each in vars(math).items() if not name.startswith("_")}
ALLOWED_NAMES: Names = {
    **_MATH,
    **{name: _limited(_MATH[name]) for name in _GROWING},
    **FUNCTIONS,
    "true": True,
    "false": False,
}
"""The names that every expression may use, as in roslaunch."""


def evaluate(expression: str, variables: Mapping[str, Any]) -> Any:
    """Return the value of an expression.

    Args:
        expression: Python: ``arg('speed') > 2``.
        variables: what it may use besides `ALLOWED_NAMES`: values and functions.

    Raises:
        InvalidValue: it is not an expression, uses something that is not allowed, or fails.
    """
    if "__" in expression:
        raise InvalidValue("double underscores are not allowed")

    def variable(part: ast.expr) -> Value | None:
        if not isinstance(part, ast.Name):
            return None
        name = part.id

        def value(_: Any) -> Any:
            try:
                return bounded(variables[name])
            except KeyError:
                raise InvalidValue(f"unknown name {name}: no function, no <arg>") from None

        return value

    return Expression(expression, ALLOWED_NAMES, variable).value()
