"""/rosapi/graph: the whole graph in one response."""

from __future__ import annotations

from typing import Any

import pytest

from ..fakes import ADD, FIBONACCI, INT32, NANOSECONDS, Client
from .rosapi_client import RosapiClient

SECS, NSECS = divmod(NANOSECONDS, 10**9)
ACTION = "actionlib_tutorials/Fibonacci"
UNKNOWN = "my_msgs/Number"


@pytest.fixture
def rosapi() -> RosapiClient:
    return RosapiClient()


def graph(rosapi: RosapiClient) -> dict[str, Any]:
    found = rosapi.call("/rosapi/graph")
    assert found["revision"] == rosapi.graph.revision
    return found


def named(found: dict[str, Any], kind: str, name: str) -> dict[str, Any]:
    """The one node, topic, service or action of that name."""
    (entry,) = [each for each in found[kind] if each["name"] == name]
    assert isinstance(entry, dict)
    return entry


def topic(rosapi: RosapiClient, name: str) -> dict[str, Any]:
    return named(graph(rosapi), "topics", name)


def test_nodes_have_their_addresses_and_connection_times(rosapi: RosapiClient) -> None:
    rosapi.connect("/talker")
    assert named(graph(rosapi), "nodes", "/talker") == {
        "name": "/talker",
        "address": "10.0.0.1:50001",
        "since": {"secs": SECS, "nsecs": NSECS},
        "own": False,
        "api": "",
        "fault": "",
        "hub": "",
    }


def test_hubs_own_nodes_are_marked_and_have_no_address(rosapi: RosapiClient) -> None:
    rosapi.connect("/talker")
    own = [node for node in graph(rosapi)["nodes"] if node["own"]]
    assert [node["name"] for node in own] == ["/rosapi", "/rosbridge_websocket", "/rosout"]
    assert {node["address"] for node in own} == {""}
    assert {node["since"]["secs"] for node in own} == {SECS}


def test_replaced_node_has_the_address_of_the_newer_one(rosapi: RosapiClient) -> None:
    rosapi.connect("/talker")
    rosapi.connect("/talker")
    assert named(graph(rosapi), "nodes", "/talker")["address"] == "10.0.0.1:50002"


def test_topic_has_its_type_and_its_publishers(rosapi: RosapiClient) -> None:
    rosapi.add_client("/b").send("advertise", "/fib", type=INT32)
    rosapi.add_client("/a").send("advertise", "/fib", type=INT32, latch=True)
    assert topic(rosapi, "/fib") == {
        "name": "/fib",
        "type": INT32,
        "checked": True,
        "publishers": [{"node": "/a", "latch": True}, {"node": "/b", "latch": False}],
        "subscriptions": [],
        "conflicts": [],
    }


def test_topic_without_a_type_has_an_empty_one(rosapi: RosapiClient) -> None:
    rosapi.add_client("/listener").send("subscribe", "/awaited")
    awaited = topic(rosapi, "/awaited")
    assert (awaited["type"], awaited["checked"], awaited["publishers"]) == ("", False, [])


def test_unknown_type_is_not_checked_until_a_client_defines_it(rosapi: RosapiClient) -> None:
    talker = rosapi.add_client("/talker")
    talker.send("advertise", "/n", type=UNKNOWN)
    assert (topic(rosapi, "/n")["type"], topic(rosapi, "/n")["checked"]) == (UNKNOWN, False)
    talker.send("advertise", "/n", type=UNKNOWN, definition="int32 data")
    assert topic(rosapi, "/n")["checked"]


@pytest.mark.parametrize(
    ("options", "expected"),
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
def test_subscription_is_listed_with_the_options_in_effect(
    rosapi: RosapiClient, options: dict[str, Any], expected: tuple[int, int, str]
) -> None:
    rosapi.add_client("/listener").send("subscribe", "/fib", type=INT32, **options)
    queue_length, throttle_rate, compression = expected
    assert topic(rosapi, "/fib")["subscriptions"] == [
        {
            "node": "/listener",
            "queue_length": queue_length,
            "throttle_rate": throttle_rate,
            "compression": compression,
        }
    ]


def test_renewed_subscription_is_listed_with_its_new_options(rosapi: RosapiClient) -> None:
    listener = rosapi.add_client("/listener")
    listener.send("subscribe", "/fib", type=INT32)
    assert topic(rosapi, "/fib")["subscriptions"][0]["throttle_rate"] == 0
    listener.send("unsubscribe", "/fib")
    listener.send("subscribe", "/fib", type=INT32, throttle_rate=50)
    assert topic(rosapi, "/fib")["subscriptions"][0]["throttle_rate"] == 50


def test_subscriptions_of_the_hub_itself_are_listed(rosapi: RosapiClient) -> None:
    rosapi.add_client("/a").send("subscribe", "/rosout")
    subscriptions = topic(rosapi, "/rosout")["subscriptions"]
    assert [each["node"] for each in subscriptions] == ["/a", "/rosout"]


def test_services_have_their_types_and_nodes(rosapi: RosapiClient) -> None:
    rosapi.add_client("/adder").send("advertise_service", service="/add", type=ADD)
    add = named(graph(rosapi), "services", "/add")
    assert add == {"name": "/add", "type": ADD, "node": "/adder"}
    assert named(graph(rosapi), "services", "/rosapi/graph") == {
        "name": "/rosapi/graph",
        "type": "fibws_msgs/GetGraph",
        "node": "/rosapi",
    }


def test_action_of_ros_2_is_listed(rosapi: RosapiClient) -> None:
    rosapi.add_client("/server").send("advertise_action", action="/count", type=FIBONACCI)
    assert graph(rosapi)["actions"] == [
        {"name": "/count", "type": FIBONACCI, "node": "/server", "over_topics": False}
    ]


def action_over_topics(
    rosapi: RosapiClient, goal_type: str | None = f"{ACTION}ActionGoal"
) -> Client:
    server = rosapi.add_client("/server")
    server.send("subscribe", "/fibonacci/goal", type=goal_type)
    server.send("subscribe", "/fibonacci/cancel", type="actionlib_msgs/GoalID")
    server.send("advertise", "/fibonacci/status", type="actionlib_msgs/GoalStatusArray")
    server.send("advertise", "/fibonacci/feedback", type=f"{ACTION}ActionFeedback")
    server.send("advertise", "/fibonacci/result", type=f"{ACTION}ActionResult")
    return server


def test_action_over_topics_is_listed(rosapi: RosapiClient) -> None:
    server = action_over_topics(rosapi)
    rosapi.add_client("/client").send(
        "subscribe", "/fibonacci/result", type=f"{ACTION}ActionResult"
    )
    assert graph(rosapi)["actions"] == [
        {"name": "/fibonacci", "type": ACTION, "node": "/server", "over_topics": True}
    ]
    server.send("unsubscribe", "/fibonacci/cancel")
    assert graph(rosapi)["actions"] == []


@pytest.mark.parametrize("goal_type", [None, "std_msgs/String"])
def test_action_over_topics_may_have_an_unknown_type(
    rosapi: RosapiClient, goal_type: str | None
) -> None:
    action_over_topics(rosapi, goal_type)
    assert graph(rosapi)["actions"][0]["type"] == ""


def test_server_of_an_action_over_topics_is_known_by_its_status_or_its_result(
    rosapi: RosapiClient,
) -> None:
    server = action_over_topics(rosapi)
    rosapi.add_client("/client").send("subscribe", "/fibonacci/status")
    server.send("unadvertise", "/fibonacci/status")
    assert graph(rosapi)["actions"][0]["node"] == "/server"
    rosapi.add_client("/client").send("subscribe", "/fibonacci/result")
    server.send("unadvertise", "/fibonacci/result")
    assert graph(rosapi)["actions"] == []


def test_everything_is_sorted_by_name(rosapi: RosapiClient) -> None:
    for node in ("/c", "/a", "/b"):
        client = rosapi.add_client(node)
        client.send("advertise", f"{node}/topic", type=INT32)
        client.send("advertise_service", service=f"{node}/add", type=ADD)
        client.send("advertise_action", action=f"{node}/count", type=FIBONACCI)
    found = graph(rosapi)
    for kind in ("nodes", "topics", "services", "actions"):
        names = [each["name"] for each in found[kind]]
        assert names == sorted(names)
        assert len(names) >= 3


def test_response_changes_with_the_graph_only(rosapi: RosapiClient) -> None:
    first = graph(rosapi)
    assert graph(rosapi) == first
    rosapi.connect("/talker")
    second = graph(rosapi)
    assert second["revision"] > first["revision"]
    assert len(second["nodes"]) == len(first["nodes"]) + 1
