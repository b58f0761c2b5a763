"""rosapi's services that list topics, services, nodes and actions."""

from __future__ import annotations

import logging
from typing import Any

import pytest

from fibws.hub.rosapi import introspection
from fibws.interfaces import Interfaces

from ..fakes import INT32, STRING, Client
from .rosapi_client import RosapiClient

OWN_TOPICS = {
    "/client_count": "std_msgs/Int32",
    "/connected_clients": "rosbridge_msgs/ConnectedClients",
    "/rosout": "rosgraph_msgs/Log",
    "/rosout_agg": "rosgraph_msgs/Log",
}
ADD = "rospy_tutorials/AddTwoInts"


@pytest.fixture
def rosapi() -> RosapiClient:
    return RosapiClient()


def talker(rosapi: RosapiClient, node: str = "/talker", **topics: str) -> Client:
    client = rosapi.add_client(node)
    for topic, type_ in topics.items():
        client.send("advertise", f"/{topic}", type=type_)
    return client


def adder(rosapi: RosapiClient, node: str = "/adder", service: str = "/add") -> Client:
    client = rosapi.add_client(node)
    client.send("advertise_service", service=service, type=ADD)
    return client


# Topics.


def test_topics_lists_published_and_subscribed_topics_with_their_types(
    rosapi: RosapiClient,
) -> None:
    talker(rosapi, fib=INT32)
    rosapi.add_client("/listener").send("subscribe", "/awaited")
    topics = rosapi.call("/rosapi/topics")
    assert dict(zip(topics["topics"], topics["types"], strict=True)) == {
        **OWN_TOPICS,
        "/fib": INT32,
        "/awaited": "",
    }
    assert topics["topics"] == sorted(topics["topics"])


def test_topics_changes_with_the_graph(rosapi: RosapiClient) -> None:
    assert rosapi.call("/rosapi/topics")["topics"] == [*OWN_TOPICS]
    client = talker(rosapi, fib=INT32)
    assert "/fib" in rosapi.call("/rosapi/topics")["topics"]
    client.send("unadvertise", "/fib")
    assert rosapi.call("/rosapi/topics")["topics"] == [*OWN_TOPICS]


def test_topics_for_type_lists_the_topics_of_a_type(rosapi: RosapiClient) -> None:
    talker(rosapi, b=STRING, a=STRING, fib=INT32)
    rosapi.add_client("/listener").send("subscribe", "/awaited")
    for spelling in (STRING, "std_msgs/msg/String"):
        found = rosapi.call("/rosapi/topics_for_type", type=spelling)
        assert found == {"topics": ["/a", "/b"]}
    for unknown in ("std_msgs/Bool", "String", ""):
        assert rosapi.call("/rosapi/topics_for_type", type=unknown) == {"topics": []}


@pytest.mark.parametrize("spelling", ["/fib", "fib"])
def test_topic_type_returns_the_type(rosapi: RosapiClient, spelling: str) -> None:
    talker(rosapi, fib=INT32)
    assert rosapi.call("/rosapi/topic_type", topic=spelling) == {"type": INT32}


@pytest.mark.parametrize("name", ["/awaited", "/nothing", "", "not a name"])
def test_topic_type_is_empty_for_an_unknown_topic_or_type(rosapi: RosapiClient, name: str) -> None:
    rosapi.add_client("/listener").send("subscribe", "/awaited")
    assert rosapi.call("/rosapi/topic_type", topic=name) == {"type": ""}


def test_private_names_belong_to_the_caller(rosapi: RosapiClient) -> None:
    rosapi.client.send("advertise", "~mine", type=INT32)
    assert rosapi.call("/rosapi/topic_type", topic="~mine") == {"type": INT32}
    assert rosapi.call("/rosapi/topic_type", topic="/caller/mine") == {"type": INT32}


def test_publishers_lists_nodes_in_order(rosapi: RosapiClient) -> None:
    talker(rosapi, "/b", fib=INT32)
    talker(rosapi, "/a", fib=INT32)
    assert rosapi.call("/rosapi/publishers", topic="/fib") == {"publishers": ["/a", "/b"]}
    assert rosapi.call("/rosapi/publishers", topic="/nothing") == {"publishers": []}
    assert "/rosapi" in rosapi.call("/rosapi/publishers", topic="/rosout")["publishers"]


def test_subscribers_lists_each_node_once(rosapi: RosapiClient) -> None:
    for node in ("/b", "/a"):
        client = rosapi.add_client(node)
        client.send("subscribe", "/fib")
        client.send("subscribe", "fib")
    assert rosapi.call("/rosapi/subscribers", topic="fib") == {"subscribers": ["/a", "/b"]}
    assert rosapi.call("/rosapi/subscribers", topic="/nothing") == {"subscribers": []}
    assert rosapi.call("/rosapi/subscribers", topic="/rosout") == {"subscribers": ["/rosout"]}


# Topics with the texts of their types.


def texts(rosapi: RosapiClient) -> dict[str, str]:
    found = rosapi.call("/rosapi/topics_and_raw_types")
    plain = rosapi.call("/rosapi/topics")
    assert (found["topics"], found["types"]) == (plain["topics"], plain["types"])
    return dict(zip(found["topics"], found["typedefs_full_text"], strict=True))


def test_topics_and_raw_types_has_the_full_text_of_each_type(rosapi: RosapiClient) -> None:
    talker(rosapi, pose="geometry_msgs/PoseStamped")
    rosapi.add_client("/listener").send("subscribe", "/awaited")
    found = texts(rosapi)
    assert found["/pose"] == Interfaces().full_text("geometry_msgs/PoseStamped")
    assert f"\n{'=' * 80}\nMSG: geometry_msgs/Pose\n" in found["/pose"]
    assert "string[] topics" in found["/rosout"]
    assert found["/awaited"] == ""


def test_unknown_type_has_no_text_until_a_client_brings_its_definition(
    rosapi: RosapiClient,
) -> None:
    talker(rosapi, thing="nowhere_msgs/Thing")
    assert texts(rosapi)["/thing"] == ""
    client = rosapi.add_client("/late")
    client.send("advertise", "/other", type="nowhere_msgs/Thing", definition="int32 x")
    assert texts(rosapi)["/thing"] == "int32 x"


def test_texts_beyond_the_limit_are_left_out(
    rosapi: RosapiClient, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(introspection, "MOST_TEXT", 1000)
    talker(rosapi, **{f"y{number}": STRING for number in range(100)})
    found = texts(rosapi)
    assert found["/client_count"] == Interfaces().full_text(INT32)
    assert found["/y0"] == Interfaces().full_text(STRING)
    assert found["/y99"] == ""
    assert "/rosapi/topics_and_raw_types" in caplog.text
    assert "1000 bytes" in caplog.text


def test_texts_beyond_the_limit_are_not_made(
    rosapi: RosapiClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(introspection, "MOST_TEXT", 1)
    read: list[str] = []

    def much(name: str) -> str:
        read.append(name)
        return "much"

    monkeypatch.setattr(rosapi.graph.definitions.base, "full_text", much)
    assert set(texts(rosapi).values()) == {""}
    assert read == [OWN_TOPICS["/client_count"]]


def test_types_that_clients_bring_are_described_while_they_are_used(rosapi: RosapiClient) -> None:
    for line in ("int8 x", "int16 x"):
        client = rosapi.add_client(None)
        client.send("advertise", "/a", type="my_msgs/Thing", definition=line)
        ask = f"{line}\n---\n{line}"
        client.send("advertise_service", service="/b", type="my_msgs/Ask", definition=ask)
        assert texts(rosapi)["/a"] == line
        for service, type_ in (
            ("message_details", "my_msgs/Thing"),
            ("service_request_details", "my_msgs/Ask"),
            ("service_response_details", "my_msgs/Ask"),
        ):
            [details] = rosapi.call(f"/rosapi/{service}", type=type_)["typedefs"]
            assert details["fieldtypes"] == [line.removesuffix(" x")]
        client.disconnect()
        for service in ("message_details", "service_request_details", "service_response_details"):
            assert "my_msgs" in rosapi.refusal(f"/rosapi/{service}", type="my_msgs/Thing")


def test_warning_about_texts_left_out_does_not_fill_the_log(
    rosapi: RosapiClient, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(introspection, "MOST_TEXT", 1)
    for number in range(9):
        talker(rosapi, **{f"y{number}": STRING})
        texts(rosapi)
    assert [record.levelno for record in caplog.records] == [logging.WARNING]


def test_response_is_made_once_for_each_revision(
    rosapi: RosapiClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[str] = []
    full_text = rosapi.graph.definitions.base.full_text

    def counted(name: str) -> str:
        read.append(name)
        return full_text(name)

    monkeypatch.setattr(rosapi.graph.definitions.base, "full_text", counted)
    names = ("topics", "topics_and_raw_types", "services", "nodes", "action_servers")
    servers = [rosapi.graph.services[f"/rosapi/{name}"].server for name in names]
    first = [response(server) for server in servers]
    again = [response(server) for server in servers]
    assert all(one is other for one, other in zip(first, again, strict=True))
    talker(rosapi, fib=INT32)
    later = [response(server) for server in servers]
    assert all(one is not other for one, other in zip(first, later, strict=True))
    assert sorted(read) == sorted({*OWN_TOPICS.values()})


def response(server: Any) -> Any:
    """The response itself, not a copy of its bytes."""
    return server._function({}, "/caller")


# Services.


def test_services_lists_all_services(rosapi: RosapiClient) -> None:
    adder(rosapi)
    services = rosapi.call("/rosapi/services")["services"]
    assert services == sorted(rosapi.graph.services)
    assert {"/add", "/rosapi/topics", "/rosout/get_loggers"} < set(services)


def test_services_and_servers_of_a_type_are_listed(rosapi: RosapiClient) -> None:
    adder(rosapi, "/b", "/plus")
    client = adder(rosapi, "/a", "/add")
    client.send("advertise_service", service="/add2", type=ADD)
    for spelling in (ADD, "rospy_tutorials/srv/AddTwoInts"):
        found = rosapi.call("/rosapi/services_for_type", type=spelling)
        assert found == {"services": ["/add", "/add2", "/plus"]}
        providers = rosapi.call("/rosapi/service_providers", service=spelling)
        assert providers == {"providers": ["/a", "/b"]}
    for unknown in ("std_srvs/Empty", "/add", ""):
        assert rosapi.call("/rosapi/services_for_type", type=unknown) == {"services": []}
        assert rosapi.call("/rosapi/service_providers", service=unknown) == {"providers": []}


@pytest.mark.parametrize("spelling", ["/add", "add"])
def test_type_node_and_host_of_a_service_are_returned(rosapi: RosapiClient, spelling: str) -> None:
    adder(rosapi)
    assert rosapi.call("/rosapi/service_type", service=spelling) == {"type": ADD}
    assert rosapi.call("/rosapi/service_node", service=spelling) == {"node": "/adder"}
    assert rosapi.call("/rosapi/service_host", service=spelling) == {"host": "127.0.0.1"}


@pytest.mark.parametrize("name", ["/nothing", "", "not a name"])
def test_type_node_and_host_of_an_unknown_service_are_empty(
    rosapi: RosapiClient, name: str
) -> None:
    assert rosapi.call("/rosapi/service_type", service=name) == {"type": ""}
    assert rosapi.call("/rosapi/service_node", service=name) == {"node": ""}
    assert rosapi.call("/rosapi/service_host", service=name) == {"host": ""}


def test_hubs_own_services_belong_to_its_nodes(rosapi: RosapiClient) -> None:
    found = rosapi.call("/rosapi/service_node", service="/rosapi/topics")
    assert found == {"node": "/rosapi"}
    found = rosapi.call("/rosapi/service_node", service="/rosout/get_loggers")
    assert found == {"node": "/rosout"}


# Nodes.


def test_nodes_lists_clients_and_the_hubs_own_nodes(rosapi: RosapiClient) -> None:
    own = ["/rosapi", "/rosbridge_websocket", "/rosout"]
    assert rosapi.call("/rosapi/nodes") == {"nodes": ["/caller", *own]}
    client = talker(rosapi)
    assert rosapi.call("/rosapi/nodes") == {"nodes": ["/caller", *own, "/talker"]}
    client.disconnect()
    assert rosapi.call("/rosapi/nodes") == {"nodes": ["/caller", *own]}


@pytest.mark.parametrize("spelling", ["/busy", "busy"])
def test_node_details_are_sorted(rosapi: RosapiClient, spelling: str) -> None:
    client = talker(rosapi, "/busy", d=INT32, c=INT32)
    for topic in ("/b", "b", "/a"):
        client.send("subscribe", topic)
    for service in ("/f", "/e"):
        client.send("advertise_service", service=service, type=ADD)
    assert rosapi.call("/rosapi/node_details", node=spelling) == {
        "subscribing": ["/a", "/b"],
        "publishing": ["/c", "/d"],
        "services": ["/e", "/f"],
    }


@pytest.mark.parametrize("name", ["/nobody", "", "not a name"])
def test_node_details_of_an_unknown_node_are_empty(rosapi: RosapiClient, name: str) -> None:
    assert rosapi.call("/rosapi/node_details", node=name) == {
        "subscribing": [],
        "publishing": [],
        "services": [],
    }


# Actions.


def test_namespace_with_all_five_topics_is_an_action_server(rosapi: RosapiClient) -> None:
    for namespace in ("/robot/move", "/fibonacci"):
        topics = {f"{namespace[1:]}/{each}": STRING for each in introspection.ACTION_TOPICS}
        talker(rosapi, f"{namespace}_server", **topics)
    found = rosapi.call("/rosapi/action_servers")
    assert found == {"action_servers": ["/fibonacci", "/robot/move"]}


@pytest.mark.parametrize("missing", sorted(introspection.ACTION_TOPICS))
def test_namespace_without_one_of_the_topics_is_not_an_action_server(
    rosapi: RosapiClient, missing: str
) -> None:
    topics = {f"fib/{each}": STRING for each in introspection.ACTION_TOPICS - {missing}}
    talker(rosapi, **topics, **{f"other/{missing}": STRING})
    assert rosapi.call("/rosapi/action_servers") == {"action_servers": []}


def test_topics_without_a_namespace_are_not_an_action_server(rosapi: RosapiClient) -> None:
    talker(rosapi, **dict.fromkeys(introspection.ACTION_TOPICS, STRING))
    assert rosapi.call("/rosapi/action_servers") == {"action_servers": []}


def test_actions_of_ros_2_are_listed_too(rosapi: RosapiClient) -> None:
    client = rosapi.add_client("/server")
    client.send("advertise_action", action="/count", type="example_interfaces/Fibonacci")
    topics = {f"fib/{each}": STRING for each in introspection.ACTION_TOPICS}
    talker(rosapi, **topics)
    assert rosapi.call("/rosapi/action_servers") == {"action_servers": ["/count", "/fib"]}
    client.disconnect()
    assert rosapi.call("/rosapi/action_servers") == {"action_servers": ["/fib"]}


FIBONACCI_TYPE = "example_interfaces/action/Fibonacci"


def test_actions_of_both_kinds_have_a_type(rosapi: RosapiClient) -> None:
    client = rosapi.add_client("/server")
    client.send("advertise_action", action="/count", type="example_interfaces/Fibonacci")
    topics = {f"fib/{each}": STRING for each in introspection.ACTION_TOPICS}
    topics["fib/goal"] = "actionlib_tutorials/FibonacciActionGoal"
    talker(rosapi, **topics)
    odd = {f"odd/{each}": STRING for each in introspection.ACTION_TOPICS}
    talker(rosapi, "/other", **odd)

    def type_of(action: str) -> str:
        type_: str = rosapi.call("/rosapi/action_type", action=action)["type"]
        return type_

    assert type_of("/count") == type_of("count") == FIBONACCI_TYPE
    assert type_of("/fib") == "actionlib_tutorials/action/Fibonacci"
    assert [type_of(name) for name in ("/odd", "/none", "", "/fib/goal")] == [""] * 4


def test_interfaces_lists_types_of_all_kinds_and_of_clients(rosapi: RosapiClient) -> None:
    before = rosapi.call("/rosapi/interfaces")["interfaces"]
    assert before == sorted(before)
    assert {FIBONACCI_TYPE, "std_msgs/msg/String", "rosapi/srv/Interfaces"} <= {*before}
    client = rosapi.add_client("/server")
    client.send(
        "advertise_action", action="/a", type="my_msgs/Clean", definition="int8 a\n---\n---\n"
    )
    after = rosapi.call("/rosapi/interfaces")["interfaces"]
    assert {*before} < {*after}
    assert "my_msgs/action/Clean" in after
    client.disconnect()
    assert rosapi.call("/rosapi/interfaces")["interfaces"] == before


def test_parts_of_an_action_are_described(rosapi: RosapiClient) -> None:
    client = rosapi.add_client("/server")
    text = "int8 a\n---\nint8 b\n---\nint8 c\n"
    client.send("advertise_action", action="/a", type="my_msgs/Clean", definition=text)

    def names(part: str, type_: str) -> list[str]:
        typedef, *_ = rosapi.call(f"/rosapi/action_{part}_details", type=type_)["typedefs"]
        found: list[str] = typedef["fieldnames"]
        return found

    for type_ in ("my_msgs/Clean", "my_msgs/action/Clean"):
        parts = [names(part, type_) for part in ("goal", "result", "feedback")]
        assert parts == [["a"], ["b"], ["c"]]
    assert names("goal", FIBONACCI_TYPE) == ["order"]
