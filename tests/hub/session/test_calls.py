"""Calling services."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import Fragment

from ..fakes import ADD, Client, FakeHub
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


def test_a_call_goes_to_the_provider_and_its_response_to_the_caller() -> None:
    _, provider, caller = adder_and_caller()
    calls(caller, 1, 2, id="x")
    assert provider.hears() == [
        {
            "op": "call_service",
            "id": "service_request:/add:1",
            "service": "/add",
            "args": {"a": 1, "b": 2},
        }
    ]
    assert caller.hears() == []
    answers(provider, "service_request:/add:1", 3)
    assert caller.hears() == [
        {
            "op": "service_response",
            "id": "x",
            "service": "/add",
            "result": True,
            "values": {"sum": 3},
        }
    ]
    assert provider.hears() == []


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
def test_arguments_come_by_name_or_in_order_and_the_rest_has_its_default(
    args: object, request_: dict[str, int]
) -> None:
    _, provider, caller = adder_and_caller()
    caller.says("call_service", service="/add", args=args)
    assert provider.hears_one("call_service")["args"] == request_


def test_arguments_may_be_left_out() -> None:
    _, provider, caller = adder_and_caller()
    caller.says_text('{"op":"call_service","service":"/add"}')
    assert provider.hears_one("call_service")["args"] == {"a": 0, "b": 0}


@pytest.mark.parametrize(
    ("args", "fault"),
    [
        ({"a": "1"}, "requires a int64 for field a, but got a str"),
        (["1"], "requires a int64 for field a, but got a str"),
        ({"a": 1.5}, "requires a int64 for field a, but got a float"),
        ({"b": True}, "requires a int64 for field b, but got a bool"),
        ({"b": 2**63}, "9223372036854775808 is not in"),
        ({"c": 1}, "Message type rospy_tutorials/AddTwoIntsRequest does not have a field c"),
        ({"a": None}, "requires a int64 for field a, but got a NoneType"),
    ],
)
def test_arguments_that_do_not_fit_fail_the_call_and_ask_nobody(args: object, fault: str) -> None:
    _, provider, caller = adder_and_caller()
    caller.says("call_service", service="/add", args=args)
    assert fault in hears_failure(caller)
    assert provider.hears() == []
    assert caller.forgotten


@pytest.mark.parametrize("id_", ["call_service:/add:1", "", "5", 5, 0, -1, 1.5, 2**70, True, False])
@pytest.mark.parametrize("service", ["/add", "/nope"])
def test_the_response_carries_the_id_as_it_was_sent(id_: object, service: str) -> None:
    _, provider, caller = adder_and_caller()
    calls(caller, service=service, id=id_)
    for asked in is_asked(provider):
        answers(provider, asked)
    response = caller.hears_one("service_response")
    assert (response["id"], type(response["id"])) == (id_, type(id_))


@pytest.mark.parametrize("fields", [{}, {"id": None}])
def test_a_call_without_an_id_has_a_response_without_one(fields: dict[str, Any]) -> None:
    _, provider, caller = adder_and_caller()
    calls(caller, **fields)
    answers(provider, is_asked_once(provider))
    assert "id" not in caller.hears_one("service_response")


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
def test_an_id_may_stand_behind_the_name(
    spelling: str, fields: dict[str, Any], id_: str | int
) -> None:
    _, provider, caller = adder_and_caller()
    calls(caller, service=spelling, **fields)
    asked = provider.hears_one("call_service")
    assert asked["service"] == "/add"
    answers(provider, asked["id"])
    response = caller.hears_one("service_response")
    assert (response["id"], response["service"], response["result"]) == (id_, spelling, True)


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
def test_each_knows_a_service_under_its_own_spelling(advertised: str, called: str) -> None:
    hub = FakeHub()
    provider, caller = adder(hub, service=advertised), hub.client("/caller")
    calls(caller, service=called)
    asked = provider.hears_one("call_service")
    assert asked["service"] == advertised
    assert asked["id"] == f"service_request:{advertised}:1"
    answers(provider, asked["id"], service=advertised)
    assert caller.hears_one("service_response")["service"] == called


def test_what_a_call_does_not_need_is_not_looked_at() -> None:
    _, provider, caller = adder_and_caller()
    calls(caller, type="nonsense", compression="png", topic=5)
    assert len(is_asked(provider)) == 1


@pytest.mark.parametrize(
    ("service", "text"),
    [
        ("/nope", "Service /nope does not exist"),
        ("nope", "Service /nope does not exist"),
        ("~add", "Service /caller/add does not exist"),
        ("", "'' is not a legal name: it is empty"),
        ("#77", "'' is not a legal name: it is empty"),
    ],
)
def test_a_call_of_no_service_fails(service: str, text: str) -> None:
    _, _, caller = adder_and_caller()
    calls(caller, service=service, id="x")
    response = caller.hears_one("service_response")
    assert (response["service"], response["id"]) == (service, "x")
    assert (response["result"], response["values"]) == (False, text)
    assert caller.forgotten


@pytest.mark.parametrize("name", ["/", "1st", "a b", "a//b", "/add/", "ä", "x" * 2000])
def test_a_call_of_what_is_no_name_fails(name: str) -> None:
    _, _, caller = adder_and_caller()
    calls(caller, service=name)
    assert "is not a legal name" in hears_failure(caller)


def test_a_client_may_call_its_own_service() -> None:
    client = FakeHub().client()
    client.says_text(
        json.dumps({"op": "advertise_service", "service": "/add", "type": ADD})
        + json.dumps({"op": "call_service", "service": "/add", "args": [1, 2], "id": "x"})
    )
    answers(client, client.hears_one("call_service")["id"])
    assert hears_sums(client) == [3]
    assert not (client.session.services._due or client.session.calls._calls)


def test_calls_may_be_answered_in_any_order() -> None:
    hub, provider, caller = adder_and_caller()
    other = hub.client("/other")
    for number in range(3):
        calls(caller, number, id=number)
        calls(other, number, id=number)
    ids = is_asked(provider)
    assert len(set(ids)) == 6
    for number in (5, 0, 3, 2, 1, 4):
        answers(provider, ids[number], number)
    assert [(each["id"], each["values"]["sum"]) for each in caller.hears()] == [
        (0, 0),
        (1, 2),
        (2, 4),
    ]
    assert [(each["id"], each["values"]["sum"]) for each in other.hears()] == [
        (2, 5),
        (1, 3),
        (0, 1),
    ]


def test_calls_of_one_id_have_a_response_each() -> None:
    _, provider, caller = adder_and_caller()
    for number in range(2):
        calls(caller, number, id="same")
    for id_, total in zip(is_asked(provider), (7, 8), strict=True):
        answers(provider, id_, total)
    assert hears_sums(caller) == [7, 8]


def test_a_client_may_wait_for_so_many_calls_and_no_more() -> None:
    _, provider, caller = adder_and_caller(max_calls=2)
    for id_ in "abc":
        calls(caller, id=id_)
    [refused] = caller.hears()
    assert (refused["id"], refused["result"]) == ("c", False)
    assert refused["values"] == "One client may have 2 calls, not more (--max-calls of the hub)"
    first, _ = is_asked(provider)
    answers(provider, first)
    calls(caller, id="d")
    assert hears_sums(caller) == [3]


def test_a_long_response_comes_in_pieces_if_the_caller_wants_it() -> None:
    hub = FakeHub()
    provider, caller = hub.client(), hub.client()
    provider.says("advertise_service", service="/x", type="my_srvs/Text")
    caller.says("call_service", service="/x", id="long", fragment_size=50)
    caller.says("call_service", service="/x", id="long", fragment_size=50)
    values = {"text": "\N{ROBOT FACE} says \n" * 20}
    for id_ in is_asked(provider):
        provider.says("service_response", service="/x", id=id_, values=values, result=True)
    fragments = caller.hears()
    whole = whole_texts(fragments)
    assert [json.loads(text)["values"] for text in whole] == [values, values]
    assert len({each["id"] for each in fragments}) == 2


def whole_texts(fragments: list[dict[str, Any]]) -> list[str]:
    """The texts that fragments of at most 50 characters make up."""
    reassembly = Reassembly(max_size=10**6)
    assert all(type(each["id"]) is str and len(each["data"]) <= 50 for each in fragments)
    texts = [reassembly.add(Fragment(**each), 0) for each in fragments]
    return [text for text in texts if text is not None]


def test_a_failure_comes_in_pieces_as_well() -> None:
    _, _, caller = adder_and_caller()
    calls(caller, service="/nope", fragment_size=50)
    [text] = whole_texts(caller.hears())
    assert json.loads(text)["values"] == "Service /nope does not exist"


# Types that nobody knows.


def unchecked() -> tuple[Client, Client]:
    hub = FakeHub()
    provider, caller = hub.client(), hub.client()
    provider.says("advertise_service", service="/do", type="my_srvs/srv/Do")
    return provider, caller


def test_a_call_of_an_unknown_type_is_relayed_as_it_is() -> None:
    provider, caller = unchecked()
    args, values = {"any": ["thing", None]}, {"other": {"thing": 2**60}}
    caller.says("call_service", service="/do", args=args)
    asked = provider.hears_one("call_service")
    assert asked["args"] == args
    provider.says("service_response", service="/do", id=asked["id"], values=values, result=True)
    assert caller.hears_one("service_response")["values"] == values


@pytest.mark.parametrize("args", [None, "text", 5])
def test_a_call_of_an_unknown_type_without_arguments_is_relayed_as_well(args: object) -> None:
    provider, caller = unchecked()
    caller.says("call_service", service="/do", args=args)
    assert provider.hears_one("call_service")["args"] == {}


def test_a_call_of_an_unknown_type_cannot_have_its_arguments_in_order() -> None:
    provider, caller = unchecked()
    caller.says("call_service", service="/do", args=[1])
    assert hears_failure(caller) == (
        "Expected a JSON object for type my_srvs/Do, whose fields are not known here"
    )
    assert provider.hears() == []
    assert caller.forgotten


MD5SUM = "6a2e34150c00229791cc89ff309fff21"
"""What stands for rospy_tutorials/AddTwoInts in ROS."""


def test_who_means_another_type_is_refused_with_the_text_of_ros() -> None:
    _, provider, caller = adder_and_caller()
    caller.says("call_service", service="/add", args={"number": 1}, headers={"md5sum": "0123"})
    fault = f"request from [/caller]: md5sums do not match: [0123] vs. [{MD5SUM}]"
    assert hears_failure(caller) == fault
    assert provider.hears() == []
    assert caller.forgotten


@pytest.mark.parametrize("md5sum", [MD5SUM, "*"])
def test_who_means_the_same_type_or_any_is_answered(md5sum: str) -> None:
    _, provider, caller = adder_and_caller()
    calls(caller, headers={"md5sum": md5sum})
    assert len(is_asked(provider)) == 1


def test_nobody_knows_what_stands_for_an_unknown_type() -> None:
    provider, caller = unchecked()
    caller.says("call_service", service="/do", args={}, headers={"md5sum": "0123"})
    assert len(is_asked(provider)) == 1


@pytest.mark.parametrize("fields", [{"timeout": "soon"}, {"fragment_size": []}])
def test_a_call_that_is_none_has_an_answer_all_the_same(fields: dict[str, Any]) -> None:
    """Its caller waits by the id, whatever was wrong."""
    client = FakeHub().client()
    client.says("call_service", service="/add", id="x", **fields)
    status, response = client.hears()
    assert status["op"] == "status"
    assert (response["op"], response["id"], response["result"]) == ("service_response", "x", False)
    assert next(iter(fields)) in response["values"]
    assert client.forgotten


def test_who_reads_no_answers_is_answered_no_more_once_it_is_to_be_closed() -> None:
    _, provider, caller = adder_and_caller(max_queued_bytes=1_000)
    caller.outbox.pause()
    while not caller.outbox.overfull:
        calls(caller, service="/nobodys")
    calls(caller)
    assert provider.hears() == []
