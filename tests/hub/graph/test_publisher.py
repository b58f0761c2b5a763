"""A publisher: what it checks, fills, counts and keeps."""

from __future__ import annotations

import json
from typing import Any

import pytest

from fibws.errors import InvalidMessage, OperationError
from fibws.hub.graph.subscription import MAX_REGISTRATIONS

from ..fakes import payloads
from .listeners import Listeners, heard_by


def test_a_message_is_checked_and_filled() -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe()
    listeners.publisher("geometry_msgs/Vector3").publish({"y": 2})
    listeners.clock.turn()
    assert [json.loads(text)["msg"] for text in payloads(writes[0])] == [{"x": 0, "y": 2, "z": 0}]


def test_a_message_that_does_not_fit_is_not_sent() -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe()
    publisher = listeners.publisher(latch=True)
    with pytest.raises(InvalidMessage):
        publisher.publish({"data": "x"})
    listeners.clock.turn()
    assert writes == []
    assert publisher.latched is None


def test_a_latching_publisher_keeps_its_last_message() -> None:
    publisher = Listeners().publisher(latch=True)
    for number in range(3):
        publisher.publish({"data": number})
    assert publisher.latched is not None
    assert publisher.latched.json() == b'{"data":2}'


def test_another_publisher_keeps_none() -> None:
    publisher = Listeners().publisher()
    publisher.publish({"data": 1})
    assert publisher.latched is None


def test_a_message_for_one_node_is_never_latched() -> None:
    publisher = Listeners().publisher(latch=True)
    publisher.publish({"data": 1})
    publisher.publish({"data": 2}, to="/listener")
    assert publisher.latched is not None
    assert publisher.latched.json() == b'{"data":1}'


@pytest.mark.parametrize("latch", [False, True])
def test_a_publisher_introduces_itself(latch: bool) -> None:
    publisher = Listeners().publisher(latch=latch)
    own = {"callerid": "/talker", "latching": "1" if latch else "0"}
    assert json.loads(publisher.header) == own
    publisher.introduce({"user": "ann"})
    assert json.loads(publisher.header) == {**own, "user": "ann"}
    publisher.introduce({"callerid": "/me"})
    assert json.loads(publisher.header) == {**own, "callerid": "/me"}


def test_a_publisher_stands_while_an_advertisement_does() -> None:
    publisher = Listeners().publisher()
    assert not publisher.unadvertise("never")
    for id_ in ("a", "b", None):
        publisher.advertise(id_)
    assert [publisher.unadvertise(id_) for id_ in ("a", "unknown", "b")] == [True, True, True]
    publisher.advertise("a")
    assert not publisher.unadvertise(None)


def test_a_publisher_has_so_many_advertisements_and_no_more() -> None:
    publisher = Listeners().publisher()
    for id_ in range(MAX_REGISTRATIONS):
        publisher.advertise(id_)
    publisher.advertise(5)
    with pytest.raises(OperationError, match="100 advertisements of one topic are enough"):
        publisher.advertise("another")
    publisher.unadvertise(5)
    publisher.advertise("another")


def test_each_publisher_counts_its_messages_in_the_header() -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe()
    first, second = (listeners.publisher("rospy_tutorials/HeaderString") for _ in range(2))
    for publisher in (first, first, second, first):
        publisher.publish({"header": {"seq": 99}})
    assert [msg["header"]["seq"] for msg in heard_by(listeners, writes)] == [1, 2, 1, 3]


def test_the_count_is_an_uint32() -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe()
    publisher = listeners.publisher("rospy_tutorials/HeaderString")
    publisher._sequence = 2**32 - 2
    for _ in range(3):
        publisher.publish({})
    assert [msg["header"]["seq"] for msg in heard_by(listeners, writes)] == [2**32 - 1, 0, 1]


@pytest.mark.parametrize(
    ("type_", "msg"),
    [
        ("std_msgs/Header", {"seq": 99}),
        ("tf2_msgs/TFMessage", {"transforms": [{"header": {"seq": 99}}]}),
    ],
)
def test_a_header_that_is_not_the_messages_own_is_left_as_it_is(
    type_: str, msg: dict[str, Any]
) -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe()
    listeners.publisher(type_).publish(msg)
    [heard] = heard_by(listeners, writes)
    assert heard.get("seq") == 99 or heard["transforms"][0]["header"]["seq"] == 99


def test_a_number_that_json_does_not_have_is_null() -> None:
    listeners = Listeners()
    _, writes = listeners.subscribe()
    listeners.publisher("std_msgs/Float64").publish({"data": float("inf")})
    assert heard_by(listeners, writes) == [{"data": None}]
