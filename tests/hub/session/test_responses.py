"""What providers answer, and what callers hear of it."""

from __future__ import annotations

from typing import Any

import pytest

from ..fakes import Client, FakeHub
from .adding import (
    adder,
    adder_and_caller,
    answers,
    calls,
    hears_failure,
    hears_sums,
    is_asked,
    is_asked_once,
)

NOTHING: dict[str, Any] = {}
FAILED = "service [/add] responded with an error"


def responds(provider: Client, **fields: Any) -> None:
    """Answer the one call that has come."""
    id_ = is_asked_once(provider)
    provider.says("service_response", **{"service": "/add", "id": id_, **fields})


@pytest.mark.parametrize(
    ("values", "total"),
    [
        ({"values": {"sum": 3}}, 3),
        ({"values": {"sum": 2**63 - 1}}, 2**63 - 1),
        ({"values": {}}, 0),
        ({"values": None}, 0),
        (NOTHING, 0),
    ],
)
@pytest.mark.parametrize("strict", [False, True])
def test_a_success_has_values_and_the_rest_has_its_default(
    strict: bool, values: dict[str, Any], total: int
) -> None:
    _, provider, caller = adder_and_caller(strict_responses=strict)
    calls(caller)
    responds(provider, result=True, **values)
    assert hears_sums(caller) == [total]
    assert provider.hears() == []


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ("text", "Expected a JSON object for type rospy_tutorials/AddTwoIntsResponse but received"),
        ([3], "Expected a JSON object for type rospy_tutorials/AddTwoIntsResponse but received"),
        (3, "Expected a JSON object for type rospy_tutorials/AddTwoIntsResponse but received"),
        ({"sum": "3"}, "requires a int64 for field sum, but got a str"),
        ({"sum": 2**63}, "9223372036854775808 is not in"),
        ({"total": 3}, "Message type rospy_tutorials/AddTwoIntsResponse does not have a field"),
    ],
)
@pytest.mark.parametrize("result", [True, False])
def test_values_that_do_not_fit_are_told_to_both(values: Any, fault: str, result: bool) -> None:
    _, provider, caller = adder_and_caller()
    calls(caller)
    responds(provider, values=values, result=result)
    text = hears_failure(caller)
    told = provider.hears_statuses()
    if result or isinstance(values, dict):
        assert fault in text
        assert told == [f"service_response: {text}"]
    else:
        assert text == (values if isinstance(values, str) else FAILED)
        assert told == []
    assert caller.forgotten
    assert not provider.kept["calls to answer"]


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"values": "out of paper"}, "out of paper"),
        ({"values": ""}, FAILED),
        ({"values": None}, FAILED),
        (NOTHING, FAILED),
        ({"values": 5}, FAILED),
        ({"values": ["out of paper"]}, FAILED),
        ({"values": False}, FAILED),
    ],
)
@pytest.mark.parametrize("strict", [False, True])
def test_a_failure_comes_with_the_providers_own_text(
    strict: bool, fields: dict[str, Any], text: str
) -> None:
    _, provider, caller = adder_and_caller(strict_responses=strict)
    calls(caller)
    responds(provider, result=False, **fields)
    assert hears_failure(caller) == text
    assert provider.hears() == []


@pytest.mark.parametrize(("values", "total"), [({"sum": 3}, 3), ({}, 0)])
def test_a_failure_with_values_is_a_success_as_on_the_real_server(
    values: dict[str, int], total: int
) -> None:
    _, provider, caller = adder_and_caller()
    provider.says("set_level", level="warning")
    calls(caller)
    responds(provider, values=values, result=False)
    assert hears_sums(caller) == [total]
    assert provider.hears_statuses("warning") == [
        "service_response: result is false, but there are values: taken for true"
    ]


@pytest.mark.parametrize("values", [{"sum": 3}, {}, {"wrong": 1}])
def test_unless_responses_are_strict(values: dict[str, int]) -> None:
    _, provider, caller = adder_and_caller(strict_responses=True)
    provider.says("set_level", level="info")
    calls(caller)
    provider.hears()
    calls(caller)
    responds(provider, values=values, result=False)
    assert hears_failure(caller) == FAILED
    assert provider.hears() == []


# Which call a response is for.


def test_a_response_without_an_id_is_for_the_oldest_call_of_the_service() -> None:
    hub = FakeHub()
    provider, caller = adder(hub), hub.client()
    provider.says("advertise_service", service="/other", type="std_srvs/Empty")
    caller.says("call_service", service="/other", id="other")
    calls(caller, id="first")
    calls(caller, id="second")
    for total, spelling in ((1, "/add"), (2, "add")):
        provider.says("service_response", service=spelling, values={"sum": total}, result=True)
    assert [(each["id"], each["values"]) for each in caller.hears()] == [
        ("first", {"sum": 1}),
        ("second", {"sum": 2}),
    ]
    provider.says("service_response", service="/other", id=None, result=True)
    assert caller.hears_one("service_response")["id"] == "other"


@pytest.mark.parametrize(
    "fields",
    [
        {"id": "service_request:/add:99"},
        {"id": "x"},
        {"id": 1},
        {"id": ""},
        {"service": "/nope"},
        {"service": "/nope", "id": None},
    ],
)
def test_a_response_that_nobody_waits_for_changes_nothing(fields: dict[str, Any]) -> None:
    _, provider, caller = adder_and_caller()
    calls(caller, id="x")
    asked = is_asked_once(provider)
    provider.says("set_level", level="info")
    provider.says("service_response", **{"service": "/add", "result": True, **fields})
    [told] = provider.hears_statuses("info")
    assert told == f"service_response: no call of {fields.get('service', '/add')} waits for this"
    assert caller.hears() == []
    answers(provider, asked)
    assert hears_sums(caller) == [3]


def test_it_is_the_id_by_which_a_call_is_known() -> None:
    _, provider, caller = adder_and_caller()
    calls(caller)
    asked = is_asked_once(provider)
    answers(provider, asked, service="any spelling")
    assert hears_sums(caller) == [3]


def test_of_two_responses_the_first_counts() -> None:
    _, provider, caller = adder_and_caller()
    calls(caller)
    asked = is_asked_once(provider)
    for total in (1, 2):
        answers(provider, asked, total)
    assert hears_sums(caller) == [1]
    assert provider.hears() == []


def test_nobody_answers_the_calls_of_others() -> None:
    hub, provider, caller = adder_and_caller()
    stranger = hub.client()
    calls(caller)
    asked = is_asked_once(provider)
    for id_ in (asked, None):
        stranger.says("service_response", service="/add", id=id_, result=True, values={"sum": 9})
    assert caller.hears() == stranger.hears() == []
    answers(provider, asked)
    assert hears_sums(caller) == [3]


@pytest.mark.parametrize(
    ("fields", "fault"),
    [
        ({}, "Expected a result field but none was found."),
        ({"result": None}, "Expected a result field but none was found."),
        ({"result": 1}, "Expected field result to be one of bool. Invalid value: 1"),
        ({"result": "true"}, 'Expected field result to be one of bool. Invalid value: "true"'),
        ({"result": True, "service": None}, "Expected a service field but none was found."),
        ({"result": True, "service": 5}, "Expected field service to be one of str. Invalid"),
    ],
)
def test_a_response_that_is_none_fails_the_call(fields: dict[str, Any], fault: str) -> None:
    _, provider, caller = adder_and_caller()
    for id_ in "ab":
        calls(caller, id=id_)
    asked, other = is_asked(provider)
    provider.says("service_response", **{"service": "/add", "id": asked, "values": {}, **fields})
    [status] = provider.hears_statuses()
    assert status.startswith(f"service_response: {fault}")
    response = caller.hears_one("service_response")
    assert (response["id"], response["result"]) == ("a", False)
    assert response["values"].startswith(fault)
    answers(provider, asked)
    assert caller.hears() == []
    answers(provider, other)
    assert hears_sums(caller) == [3]


@pytest.mark.parametrize(
    "fields",
    [
        {"result": True, "id": ["x"]},
        {"result": True, "id": {}},
        {"result": 1, "id": 5},
        {"result": 1, "id": None},
        {"result": 1, "id": "x"},
        {"result": True, "id": None, "service": "not legal"},
    ],
)
def test_what_is_no_response_to_any_call_leaves_all_as_they_were(fields: dict[str, Any]) -> None:
    _, provider, caller = adder_and_caller()
    calls(caller)
    asked = is_asked_once(provider)
    provider.says("service_response", **{"service": "/add", **fields})
    assert len(provider.hears_statuses()) == 1
    assert caller.hears() == []
    answers(provider, asked)
    assert hears_sums(caller) == [3]


def test_numbers_that_json_does_not_have_are_null_in_a_response() -> None:
    hub = FakeHub()
    provider, caller = hub.client(), hub.client()
    provider.says("advertise_service", service="/add", type="my_srvs/Do")
    calls(caller)
    asked = is_asked_once(provider)
    provider.says_text(
        '{"op":"service_response","service":"/add","result":true,'
        f'"id":"{asked}","values":{{"x":[NaN,1e400,-Infinity,0.1]}}}}'
    )
    assert caller.hears_one("service_response")["values"] == {"x": [None, None, None, 0.1]}
