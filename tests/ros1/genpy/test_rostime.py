"""Times reckon as genpy's do."""

from __future__ import annotations

import pickle

import pytest
from genpy import Duration, Time, TVal

from .conftest import Agree

VALUES = [
    *("Time()", "Time(1, 500000000)", "Time(1.5)", "Time(3, -1)", "Time.from_sec(1600000000.1)"),
    *("Duration()", "Duration(-1, 5)", "Duration(-1.5)", "Duration(2, 3 * 10**9)", "TVal(1, 5)"),
    *("2", "0.3", "True", "'a'", "None"),
]
OPERATORS = ["+", "-", "*", "/", "//", "%", "<", "<=", ">", ">=", "==", "!="]


@pytest.mark.parametrize("operator", OPERATORS)
def test_operators_give_the_same_as_in_genpy(agree: Agree, operator: str) -> None:
    for one in VALUES[:10]:
        for other in VALUES:
            agree(f"{one} {operator} {other}")
            agree(f"{other} {operator} {one}")


@pytest.mark.parametrize("value", VALUES[:10])
@pytest.mark.parametrize(
    "what",
    [
        *("repr({})", "str({})", "hash({})", "bool({})", "{}.to_sec()", "{}.to_nsec()"),
        *("{}.is_zero()", "{}.to_time()", "abs({})", "-{}", "divmod({}, Duration(2))"),
        *("parts({})", "{}.__slots__", "{}._slot_types", "copied({})", "set({}, secs=7).secs"),
        *("[t := {}, t.set(5, 2 * 10**9), t.secs, t.canon(), t.secs]", "{}.millis"),
    ],
)
def test_methods_return_the_same_as_in_genpy(agree: Agree, what: str, value: str) -> None:
    agree(what.format(value))


@pytest.mark.parametrize(
    "wrong",
    [
        *("Time(-1)", "Time(1.5, 1)", "Duration(1.5, 1)", "Time(0, -1)"),
        *("Time.from_sec(-1.5)", "Time(1) - Duration(2)", "set(Time(), millis=1)"),
    ],
)
def test_errors_have_the_same_texts_as_in_genpy(agree: Agree, wrong: str) -> None:
    assert "Error: " in agree(wrong)


@pytest.mark.parametrize("value", [Time(1, 2), Duration(-1, 2), TVal(3)])
def test_times_can_be_pickled(value: TVal) -> None:
    again = pickle.loads(pickle.dumps(value))
    assert (type(again), again.secs, again.nsecs) == (type(value), value.secs, value.nsecs)


def test_operators_return_the_derived_class() -> None:
    class Stamp(Time):
        pass

    assert type(Stamp(1) + Duration(1)) is Stamp
    assert type(Stamp(2) - Duration(1)) is Stamp
    assert type(Stamp.from_sec(1.5)) is Stamp
    assert Stamp(1) == Time(1)
    assert len({Stamp(1), Time(1)}) == 1
