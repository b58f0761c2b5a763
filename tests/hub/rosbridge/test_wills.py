"""Last wills: what the hub publishes for clients that have gone."""

from __future__ import annotations

import logging
from typing import Any

import pytest

from fibws.hub.rosbridge.wills import CHECKS

from ..fakes import INT32, Client, FakeHub, number

STOP = number(0)
SET = {"op": "set_will", "topic": "/cmd"}


@pytest.fixture
def hub() -> FakeHub:
    return FakeHub()


@pytest.fixture
def robot(hub: FakeHub) -> Client:
    robot = hub.client("/robot")
    robot.send("subscribe", "/cmd", type=INT32)
    return robot


def driver(hub: FakeHub, node: str = "/driver", *, serialized: bool = False) -> Client:
    client = hub.client(node, serialized=serialized)
    client.send("advertise", "/cmd", type=INT32, **({"publisher": 1} if serialized else {}))
    return client


@pytest.mark.parametrize("serialized", [False, True])
def test_will_is_the_last_message_of_a_client_that_leaves(
    hub: FakeHub, robot: Client, *, serialized: bool
) -> None:
    client = driver(hub, serialized=serialized)
    client.send("set_will", "/cmd", msg=STOP)
    client.send("publish", "/cmd", msg=number(5))
    assert robot.receive_numbers("/cmd") == [5]
    client.send("publish", "/cmd", msg=number(6))
    client.disconnect()
    assert robot.receive_numbers("/cmd") == [6, 0]
    client.disconnect()
    assert robot.receive() == []


def test_will_is_published_when_its_node_is_replaced(hub: FakeHub, robot: Client) -> None:
    driver(hub).send("set_will", "/cmd", msg=STOP)
    driver(hub)
    assert robot.receive_numbers("/cmd") == [0]


def test_will_needs_no_advertisement(hub: FakeHub, robot: Client) -> None:
    client = hub.client("/driver")
    client.send("set_will", "/cmd", msg=STOP)
    client.send("set_will", "/other", type=INT32, msg=STOP)
    assert client.receive() == []
    assert {"/cmd", "/other"} <= hub.graph.topics.keys()
    client.disconnect()
    assert robot.receive_numbers("/cmd") == [0]


def test_newer_will_replaces_the_older(hub: FakeHub, robot: Client) -> None:
    client = driver(hub)
    for data in (1, 2):
        client.send("set_will", "/cmd", msg=number(data))
    client.disconnect()
    assert robot.receive_numbers("/cmd") == [2]


@pytest.mark.parametrize("op", ["clear_will", "unadvertise"])
def test_will_can_be_taken_back(hub: FakeHub, robot: Client, op: str) -> None:
    client = driver(hub)
    client.send("set_will", "/cmd", msg=STOP, timeout=1)
    client.send(op, "/cmd")
    client.send("clear_will", "/none")
    client.disconnect()
    assert robot.receive() == []
    hub.clock.advance(10)
    assert client.forgotten


def test_will_without_a_message_is_the_default_message(hub: FakeHub, robot: Client) -> None:
    client = driver(hub)
    client.send("set_will", "/cmd")
    client.disconnect()
    assert robot.receive_numbers("/cmd") == [0]


@pytest.mark.parametrize(
    ("fields", "fact"),
    [
        ({"msg": {"data": "x"}}, "std_msgs/Int32"),
        ({"msg": STOP, "timeout": 0.01}, "timeout"),
        ({"msg": STOP, "timeout": 1e9}, "timeout"),
        ({"msg": STOP, "topic": "/untyped"}, "/untyped has no type"),
        ({"msg": STOP, "topic": "/a", "type": "std_msgs/Nope"}, "Nope"),
        ({"msg": STOP, "topic": "not legal"}, "not legal"),
    ],
)
def test_invalid_will_is_refused_and_leaves_the_older(
    hub: FakeHub, robot: Client, fields: dict[str, Any], fact: str
) -> None:
    client = driver(hub)
    client.send("set_will", "/cmd", msg=number(3))
    client.send("set_will", **{"topic": "/cmd", **fields})
    (status,) = client.receive_statuses()
    assert status.startswith("set_will: ")
    assert fact in status
    client.disconnect()
    assert robot.receive_numbers("/cmd") == [3]


def test_wills_are_bounded() -> None:
    hub = FakeHub(max_latched_bytes=100, max_advertisements=3)
    client = hub.client(serialized=True)
    for topic in "abcd":
        client.send("set_will", f"/{topic}", type="std_msgs/String", msg={"data": "x" * 20})
    assert [each["code"] for each in client.receive()] == ["limit_reached"]
    client.send("set_will", "/a", msg={"data": "x" * 60})
    assert [each["code"] for each in client.receive()] == ["limit_reached"]
    client.send("clear_will", "/b")
    client.send("set_will", "/a", msg={"data": "x" * 40})
    assert client.receive() == []
    client.disconnect()
    assert client.forgotten
    assert hub.empty


def test_number_of_wills_is_bounded(hub: FakeHub, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fibws.hub.rosbridge.wills.MOST_WILLS", 2)
    client = hub.client(serialized=True)
    for topic in "aabb":
        client.send("set_will", f"/{topic}", type=INT32)
    assert client.receive() == []
    client.send("set_will", "/c", type=INT32)
    assert [each["code"] for each in client.receive()] == ["limit_reached"]


# Timeouts.


def test_will_is_published_when_the_topic_is_silent_for_too_long(
    hub: FakeHub, robot: Client, caplog: pytest.LogCaptureFixture
) -> None:
    client = driver(hub)
    client.send("set_will", "/cmd", msg=STOP, timeout=1.0)
    hub.clock.advance(10)
    assert robot.receive() == []  # The client has not begun.
    for data in range(1, 9):
        client.send("publish", "/cmd", msg=number(data))
        hub.clock.advance(0.5)
    assert robot.receive_numbers("/cmd") == [*range(1, 9)]
    caplog.set_level(logging.WARNING)
    hub.clock.advance(0.5 + 1 / CHECKS)
    assert robot.receive_numbers("/cmd") == [0]
    assert "/driver" in caplog.text
    hub.clock.advance(100)
    client.disconnect()
    assert robot.receive() == []  # It was published once.


def test_timeout_counts_again_after_the_next_message(hub: FakeHub, robot: Client) -> None:
    client = driver(hub)
    client.send("set_will", "/cmd", msg=STOP, timeout=1.0)
    for _ in range(2):
        client.send("publish", "/cmd", msg=number(5))
        hub.clock.advance(5)
        assert robot.receive_numbers("/cmd") == [5, 0]
    client.send("publish", "/cmd", msg=number(6))
    client.disconnect()
    assert robot.receive_numbers("/cmd") == [6, 0]
    hub.clock.advance(5)
    assert hub.clock.timers == 0


def test_client_that_is_only_connected_keeps_no_will_alive(hub: FakeHub, robot: Client) -> None:
    client = driver(hub)
    client.send("set_will", "/cmd", msg=STOP, timeout=1.0)
    client.send("publish", "/cmd", msg=number(5))
    for _ in range(10):
        client.send("subscribe", "/other", type=INT32)
        hub.clock.advance(0.2)
    assert robot.receive_numbers("/cmd") == [5, 0]


def test_timers_of_wills_run_only_while_their_topics_are_in_use(hub: FakeHub) -> None:
    client = hub.client("/driver")
    for index in range(50):
        fields = {"type": INT32, "msg": STOP, "timeout": 0.05 + index / 100}
        client.send("set_will", f"/w{index}", **fields)
    assert hub.clock.timers == 0
    for index in range(50):
        client.send("publish", f"/w{index}", msg=number(1))
        assert hub.clock.timers == 1
    hub.clock.advance(10)
    assert hub.clock.timers == 0
    client.send("publish", "/w7", msg=number(1))
    assert hub.clock.timers == 1
    client.send("clear_will", "/w7")
    assert hub.clock.timers == 0


def test_shorter_timeout_is_not_late_because_of_a_longer_one(hub: FakeHub, robot: Client) -> None:
    client = driver(hub)
    client.send("set_will", "/slow", type=INT32, msg=STOP, timeout=100.0)
    client.send("publish", "/slow", msg=number(1))
    client.send("set_will", "/cmd", msg=STOP, timeout=1.0)
    client.send("publish", "/cmd", msg=number(5))
    hub.clock.advance(1 + 1 / CHECKS)
    assert robot.receive_numbers("/cmd") == [5, 0]
    hub.clock.advance(100 + 100 / CHECKS)
    assert hub.clock.timers == 0
