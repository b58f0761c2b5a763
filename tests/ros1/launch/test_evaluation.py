"""$(eval ...)."""

from __future__ import annotations

import math
from typing import Any

import pytest

from fibws.errors import InvalidValue
from fibws.ros1.launch.evaluation import ALLOWED_NAMES, evaluate

VARIABLES = {"n": 3, "text": "a,b", "arg": {"n": 3}.get, "long": "x" * 100_000}


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("arg('n') * 2 + n", 9),
        ("n > 5 or text.split(',')", ["a", "b"]),
        ("1 < n < 2 < unknown", False),
        ("sin(pi / 2) + sqrt(4)", 3.0),
        ("factorial(5)", 120),
        ("frexp(8)", [0.5, 4]),
        ("pow(2, 0.5)", math.sqrt(2)),
        ("true and not false", True),
    ],
)
def test_expressions_use_arguments_and_mathematics(expression: str, value: Any) -> None:
    assert evaluate(expression, VARIABLES) == value


@pytest.mark.parametrize(
    ("expression", "fact"),
    [
        ("speed > 1", "speed"),
        ("n(1)", "3 is not a function"),
        ("sqrt(-1)", "."),
        ("arg", "function"),
        ("text.__class__", "double underscores"),
        ("arg('n')('n')", "unsupported"),
        ("os.getcwd()", "unsupported"),
        ("open('/etc/passwd')", "unknown name open"),
    ],
)
def test_failures_are_reported(expression: str, fact: str) -> None:
    with pytest.raises(InvalidValue, match=fact):
        evaluate(expression, VARIABLES)


@pytest.mark.parametrize("function", ["factorial", "comb", "perm", "prod", "lcm"])
def test_functions_with_large_results_take_small_numbers_only(function: str) -> None:
    with pytest.raises(InvalidValue, match="limit: 1000"):
        ALLOWED_NAMES[function](1001)


@pytest.mark.parametrize(
    "expression",
    [
        "factorial(100000)",
        "list(map(factorial, [100000]))",
        "map(map, [factorial], [[3000000]])",
        "prod([1000] * 5000)",
        "comb(10 ** 8, 10 ** 7)",
        "long",
    ],
)
def test_expressions_take_neither_long_nor_much_memory(expression: str) -> None:
    with pytest.raises(InvalidValue, match=r"too (large|long)"):
        evaluate(expression, VARIABLES)
