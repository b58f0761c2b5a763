"""Messages to and from clients."""

from __future__ import annotations

import json
import struct
from typing import Any

import pytest

from fibws.hub.delivery.send_queue import LargeFrame

from ..fakes import INT32, NANOSECONDS, STRING, number
from .foxglove_client import FoxgloveClient, FoxgloveHub


def int32(value: int) -> bytes:
    return struct.pack("<i", value)


def talking(**advertise: Any) -> tuple[FoxgloveHub, Any, FoxgloveClient]:
    """Return a hub, a client that publishes /fib, and one of Foxglove's."""
    hub = FoxgloveHub()
    talker = hub.client("/talker")
    talker.send("advertise", "/fib", type=INT32, **advertise)
    return hub, talker, hub.foxglove_client()


def test_message_has_the_time_at_which_it_came() -> None:
    _, talker, client = talking()
    client.subscribe("/fib", 7)
    talker.send("publish", "/fib", msg=number(8))
    assert client.receive_messages() == [(7, NANOSECONDS, int32(8))]


def test_clients_share_the_bytes_of_large_messages() -> None:
    hub = FoxgloveHub()
    talker = hub.client("/talker", serialized=True)
    talker.send("advertise", "/image", type="std_msgs/String", publisher=1)
    clients = [hub.foxglove_client(f"/foxglove{each}") for each in range(3)]
    for id_, client in enumerate(clients):
        client.subscribe("/image", id_ // 2)
    size = 200_000
    message = struct.pack("<I", size) + b"x" * size
    talker.send_binary(struct.pack("<BI", 1, 1) + message)
    sent = [client.queue.frames[0] for client in clients]
    assert all(isinstance(each, LargeFrame) for each in sent)
    bodies = {id(each.body.obj) for each in sent if isinstance(each, LargeFrame)}
    assert len(bodies) == 1
    assert sent[0] is sent[1] is not sent[2]
    for id_, client in enumerate(clients):
        assert client.receive_messages() == [(id_ // 2, NANOSECONDS, message)]


def test_latched_message_follows_the_subscription() -> None:
    _, talker, client = talking(latch=True)
    talker.send("publish", "/fib", msg=number(5))
    client.subscribe("/fib")
    assert client.receive_messages() == [(0, NANOSECONDS, int32(5))]
    [sink] = client._hub.graph.topics["/fib"].sinks_of("/foxglove")
    assert sink.report()._asdict() == {
        "queue_length": 1000,
        "throttle_rate": 0,
        "encoding": "ros1",
        "messages": 1,
        "dropped": 0,
        "throttled": 0,
    }


def test_message_to_this_node_alone_arrives() -> None:
    _, talker, client = talking()
    client.subscribe("/fib")
    talker.send("publish", "/fib", msg=number(5), to="/foxglove")
    talker.send("publish", "/fib", msg=number(6), to="/other")
    assert client.receive_messages() == [(0, NANOSECONDS, int32(5))]


def test_unsubscribed_client_gets_nothing_more() -> None:
    hub, talker, client = talking()
    client.subscribe("/fib")
    client.send("unsubscribe", subscriptionIds=[0, 5])
    talker.send("publish", "/fib", msg=number(8))
    assert client.receive() == []
    assert hub.foxglove.groups == {}


def test_second_subscription_is_a_warning_and_changes_nothing() -> None:
    _, talker, client = talking()
    talker.send("advertise", "/other", type=INT32)
    client.receive()
    fib, other = (client.channels[topic]["id"] for topic in ("/fib", "/other"))
    wanted = [{"id": id_, "channelId": each} for id_, each in ((0, fib), (1, fib), (0, other))]
    client.send("subscribe", subscriptions=wanted)
    first, second = client.receive_statuses(1)
    assert "/fib" in first
    assert "/fib" in second
    talker.send("publish", "/fib", msg=number(1))
    talker.send("publish", "/other", msg=number(2))
    assert client.receive_messages() == [(0, NANOSECONDS, int32(1))]


def test_unknown_channel_is_an_error_and_does_not_affect_others() -> None:
    _, talker, client = talking()
    client.receive()
    known = client.channels["/fib"]["id"]
    wanted = [{"id": 0, "channelId": 99}, {"id": 1, "channelId": known}]
    client.send("subscribe", subscriptions=wanted)
    assert client.receive_statuses() == ["subscribe: Unknown channel ID: 99"]
    talker.send("publish", "/fib", msg=number(1))
    assert client.receive_messages() == [(1, NANOSECONDS, int32(1))]


def test_channel_that_is_gone_is_unknown() -> None:
    _, talker, client = talking()
    client.receive()
    channel = client.channels["/fib"]["id"]
    talker.send("unadvertise", "/fib")
    client.send("subscribe", subscriptions=[{"id": 0, "channelId": channel}])
    assert client.receive_statuses() == [f"subscribe: Unknown channel ID: {channel}"]


def test_subscription_survives_a_publisher_that_returns_at_once() -> None:
    _, talker, client = talking()
    client.subscribe("/fib")
    talker.send("unadvertise", "/fib")
    talker.send("advertise", "/fib", type=INT32)
    talker.send("publish", "/fib", msg=number(1))
    assert client.receive_messages() == [(0, NANOSECONDS, int32(1))]


def test_too_many_subscriptions_are_refused() -> None:
    hub = FoxgloveHub(max_subscriptions=2)
    talker, client = hub.client("/talker"), hub.foxglove_client()
    for each in range(3):
        talker.send("advertise", f"/topic{each}", type=INT32)
    for each in range(3):
        client.subscribe(f"/topic{each}", each)
    [status] = client.receive_statuses()
    assert "limit 2" in status
    assert client.session.registrations("subscriptions") == 2


def test_slow_client_loses_the_oldest_and_is_told_so() -> None:
    hub = FoxgloveHub(queue_length=10)
    talker = hub.client("/talker")
    talker.send("advertise", "/fib", type=INT32)
    client, fast = hub.foxglove_client(), hub.foxglove_client("/fast")
    client.subscribe("/fib")
    fast.subscribe("/fib")
    client.pause()
    for each in range(25):
        talker.send("publish", "/fib", msg=number(each))
    [sink] = hub.graph.topics["/fib"].sinks_of("/foxglove")
    assert sink.report().dropped == 15 == client.queue.dropped
    assert len(fast.receive_messages()) == 25
    client.queue.resume()
    status, *messages = client.receive()
    assert isinstance(status, dict)
    assert (status["op"], status["level"]) == ("status", 1)
    assert status["message"].startswith("Send buffer limit reached")
    assert "/fib: 15" in status["message"]
    assert [each[13:] for each in messages if isinstance(each, bytes)] == [
        int32(each) for each in range(15, 25)
    ]


def test_client_that_loses_nothing_is_told_nothing() -> None:
    _, talker, client = talking()
    client.subscribe("/fib")
    client.pause()
    talker.send("publish", "/fib", msg=number(1))
    client.queue.resume()
    assert client.receive_messages() == [(0, NANOSECONDS, int32(1))]


def test_status_about_drops_comes_once_in_a_while() -> None:
    hub = FoxgloveHub(queue_length=1)
    talker, client = hub.client("/talker"), hub.foxglove_client()
    talker.send("advertise", "/fib", type=INT32)
    client.subscribe("/fib")

    def statuses() -> list[dict[str, Any]]:
        client.pause()
        for each in range(3):
            talker.send("publish", "/fib", msg=number(each))
        client.queue.resume()
        return [each for each in client.receive() if isinstance(each, dict)]

    assert len(statuses()) == 1
    assert statuses() == []
    hub.clock.advance(60)
    [status] = statuses()
    assert "dropped so far: 6" in status["message"]


@pytest.mark.parametrize("encoding", ["ros1", "json"])
def test_published_message_arrives(encoding: str) -> None:
    hub = FoxgloveHub()
    listener, client = hub.client("/listener"), hub.foxglove_client()
    listener.send("subscribe", "/text")
    client.advertise("/text", STRING, encoding=encoding, schema="string data\n")
    message = b"\2\0\0\0hi" if encoding == "ros1" else b'{"data":"hi"}'
    client.publish(1, message)
    assert listener.receive_messages("/text") == [{"data": "hi"}]
    assert client.receive() == []
    assert client.session.publishing() == {"/text"}
    client.send("unadvertise", channelIds=[1, 2])
    assert client.session.publishing() == set()
    client.publish(1, message)
    [status] = client.receive_statuses()
    assert "channel 1 is not advertised" in status


def test_types_of_ros2_and_jsonschema_are_understood() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    client.advertise(
        *("/text", "std_msgs/msg/String"),
        encoding="json",
        schema='{"type": "object"}',
        schemaEncoding="jsonschema",
    )
    client.receive()
    assert client.channels["/text"]["schemaName"] == STRING


def test_client_can_bring_a_definition() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    schema = "Part part\n" + "=" * 80 + "\nMSG: my_msgs/Part\nint32 a"
    client.advertise("/thing", "my_msgs/Thing", schema=schema, schemaEncoding="ros1msg")
    client.subscribe("/thing")
    client.publish(1, int32(3))
    assert client.receive_messages() == [(0, NANOSECONDS, int32(3))]
    client.advertise("/other", "my_msgs/Unknown", 2)
    [status] = client.receive_statuses()
    assert "my_msgs/Unknown" in status


@pytest.mark.parametrize(
    ("fields", "fault"),
    [
        ({"encoding": "cdr"}, "ros1 or json"),
        ({"topic": "/bad name"}, "/bad name"),
        ({"schemaName": "std_msgs/Nothing"}, "Nothing"),
        ({"schemaName": "nonsense"}, "nonsense"),
    ],
)
def test_refused_channel_does_not_affect_others(fields: dict[str, str], fault: str) -> None:
    hub = FoxgloveHub()
    hub.client("/talker").send("advertise", "/taken", type=STRING)
    client = hub.foxglove_client()
    good = {"id": 1, "topic": "/fib", "encoding": "ros1", "schemaName": INT32}
    client.send("advertise", channels=[{**good, "id": 2, **fields}, good])
    [status] = client.receive_statuses()
    assert fault in status
    assert hub.reported == [("/foxglove", status)]
    assert client.session.publishing() == {"/fib"}
    assert client.session.registrations("advertisements") == 1


def test_channels_of_one_topic_share_its_source() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    client.advertise("/fib", INT32, 1)
    client.advertise("/fib", INT32, 2, encoding="json")
    client.advertise("/other", INT32, 2)
    [status] = client.receive_statuses()
    assert "channel 2 is advertised already, for /fib" in status
    client.send("unadvertise", channelIds=[1])
    assert client.session.publishing() == {"/fib"}
    client.send("unadvertise", channelIds=[2])
    assert hub.graph.topics == {}


@pytest.mark.parametrize(
    ("encoding", "message", "fault"),
    [
        ("ros1", b"\1", "bytes"),
        ("ros1", b"\1\2\3\4\5", "bytes"),
        ("json", b"{", "invalid JSON"),
        ("json", b"[1]", "JSON object"),
        ("json", b'{"data":"x"}', "data"),
        ("json", b'{"nothing":1}', "nothing"),
    ],
)
def test_invalid_message_is_an_error_that_names_the_topic(
    encoding: str, message: bytes, fault: str
) -> None:
    hub = FoxgloveHub()
    client, listener = hub.foxglove_client(), hub.client("/listener")
    client.advertise("/fib", INT32, encoding=encoding)
    listener.send("subscribe", "/fib")
    client.publish(1, message)
    [status] = client.receive_statuses()
    assert status.startswith("/fib: ")
    assert fault in status
    client.publish(1, int32(1) if encoding == "ros1" else json.dumps(number(1)).encode())
    assert listener.receive_numbers("/fib") == [1]


def test_messages_of_unknown_channels_are_reported_now_and_then() -> None:
    client = FoxgloveHub().foxglove_client()
    for _ in range(50):
        client.publish(9, b"")
    assert len(client.receive_statuses()) == 2


def test_too_many_channels_are_refused() -> None:
    client = FoxgloveHub(max_advertisements=2).foxglove_client()
    for each in range(3):
        client.advertise(f"/topic{each}", INT32, each)
    [status] = client.receive_statuses()
    assert "limit 2" in status


def test_nothing_is_left_of_a_client_that_has_gone() -> None:
    hub, talker, client = talking()
    client.subscribe("/fib")
    client.advertise("/mine", INT32)
    client.disconnect()
    talker.send("publish", "/fib", msg=number(1))
    talker.disconnect()
    assert hub.empty


def test_name_can_be_taken_over() -> None:
    hub, talker, client = talking()
    client.subscribe("/fib")
    newer = hub.foxglove_client()
    assert [reason.code for reason in client.closings] == [4001]
    newer.subscribe("/fib")
    talker.send("publish", "/fib", msg=number(1))
    assert client.receive() == []
    assert len(newer.receive_messages()) == 1


def test_misspelled_package_earns_a_warning() -> None:
    client = FoxgloveHub().foxglove_client()
    client.advertise("/text", "std_msg/String", encoding="json")
    warning = client.receive_statuses(1)[0]
    assert "std_msg/String" in warning and "did you mean std_msgs/String?" in warning


ROS2_SCHEMAS = {
    "ros2msg": "my_msgs/Part[] parts\nstd_msgs/Header header\n"
    + f"{'=' * 80}\nMSG: my_msgs/msg/Part\nfloat32 size 0.5\n"
    + f"{'=' * 80}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    + f"{'=' * 80}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n",
    "ros2idl": f"{'=' * 80}\nIDL: my_msgs/msg/Thing\n"
    "module my_msgs { module msg { struct Thing {\n"
    "sequence<my_msgs::msg::Part> parts; std_msgs::msg::Header header; }; }; };\n"
    f"{'=' * 80}\nIDL: my_msgs/msg/Part\n"
    "module my_msgs { module msg { struct Part { @default(value=0.5) float size; }; }; };\n"
    f"{'=' * 80}\nIDL: std_msgs/msg/Header\n"
    "module std_msgs { module msg { struct Header {\n"
    "builtin_interfaces::msg::Time stamp; string frame_id; }; }; };\n",
}


@pytest.mark.parametrize("encoding", ROS2_SCHEMAS)
def test_schemas_of_ros_2_define_a_type(encoding: str) -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    listener = hub.client("/listener")
    listener.send("subscribe", "/t")
    fields: dict[str, Any] = {
        "schema": ROS2_SCHEMAS[encoding],
        "schemaEncoding": encoding,
        "encoding": "json",
    }
    client.advertise("/t", "my_msgs/msg/Thing", **fields)
    client.publish(1, b'{"parts":[{"size":2}],"header":{"frame_id":"map","stamp":{"sec":1}}}')
    message = listener.receive_one("publish")["msg"]
    assert message["parts"] == [{"size": 2.0}]
    assert message["header"]["frame_id"] == "map"
    assert message["header"]["stamp"]["secs"] == 1


@pytest.mark.parametrize(
    ("encoding", "schema", "fault"),
    [
        ("ros2idl", "module my_msgs { module msg { union Thing { }; }; };", "union"),
        ("ros2idl", "module my_msgs { module msg { struct Other { long x; }; }; };", "Thing"),
        ("ros2msg", "float32 9x", "line 1"),
        ("ros2idl", "//" + " " * 2**18, "too long"),
    ],
)
def test_schema_of_ros_2_that_cannot_be_read_is_refused(
    encoding: str, schema: str, fault: str
) -> None:
    client = FoxgloveHub().foxglove_client()
    client.receive()
    fields: dict[str, Any] = {"schema": schema, "schemaEncoding": encoding, "encoding": "json"}
    client.advertise("/t", "my_msgs/Thing", **fields)
    [text] = client.receive_statuses()
    assert fault in text
