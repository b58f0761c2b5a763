"""Requests and responses of services: conversion and validation."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import InvalidMessage
from fibws.interfaces import Service, Time
from fibws.msg.diagnostic_msgs import KeyValue
from fibws.msg.std_msgs import Int32
from fibws.node.types import NodeTypes
from fibws.srv.diagnostic_msgs import SelfTest
from fibws.srv.nav_msgs import GetMap
from fibws.srv.rosapi import GetTime
from fibws.srv.rospy_tutorials import AddTwoInts
from fibws.srv.std_srvs import Empty, Trigger


def request(types: NodeTypes, given: Any) -> dict[str, Any]:
    """Return a request as it travels."""
    type_ = types.service(AddTwoInts)
    return type_.request.json(type_.encode_request(given))


def response(types: NodeTypes, service: type[Service[Any, Any]], given: Any) -> dict[str, Any]:
    """Return a response as it travels."""
    type_ = types.service(service)
    return type_.response.json(type_.encode_response(given))


def test_service_type_has_a_name(types: NodeTypes) -> None:
    assert types.service(AddTwoInts).md5sum == "6a2e34150c00229791cc89ff309fff21"
    assert types.service(AddTwoInts).name == "rospy_tutorials/AddTwoInts"
    assert types.service(AddTwoInts) is types.service(AddTwoInts)


@pytest.mark.parametrize("given", [{"a": 1}, AddTwoInts.Request(1), AddTwoInts.Request(a=1)])
def test_request_may_be_a_message_or_a_dict(types: NodeTypes, given: Any) -> None:
    assert request(types, given) == {"a": 1, "b": 0}


@pytest.mark.parametrize(
    ("given", "name"),
    [
        (Int32(1), r"\[std_msgs/Int32\]"),
        (5, r"\[int\]; write a dict of its fields: a, b"),
        ((1, 2), r"\[tuple\]; write a dict of its fields: a, b"),
        (AddTwoInts, "the class AddTwoInts"),
        (AddTwoInts.Request, r"the class AddTwoIntsRequest: write AddTwoIntsRequest\(\)"),
    ],
)
def test_other_requests_are_refused(types: NodeTypes, given: Any, name: str) -> None:
    fault = rf"expected \[rospy_tutorials/AddTwoIntsRequest\] but got {name}$"
    with pytest.raises(TypeError, match=fault):
        request(types, given)


def test_received_request_is_validated(types: NodeTypes) -> None:
    service = types.service(AddTwoInts)
    assert service.read_request({"a": 1}) == AddTwoInts.Request(1, 0)
    assert service.read_request(None) == AddTwoInts.Request()
    with pytest.raises(InvalidMessage, match="field c"):
        service.read_request({"c": 1})


@pytest.mark.parametrize("given", [AddTwoInts.Response(3), {"sum": 3}, (3,), [3], 3])
def test_response_may_have_all_forms_of_rospy(types: NodeTypes, given: Any) -> None:
    assert response(types, AddTwoInts, given) == {"sum": 3}


@pytest.mark.parametrize("given", [(True, "done"), {"success": True, "message": "done"}])
def test_response_fields_may_be_given_in_order_or_by_name(types: NodeTypes, given: Any) -> None:
    assert response(types, Trigger, given) == {"success": True, "message": "done"}


@pytest.mark.parametrize("given", [{}, (), Empty.Response()])
def test_response_may_be_empty(types: NodeTypes, given: Any) -> None:
    assert response(types, Empty, given) == {}


def test_fields_may_hold_messages_and_times(types: NodeTypes) -> None:
    nested = {"id": "x", "status": [{"name": "motor", "values": (KeyValue("volts", "12"),)}]}
    values = response(types, SelfTest, nested)
    assert values["status"][0]["values"] == [{"key": "volts", "value": "12"}]
    for time in (Time(5, 6), {"time": Time(5, 6)}):
        assert response(types, GetTime, time) == {"time": {"secs": 5, "nsecs": 6}}
    assert response(types, GetMap, {"map": {"data": [1, -1]}})["map"]["data"] == [
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
    types: NodeTypes, given: Any, text: str
) -> None:
    with pytest.raises(InvalidMessage, match=text):
        response(types, AddTwoInts, given)


def test_received_response_is_validated(types: NodeTypes) -> None:
    service = types.service(AddTwoInts)
    assert service.response.read({"sum": 3}) == AddTwoInts.Response(3)
    with pytest.raises(InvalidMessage):
        service.response.read("3")
