"""The whole graph in one answer."""

from __future__ import annotations

from typing import Any

import pytest

from ..fakes import ADD, FIBONACCI, INT32, NANOSECONDS, Client
from .asking import Asking

SECS, NSECS = divmod(NANOSECONDS, 10**9)
ACTION = "actionlib_tutorials/Fibonacci"
UNKNOWN = "my_msgs/Number"


@pytest.fixture
def asking() -> Asking:
    return Asking()


def graph(asking: Asking) -> dict[str, Any]:
    told = asking.gets("/rosapi/graph")
    assert told["revision"] == asking.graph.revision
    return told


def named(told: dict[str, Any], what: str, name: str) -> dict[str, Any]:
    """What is told of the one node, topic, service or action of that name."""
    (found,) = [each for each in told[what] if each["name"] == name]
    assert isinstance(found, dict)
    return found


def topic(asking: Asking, name: str) -> dict[str, Any]:
    return named(graph(asking), "topics", name)


def test_nodes_have_their_addresses_and_the_moment_when_they_came(asking: Asking) -> None:
    asking.connects("/talker")
    assert named(graph(asking), "nodes", "/talker") == {
        "name": "/talker",
        "address": "10.0.0.1:50001",
        "since": {"secs": SECS, "nsecs": NSECS},
        "own": False,
    }


def test_the_hubs_own_nodes_are_told_apart_and_have_no_address(asking: Asking) -> None:
    asking.connects("/talker")
    own = [node for node in graph(asking)["nodes"] if node["own"]]
    assert [node["name"] for node in own] == ["/rosapi", "/rosbridge_websocket", "/rosout"]
    assert {node["address"] for node in own} == {""}
    assert {node["since"]["secs"] for node in own} == {SECS}


def test_a_node_that_is_replaced_has_the_newer_ones_address(asking: Asking) -> None:
    asking.connects("/talker")
    asking.connects("/talker")
    assert named(graph(asking), "nodes", "/talker")["address"] == "10.0.0.1:50002"


def test_a_topic_has_its_type_and_its_publishers(asking: Asking) -> None:
    asking.joins("/b").says("advertise", "/fib", type=INT32)
    asking.joins("/a").says("advertise", "/fib", type=INT32, latch=True)
    assert topic(asking, "/fib") == {
        "name": "/fib",
        "type": INT32,
        "checked": True,
        "publishers": [{"node": "/a", "latch": True}, {"node": "/b", "latch": False}],
        "subscriptions": [],
    }


def test_a_topic_may_have_no_type_yet(asking: Asking) -> None:
    asking.joins("/listener").says("subscribe", "/awaited")
    awaited = topic(asking, "/awaited")
    assert (awaited["type"], awaited["checked"], awaited["publishers"]) == ("", False, [])


def test_a_type_that_nobody_defined_is_not_checked_until_somebody_does(asking: Asking) -> None:
    talker = asking.joins("/talker")
    talker.says("advertise", "/n", type=UNKNOWN)
    assert (topic(asking, "/n")["type"], topic(asking, "/n")["checked"]) == (UNKNOWN, False)
    talker.says("advertise", "/n", type=UNKNOWN, definition="int32 data")
    assert topic(asking, "/n")["checked"]


@pytest.mark.parametrize(
    ("wish", "expected"),
    [
        ({}, (1000, 0, "none")),
        ({"queue_length": 5}, (5, 0, "none")),
        ({"throttle_rate": 99.6, "queue_length": 1}, (1, 100, "none")),
        ({"compression": "cbor-raw"}, (1000, 0, "cbor-raw")),
        ({"compression": "cbor"}, (1000, 0, "cbor")),
        ({"compression": "png"}, (1000, 0, "png")),
        ({"compression": "zip"}, (1000, 0, "none")),
        ({"throttle_rate": 1e300, "queue_length": 10**15}, (2**32 - 1, 2**32 - 1, "none")),
    ],
)
def test_a_subscription_is_told_as_the_hub_took_it(
    asking: Asking, wish: dict[str, Any], expected: tuple[int, int, str]
) -> None:
    asking.joins("/listener").says("subscribe", "/fib", type=INT32, **wish)
    queue_length, throttle_rate, compression = expected
    assert topic(asking, "/fib")["subscriptions"] == [
        {
            "node": "/listener",
            "queue_length": queue_length,
            "throttle_rate": throttle_rate,
            "compression": compression,
        }
    ]


def test_a_subscription_may_change(asking: Asking) -> None:
    listener = asking.joins("/listener")
    listener.says("subscribe", "/fib", type=INT32)
    assert topic(asking, "/fib")["subscriptions"][0]["throttle_rate"] == 0
    listener.says("unsubscribe", "/fib")
    listener.says("subscribe", "/fib", type=INT32, throttle_rate=50)
    assert topic(asking, "/fib")["subscriptions"][0]["throttle_rate"] == 50


def test_what_the_hub_itself_hears_is_told_too(asking: Asking) -> None:
    asking.joins("/a").says("subscribe", "/rosout")
    heard = topic(asking, "/rosout")["subscriptions"]
    assert [each["node"] for each in heard] == ["/a", "/rosout"]


def test_services_have_their_types_and_nodes(asking: Asking) -> None:
    asking.joins("/adder").says("advertise_service", service="/add", type=ADD)
    add = named(graph(asking), "services", "/add")
    assert add == {"name": "/add", "type": ADD, "node": "/adder"}
    assert named(graph(asking), "services", "/rosapi/graph") == {
        "name": "/rosapi/graph",
        "type": "fibws_msgs/GetGraph",
        "node": "/rosapi",
    }


def test_an_action_by_operations(asking: Asking) -> None:
    asking.joins("/server").says("advertise_action", action="/count", type=FIBONACCI)
    assert graph(asking)["actions"] == [
        {"name": "/count", "type": FIBONACCI, "node": "/server", "over_topics": False}
    ]


def action_over_topics(asking: Asking, goal_type: str | None = f"{ACTION}ActionGoal") -> Client:
    server = asking.joins("/server")
    server.says("subscribe", "/fibonacci/goal", type=goal_type)
    server.says("subscribe", "/fibonacci/cancel", type="actionlib_msgs/GoalID")
    server.says("advertise", "/fibonacci/status", type="actionlib_msgs/GoalStatusArray")
    server.says("advertise", "/fibonacci/feedback", type=f"{ACTION}ActionFeedback")
    server.says("advertise", "/fibonacci/result", type=f"{ACTION}ActionResult")
    return server


def test_an_action_over_topics(asking: Asking) -> None:
    server = action_over_topics(asking)
    asking.joins("/client").says("subscribe", "/fibonacci/result", type=f"{ACTION}ActionResult")
    assert graph(asking)["actions"] == [
        {"name": "/fibonacci", "type": ACTION, "node": "/server", "over_topics": True}
    ]
    server.says("unsubscribe", "/fibonacci/cancel")
    assert graph(asking)["actions"] == []


@pytest.mark.parametrize("goal_type", [None, "std_msgs/String"])
def test_an_action_over_topics_may_be_of_no_known_type(
    asking: Asking, goal_type: str | None
) -> None:
    action_over_topics(asking, goal_type)
    assert graph(asking)["actions"][0]["type"] == ""


def test_a_result_names_the_server_as_well_as_a_status(asking: Asking) -> None:
    server = action_over_topics(asking)
    asking.joins("/client").says("subscribe", "/fibonacci/status")
    server.says("unadvertise", "/fibonacci/status")
    assert graph(asking)["actions"][0]["node"] == "/server"
    asking.joins("/client").says("subscribe", "/fibonacci/result")
    server.says("unadvertise", "/fibonacci/result")
    assert graph(asking)["actions"] == []


def test_everything_is_in_the_order_of_its_name(asking: Asking) -> None:
    for node in ("/c", "/a", "/b"):
        client = asking.joins(node)
        client.says("advertise", f"{node}/topic", type=INT32)
        client.says("advertise_service", service=f"{node}/add", type=ADD)
        client.says("advertise_action", action=f"{node}/count", type=FIBONACCI)
    told = graph(asking)
    for what in ("nodes", "topics", "services", "actions"):
        found = [each["name"] for each in told[what]]
        assert found == sorted(found)
        assert len(found) >= 3


def test_the_answer_is_made_anew_only_when_the_graph_has_changed(asking: Asking) -> None:
    first = graph(asking)
    assert graph(asking) == first
    asking.connects("/talker")
    second = graph(asking)
    assert second["revision"] > first["revision"]
    assert len(second["nodes"]) == len(first["nodes"]) + 1
