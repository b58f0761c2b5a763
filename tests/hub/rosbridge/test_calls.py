"""Calling services."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import LONGEST_ID, Fragment

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


def test_call_reaches_the_server_and_its_response_the_caller() -> None:
    _, server, caller = adder_and_caller()
    call_add(caller, 1, 2, id="x")
    asked = server.receive_one("call_service")
    id_ = asked.pop("id")
    assert asked == {"op": "call_service", "service": "/add", "args": {"a": 1, "b": 2}}
    assert caller.receive() == []
    respond(server, id_, 3)
    assert caller.receive() == [
        {
            "op": "service_response",
            "id": "x",
            "service": "/add",
            "result": True,
            "values": {"sum": 3},
        }
    ]
    assert server.receive() == []


@pytest.mark.parametrize(
    ("args", "request_"),
    [
        ({"a": 1, "b": 2}, {"a": 1, "b": 2}),
        ({"b": 2}, {"a": 0, "b": 2}),
        ({}, {"a": 0, "b": 0}),
        (None, {"a": 0, "b": 0}),
        ([1, 2], {"a": 1, "b": 2}),
        ([1], {"a": 1, "b": 0}),
        ([], {"a": 0, "b": 0}),
        ([1, 2, 3, "more"], {"a": 1, "b": 2}),
        ("text", {"a": 0, "b": 0}),
        (5, {"a": 0, "b": 0}),
        (True, {"a": 0, "b": 0}),
        ({"a": 2**63 - 1, "b": -(2**63)}, {"a": 2**63 - 1, "b": -(2**63)}),
    ],
)
def test_arguments_are_an_object_or_a_list_with_defaults_for_the_rest(
    args: object, request_: dict[str, int]
) -> None:
    _, server, caller = adder_and_caller()
    caller.send("call_service", service="/add", args=args)
    assert server.receive_one("call_service")["args"] == request_


def test_arguments_may_be_left_out() -> None:
    _, server, caller = adder_and_caller()
    caller.send_text('{"op":"call_service","service":"/add"}')
    assert server.receive_one("call_service")["args"] == {"a": 0, "b": 0}


@pytest.mark.parametrize(
    ("args", "fault"),
    [
        ({"a": "one"}, "requires an int64 for field a, but got a str"),
        (["one"], "requires an int64 for field a, but got a str"),
        ({"a": 1.5}, "requires an int64 for field a, but got a float"),
        ({"b": True}, "requires an int64 for field b, but got a bool"),
        ({"b": 2**63}, "9223372036854775808 is not in"),
        ({"c": 1}, "Message type rospy_tutorials/AddTwoIntsRequest does not have a field c"),
        ({"a": None}, "requires an int64 for field a, but got a NoneType"),
    ],
)
def test_invalid_arguments_fail_the_call_before_the_server(args: object, fault: str) -> None:
    _, server, caller = adder_and_caller()
    caller.send("call_service", service="/add", args=args)
    assert fault in received_failure(caller)
    assert server.receive() == []
    assert caller.forgotten


@pytest.mark.parametrize("id_", ["call_service:/add:1", "", "5", 5, 0, -1, 1.5, 2**70, True, False])
@pytest.mark.parametrize("service", ["/add", "/nope"])
def test_response_carries_the_id_as_it_was_sent(id_: object, service: str) -> None:
    _, server, caller = adder_and_caller()
    call_add(caller, service=service, id=id_)
    for asked in received_calls(server):
        respond(server, asked)
    response = caller.receive_one("service_response")
    assert (response["id"], type(response["id"])) == (id_, type(id_))


@pytest.mark.parametrize("fields", [{}, {"id": None}])
def test_call_without_an_id_has_a_response_without_one(fields: dict[str, Any]) -> None:
    _, server, caller = adder_and_caller()
    call_add(caller, **fields)
    respond(server, received_call(server))
    assert "id" not in caller.receive_one("service_response")


@pytest.mark.parametrize(
    ("spelling", "fields", "id_"),
    [
        ("/add#77", {}, "77"),
        ("add#77", {}, "77"),
        ("/add#77", {"id": None}, "77"),
        ("/add#77", {"id": 5}, 5),
        ("/add#a#b", {}, "a#b"),
        ("/add#", {}, ""),
    ],
)
def test_id_may_follow_the_service_name(
    spelling: str, fields: dict[str, Any], id_: str | int
) -> None:
    _, server, caller = adder_and_caller()
    call_add(caller, service=spelling, **fields)
    asked = server.receive_one("call_service")
    assert asked["service"] == "/add"
    respond(server, asked["id"])
    response = caller.receive_one("service_response")
    assert (response["id"], response["service"], response["result"]) == (id_, spelling, True)


@pytest.mark.parametrize("id_", [None, 5])
def test_id_that_follows_the_service_name_has_a_bounded_length(id_: object) -> None:
    """It is kept until the response, as is the name that it follows."""
    _, server, caller = adder_and_caller()
    call_add(caller, service=f"/add#{'x' * LONGEST_ID}", id=id_)
    assert len(received_calls(server)) == 1
    call_add(caller, service=f"/add#{'x' * (LONGEST_ID + 1)}", id=id_)
    assert received_calls(server) == []
    errors = [each for each in caller.receive() if each["op"] == "status"]
    assert [each["msg"] for each in errors] == [
        f"call_service: an id behind the # has at most {LONGEST_ID} characters"
    ]


@pytest.mark.parametrize(
    ("advertised", "called"),
    [
        ("/add", "add"),
        ("add", "/add"),
        ("add", "add"),
        ("~add", "/adder/add"),
        ("/caller/add", "~add"),
    ],
)
def test_each_client_keeps_its_spelling_of_a_service(advertised: str, called: str) -> None:
    hub = FakeHub()
    server, caller = adder(hub, service=advertised), hub.client("/caller")
    call_add(caller, service=called)
    asked = server.receive_one("call_service")
    assert asked["service"] == advertised
    assert asked["id"].startswith(f"service_request:{advertised}:")
    respond(server, asked["id"], service=advertised)
    assert caller.receive_one("service_response")["service"] == called


def test_unneeded_fields_of_a_call_are_ignored() -> None:
    _, server, caller = adder_and_caller()
    call_add(caller, type="nonsense", compression="png", topic=5)
    assert len(received_calls(server)) == 1


@pytest.mark.parametrize(
    ("service", "text"),
    [
        ("/nope", "Service /nope does not exist"),
        ("nope", "Service /nope does not exist"),
        ("~add", "Service /caller/add does not exist"),
        ("", "'' is not a legal name: it is empty"),
        ("#77", "'' is not a legal name: it is empty"),
        ("add-two", "Service /add-two does not exist"),
    ],
)
def test_call_of_an_unknown_service_fails(service: str, text: str) -> None:
    _, _, caller = adder_and_caller()
    call_add(caller, service=service, id="x")
    response = caller.receive_one("service_response")
    assert (response["service"], response["id"]) == (service, "x")
    assert (response["result"], response["values"]) == (False, text)
    assert caller.forgotten


@pytest.mark.parametrize("name", ["/", "//", "~", "a b", "a\tb", "x" * 2000])
def test_call_of_an_invalid_name_fails(name: str) -> None:
    _, _, caller = adder_and_caller()
    call_add(caller, service=name)
    assert "is not a legal name" in received_failure(caller)


def test_client_may_call_its_own_service() -> None:
    client = FakeHub().client()
    client.send_text(
        json.dumps({"op": "advertise_service", "service": "/add", "type": ADD})
        + json.dumps({"op": "call_service", "service": "/add", "args": [1, 2], "id": "x"})
    )
    respond(client, client.receive_one("call_service")["id"])
    assert received_sums(client) == [3]
    assert not (client.kept["calls to answer"] or client.kept["calls"])


def test_calls_may_be_answered_in_any_order() -> None:
    hub, server, caller = adder_and_caller()
    other = hub.client("/other")
    for number in range(3):
        call_add(caller, number, id=number)
        call_add(other, number, id=number)
    ids = received_calls(server)
    assert len(set(ids)) == 6
    for number in (5, 0, 3, 2, 1, 4):
        respond(server, ids[number], number)
    assert [(each["id"], each["values"]["sum"]) for each in caller.receive()] == [
        (0, 0),
        (1, 2),
        (2, 4),
    ]
    assert [(each["id"], each["values"]["sum"]) for each in other.receive()] == [
        (2, 5),
        (1, 3),
        (0, 1),
    ]


def test_calls_with_the_same_id_get_a_response_each() -> None:
    _, server, caller = adder_and_caller()
    for number in range(2):
        call_add(caller, number, id="same")
    for id_, total in zip(received_calls(server), (7, 8), strict=True):
        respond(server, id_, total)
    assert received_sums(caller) == [7, 8]


def test_number_of_calls_of_a_client_is_limited() -> None:
    _, server, caller = adder_and_caller(max_calls=2)
    for id_ in "abc":
        call_add(caller, id=id_)
    [refused] = caller.receive()
    assert (refused["id"], refused["result"]) == ("c", False)
    assert "limit 2" in refused["values"]
    assert "--max-calls" in refused["values"]
    first, _ = received_calls(server)
    respond(server, first)
    call_add(caller, id="d")
    assert received_sums(caller) == [3]


def test_long_response_is_fragmented_on_request() -> None:
    hub = FakeHub()
    server, caller = hub.client(), hub.client()
    server.send("advertise_service", service="/x", type="my_srvs/Text")
    caller.send("call_service", service="/x", id="long", fragment_size=50)
    caller.send("call_service", service="/x", id="long", fragment_size=50)
    values = {"text": "\N{ROBOT FACE} says \n" * 20}
    for id_ in received_calls(server):
        server.send("service_response", service="/x", id=id_, values=values, result=True)
    fragments = caller.receive()
    whole = whole_texts(fragments)
    assert [json.loads(text)["values"] for text in whole] == [values, values]
    assert len({each["id"] for each in fragments}) == 2


def whole_texts(fragments: list[dict[str, Any]]) -> list[str]:
    """Return the texts that fragments of at most 50 characters make up."""
    reassembly = Reassembly(max_size=10**6)
    assert all(type(each["id"]) is str and len(each["data"]) <= 50 for each in fragments)
    texts = [reassembly.add(Fragment(**each), 0) for each in fragments]
    return [text for text in texts if text is not None]


def test_long_failure_is_fragmented_on_request() -> None:
    _, _, caller = adder_and_caller()
    call_add(caller, service="/nope", fragment_size=50)
    [text] = whole_texts(caller.receive())
    assert json.loads(text)["values"] == "Service /nope does not exist"


# Unknown types.


def unchecked() -> tuple[Client, Client]:
    hub = FakeHub()
    server, caller = hub.client(), hub.client()
    server.send("advertise_service", service="/do", type="my_srvs/srv/Do")
    return server, caller


def test_call_of_an_unknown_type_is_relayed_unchecked() -> None:
    server, caller = unchecked()
    args, values = {"any": ["thing", None]}, {"other": {"thing": 2**60}}
    caller.send("call_service", service="/do", args=args)
    asked = server.receive_one("call_service")
    assert asked["args"] == args
    server.send("service_response", service="/do", id=asked["id"], values=values, result=True)
    assert caller.receive_one("service_response")["values"] == values


@pytest.mark.parametrize("args", [None, "text", 5])
def test_call_of_an_unknown_type_needs_no_arguments(args: object) -> None:
    server, caller = unchecked()
    caller.send("call_service", service="/do", args=args)
    assert server.receive_one("call_service")["args"] == {}


def test_arguments_of_an_unknown_type_cannot_be_a_list() -> None:
    server, caller = unchecked()
    caller.send("call_service", service="/do", args=[1])
    assert received_failure(caller) == (
        "Expected a JSON object for type my_srvs/Do, whose fields are not known here"
    )
    assert server.receive() == []
    assert caller.forgotten


MD5SUM = "6a2e34150c00229791cc89ff309fff21"
"""The md5sum of rospy_tutorials/AddTwoInts."""


def test_caller_with_another_md5sum_is_refused_with_the_text_of_ros() -> None:
    _, server, caller = adder_and_caller()
    caller.send("call_service", service="/add", args={"number": 1}, headers={"md5sum": "0123"})
    fault = f"request from [/caller]: md5sums do not match: [0123] vs. [{MD5SUM}]"
    assert received_failure(caller) == fault
    assert server.receive() == []
    assert caller.forgotten


@pytest.mark.parametrize("md5sum", [MD5SUM, "*"])
def test_caller_with_the_same_md5sum_or_an_asterisk_is_answered(md5sum: str) -> None:
    _, server, caller = adder_and_caller()
    call_add(caller, headers={"md5sum": md5sum})
    assert len(received_calls(server)) == 1


def test_md5sum_of_an_unknown_type_is_not_checked() -> None:
    server, caller = unchecked()
    caller.send("call_service", service="/do", args={}, headers={"md5sum": "0123"})
    assert len(received_calls(server)) == 1


@pytest.mark.parametrize("fields", [{"timeout": "soon"}, {"fragment_size": []}])
def test_malformed_call_gets_a_response(fields: dict[str, Any]) -> None:
    """The caller waits for a response with its id, whatever the error."""
    client = FakeHub().client()
    client.send("call_service", service="/add", id="x", **fields)
    status, response = client.receive()
    assert status["op"] == "status"
    assert (response["op"], response["id"], response["result"]) == ("service_response", "x", False)
    assert next(iter(fields)) in response["values"]
    assert client.forgotten


def test_overfull_client_gets_no_more_responses() -> None:
    _, server, caller = adder_and_caller(max_queued_bytes=1_000)
    caller.queue.pause()
    while not caller.queue.overfull:
        call_add(caller, service="/nobodys")
    call_add(caller)
    assert server.receive() == []
