"""Timeouts of service calls."""

from __future__ import annotations

import gc
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.hub.graph.service import Call

from .service_clients import (
    adder_and_caller,
    call_add,
    received_call,
    received_calls,
    received_failure,
    received_sums,
    respond,
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
def test_call_times_out(fields: dict[str, Any], seconds: float, spelled: str) -> None:
    hub, server, caller = adder_and_caller()
    call_add(caller, **fields)
    hub.clock.advance(seconds * 0.99)
    assert caller.receive() == []
    hub.clock.advance(seconds * 0.02)
    assert received_failure(caller) == f"Service /add did not answer within {spelled} s"
    assert caller.forgotten
    assert not server.kept["calls to answer"]


def test_default_timeout_is_a_setting() -> None:
    hub, _, caller = adder_and_caller(service_timeout=5)
    call_add(caller)
    hub.clock.advance(5)
    assert received_failure(caller) == "Service /add did not answer within 5 s"


def test_service_timeout_of_0_means_no_limit() -> None:
    hub, server, caller = adder_and_caller(service_timeout=0)
    call_add(caller)
    hub.clock.advance(1e6)
    assert caller.receive() == []
    assert hub.clock.timers == 0
    server.disconnect()
    assert "has left" in received_failure(caller)


def test_each_call_has_its_own_timeout() -> None:
    hub, server, caller = adder_and_caller()
    for id_, timeout in (("slow", 30), ("quick", 1), ("answered", 2)):
        call_add(caller, id=id_, timeout=timeout)
    respond(server, received_calls(server)[2])
    assert received_sums(caller) == [3]
    hub.clock.advance(29)
    assert caller.receive_one("service_response")["id"] == "quick"
    hub.clock.advance(1)
    assert caller.receive_one("service_response")["id"] == "slow"


def test_late_response_is_ignored() -> None:
    hub, server, caller = adder_and_caller()
    call_add(caller, id="x", timeout=1)
    asked = received_call(server)
    hub.clock.advance(1)
    received_failure(caller)
    respond(server, asked)
    assert (caller.receive(), server.receive()) == ([], [])


def test_calls_that_have_ended_have_no_timers() -> None:
    hub, server, caller = adder_and_caller()
    for number in range(100):
        call_add(caller, timeout=1 + number * 7 % 10)
    for left, id_ in enumerate(reversed(received_calls(server))):
        assert hub.clock.timers == 100 - left
        respond(server, id_)
    assert len(received_sums(caller)) == 100
    assert hub.clock.timers == 0


def test_calls_that_have_ended_are_not_kept_until_their_deadlines() -> None:
    hub, server, caller = adder_and_caller()
    call_add(caller, id="waits")
    received_call(server)
    for _ in range(200):
        call_add(caller)
        respond(server, received_call(server))
    assert len(received_sums(caller)) == 200
    gc.collect()  # Calls of other tests may wait for it.
    kept = [each for each in gc.get_objects() if type(each) is Call and each.caller == "/caller"]
    assert len(kept) < 20
    hub.clock.advance(60)
    assert caller.receive_one("service_response")["id"] == "waits"


@given(
    st.lists(
        st.tuples(st.integers(0, 5), st.integers(0, 20), st.integers(1, 20) | st.none()),
        max_size=8,
    )
)
def test_calls_time_out_neither_early_nor_late(
    plans: list[tuple[int, int, int | None]],
) -> None:
    """Each plan is the seconds before a call, its timeout, and after how long it is answered."""
    hub, server, caller = adder_and_caller(service_timeout=9)
    expected: list[tuple[float, int, bool]] = []
    answering: list[tuple[float, str]] = []
    moment = 0.0
    received: list[tuple[float, int, bool]] = []

    def lives_until(end: float) -> None:
        while hub.clock.time() < end:
            hub.clock.advance(0.5)
            for when, id_ in answering:
                if when == hub.clock.time():
                    respond(server, id_)
            received.extend(
                (hub.clock.time(), each["id"], each["result"]) for each in caller.receive()
            )

    for number, (pause, timeout, answered) in enumerate(plans):
        moment += pause
        lives_until(moment)
        call_add(caller, id=number, timeout=timeout)
        id_ = received_call(server)
        due = moment + (timeout or 9)
        when = math.inf if answered is None else moment + answered - 0.5
        answering.append((when, id_))
        expected.append((min(when, due), number, when < due))
    lives_until(moment + 30)
    assert sorted(received) == sorted(expected)
    assert (server.receive(), hub.clock.timers) == ([], 0)
