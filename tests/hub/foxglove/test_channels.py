"""The channels and services that a client is offered, and their changes."""

from __future__ import annotations

import struct
from collections.abc import Callable

import pytest
from work import executed_lines

from fibws.hub.foxglove.feeds import BATCH, MOST_PROBES, PROBE_SECONDS, Schemas
from fibws.hub.graph.nodes import ExternalNode
from fibws.hub.graph.types import MessageType

from ..fakes import ADD, FIBONACCI, INT32, NANOSECONDS, STANDARD, STRING
from .foxglove_client import FoxgloveHub

POSE = "geometry_msgs/PoseStamped"
CUSTOM = "my_msgs/Thing"


def test_server_is_introduced_before_everything_else() -> None:
    hub = FoxgloveHub()
    hub.client("/talker").send("advertise", "/fib", type=INT32)
    client = hub.foxglove_client()
    assert client.receive_operations() == ["serverInfo", "advertise"]
    assert client.info["supportedEncodings"] == ["ros1", "json"]
    assert client.info["metadata"] == {"ROS_DISTRO": "noetic"}
    assert {"clientPublish", "parameters", "parametersSubscribe", "services"} <= {
        *client.info["capabilities"]
    }
    assert client.info["sessionId"] == hub.foxglove_client("/other").session._foxglove.session_id


def test_channel_has_the_full_text_of_its_type() -> None:
    hub = FoxgloveHub()
    hub.client("/talker").send("advertise", "/pose", type=POSE)
    client = hub.foxglove_client()
    client.receive()
    channel = client.channels["/pose"]
    assert (channel["encoding"], channel["schemaEncoding"]) == ("ros1", "ros1msg")
    assert channel["schemaName"] == POSE
    assert channel["schema"] == hub.graph.definitions.full_text(POSE)
    assert "MSG: geometry_msgs/Quaternion" in channel["schema"]


def test_topic_that_waits_for_a_publisher_is_a_channel() -> None:
    """A robot waits for its velocity, which the application can publish."""
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    robot = hub.client("/robot")
    robot.send("subscribe", "/cmd_vel", type="geometry_msgs/Twist")
    client.receive()
    assert client.channels["/cmd_vel"]["schemaName"] == "geometry_msgs/Twist"
    client.advertise("/cmd_vel", "geometry_msgs/Twist")
    client.publish(1, bytes(48))
    assert robot.receive_one("publish")["msg"]["linear"] == {"x": 0.0, "y": 0.0, "z": 0.0}
    client.send("unadvertise", channelIds=[1])
    robot.disconnect()
    client.receive()
    assert client.channels == {}


def test_topic_that_only_applications_subscribe_to_is_no_channel() -> None:
    hub = FoxgloveHub()
    clients = [hub.foxglove_client(), hub.foxglove_client("/other")]
    talker = hub.client("/talker")
    talker.send("advertise", "/fib", type=INT32)
    for client in clients:
        client.subscribe("/fib")
    talker.disconnect()
    for client in clients:
        client.receive()
        assert client.channels == {}


def test_topic_without_a_type_is_no_channel() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    hub.client("/listener").send("subscribe", "/fib")
    assert client.receive() == []
    assert client.channels == {}


def test_id_stays_while_publishers_and_subscribers_come_and_go() -> None:
    hub = FoxgloveHub()
    first, second = hub.client("/first"), hub.client("/second")
    first.send("advertise", "/fib", type=INT32)
    client = hub.foxglove_client()
    client.subscribe("/fib")
    client.receive()
    id_ = client.channels["/fib"]["id"]
    second.send("advertise", "/fib", type=INT32)
    second.send("subscribe", "/fib")
    first.disconnect()
    assert client.receive_operations() == []
    assert client.channels["/fib"]["id"] == id_
    other = hub.foxglove_client("/other")
    other.receive()
    assert other.channels["/fib"]["id"] == id_


def test_changes_within_one_turn_are_sent_together() -> None:
    hub = FoxgloveHub()
    client, talker = hub.foxglove_client(), hub.client("/talker")
    client.receive()
    for number in range(20):
        talker.send("advertise", f"/topic{number}", type=INT32)
    assert client.receive_operations() == ["advertise"]
    talker.send("unadvertise", "/topic7")
    talker.send("advertise", "/topic7", type=INT32)
    for number in range(5):
        talker.send("unadvertise", f"/topic{number}")
    talker.send("advertise", "/another", type=INT32)
    assert client.receive_operations() == ["unadvertise", "advertise"]
    assert set(client.channels) == {"/another", *(f"/topic{number}" for number in range(5, 20))}


def test_another_type_is_another_channel() -> None:
    hub = FoxgloveHub()
    client, talker = hub.foxglove_client(), hub.client("/talker")
    talker.send("advertise", "/data", type=INT32)
    client.subscribe("/data")
    client.receive()
    older = client.channels["/data"]
    talker.send("unadvertise", "/data")
    talker.send("advertise", "/data", type="std_msgs/String")
    talker.send("publish", "/data", msg={"data": "text"})
    assert client.receive_operations() == ["unadvertise", "advertise"]
    newer = client.channels["/data"]
    assert newer["schemaName"] == "std_msgs/String"
    assert newer["id"] != older["id"]
    assert client.session.subscribing() == set()
    client.subscribe("/data", 1)
    talker.send("publish", "/data", msg={"data": "again"})
    [(subscription, _, data)] = client.receive_messages()
    assert (subscription, data) == (1, b"\5\0\0\0again")


def test_unknown_definition_is_reported_once_and_no_longer_once_it_is_known() -> None:
    hub = FoxgloveHub()
    talker = hub.client("/talker")
    talker.send("advertise", "/thing", type=CUSTOM)
    client = hub.foxglove_client()
    [status] = client.receive()
    assert isinstance(status, dict)
    assert (status["op"], status["level"]) == ("status", 1)
    assert status["message"].startswith(f"no definition of {CUSTOM}")
    assert "/thing" in status["message"]
    talker.send("publish", "/thing", msg={"a": 1})
    hub.client("/listener").send("subscribe", "/thing")
    assert client.receive() == []
    assert client.channels == {}
    hub.client("/other").send("advertise", "/thing", type=CUSTOM, definition="int32 a")
    assert client.receive_one("removeStatus")["statusIds"] == [status["id"]]
    assert client.channels["/thing"]["schema"] == "int32 a"


class Ros1Node(ExternalNode):
    """A ROS 1 node that tells no definitions."""

    api, fault, since = "http://127.0.0.1:9/", "", 0

    def publishing(self) -> list[str]:
        return []

    subscribing = providing = publishing

    def replaced(self) -> None:
        raise AssertionError

    def ping(self, done: Callable[[str], object]) -> Callable[[], object]:
        raise AssertionError

    def shut_down(self, reason: str, done: Callable[[str], object]) -> Callable[[], object]:
        raise AssertionError

    def unregister(self) -> None:
        raise AssertionError


def test_ros1_node_is_asked_for_definitions_before_the_client_is_warned() -> None:
    hub = FoxgloveHub()
    hub.graph.enter(Ros1Node(), "/ros1")
    topics = [f"/thing{number}" for number in range(MOST_PROBES + 5)]
    for topic in topics:
        hub.graph.advertise(hub.graph.topic(topic), "/ros1", CUSTOM)
    client = hub.foxglove_client()
    assert client.receive() == []
    asked = [topic for topic in topics if hub.graph.topics[topic].sinks()]
    assert len(asked) == MOST_PROBES
    known = asked[3]
    hub.graph.advertise(hub.graph.topics[known], "/ros1", CUSTOM, "int32 a")
    assert client.receive() == []
    assert set(client.channels) == {known}
    assert not hub.graph.topics[known].sinks()
    hub.clock.advance(PROBE_SECONDS)
    hub.clock.advance(PROBE_SECONDS)
    assert len(client.receive_statuses(1)) == len(topics) - 1
    assert not any(hub.graph.topics[topic].sinks() for topic in topics)
    client.disconnect()
    later = hub.foxglove_client()
    later.disconnect()
    assert hub.clock.timers == 0
    assert not any(hub.graph.topics[topic].sinks() for topic in topics)


def test_topic_that_cannot_be_described_does_not_hide_others(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    hub = FoxgloveHub()
    talker = hub.client("/talker")
    for topic, type_ in (("/pose", POSE), ("/fib", INT32)):
        talker.send("advertise", topic, type=type_)
    find = Schemas.find

    def fail(schemas: Schemas, type_: MessageType) -> bytes | None:
        if type_.name == POSE:
            raise ZeroDivisionError
        return find(schemas, type_)

    with monkeypatch.context() as patch:
        patch.setattr(Schemas, "find", fail)
        client = hub.foxglove_client()
        client.receive()
    assert set(client.channels) == {"/fib"}
    assert "ZeroDivisionError" in caplog.text
    caplog.clear()


def test_services_are_offered_with_both_schemas() -> None:
    hub = FoxgloveHub()
    client, server = hub.foxglove_client(), hub.client("/server")
    server.send("advertise_service", service="/add", type=ADD)
    server.send("advertise_service", service="/unknown", type="my_srvs/Unknown")
    client.receive()
    assert set(client.services) == {"/add"}
    service = client.services["/add"]
    assert service["type"] == ADD
    assert service["request"] == {
        "encoding": "ros1",
        "schemaName": f"{ADD}Request",
        "schemaEncoding": "ros1msg",
        "schema": "int64 a\nint64 b",
    }
    assert service["response"]["schema"] == "int64 sum\n" == service["responseSchema"]
    assert service["requestSchema"] == "int64 a\nint64 b"
    server.disconnect()
    assert client.receive_operations() == ["unadvertiseServices"]
    assert client.services == {}


def test_schema_of_a_service_has_nested_types() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    hub.client("/server").send("advertise_action", action="/fib", type=FIBONACCI)
    client.receive()
    [service] = client.services.values()
    assert service["type"] == "action_msgs/CancelGoal"
    assert "MSG: action_msgs/GoalInfo" in service["request"]["schema"]


def test_service_with_another_server_has_another_id() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    hub.client("/server").send("advertise_service", service="/add", type=ADD)
    client.receive()
    older = client.services["/add"]["id"]
    hub.client("/other").send("advertise_service", service="/add", type=ADD)
    assert client.receive_operations() == ["unadvertiseServices", "advertiseServices"]
    assert client.services["/add"]["id"] != older


def test_many_long_schemas_are_sent_in_several_turns() -> None:
    hub = FoxgloveHub()
    talker = hub.client("/talker")
    definition = "int32 a  # " + "x" * 100_000
    size = 0
    while size < 3 * BATCH:
        topic = f"/topic{size}"
        talker.send("advertise", topic, type=f"my_msgs/T{size}", definition=definition)
        size += len(definition)
    client = hub.foxglove_client()
    hub.clock.turn()
    sent = sum(map(len, client.writes))
    assert BATCH < sent < 2 * BATCH
    while len(client.receive_operations()):
        pass
    assert len(client.channels) == len(hub.graph.topics)


def test_client_that_does_not_read_is_sent_the_last_state_alone() -> None:
    hub = FoxgloveHub()
    client, talker = hub.foxglove_client(), hub.client("/talker")
    client.pause()
    for number in range(100):
        talker.send("advertise", f"/topic{number}", type=INT32)
        hub.clock.advance(0)
        if number:
            talker.send("unadvertise", f"/topic{number}")
            hub.clock.advance(0)
    assert client.queue.kept_bytes == 0
    client.queue.resume()
    assert client.receive_operations() == ["advertise"]
    assert set(client.channels) == {"/topic0"}


def test_clients_that_leave_get_nothing_more() -> None:
    hub = FoxgloveHub()
    client, talker = hub.foxglove_client(), hub.client("/talker")
    client.send("subscribeConnectionGraph")
    client.send("subscribeParameterUpdates", parameterNames=["/a"])
    client.receive()
    talker.send("advertise", "/fib", type=INT32)
    hub.graph.parameters.set("/a", 1)
    client.disconnect()
    client.disconnect()
    assert client.receive_operations() == []
    talker.disconnect()
    assert hub.empty


def work(channels: int, clients: int) -> int:
    """Return the work of the hub while clients connect that are told of many channels."""
    hub = FoxgloveHub(max_advertisements=channels)
    talker = hub.client("/talker")
    types = STANDARD.messages("sensor_msgs")
    for number in range(channels):
        talker.send("advertise", f"/robot/topic{number}", type=types[number % len(types)])
    connected = []

    def connect() -> None:
        for number in range(clients):
            connected.append(hub.foxglove_client(f"/foxglove{number}"))
        for _ in range(20):
            hub.clock.advance(0)
            hub.clock.turn()

    lines = executed_lines(connect)
    for client in connected:
        client.receive()
        assert len(client.channels) == channels
    return lines


def test_topic_is_a_channel_for_each_type_with_which_it_is_published() -> None:
    hub = FoxgloveHub()
    wrong, talker, client = hub.client("/wrong"), hub.client("/talker"), hub.foxglove_client()
    wrong.send("advertise", "/fib", type=STRING)
    client.subscribe("/fib", 1)
    talker.send("advertise", "/fib", type=INT32)
    operations = client.receive_operations()
    assert "unadvertise" not in operations
    assert client.channels["/fib"]["schemaName"] == INT32
    client.subscribe("/fib", 2)
    wrong.send("publish", "/fib", msg={"data": ""})
    talker.send("publish", "/fib", msg={"data": 5})
    assert client.receive_messages() == [
        (1, NANOSECONDS, bytes(4)),
        (2, NANOSECONDS, struct.pack("<i", 5)),
    ]
    wrong.disconnect()
    talker.send("publish", "/fib", msg={"data": 6})
    assert client.receive_messages() == [(2, NANOSECONDS, struct.pack("<i", 6))]


@pytest.mark.long
def test_work_grows_as_channels_and_clients_do() -> None:
    some = work(1000, 1)
    assert some < 100 * 1000  # It is 70 lines for each channel.
    assert work(3000, 1) < 3.2 * some
    assert work(1000, 10) < 10.5 * some
