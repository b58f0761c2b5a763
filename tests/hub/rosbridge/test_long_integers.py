"""Subscriptions that get 64-bit integers as strings."""

from __future__ import annotations

import math
from struct import pack
from typing import Any

import pytest

from ..fakes import Client, FakeHub

LARGE = 2**53 + 1


def subscribed(hub: FakeHub, **fields: Any) -> Client:
    client = hub.client()
    client.send("subscribe", "/n", **fields)
    return client


def talker(hub: FakeHub, type_: str = "std_msgs/Int64", **fields: Any) -> Client:
    client = hub.client(serialized="publisher" in fields)
    client.send("advertise", "/n", type=type_, **fields)
    return client


def test_integers_are_strings_on_request() -> None:
    hub = FakeHub()
    asking, other = subscribed(hub, int64="string"), subscribed(hub)
    talker(hub).send("publish", "/n", msg={"data": LARGE})
    assert asking.receive_messages("/n") == [{"data": str(LARGE)}]
    assert other.receive_messages("/n") == [{"data": LARGE}]


def test_small_integers_are_strings_too() -> None:
    hub = FakeHub()
    asking = subscribed(hub, int64="string")
    talker(hub).send("publish", "/n", msg={"data": -1})
    assert asking.receive_messages("/n") == [{"data": "-1"}]


def test_serialized_messages_have_them_too() -> None:
    hub = FakeHub()
    asking = subscribed(hub, int64="string")
    talker(hub, publisher=1).send_binary(pack("<BIq", 1, 1, LARGE))
    assert asking.receive_messages("/n") == [{"data": str(LARGE)}]


def test_latched_message_has_them_too() -> None:
    hub = FakeHub()
    talker(hub, latch=True).send("publish", "/n", msg={"data": LARGE})
    assert subscribed(hub, int64="string").receive_messages("/n") == [{"data": str(LARGE)}]


def test_integer_sent_as_a_string_is_a_number_for_others() -> None:
    hub = FakeHub()
    listener = subscribed(hub)
    talker(hub).send("publish", "/n", msg={"data": str(LARGE)})
    assert listener.receive_messages("/n") == [{"data": LARGE}]


@pytest.mark.parametrize("type_", ["std_msgs/Int32", "my_pkg/Unknown"])
def test_other_integers_stay_numbers(type_: str) -> None:
    hub = FakeHub()
    asking = subscribed(hub, int64="string")
    talker(hub, type_).send("publish", "/n", msg={"data": 5})
    assert asking.receive_messages("/n") == [{"data": 5}]


@pytest.mark.parametrize("headers", [None, True])
def test_infinity_is_as_without(headers: bool | None) -> None:
    hub = FakeHub()
    definition = "int64 long\nfloat64 real"
    asking = subscribed(hub, int64="string", headers=headers)
    client = talker(hub, "my_msgs/Both", definition=definition)
    client.send("publish", "/n", msg={"long": 1, "real": math.inf})
    received = asking.receive_one("publish")
    assert received["msg"] == {"long": "1", "real": math.inf if headers else None}
    assert ("header" in received) == bool(headers)


def test_another_value_is_refused() -> None:
    hub = FakeHub()
    asking = subscribed(hub, int64="number")
    [status] = asking.receive_statuses()
    assert "Expected field int64 to be one of 'string'" in status
