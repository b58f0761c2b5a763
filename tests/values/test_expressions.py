"""Restricted Python expressions."""

from __future__ import annotations

import math
from typing import Any

import pytest

from fibws.errors import FibwsError, InvalidValue, UnknownName
from fibws.values.expressions import (
    FUNCTIONS,
    MAX_BITS,
    MAX_CHARACTERS,
    MAX_ITEMS,
    Expression,
    bounded,
)


def evaluate(expression: str, /, **names: Any) -> Any:
    return Expression(expression, {**FUNCTIONS, **names}).value()


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("1 + 2 * 3 - 4 / 2", 5.0),
        ("7 // 2 ** 1 % 2", 1),
        ("(1 << 3) | 1 ^ 2 & 3 >> 1", 9),
        ("-n + +n - ~n", 4),
        ("n > 2 and text != 'x'", True),
        ("n > 5 or text", "a,b"),
        ("not on", False),
        ("1 < n <= 3", True),
        ("1 < n < 2 < 1 / 0", False),
        ("'a' in text and 'z' not in text", True),
        ("'yes' if on else 'no'", "yes"),
        ("'%s' % n + '%d' % 4", "34"),
        ("text.split(',')[0].upper() + 'x' * 2", "Axx"),
        ("text[-1:]", "b"),
        ("[1, 2.5, 'x'][1]", 2.5),
        ("{'a': 1}['a'] + {'a': 1}.get('b', 2)", 3),
        ("{'a': 1}.items() + {'a': 2}.keys() + {'a': 3}.values()", [["a", 1], "a", 3]),
        ("dict([['a', 1]])", {"a": 1}),
        ("list(map(int, ['1', '2']))", [1, 2]),
        ("','.join(map(str, [1, 2]))", "1,2"),
        ("'aXb'.replace('X', '-').partition('-')", ["a", "-", "b"]),
        ("str(int('4') + float('0.5'))", "4.5"),
        ("None is None", True),
        ("round(max(1.26, abs(-2)) + len('ab') + sum([min(1, 2)]), 1)", 5),
        ("sorted([2, 1]) if all([1, bool(1)]) and any([0, 1]) else []", [1, 2]),
        ("'aa'.replace('a', 'b', 1)", "ba"),
        ("('a' * 5000).replace('b', 'c')", "a" * 5000),
        ("len(','.join(['ab'] * 3000))", 8999),
        ("(-1) ** 9999", -1),
        ("2 ** -1", 0.5),
        ("'ab' * -1", ""),
        ("[0] * True", [0]),
    ],
)
def test_values_are_those_of_python(expression: str, value: Any) -> None:
    assert evaluate(expression, n=3, text="a,b", on=True) == value


@pytest.mark.parametrize(
    ("expression", "fact"),
    [
        ("speed > 1", "speed"),
        ("1 +", "1 [+]"),
        ("n(1)", "3 is not a function"),
        ("1 / 0", "ZeroDivisionError"),
        ("'a' + 1", "TypeError"),
        ("'a' * 'b'", "TypeError"),
        ("[1] * 1.5", "TypeError"),
        ("{} * 2", "TypeError"),
        ("'a' ** 2", "TypeError"),
        ("1 << 'a'", "TypeError"),
        ("1[0]", "TypeError"),
        ("int('x')", "'x'"),
        ("[1][5]", "IndexError"),
        ("round", "function"),
        ("1\0", "null"),
    ],
)
def test_failures_are_reported(expression: str, fact: str) -> None:
    with pytest.raises(InvalidValue, match=fact):
        evaluate(expression, n=3)


@pytest.mark.parametrize(
    "expression",
    [
        "__import__('os').system('true')",
        "().__class__.__bases__[0].__subclasses__()",
        "open('/etc/passwd').read()",
        "eval('1')",
        "exec('1')",
        "getattr(text, 'upper')",
        "text.format(n)",
        "text.encode()",
        "[1].append(2)",
        "{}.update({})",
        "text.zfill(9)",
        "str.mro()",
        "str.upper('a')",
        "text.upper",
        "(lambda: 1)()",
        "[x for x in text]",
        "{x for x in text}",
        "(x := 1)",
        "f'{text}'",
        "b'a'",
        "1j",
        "...",
        "{**{}}",
        "[*text]",
        "int(x='1')",
        "str(1)(1)",
        "1 @ 2",
        "await text",
        "yield",
        "list[int]",
    ],
)
def test_expressions_reach_nothing_else(expression: str) -> None:
    with pytest.raises(InvalidValue):
        evaluate(expression, text="a")


@pytest.mark.parametrize(
    "expression",
    [
        "9 ** 9 ** 9",
        "1 << 10 ** 10",
        "'x' * 10 ** 10",
        "10 ** 10 * [1]",
        "'%1000000000d' % 1",
        "'%*d' % (1000000000, 1)",
        "('a' * 9999).replace('a', 'b' * 9999)",
        "('a' * 9999).join(['a'] * 9999)",
        "+".join(["1"] * 6000),
        "(" * 3000 + "1" + ")" * 3000,
        "-" * 5000 + "1",
        "-" * 900 + "1",
        "int('9' * 9000)",
        "round(5, -10 ** 9)",
        "sum([[0] * 10000] * 10000, [])",
        "str([[[0] * 1000] * 1000] * 1000)",
        "[[[0] * 999] * 999] * 999 == [[[0] * 999] * 999] * 999",
        "['a' * 9999] * 9999",
        "{'a': [[0] * 999] * 999}",
        "'%(a)999999999d' % {'a': 1}",
        "'%.999999999f' % 1.5",
        "1" * (MAX_CHARACTERS + 1),
    ],
)
def test_expressions_take_neither_long_nor_much_memory(expression: str) -> None:
    with pytest.raises(InvalidValue, match=r"too (large|long|many|deeply)|Exceeds"):
        evaluate(expression)


def test_size_of_a_value_includes_nested_values() -> None:
    assert bounded(2 ** (MAX_BITS - 1)) and bounded("a" * MAX_ITEMS)
    half = ["a" * (MAX_ITEMS // 2)]
    assert bounded({"a": half})
    for value in (2**MAX_BITS, "a" * (MAX_ITEMS + 1), {"a": half, "b": half}):
        with pytest.raises(InvalidValue, match=f"{MAX_BITS}|{MAX_ITEMS}"):
            bounded(value)


def test_expression_is_compiled_once_and_has_a_value_for_each_set_of_variables() -> None:
    doubled = Expression("2 * n", {}, lambda part: lambda variables: variables["n"])
    assert [doubled.value({"n": n}) for n in (1, 2)] == [2, 4]


def test_own_errors_of_variables_are_raised_as_they_are() -> None:
    def unknown(variables: Any) -> Any:
        raise UnknownName("n")

    expression = Expression("n", {}, lambda part: unknown)
    with pytest.raises(UnknownName):
        expression.value()
    assert issubclass(InvalidValue, FibwsError)


def test_functions_are_not_results() -> None:
    with pytest.raises(InvalidValue):
        Expression("sin", {"sin": math.sin}).value()
