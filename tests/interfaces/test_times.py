"""Times and durations count in whole nanoseconds and are ordered."""

from __future__ import annotations

import json
import math
import subprocess
from typing import Any

import numpy
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recorded_answers import Answers

from fibws.interfaces import Duration, Time

VALUES = [
    *("Time()", "Time(1, 500000000)", "Time(1.5)", "Time(3, 5)", "Time.from_sec(1600000000.125)"),
    *("Duration()", "Duration(-1, 5)", "Duration(-1.5)", "Duration(7, 3 * 10**9)"),
    "Duration(2.25)",
    *("2", "0.3", "-3", "'a'", "None"),
]
TIMES = VALUES[:10]
OPERATORS = ["+", "-", "*", "/", "//", "%", "<", "<=", ">", ">=", "==", "!="]
EXPRESSIONS = [
    *(f"{one} {sign} {other}" for sign in OPERATORS for one in TIMES for other in VALUES),
    *(f"{other} {sign} {one}" for sign in OPERATORS for one in TIMES for other in VALUES[10:]),
    *(f"{name}({one})" for name in ("abs", "bool", "hash", "-") for one in TIMES),
    *(f"divmod({one}, Duration(2))" for one in TIMES),
    *("Time(1.5, 1)", "Duration('a')", "Duration(None)", "Time(-1.5)", "Duration(1e400)"),
    *("len({Time(1), Time(1), Duration(1)})", "sum([Duration(1), Duration(2)], Duration())"),
]
GENPY = """
import json
import sys

from genpy import Duration, Time, TVal

WRITE
print(json.dumps([said(each) for each in json.load(sys.stdin)]))
"""
WRITE = """
def written(value):
    if isinstance(value, (Time, Duration)):
        return [type(value).__name__, value.secs * 10**9 + value.nsecs]
    return [written(each) for each in value] if isinstance(value, tuple) else value


def said(expression):
    try:
        return written(eval(expression))
    except Exception:
        return "error"
"""
"""Turns values into JSON, where genpy is, and here."""


def test_operators_give_the_same_as_in_genpy(answers: Answers) -> None:
    def ask() -> str:
        program = GENPY.replace("WRITE", WRITE)
        command = ("/usr/bin/python3", "-I", "-c", program)
        return subprocess.run(
            command, input=json.dumps(EXPRESSIONS), capture_output=True, check=True, text=True
        ).stdout.strip()

    names: dict[str, Any] = {"Time": Time, "Duration": Duration}
    exec(WRITE, names)
    theirs = json.loads(answers.of("operators", ask))
    for expression, expected in zip(EXPRESSIONS, theirs, strict=True):
        assert is_same(names["said"](expression), expected), (expression, expected)


def is_same(ours: Any, theirs: Any) -> bool:
    """Return whether values are equal; genpy cuts off fractions of nanoseconds, and loses some."""
    if isinstance(ours, list) and isinstance(theirs, list):
        return all(is_same(*each) for each in zip(ours, theirs, strict=True))
    if isinstance(ours, str | bool) or isinstance(theirs, str | bool):
        return bool(ours == theirs)
    return math.isclose(ours, theirs, rel_tol=1e-15, abs_tol=1)


@pytest.mark.parametrize("kind", [Time, Duration])
def test_floats_are_split(kind: type[Time | Duration]) -> None:
    for given_ in (2.3, numpy.float64(2.3)):
        made = kind(given_)
        assert made == kind(2, 300_000_000) == kind.from_sec(2.3)
        assert (type(made.secs), type(made.nsecs)) == (int, int)
    made = kind(numpy.int32(2), numpy.uint8(3))  # type: ignore[arg-type]
    assert repr(made).endswith("(secs=2, nsecs=3)")
    for wrong in (math.nan, math.inf, -math.inf):
        with pytest.raises(ValueError, match="finite"):
            kind(wrong)
    with pytest.raises(TypeError, match=r"nsecs must be an int, got 0\.5"):
        kind(1, 0.5)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="secs must be a number, got 'a'"):
        kind("a")  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", [Time, Duration])
def test_whole_seconds_among_the_nanoseconds_are_carried_over(kind: type[Time | Duration]) -> None:
    assert kind(1, 2_500_000_000) == kind(3, 500_000_000)
    assert repr(kind(3)).endswith("(secs=3, nsecs=0)")


def test_seconds_are_floats() -> None:
    assert Time.from_sec(1.5) == Time(1, 500_000_000)
    assert Duration.from_sec(-0.5) == Duration(-1, 500_000_000)
    assert Duration(-1, 500_000_000).to_sec() == -0.5


@given(st.integers(-(2**62), 2**62))
def test_nanoseconds_are_exact(nanoseconds: int) -> None:
    duration = Duration.from_nanoseconds(nanoseconds)
    assert duration.to_nanoseconds() == nanoseconds
    assert 0 <= duration.nsecs < 1_000_000_000


def test_times_are_ordered() -> None:
    assert Time(1, 5) < Time(2) < Time(2, 1)
    assert Duration(-1) < Duration(0)
    with pytest.raises(TypeError):
        assert Time(1) < Duration(2)  # type: ignore[operator]


def test_times_and_durations_add_up() -> None:
    assert Time(5) - Time(3, 1) == Duration(1, 999_999_999)
    assert Time(5) + Duration(1, 1) == Time(6, 1)
    assert Time(5) - Duration(1) == Time(4)
    assert Duration(5) + Duration(1) == Duration(6)
    assert Duration(5) - Duration(6) == -Duration(1)


def test_times_before_1970_are_refused() -> None:
    with pytest.raises(ValueError, match="before 1970"):
        Time(-1)
