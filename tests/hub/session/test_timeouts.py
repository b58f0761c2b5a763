"""How long callers wait."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from .adding import (
    adder_and_caller,
    answers,
    calls,
    hears_failure,
    hears_sums,
    is_asked,
    is_asked_once,
)


@pytest.mark.parametrize(
    ("fields", "seconds", "spelled"),
    [
        ({}, 60, "60"),
        ({"timeout": None}, 60, "60"),
        ({"timeout": 0}, 60, "60"),
        ({"timeout": -1}, 60, "60"),
        ({"timeout": 2.5}, 2.5, "2.5"),
        ({"timeout": 0.001}, 0.001, "0.001"),
        ({"timeout": 100}, 100, "100"),
        ({"timeout": 1e300}, 86400, "86400"),
    ],
)
def test_a_provider_that_does_not_answer_has_so_much_time(
    fields: dict[str, Any], seconds: float, spelled: str
) -> None:
    hub, provider, caller = adder_and_caller()
    calls(caller, **fields)
    hub.clock.advance(seconds * 0.99)
    assert caller.hears() == []
    hub.clock.advance(seconds * 0.02)
    assert hears_failure(caller) == f"Service /add did not answer within {spelled} s"
    assert caller.forgotten
    assert not provider.kept["calls to answer"]


def test_the_hub_decides_how_much_time_there_is_without_a_timeout() -> None:
    hub, _, caller = adder_and_caller(service_timeout=5)
    calls(caller)
    hub.clock.advance(5)
    assert hears_failure(caller) == "Service /add did not answer within 5 s"


def test_a_hub_may_leave_a_call_as_much_time_as_its_provider_stays() -> None:
    hub, provider, caller = adder_and_caller(service_timeout=0)
    calls(caller)
    hub.clock.advance(1e6)
    assert caller.hears() == []
    assert hub.clock.timers == 0
    provider.leaves()
    assert "has left" in hears_failure(caller)


def test_each_call_has_its_own_time() -> None:
    hub, provider, caller = adder_and_caller()
    for id_, timeout in (("slow", 30), ("quick", 1), ("answered", 2)):
        calls(caller, id=id_, timeout=timeout)
    answers(provider, is_asked(provider)[2])
    assert hears_sums(caller) == [3]
    hub.clock.advance(29)
    assert caller.hears_one("service_response")["id"] == "quick"
    hub.clock.advance(1)
    assert caller.hears_one("service_response")["id"] == "slow"


def test_an_answer_that_comes_too_late_is_nobodys() -> None:
    hub, provider, caller = adder_and_caller()
    calls(caller, id="x", timeout=1)
    asked = is_asked_once(provider)
    hub.clock.advance(1)
    hears_failure(caller)
    answers(provider, asked)
    assert (caller.hears(), provider.hears()) == ([], [])


def test_one_timer_is_enough_for_all_calls_of_a_client() -> None:
    hub, provider, caller = adder_and_caller()
    for number in range(100):
        calls(caller, timeout=1 + number * 7 % 10)
        assert hub.clock.timers == 1
    for id_ in is_asked(provider):
        answers(provider, id_)
        assert hub.clock.timers <= 1
    assert len(hears_sums(caller)) == 100
    hub.clock.advance(60)
    assert hub.clock.timers == 0
    assert caller.hears() == []


@settings(deadline=None)
@given(
    st.lists(
        st.tuples(st.integers(0, 5), st.integers(0, 20), st.integers(1, 20) | st.none()),
        max_size=8,
    )
)
def test_no_call_fails_too_early_or_too_late(
    plans: list[tuple[int, int, int | None]],
) -> None:
    """Each plan is the seconds before a call, its timeout, and after how long it is answered."""
    hub, provider, caller = adder_and_caller(service_timeout=9)
    expected: list[tuple[float, int, bool]] = []
    answering: list[tuple[float, str]] = []
    moment = 0.0
    heard: list[tuple[float, int, bool]] = []

    def lives_until(end: float) -> None:
        while hub.clock.time() < end:
            hub.clock.advance(0.5)
            for when, id_ in answering:
                if when == hub.clock.time():
                    answers(provider, id_)
            heard.extend((hub.clock.time(), each["id"], each["result"]) for each in caller.hears())

    for number, (pause, timeout, answered) in enumerate(plans):
        moment += pause
        lives_until(moment)
        calls(caller, id=number, timeout=timeout)
        id_ = is_asked_once(provider)
        due = moment + (timeout or 9)
        when = math.inf if answered is None else moment + answered - 0.5
        answering.append((when, id_))
        expected.append((min(when, due), number, when < due))
    lives_until(moment + 30)
    assert sorted(heard) == sorted(expected)
    assert (provider.hears(), hub.clock.timers) == ([], 0)
