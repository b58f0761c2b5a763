"""Requests and responses of services: conversion and validation."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import InvalidMessage
from fibws.interfaces import Time
from fibws.msg.diagnostic_msgs import KeyValue
from fibws.msg.std_msgs import Int32
from fibws.node.types import Types
from fibws.srv.diagnostic_msgs import SelfTest
from fibws.srv.nav_msgs import GetMap
from fibws.srv.rosapi import GetTime
from fibws.srv.rospy_tutorials import AddTwoInts
from fibws.srv.std_srvs import Empty, Trigger


def test_service_type_has_a_name(types: Types) -> None:
    assert types.service(AddTwoInts).name == "rospy_tutorials/AddTwoInts"
    assert types.service(AddTwoInts) is types.service(AddTwoInts)


@pytest.mark.parametrize("given", [{"a": 1}, AddTwoInts.Request(1), AddTwoInts.Request(a=1)])
def test_request_may_be_a_message_or_a_dict(types: Types, given: Any) -> None:
    assert types.service(AddTwoInts).write_request(given) == {"a": 1, "b": 0}


@pytest.mark.parametrize(
    ("given", "name"),
    [(Int32(1), "std_msgs/Int32"), (5, "int"), ((1, 2), "tuple"), (AddTwoInts, "type")],
)
def test_other_requests_are_refused(types: Types, given: Any, name: str) -> None:
    fault = rf"expected \[rospy_tutorials/AddTwoIntsRequest\] but got \[{name}\]"
    with pytest.raises(TypeError, match=fault):
        types.service(AddTwoInts).write_request(given)


def test_received_request_is_validated(types: Types) -> None:
    service = types.service(AddTwoInts)
    assert service.read_request({"a": 1}) == AddTwoInts.Request(1, 0)
    assert service.read_request(None) == AddTwoInts.Request()
    with pytest.raises(InvalidMessage, match="field c"):
        service.read_request({"c": 1})


@pytest.mark.parametrize("given", [AddTwoInts.Response(3), {"sum": 3}, (3,), [3], 3])
def test_response_may_have_all_forms_of_rospy(types: Types, given: Any) -> None:
    assert types.service(AddTwoInts).write_response(given) == {"sum": 3}


@pytest.mark.parametrize("given", [(True, "done"), {"success": True, "message": "done"}])
def test_response_fields_may_be_given_in_order_or_by_name(types: Types, given: Any) -> None:
    assert types.service(Trigger).write_response(given) == {"success": True, "message": "done"}


@pytest.mark.parametrize("given", [{}, (), Empty.Response()])
def test_response_may_be_empty(types: Types, given: Any) -> None:
    assert types.service(Empty).write_response(given) == {}


def test_fields_may_hold_messages_and_times(types: Types) -> None:
    nested = {"id": "x", "status": [{"name": "motor", "values": (KeyValue("volts", "12"),)}]}
    values = types.service(SelfTest).write_response(nested)
    assert values["status"][0]["values"] == [{"key": "volts", "value": "12"}]
    for time in (Time(5, 6), {"time": Time(5, 6)}):
        assert types.service(GetTime).write_response(time) == {"time": {"secs": 5, "nsecs": 6}}
    assert types.service(GetMap).write_response({"map": {"data": [1, -1]}})["map"]["data"] == [
        1,
        -1,
    ]


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (None, "^service handler returned None$"),
        ((1, 2), "^handler returned wrong number of values: "),
        ("3", "^handler returned invalid value: .* field sum"),
        ({"total": 3}, "^handler returned invalid value: .* field total"),
        (Int32(3), r"^handler returned invalid value: .* but got \[std_msgs/Int32\]"),
    ],
)
def test_other_responses_are_refused_with_the_error_of_rospy(
    types: Types, given: Any, text: str
) -> None:
    with pytest.raises(InvalidMessage, match=text):
        types.service(AddTwoInts).write_response(given)


def test_received_response_is_validated(types: Types) -> None:
    service = types.service(AddTwoInts)
    assert service.read_response({"sum": 3}) == AddTwoInts.Response(3)
    with pytest.raises(InvalidMessage):
        service.read_response("3")
