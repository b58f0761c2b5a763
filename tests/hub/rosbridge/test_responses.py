"""Responses of service servers, and how they reach the callers."""

from __future__ import annotations

from typing import Any

import pytest

from ..fakes import ADD, Client, FakeHub
from .service_clients import (
    adder,
    adder_and_caller,
    call_add,
    received_call,
    received_calls,
    received_failure,
    received_sums,
    respond,
)

NOTHING: dict[str, Any] = {}
FAILED = "service [/add] responded with an error"


def responds(server: Client, **fields: Any) -> None:
    """Answer the one call that has come."""
    id_ = received_call(server)
    server.send("service_response", **{"service": "/add", "id": id_, **fields})


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
def test_missing_fields_of_a_response_get_their_defaults(
    strict: bool, values: dict[str, Any], total: int
) -> None:
    _, server, caller = adder_and_caller(strict_responses=strict)
    call_add(caller)
    responds(server, result=True, **values)
    assert received_sums(caller) == [total]
    assert server.receive() == []


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ("text", "Expected a JSON object for type rospy_tutorials/AddTwoIntsResponse but received"),
        ([3], "Expected a JSON object for type rospy_tutorials/AddTwoIntsResponse but received"),
        (3, "Expected a JSON object for type rospy_tutorials/AddTwoIntsResponse but received"),
        ({"sum": "three"}, "requires an int64 for field sum, but got a str"),
        ({"sum": 2**63}, "9223372036854775808 is not in"),
        ({"total": 3}, "Message type rospy_tutorials/AddTwoIntsResponse does not have a field"),
    ],
)
@pytest.mark.parametrize("result", [True, False])
def test_invalid_response_is_reported_to_server_and_caller(
    values: Any, fault: str, result: bool
) -> None:
    _, server, caller = adder_and_caller()
    call_add(caller)
    responds(server, values=values, result=result)
    text = received_failure(caller)
    statuses = server.receive_statuses()
    if result or isinstance(values, dict):
        assert fault in text
        assert statuses == [f"service_response: {text}"]
    else:
        assert text == (values if isinstance(values, str) else FAILED)
        assert statuses == []
    assert caller.forgotten
    assert not server.kept["calls to answer"]


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
def test_failure_carries_the_servers_text(strict: bool, fields: dict[str, Any], text: str) -> None:
    _, server, caller = adder_and_caller(strict_responses=strict)
    call_add(caller)
    responds(server, result=False, **fields)
    assert received_failure(caller) == text
    assert server.receive() == []


@pytest.mark.parametrize(("values", "total"), [({"sum": 3}, 3), ({}, 0)])
def test_failure_with_values_counts_as_success_as_on_the_real_server(
    values: dict[str, int], total: int
) -> None:
    _, server, caller = adder_and_caller()
    server.send("set_level", level="warning")
    call_add(caller)
    responds(server, values=values, result=False)
    assert received_sums(caller) == [total]
    assert server.receive_statuses("warning") == [
        "service_response: result is false, but there are values: taken for true"
    ]


@pytest.mark.parametrize("values", [{"sum": 3}, {}, {"wrong": 1}])
def test_failure_with_values_is_a_failure_with_strict_responses(values: dict[str, int]) -> None:
    _, server, caller = adder_and_caller(strict_responses=True)
    server.send("set_level", level="info")
    call_add(caller)
    server.receive()
    call_add(caller)
    responds(server, values=values, result=False)
    assert received_failure(caller) == FAILED
    assert server.receive() == []


# Which call a response is for.


def test_response_without_an_id_answers_the_oldest_call() -> None:
    hub = FakeHub()
    server, caller = adder(hub), hub.client()
    server.send("advertise_service", service="/other", type="std_srvs/Empty")
    caller.send("call_service", service="/other", id="other")
    call_add(caller, id="first")
    call_add(caller, id="second")
    for total, spelling in ((1, "/add"), (2, "add")):
        server.send("service_response", service=spelling, values={"sum": total}, result=True)
    assert [(each["id"], each["values"]) for each in caller.receive()] == [
        ("first", {"sum": 1}),
        ("second", {"sum": 2}),
    ]
    server.send("service_response", service="/other", id=None, result=True)
    assert caller.receive_one("service_response")["id"] == "other"


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
def test_response_to_an_unknown_call_changes_nothing(fields: dict[str, Any]) -> None:
    _, server, caller = adder_and_caller()
    call_add(caller, id="x")
    asked = received_call(server)
    server.send("set_level", level="info")
    server.send("service_response", **{"service": "/add", "result": True, **fields})
    [status] = server.receive_statuses("info")
    assert status == f"service_response: no call of {fields.get('service', '/add')} waits for this"
    assert caller.receive() == []
    respond(server, asked)
    assert received_sums(caller) == [3]


def test_response_is_matched_by_id_not_by_service() -> None:
    _, server, caller = adder_and_caller()
    call_add(caller)
    asked = received_call(server)
    respond(server, asked, service="any spelling")
    assert received_sums(caller) == [3]


def test_second_response_to_a_call_is_ignored() -> None:
    _, server, caller = adder_and_caller()
    call_add(caller)
    asked = received_call(server)
    for total in (1, 2):
        respond(server, asked, total)
    assert received_sums(caller) == [1]
    assert server.receive() == []


# Responses on another connection than the server's, as rosbridgecpp sends them.


@pytest.mark.parametrize("is_served_there", [False, True])
def test_response_may_come_on_another_connection(is_served_there: bool) -> None:
    hub, server, caller = adder_and_caller()
    other = hub.client()
    if is_served_there:
        other.send("advertise_service", service="/other", type=ADD)
    for id_ in "ab":
        call_add(caller, id=id_)
    first, second = received_calls(server)
    respond(other, second, 2)
    assert caller.receive_one("service_response")["id"] == "b"
    assert len(server.kept["calls to answer"]) == 1
    respond(server, first)
    assert received_sums(caller) == [3]
    other.disconnect()
    call_add(caller)
    respond(server, received_call(server))
    assert received_sums(caller) == [3]


def test_failure_may_come_on_another_connection() -> None:
    hub, server, caller = adder_and_caller()
    call_add(caller)
    fields = {"service": "/add", "id": received_call(server), "values": "out of paper"}
    hub.client().send("service_response", **fields, result=False)
    assert received_failure(caller) == "out of paper"


@pytest.mark.parametrize("fields", [{"result": True, "values": {"sum": "three"}}, {"result": 1}])
def test_invalid_response_on_another_connection_fails_the_call(fields: dict[str, Any]) -> None:
    hub, server, caller = adder_and_caller()
    other = hub.client()
    call_add(caller)
    other.send("service_response", service="/add", id=received_call(server), **fields)
    text = received_failure(caller)
    assert other.receive_statuses() == [f"service_response: {text}"]
    assert server.receive() == []
    assert not server.kept["calls to answer"]


def test_call_fails_when_its_server_leaves_before_the_other_connection_responds() -> None:
    hub, server, caller = adder_and_caller()
    other = hub.client()
    call_add(caller)
    asked = received_call(server)
    server.disconnect()
    assert received_failure(caller) == "service [/add] unavailable: /adder has left"
    respond(other, asked)
    assert caller.receive() == other.receive() == []
    for client in (caller, other):
        client.disconnect()
    assert hub.empty


def test_response_on_another_connection_without_the_calls_id_changes_nothing() -> None:
    hub, server, caller = adder_and_caller()
    stranger = adder(hub, "/stranger", "/other")
    call_add(caller)
    asked = received_call(server)
    call_add(caller, service="/other")
    own = received_call(stranger)
    for id_ in (
        None,
        "service_request:/add:1",
        own.replace("other", "add"),
        asked.replace("-", "0-"),
    ):
        stranger.send("service_response", service="/add", id=id_, result=True, values={"sum": 9})
        stranger.send("service_response", service="/add", id=id_, values={"sum": 9})
    received = stranger.receive()
    assert all(each["op"] == "status" for each in received)
    assert caller.receive() == []
    respond(server, asked)
    respond(stranger, own)
    assert received_sums(caller) == [3, 3]


def test_ids_of_calls_cannot_be_guessed_from_those_of_another_hub_or_server() -> None:
    secrets = set()
    for node in ("/a", "/b"):
        hub = FakeHub()
        for service in ("/add", "/other"):
            server = adder(hub, node, service)
            call_add(hub.client(), service=service)
            secrets.add(received_call(server).rpartition(":")[2])
    assert len(secrets) == 4


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
def test_malformed_response_fails_the_call(fields: dict[str, Any], fault: str) -> None:
    _, server, caller = adder_and_caller()
    for id_ in "ab":
        call_add(caller, id=id_)
    asked, other = received_calls(server)
    server.send("service_response", **{"service": "/add", "id": asked, "values": {}, **fields})
    [status] = server.receive_statuses()
    assert status.startswith(f"service_response: {fault}")
    response = caller.receive_one("service_response")
    assert (response["id"], response["result"]) == ("a", False)
    assert response["values"].startswith(fault)
    respond(server, asked)
    assert caller.receive() == []
    respond(server, other)
    assert received_sums(caller) == [3]


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
def test_malformed_response_to_an_unknown_call_changes_nothing(fields: dict[str, Any]) -> None:
    _, server, caller = adder_and_caller()
    call_add(caller)
    asked = received_call(server)
    server.send("service_response", **{"service": "/add", **fields})
    assert len(server.receive_statuses()) == 1
    assert caller.receive() == []
    respond(server, asked)
    assert received_sums(caller) == [3]


def test_nan_and_infinity_are_null_in_a_response() -> None:
    hub = FakeHub()
    server, caller = hub.client(), hub.client()
    server.send("advertise_service", service="/add", type="my_srvs/Do")
    call_add(caller)
    asked = received_call(server)
    server.send_text(
        '{"op":"service_response","service":"/add","result":true,'
        f'"id":"{asked}","values":{{"x":[NaN,1e400,-Infinity,0.1]}}}}'
    )
    assert caller.receive_one("service_response")["values"] == {"x": [None, None, None, 0.1]}
