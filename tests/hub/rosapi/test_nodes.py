"""The hub's own nodes are there from the start, as nodes among others."""

from __future__ import annotations

import pytest

from fibws.hub.rosapi.nodes import OwnNode

from ..fakes import INT32
from .asking import Asking

LOG = {"name": "/talker", "msg": "hello", "level": 2}


@pytest.fixture
def asking() -> Asking:
    return Asking()


def loggers(node: str) -> list[str]:
    return [f"{node}/get_loggers", f"{node}/set_logger_level"]


def test_they_publish_hear_and_provide(asking: Asking) -> None:
    rosout = asking.gets("/rosapi/node_details", node="/rosout")
    assert rosout == {
        "publishing": ["/rosout_agg"],
        "subscribing": ["/rosout"],
        "services": loggers("/rosout"),
    }
    rosbridge = asking.gets("/rosapi/node_details", node="/rosbridge_websocket")
    assert rosbridge == {
        "publishing": ["/client_count", "/connected_clients"],
        "subscribing": [],
        "services": loggers("/rosbridge_websocket"),
    }
    rosapi = asking.gets("/rosapi/node_details", node="/rosapi")
    assert (rosapi["publishing"], rosapi["subscribing"]) == (["/rosout"], [])
    assert set(rosapi["services"]) == {
        name for name in asking.graph.services if name.startswith("/rosapi/")
    }


def test_a_message_on_rosout_is_repeated(asking: Asking) -> None:
    talker, listener = asking.joins("/talker"), asking.joins("/listener")
    listener.says("subscribe", "/rosout")
    listener.says("subscribe", "/rosout_agg")
    talker.says("advertise", "/rosout", type="rosgraph_msgs/Log")
    for number in (1, 2):
        talker.says("publish", "/rosout", msg={**LOG, "line": number})
        heard = {each["topic"]: each["msg"] for each in listener.hears()}
        assert heard["/rosout"] == heard["/rosout_agg"]
        assert (heard["/rosout"]["msg"], heard["/rosout"]["line"]) == ("hello", number)


def test_nothing_is_repeated_to_nobody(asking: Asking, monkeypatch: pytest.MonkeyPatch) -> None:
    (aggregated,) = asking.graph.topics["/rosout_agg"].publishers.values()
    checked: list[object] = []
    monkeypatch.setattr(type(aggregated), "publish", lambda self, msg: checked.append(msg))
    asking.graph.topics["/rosout"].observers[0](dict(LOG))
    assert checked == []
    asking.joins("/listener").says("subscribe", "/rosout_agg")
    asking.graph.topics["/rosout"].observers[0](dict(LOG))
    assert checked == [LOG]


def test_their_topics_have_their_types_for_good(asking: Asking) -> None:
    talker = asking.joins("/talker")
    talker.says("advertise", "/client_count", type="std_msgs/String")
    (status,) = talker.hears_statuses()
    assert "already established with type std_msgs/Int32 (by /rosbridge_websocket)" in status


def test_their_services_are_not_to_be_taken_over(asking: Asking) -> None:
    thief = asking.joins("/thief")
    thief.says("advertise_service", service="/rosapi/topics", type="rosapi/Topics")
    assert thief.hears_statuses() != []
    assert "/rosout" in asking.gets("/rosapi/topics")["topics"]


def test_they_are_never_replaced() -> None:
    with pytest.raises(AssertionError, match="/rosapi is the hub's own"):
        OwnNode("/rosapi", [], [], []).replaced()


def test_in_the_end_nothing_is_left(asking: Asking) -> None:
    connections = [asking.connects() for _ in range(2)]
    asking.client.says("advertise", "/fib", type=INT32)
    asking.client.leaves()
    for connection in connections:
        connection.client.leaves()
    asking.own.close()
    graph = asking.graph
    assert (graph.nodes, graph.topics, graph.services) == ({}, {}, {})
    assert asking.hub.clock.timers == 0


def test_they_close_only_once(asking: Asking) -> None:
    asking.own.close()
    asking.own.close()


def test_what_clients_subscribe_to_outlives_them(asking: Asking) -> None:
    asking.client.says("subscribe", "/rosout")
    asking.own.close()
    assert list(asking.graph.topics) == ["/rosout"]
    assert asking.graph.topics["/rosout"].observers == []
