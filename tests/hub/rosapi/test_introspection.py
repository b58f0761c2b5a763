"""What there is in the graph, told by rosapi."""

from __future__ import annotations

import logging
from typing import Any

import pytest

from fibws.hub.rosapi import introspection
from fibws.interfaces import Interfaces

from ..fakes import INT32, STRING, Client
from .asking import Asking

OWN_TOPICS = {
    "/client_count": "std_msgs/Int32",
    "/connected_clients": "rosbridge_msgs/ConnectedClients",
    "/rosout": "rosgraph_msgs/Log",
    "/rosout_agg": "rosgraph_msgs/Log",
}
ADD = "rospy_tutorials/AddTwoInts"


@pytest.fixture
def asking() -> Asking:
    return Asking()


def talker(asking: Asking, node: str = "/talker", **topics: str) -> Client:
    client = asking.joins(node)
    for topic, type_ in topics.items():
        client.says("advertise", f"/{topic}", type=type_)
    return client


def adder(asking: Asking, node: str = "/adder", service: str = "/add") -> Client:
    client = asking.joins(node)
    client.says("advertise_service", service=service, type=ADD)
    return client


# Topics.


def test_topics_are_those_published_or_subscribed_to_with_their_types(asking: Asking) -> None:
    talker(asking, fib=INT32)
    asking.joins("/listener").says("subscribe", "/awaited")
    topics = asking.gets("/rosapi/topics")
    assert dict(zip(topics["topics"], topics["types"], strict=True)) == {
        **OWN_TOPICS,
        "/fib": INT32,
        "/awaited": "",
    }
    assert topics["topics"] == sorted(topics["topics"])


def test_topics_change_with_the_graph(asking: Asking) -> None:
    assert asking.gets("/rosapi/topics")["topics"] == [*OWN_TOPICS]
    client = talker(asking, fib=INT32)
    assert "/fib" in asking.gets("/rosapi/topics")["topics"]
    client.says("unadvertise", "/fib")
    assert asking.gets("/rosapi/topics")["topics"] == [*OWN_TOPICS]


def test_topics_of_a_type(asking: Asking) -> None:
    talker(asking, b=STRING, a=STRING, fib=INT32)
    asking.joins("/listener").says("subscribe", "/awaited")
    for spelling in (STRING, "std_msgs/msg/String"):
        found = asking.gets("/rosapi/topics_for_type", type=spelling)
        assert found == {"topics": ["/a", "/b"]}
    for nothing in ("std_msgs/Bool", "String", ""):
        assert asking.gets("/rosapi/topics_for_type", type=nothing) == {"topics": []}


@pytest.mark.parametrize("spelling", ["/fib", "fib"])
def test_the_type_of_a_topic(asking: Asking, spelling: str) -> None:
    talker(asking, fib=INT32)
    assert asking.gets("/rosapi/topic_type", topic=spelling) == {"type": INT32}


@pytest.mark.parametrize("name", ["/awaited", "/nothing", "", "no name"])
def test_what_has_no_type_has_an_empty_one(asking: Asking, name: str) -> None:
    asking.joins("/listener").says("subscribe", "/awaited")
    assert asking.gets("/rosapi/topic_type", topic=name) == {"type": ""}


def test_private_names_are_those_of_the_caller(asking: Asking) -> None:
    asking.client.says("advertise", "~mine", type=INT32)
    assert asking.gets("/rosapi/topic_type", topic="~mine") == {"type": INT32}
    assert asking.gets("/rosapi/topic_type", topic="/asker/mine") == {"type": INT32}


def test_the_publishers_of_a_topic(asking: Asking) -> None:
    talker(asking, "/b", fib=INT32)
    talker(asking, "/a", fib=INT32)
    assert asking.gets("/rosapi/publishers", topic="/fib") == {"publishers": ["/a", "/b"]}
    assert asking.gets("/rosapi/publishers", topic="/nothing") == {"publishers": []}
    assert "/rosapi" in asking.gets("/rosapi/publishers", topic="/rosout")["publishers"]


def test_the_subscribers_of_a_topic_each_once(asking: Asking) -> None:
    for node in ("/b", "/a"):
        client = asking.joins(node)
        client.says("subscribe", "/fib")
        client.says("subscribe", "fib")
    assert asking.gets("/rosapi/subscribers", topic="fib") == {"subscribers": ["/a", "/b"]}
    assert asking.gets("/rosapi/subscribers", topic="/nothing") == {"subscribers": []}
    assert asking.gets("/rosapi/subscribers", topic="/rosout") == {"subscribers": ["/rosout"]}


# Topics with the texts of their types.


def texts(asking: Asking) -> dict[str, str]:
    told = asking.gets("/rosapi/topics_and_raw_types")
    plain = asking.gets("/rosapi/topics")
    assert (told["topics"], told["types"]) == (plain["topics"], plain["types"])
    return dict(zip(told["topics"], told["typedefs_full_text"], strict=True))


def test_topics_come_with_the_full_text_of_their_types(asking: Asking) -> None:
    talker(asking, pose="geometry_msgs/PoseStamped")
    asking.joins("/listener").says("subscribe", "/awaited")
    told = texts(asking)
    assert told["/pose"] == Interfaces().full_text("geometry_msgs/PoseStamped")
    assert f"\n{'=' * 80}\nMSG: geometry_msgs/Pose\n" in told["/pose"]
    assert "string[] topics" in told["/rosout"]
    assert told["/awaited"] == ""


def test_a_type_that_nobody_knows_has_no_text_until_somebody_brings_it(asking: Asking) -> None:
    talker(asking, thing="nowhere_msgs/Thing")
    assert texts(asking)["/thing"] == ""
    client = asking.joins("/knower")
    client.says("advertise", "/other", type="nowhere_msgs/Thing", definition="int32 x")
    assert texts(asking)["/thing"] == "int32 x"


def test_more_text_than_there_is_room_for_is_left_out(
    asking: Asking, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(introspection, "MOST_TEXT", 1000)
    talker(asking, **{f"y{number}": STRING for number in range(100)})
    told = texts(asking)
    assert told["/client_count"] == Interfaces().full_text(INT32)
    assert told["/y0"] == Interfaces().full_text(STRING)
    assert told["/y99"] == ""
    assert "more text than rosapi will tell" in caplog.text


def test_no_text_is_made_that_there_is_no_room_for(
    asking: Asking, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(introspection, "MOST_TEXT", 1)
    read: list[str] = []

    def much(name: str) -> str:
        read.append(name)
        return "much"

    monkeypatch.setattr(asking.graph.interfaces, "full_text", much)
    assert set(texts(asking).values()) == {""}
    assert read == [OWN_TOPICS["/client_count"]]


def test_the_warning_about_too_much_text_does_not_fill_the_log(
    asking: Asking, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(introspection, "MOST_TEXT", 1)
    for number in range(9):
        talker(asking, **{f"y{number}": STRING})
        texts(asking)
    assert [record.levelno for record in caplog.records] == [logging.WARNING]


def test_an_answer_is_made_once_for_each_state_of_the_graph(
    asking: Asking, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[str] = []
    full_text = asking.graph.interfaces.full_text

    def counted(name: str) -> str:
        read.append(name)
        return full_text(name)

    monkeypatch.setattr(asking.graph.interfaces, "full_text", counted)
    names = ("topics", "topics_and_raw_types", "services", "nodes", "action_servers")
    functions = [asking.graph.services[f"/rosapi/{name}"].provider for name in names]
    first = [answer(function) for function in functions]
    again = [answer(function) for function in functions]
    assert all(one is other for one, other in zip(first, again, strict=True))
    talker(asking, fib=INT32)
    later = [answer(function) for function in functions]
    assert all(one is not other for one, other in zip(first, later, strict=True))
    assert sorted(read) == sorted({*OWN_TOPICS.values()})


def answer(provider: Any) -> Any:
    return provider._function({}, "/asker")


# Services.


def test_services_are_all_there_are(asking: Asking) -> None:
    adder(asking)
    services = asking.gets("/rosapi/services")["services"]
    assert services == sorted(asking.graph.services)
    assert {"/add", "/rosapi/topics", "/rosout/get_loggers"} < set(services)


def test_services_of_a_type_and_their_providers(asking: Asking) -> None:
    adder(asking, "/b", "/plus")
    client = adder(asking, "/a", "/add")
    client.says("advertise_service", service="/add2", type=ADD)
    for spelling in (ADD, "rospy_tutorials/srv/AddTwoInts"):
        found = asking.gets("/rosapi/services_for_type", type=spelling)
        assert found == {"services": ["/add", "/add2", "/plus"]}
        providers = asking.gets("/rosapi/service_providers", service=spelling)
        assert providers == {"providers": ["/a", "/b"]}
    for nothing in ("std_srvs/Empty", "/add", ""):
        assert asking.gets("/rosapi/services_for_type", type=nothing) == {"services": []}
        assert asking.gets("/rosapi/service_providers", service=nothing) == {"providers": []}


@pytest.mark.parametrize("spelling", ["/add", "add"])
def test_the_type_node_and_host_of_a_service(asking: Asking, spelling: str) -> None:
    adder(asking)
    assert asking.gets("/rosapi/service_type", service=spelling) == {"type": ADD}
    assert asking.gets("/rosapi/service_node", service=spelling) == {"node": "/adder"}
    assert asking.gets("/rosapi/service_host", service=spelling) == {"host": "127.0.0.1"}


@pytest.mark.parametrize("name", ["/nothing", "", "no name"])
def test_a_service_that_is_not_there_has_none_of_them(asking: Asking, name: str) -> None:
    assert asking.gets("/rosapi/service_type", service=name) == {"type": ""}
    assert asking.gets("/rosapi/service_node", service=name) == {"node": ""}
    assert asking.gets("/rosapi/service_host", service=name) == {"host": ""}


def test_the_hub_s_own_services_are_its_nodes(asking: Asking) -> None:
    found = asking.gets("/rosapi/service_node", service="/rosapi/topics")
    assert found == {"node": "/rosapi"}
    found = asking.gets("/rosapi/service_node", service="/rosout/get_loggers")
    assert found == {"node": "/rosout"}


# Nodes.


def test_nodes_are_the_clients_and_the_hub_s_own(asking: Asking) -> None:
    own = ["/rosapi", "/rosbridge_websocket", "/rosout"]
    assert asking.gets("/rosapi/nodes") == {"nodes": ["/asker", *own]}
    client = talker(asking)
    assert asking.gets("/rosapi/nodes") == {"nodes": ["/asker", *own, "/talker"]}
    client.leaves()
    assert asking.gets("/rosapi/nodes") == {"nodes": ["/asker", *own]}


@pytest.mark.parametrize("spelling", ["/busy", "busy"])
def test_the_details_of_a_node_are_sorted(asking: Asking, spelling: str) -> None:
    client = talker(asking, "/busy", d=INT32, c=INT32)
    for topic in ("/b", "b", "/a"):
        client.says("subscribe", topic)
    for service in ("/f", "/e"):
        client.says("advertise_service", service=service, type=ADD)
    assert asking.gets("/rosapi/node_details", node=spelling) == {
        "subscribing": ["/a", "/b"],
        "publishing": ["/c", "/d"],
        "services": ["/e", "/f"],
    }


@pytest.mark.parametrize("name", ["/nobody", "", "no name"])
def test_a_node_that_is_not_there_has_nothing(asking: Asking, name: str) -> None:
    assert asking.gets("/rosapi/node_details", node=name) == {
        "subscribing": [],
        "publishing": [],
        "services": [],
    }


# Actions.


def test_action_servers_are_namespaces_with_all_five_topics(asking: Asking) -> None:
    for namespace in ("/robot/move", "/fibonacci"):
        topics = {f"{namespace[1:]}/{each}": STRING for each in introspection.ACTION_TOPICS}
        talker(asking, f"{namespace}_server", **topics)
    found = asking.gets("/rosapi/action_servers")
    assert found == {"action_servers": ["/fibonacci", "/robot/move"]}


@pytest.mark.parametrize("missing", sorted(introspection.ACTION_TOPICS))
def test_with_one_topic_missing_there_is_no_action_server(asking: Asking, missing: str) -> None:
    topics = {f"fib/{each}": STRING for each in introspection.ACTION_TOPICS - {missing}}
    talker(asking, **topics, **{f"other/{missing}": STRING})
    assert asking.gets("/rosapi/action_servers") == {"action_servers": []}


def test_topics_in_no_namespace_make_no_action_server(asking: Asking) -> None:
    talker(asking, **dict.fromkeys(introspection.ACTION_TOPICS, STRING))
    assert asking.gets("/rosapi/action_servers") == {"action_servers": []}


def test_actions_of_ros_2_are_action_servers_too(asking: Asking) -> None:
    client = asking.joins("/server")
    client.says("advertise_action", action="/count", type="example_interfaces/Fibonacci")
    topics = {f"fib/{each}": STRING for each in introspection.ACTION_TOPICS}
    talker(asking, **topics)
    assert asking.gets("/rosapi/action_servers") == {"action_servers": ["/count", "/fib"]}
    client.leaves()
    assert asking.gets("/rosapi/action_servers") == {"action_servers": ["/fib"]}
