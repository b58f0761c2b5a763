"""The hub's own nodes: their topics, services and log."""

from __future__ import annotations

import pytest

from fibws.hub.errors import NotAllowed
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.types import CheckedType
from fibws.hub.rosapi.nodes import OwnNode
from fibws.protocol.serialized import publish_head, read_delivery

from ..fakes import INT32
from ..graph.recorder import Recorder
from ..graph.test_policy import Forbid
from .rosapi_client import RosapiClient

LOG = {"name": "/talker", "msg": "hello", "level": 2}


@pytest.fixture
def rosapi() -> RosapiClient:
    return RosapiClient()


def loggers(node: str) -> list[str]:
    return [f"{node}/get_loggers", f"{node}/set_logger_level"]


def test_hubs_own_nodes_publish_subscribe_and_serve(rosapi: RosapiClient) -> None:
    rosout = rosapi.call("/rosapi/node_details", node="/rosout")
    assert rosout == {
        "publishing": ["/rosout_agg"],
        "subscribing": ["/rosout"],
        "services": loggers("/rosout"),
    }
    rosbridge = rosapi.call("/rosapi/node_details", node="/rosbridge_websocket")
    assert rosbridge == {
        "publishing": ["/client_count", "/connected_clients", "/rosout"],
        "subscribing": [],
        "services": loggers("/rosbridge_websocket"),
    }
    own = rosapi.call("/rosapi/node_details", node="/rosapi")
    assert (own["publishing"], own["subscribing"]) == (["/rosout"], [])
    assert set(own["services"]) == {
        name for name in rosapi.graph.services if name.startswith("/rosapi/")
    }


def test_message_on_rosout_is_published_on_rosout_agg(rosapi: RosapiClient) -> None:
    talker, listener = rosapi.add_client("/talker"), rosapi.add_client("/listener")
    listener.send("subscribe", "/rosout")
    listener.send("subscribe", "/rosout_agg")
    talker.send("advertise", "/rosout", type="rosgraph_msgs/Log")
    for number in (1, 2):
        talker.send("publish", "/rosout", msg={**LOG, "line": number})
        received = {each["topic"]: each["msg"] for each in listener.receive()}
        assert received["/rosout"] == received["/rosout_agg"]
        assert (received["/rosout"]["msg"], received["/rosout"]["line"]) == ("hello", number)


def test_rosout_agg_is_published_only_to_subscribers(
    rosapi: RosapiClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    (aggregated,) = rosapi.graph.topics["/rosout_agg"].sources.values()
    forwarded: list[Publication] = []
    monkeypatch.setattr(
        type(aggregated), "forward", lambda self, publication: forwarded.append(publication)
    )
    talker = rosapi.add_client("/talker")
    talker.send("advertise", "/rosout", type="rosgraph_msgs/Log")
    talker.send("publish", "/rosout", msg=LOG)
    assert forwarded == []
    rosapi.add_client("/listener").send("subscribe", "/rosout_agg")
    talker.send("publish", "/rosout", msg=LOG)
    assert [each.values()["msg"] for each in forwarded] == ["hello"]


@pytest.mark.parametrize("topic", ["/client_count", "/connected_clients", "/rosout_agg"])
def test_internal_topics_are_published_by_the_hub_alone(rosapi: RosapiClient, topic: str) -> None:
    present = rosapi.graph.topics[topic]
    assert present.type is not None
    talker = rosapi.add_client("/talker")
    talker.send("advertise", topic, type=present.type.name)
    (status,) = talker.receive_statuses()
    assert topic in status
    assert "/talker" not in present.sources


def test_type_of_the_log_cannot_be_changed(rosapi: RosapiClient) -> None:
    talker = rosapi.add_client("/talker")
    talker.send("advertise", "/rosout", type="std_msgs/String")
    (status,) = talker.receive_statuses()
    assert "already established with type rosgraph_msgs/Log (by /rosapi)" in status


def test_internal_services_cannot_be_taken_over(rosapi: RosapiClient) -> None:
    client = rosapi.add_client("/client")
    client.send("advertise_service", service="/rosapi/topics", type="rosapi/Topics")
    assert client.receive_statuses() != []
    assert "/rosout" in rosapi.call("/rosapi/topics")["topics"]


def test_own_node_is_never_replaced() -> None:
    with pytest.raises(AssertionError, match="/rosapi is the hub's own"):
        OwnNode("/rosapi", [], [], []).replaced()


def test_closing_removes_all_nodes_topics_and_services(rosapi: RosapiClient) -> None:
    connections = [rosapi.connect() for _ in range(2)]
    rosapi.client.send("advertise", "/fib", type=INT32)
    rosapi.client.disconnect()
    for connection in connections:
        connection.client.disconnect()
    rosapi.own.close()
    graph = rosapi.graph
    assert (graph.nodes, graph.topics, graph.services) == ({}, {}, {})
    assert rosapi.hub.clock.timers == 0


def test_closing_twice_is_harmless(rosapi: RosapiClient) -> None:
    rosapi.own.close()
    rosapi.own.close()


def test_topic_with_a_client_as_subscriber_outlives_them(rosapi: RosapiClient) -> None:
    rosapi.client.send("subscribe", "/rosout")
    rosapi.own.close()
    assert list(rosapi.graph.topics) == ["/rosout"]
    assert list(rosapi.graph.topics["/rosout"].subscribers()) == ["/caller"]


def test_serialized_message_on_rosout_is_repeated_without_being_decoded(
    rosapi: RosapiClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    talker, listener = (rosapi.hub.client(node, serialized=True) for node in ("/a", "/b"))
    talker.send("advertise", "/rosout", type="rosgraph_msgs/Log", publisher=1)
    for topic in ("/rosout", "/rosout_agg"):
        listener.send("subscribe", topic, compression="ros1")
    assert [each["op"] for each in listener.receive()] == ["subscribed", "subscribed"]
    log = rosapi.graph.topics["/rosout"].type
    assert log is not None
    data = bytes(log.serialize(log.validate(LOG)))
    monkeypatch.setattr(CheckedType, "deserialize", None)
    talker.send_binary(publish_head(1) + data)
    messages = [read_delivery(payload).message for _, payload in listener.receive_frames()]
    assert [bytes(message[4:]) for message in messages] == [data[4:], data[4:]]


def test_rosout_counts_as_a_subscriber_of_the_log(rosapi: RosapiClient) -> None:
    talker = rosapi.add_client("/talker")
    talker.send("advertise", "/rosout", type="rosgraph_msgs/Log", peers=True)
    assert talker.receive_one("peers")["nodes"] == ["/rosout"]
    talker.send("publish", "/rosout", msg=LOG)
    [report] = [sink.report() for sink in rosapi.graph.topics["/rosout"].sinks()]
    assert report.messages == 1


def test_time_is_simulated_while_the_parameter_says_so(rosapi: RosapiClient) -> None:
    clock = rosapi.graph.clock
    real = rosapi.call("/rosapi/get_time")["time"]
    rosapi.call("/rosapi/set_param", name="/use_sim_time", value="true")
    assert clock.simulated == 0
    assert rosapi.graph.topics["/clock"].sinks()
    assert rosapi.call("/rosapi/node_details", node="/rosapi")["subscribing"] == ["/clock"]
    player = rosapi.add_client("/player")
    player.send("advertise", "/clock", type="rosgraph_msgs/Clock")
    player.send("publish", "/clock", msg={"clock": {"secs": 12, "nsecs": 34}})
    assert rosapi.call("/rosapi/get_time")["time"] == {"secs": 12, "nsecs": 34}
    rosapi.call("/rosapi/set_param", name="/use_sim_time", value="false")
    assert rosapi.call("/rosapi/get_time")["time"] == real
    assert not rosapi.graph.topics["/clock"].sinks()


def test_messages_of_the_clock_have_their_own_time_for_all(rosapi: RosapiClient) -> None:
    """Also for those who subscribed before the hub did."""
    listener = Recorder("/listener")
    rosapi.graph.subscribe(rosapi.graph.topic("/clock"), listener, "rosgraph_msgs/Clock")
    rosapi.call("/rosapi/set_param", name="/use_sim_time", value="true")
    player = rosapi.add_client("/player")
    player.send("advertise", "/clock", type="rosgraph_msgs/Clock")
    for seconds in (12, 13, 2):
        player.send("publish", "/clock", msg={"clock": {"secs": seconds, "nsecs": 1}})
    times = [each.received for each in listener.received]
    assert times == [each * 10**9 + 1 for each in (12, 13, 2)]


def test_clock_of_another_type_sets_no_time_and_keeps_no_clock_out(rosapi: RosapiClient) -> None:
    wrong, player = rosapi.add_client("/wrong"), rosapi.add_client("/player")
    wrong.send("advertise", "/clock", type=INT32)
    rosapi.call("/rosapi/set_param", name="/use_sim_time", value="true")
    wrong.send("publish", "/clock", msg={"data": 7})
    assert rosapi.graph.clock.simulated == 0
    player.send("advertise", "/clock", type="rosgraph_msgs/Clock")
    player.send("publish", "/clock", msg={"clock": {"secs": 12, "nsecs": 34}})
    assert rosapi.graph.clock.simulated == 12 * 10**9 + 34


# A client that is called /rosout.


def test_client_may_be_called_rosout_while_the_log_is_aggregated(rosapi: RosapiClient) -> None:
    listener, talker = rosapi.add_client("/listener"), rosapi.add_client("/talker")
    listener.send("subscribe", "/rosout_agg")
    talker.send("advertise", "/rosout", type="rosgraph_msgs/Log")

    client = rosapi.add_client("/rosout")
    client.send("advertise_service", service="/rosout/get_loggers", type="roscpp/GetLoggers")
    assert rosapi.graph.services["/rosout/get_loggers"].node == "/rosout"
    client.send("advertise", "/rosout_agg", type="rosgraph_msgs/Log")
    assert "/rosout_agg is published by the hub alone" in client.receive_statuses()[0]
    listener.receive()  # The log line of this.
    talker.send("publish", "/rosout", msg=LOG)
    assert [each["msg"]["msg"] for each in listener.receive()] == ["hello"]
    assert list(rosapi.graph.topics["/rosout_agg"].sources) == ["/rosapi"]

    client.disconnect()
    talker.send("publish", "/rosout", msg=LOG)
    assert [each["msg"]["msg"] for each in listener.receive()] == ["hello"]
    rosout = rosapi.call("/rosapi/node_details", node="/rosout")
    assert rosout["publishing"] == ["/rosout_agg"]
    assert rosout["services"] == loggers("/rosout")


@pytest.mark.parametrize("name", ["/rosapi", "/rosbridge_websocket"])
def test_other_names_of_the_hub_cannot_be_taken(rosapi: RosapiClient, name: str) -> None:
    with pytest.raises(NotAllowed, match=name):
        rosapi.add_client(name)


def test_rosout_cannot_be_taken_on_a_hub_with_a_policy() -> None:
    rosapi = RosapiClient(policy=Forbid())
    with pytest.raises(NotAllowed, match="/rosout"):
        rosapi.add_client("/rosout")
