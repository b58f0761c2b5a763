"""The operators, functions and methods of $(eval ...), each in bounds."""

from __future__ import annotations

import ast
from typing import Any

import pytest

from fibws.ros1.launch.evaluation import evaluate
from fibws.ros1.launch.vocabulary import BINARY, BUILT_IN, METHODS, MOST_BITS, MOST_ITEMS, small


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("'aa'.replace('a', 'b', 1)", "ba"),
        ("('a' * 5000).replace('b', 'c')", "a" * 5000),
        ("len(','.join(['ab'] * 3000))", 8999),
        ("(-1) ** 9999", -1),
        ("2 ** -1", 0.5),
        ("'ab' * -1", ""),
        ("[0] * True", [0]),
    ],
)
def test_what_stays_small_is_allowed(expression: str, value: Any) -> None:
    assert evaluate(expression, {}) == value


@pytest.mark.parametrize("expression", ["'a' * 'b'", "[1] * 1.5", "{} * 2", "'a' ** 2", "1 << 'a'"])
def test_what_python_cannot_do_is_its_own_error(expression: str) -> None:
    with pytest.raises(ValueError, match="TypeError: "):
        evaluate(expression, {})


@pytest.mark.parametrize("function", ["factorial", "comb", "perm", "prod", "lcm"])
def test_what_grows_takes_little_numbers_alone(function: str) -> None:
    with pytest.raises(ValueError, match="too large"):
        BUILT_IN[function](1001)


def test_methods_neither_change_a_value_nor_repeat_it() -> None:
    names = {name for _, name in METHODS}
    assert not names & {"append", "update", "pop", "format", "center", "ljust", "zfill", "encode"}


def test_results_are_bounded_before_they_are_there() -> None:
    for operation, left, right in (
        (ast.Pow, 10, 10**10),
        (ast.LShift, 1, 10**10),
        (ast.Mult, "a", 10**10),
        (ast.Mult, 10**10, ["a"]),
        (ast.Mod, "%1000000000d", 1),
    ):
        with pytest.raises(ValueError, match="too l"):
            BINARY[operation](left, right)


def test_a_value_is_as_large_as_all_that_is_in_it() -> None:
    assert small(2 ** (MOST_BITS - 1)) and small("a" * MOST_ITEMS)
    half = ["a" * (MOST_ITEMS // 2)]
    assert small({"a": half})
    for value in (2**MOST_BITS, "a" * (MOST_ITEMS + 1), {"a": half, "b": half}):
        with pytest.raises(ValueError, match="too l"):
            small(value)
