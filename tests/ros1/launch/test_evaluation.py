"""$(eval ...)."""

from __future__ import annotations

import math
from typing import Any

import pytest

from fibws.ros1.launch.evaluation import evaluate

NAMES = {"n": 3, "text": "a,b", "arg": {"n": 3}.get, "on": True}


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
        ("1 < n < 2 < fail", False),
        ("'a' in text and 'z' not in text", True),
        ("'yes' if on else 'no'", "yes"),
        ("arg('n') * 2", 6),
        ("'%s' % n + '%d' % 4", "34"),
        ("text.split(',')[0].upper() + 'x' * 2", "Axx"),
        ("text[-1:]", "b"),
        ("[1, 2.5, 'x'][1]", 2.5),
        ("{'a': 1}['a'] + {'a': 1}.get('b', 2)", 3),
        ("{'a': 1}.items()", [["a", 1]]),
        ("dict([['a', 1]])", {"a": 1}),
        ("list(map(int, ['1', '2']))", [1, 2]),
        ("','.join(map(str, [1, 2]))", "1,2"),
        ("'aXb'.replace('X', '-').partition('-')", ["a", "-", "b"]),
        ("sin(pi / 2) + sqrt(4)", 3.0),
        ("factorial(5)", 120),
        ("str(int('4') + float('0.5'))", "4.5"),
        ("true and not false", True),
        ("None is None", True),
        ("round(max(1.26, abs(-2)) + len('ab') + sum([min(1, 2)]), 1)", 5),
        ("sorted([2, 1]) if all([1, bool(1)]) and any([0, 1]) else []", [1, 2]),
        ("frexp(8)", [0.5, 4]),
        ("pow(2, 0.5)", math.sqrt(2)),
    ],
)
def test_expressions_are_those_of_python(expression: str, value: Any) -> None:
    assert evaluate(expression, NAMES) == value


@pytest.mark.parametrize(
    ("expression", "error"),
    [
        ("speed > 1", "nothing is called speed"),
        ("1 +", "invalid syntax: 1 [+]"),
        ("n(1)", "n is no function"),
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("'a' + 1", "TypeError: "),
        ("sqrt(-1)", "."),
        ("[1][5]", "IndexError"),
        ("round", "it is a function"),
    ],
)
def test_an_expression_that_fails_says_why(expression: str, error: str) -> None:
    with pytest.raises(ValueError, match=error):
        evaluate(expression, NAMES)


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
        "str.mro()",
        "text.upper",
        "(lambda: 1)()",
        "[x for x in text]",
        "{x for x in text}",
        "(x := 1)",
        "f'{n}'",
        "b'a'",
        "1j",
        "...",
        "{**{}}",
        "[*text]",
        "int(x='1')",
        "arg('n')('n')",
        "1 @ 2",
        "await n",
        "yield",
    ],
)
def test_an_expression_reaches_nothing_else(expression: str) -> None:
    with pytest.raises(
        ValueError,
        match=r"this is not known|nothing is called|double underscores|invalid syntax|is no",
    ):
        evaluate(expression, NAMES)


@pytest.mark.parametrize(
    "expression",
    [
        "9 ** 9 ** 9",
        "1 << 10 ** 10",
        "'x' * 10 ** 10",
        "10 ** 10 * [1]",
        "'%1000000000d' % 1",
        "'%*d' % (1000000000, 1)",
        "factorial(100000)",
        "list(map(factorial, [100000]))",
        "prod([1000] * 5000)",
        "comb(10 ** 8, 10 ** 7)",
        "('a' * 9999).replace('a', 'b' * 9999)",
        "('a' * 9999).join(['a'] * 9999)",
        "+".join(["1"] * 6000),
        "(" * 3000 + "1" + ")" * 3000,
        "-" * 5000 + "1",
        "int('9' * 9000)",
        "round(5, -10 ** 9)",
        "map(map, [factorial], [[3000000]])",
        "sum([[0] * 10000] * 10000, [])",
        "str([[[0] * 1000] * 1000] * 1000)",
        "[[[0] * 999] * 999] * 999 == [[[0] * 999] * 999] * 999",
        "['a' * 9999] * 9999",
        "{'a': [[0] * 999] * 999}",
        "'%(a)999999999d' % {'a': 1}",
        "'%.999999999f' % 1.5",
    ],
)
def test_an_expression_takes_neither_long_nor_much_memory(expression: str) -> None:
    with pytest.raises(ValueError, match=r"too (large|long|many)|more than|Exceeds"):
        evaluate(expression, NAMES)
