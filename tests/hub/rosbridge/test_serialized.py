"""``fibws.v1``: messages in ROS 1's serialization, in binary frames."""

from __future__ import annotations

import json
import struct
from typing import Any, NamedTuple

import cbor2
import pytest

from fibws.hub.graph.types import Types
from fibws.interfaces import Interfaces
from fibws.protocol.serialized import deliver_head, publish_head, read_delivery

from ..fakes import BINARY, INT32, NANOSECONDS, STRING, TEXT, Client, FakeHub

NUMBER = 7
"""The publisher's number in most tests."""
INT32_MD5 = "da5909fbe378aeaf85e547e830cc1bb7"
IMAGE = "sensor_msgs/Image"
TYPES = Types(Interfaces(), lambda: NANOSECONDS, strict=False)


class Delivered(NamedTuple):
    """A binary frame that a client received."""

    topic: int
    received: int
    header: dict[str, Any] | None
    message: bytes


def serialized(type_: str, values: dict[str, Any]) -> bytes:
    """Return a message in ROS 1's serialization."""
    message = TYPES.message(type_)
    return bytes(message.serialize(message.validate(values)))


def int32(data: int) -> bytes:
    return struct.pack("<i", data)


def string(data: str | bytes) -> bytes:
    text = data.encode() if isinstance(data, str) else data
    return struct.pack("<I", len(text)) + text


def publish(client: Client, message: bytes, *, number: int = NUMBER, to: str | None = None) -> None:
    """Publish a message in a binary frame."""
    client.send_binary(publish_head(number, to) + message)


def talker(
    hub: FakeHub, topic: str = "/n", type_: str = INT32, node: str = "/talker", **fields: Any
) -> Client:
    """Return a new client that advertises a topic under `NUMBER`."""
    client = hub.client(node, serialized=True)
    client.send("advertise", topic, **{"type": type_, "publisher": NUMBER, **fields})
    assert client.receive() == []
    return client


def listener(
    hub: FakeHub, topic: str = "/n", type_: str | None = INT32, **fields: Any
) -> tuple[Client, int]:
    """Return a new client that subscribes to serialized messages, and the topic's number."""
    client = hub.client(fields.pop("node", None), serialized=True)
    return client, subscribe(client, topic, type_, **fields)


def subscribe(client: Client, topic: str = "/n", type_: str | None = INT32, **fields: Any) -> int:
    """Subscribe to serialized messages; return the topic's number."""
    client.send("subscribe", topic, **{"type": type_, "compression": "ros1", **fields})
    answer = client.receive_one("subscribed")
    number: int = answer["topic_id"]
    return number


def deliveries(client: Client) -> list[Delivered]:
    """Return the binary frames that have come; nothing else may have."""
    result = []
    for first, payload in client.receive_frames():
        assert first == BINARY, payload
        delivery = read_delivery(payload)
        header = json.loads(delivery.header) if delivery.header else None
        message = bytes(delivery.message)
        result.append(Delivered(delivery.topic, delivery.received, header, message))
    return result


def messages(client: Client) -> list[bytes]:
    """Return the serialized messages that have come."""
    return [delivery.message for delivery in deliveries(client)]


def error(client: Client) -> tuple[str, str]:
    """Return the code and the text of the one error that has come."""
    status = client.receive_one("status")
    assert status["level"] == "error"
    return status["code"], status["msg"]


# Publishing and subscribing.


def test_published_bytes_reach_a_serialized_subscriber_unchanged() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    client, topic = listener(hub)
    publish(publisher, int32(5))
    assert client.receive_frames() == [(BINARY, deliver_head(topic, NANOSECONDS) + int32(5))]
    assert publisher.receive() == []


def test_subscribe_is_answered_with_number_type_and_md5sum() -> None:
    hub = FakeHub()
    client = hub.client("/listener", serialized=True)
    client.send("subscribe", "/n", type=INT32, compression="ros1", id="s")
    answer = client.receive_one("subscribed")
    assert isinstance(answer.pop("topic_id"), int)
    assert answer == {
        "op": "subscribed",
        "id": "s",
        "topic": "/n",
        "type": INT32,
        "md5sum": INT32_MD5,
    }


def test_subscribed_repeats_the_clients_spelling() -> None:
    hub = FakeHub()
    client = hub.client("/robot/listener", serialized=True)
    client.send("subscribe", "n", type=INT32, compression="ros1")
    assert client.receive_one("subscribed")["topic"] == "n"


def test_frame_bytes_are_shared_by_all_subscribers_whatever_their_spelling() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    subscribers = [listener(hub, spelling) for spelling in ("/n", "n", "/n")]
    clients = [client for client, _ in subscribers]
    numbers = [number for _, number in subscribers]
    assert len(set(numbers)) == 1
    publish(publisher, int32(5))
    hub.clock.turn()
    written = [client.writes for client in clients]
    assert all(len(each) == 1 for each in written)
    assert len({id(each[0]) for each in written}) == 1


def test_topics_have_different_numbers() -> None:
    hub = FakeHub()
    client, first = listener(hub, "/a")
    second = subscribe(client, "/b")
    assert first != second
    publisher = talker(hub, "/a")
    publisher.send("advertise", "/b", type=INT32, publisher=8)
    publish(publisher, int32(1), number=8)
    publish(publisher, int32(2))
    assert [(each.topic, each.message) for each in deliveries(client)] == [
        (second, int32(1)),
        (first, int32(2)),
    ]


@pytest.mark.parametrize("number", [0, 2**32 - 1])
def test_publisher_numbers_span_32_bits(number: int) -> None:
    hub = FakeHub()
    publisher = talker(hub, publisher=number)
    client, _ = listener(hub)
    publish(publisher, int32(5), number=number)
    assert messages(client) == [int32(5)]


@pytest.mark.parametrize("number", [-1, 2**32, "7", 1.5])
def test_advertise_refuses_invalid_publisher_number(number: object) -> None:
    hub = FakeHub()
    client = hub.client(serialized=True)
    client.send("advertise", "/n", type=INT32, publisher=number)
    _, text = error(client)
    assert "publisher" in text
    assert "/n" not in hub.graph.topics


def test_headers_carry_the_publishers_connection_header() -> None:
    hub = FakeHub()
    publisher = talker(hub, headers={"language": "python"})
    client, topic = listener(hub, headers=True)
    publish(publisher, int32(5))
    header = {"callerid": "/talker", "latching": "0", "language": "python"}
    assert deliveries(client) == [Delivered(topic, NANOSECONDS, header, int32(5))]


def test_header_is_sent_only_to_subscriptions_that_ask_for_it() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    plain, _ = listener(hub)
    with_header, _ = listener(hub, headers=True)
    publish(publisher, int32(5))
    assert [each.header is None for each in deliveries(plain)] == [True]
    assert [each.header is None for each in deliveries(with_header)] == [False]


def test_header_of_a_json_publisher() -> None:
    hub = FakeHub()
    publisher = hub.client("/talker")
    publisher.send("advertise", "/n", type=INT32, latch=True)
    client, topic = listener(hub, headers=True)
    publisher.send("publish", "/n", msg={"data": 5})
    header = {"callerid": "/talker", "latching": "1"}
    assert deliveries(client) == [Delivered(topic, NANOSECONDS, header, int32(5))]


def test_message_for_one_node_reaches_that_node_alone() -> None:
    hub = FakeHub()
    publisher = talker(hub, latch=True)
    chosen, topic = listener(hub, node="/chosen")
    other, _ = listener(hub, node="/other")
    publish(publisher, int32(5), to="/chosen")
    assert deliveries(chosen) == [Delivered(topic, NANOSECONDS, None, int32(5))]
    assert other.receive_frames() == []
    late, _ = listener(hub)
    assert late.receive_frames() == []  # It is not latched.


def test_message_for_one_node_reaches_its_json_subscription() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    chosen = hub.client("/chosen")
    chosen.send("subscribe", "/n")
    publish(publisher, int32(5), to="/chosen")
    publish(publisher, int32(6), to="/missing")
    assert chosen.receive_numbers("/n") == [5]
    assert publisher.receive() == []


def test_header_seq_is_counted_for_types_with_a_header() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_=IMAGE)
    client, _ = listener(hub, type_=None)
    data = serialized(IMAGE, {"header": {"seq": 99, "frame_id": "camera"}, "height": 3})
    for _ in range(2):
        publish(publisher, data)
    assert messages(client) == [int32(1) + data[4:], int32(2) + data[4:]]


def test_header_seq_is_kept_if_the_publisher_asks_for_it() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_=IMAGE, keep_seq=True)
    client, _ = listener(hub, type_=None)
    data = serialized(IMAGE, {"header": {"seq": 99}})
    for _ in range(2):
        publish(publisher, data)
    assert messages(client) == [int32(99) + data[4:]] * 2


def test_subscribed_has_the_definition_if_the_request_asks_for_it() -> None:
    hub = FakeHub()
    talker(hub, type_=IMAGE)
    client = hub.client(serialized=True)
    client.send("subscribe", "/n", compression="ros1", send_definition=True)
    answer = client.receive_one("subscribed")
    assert answer["definition"] == Interfaces().full_text(IMAGE)


# Advertisements and their numbers.


def test_each_advertisement_of_a_topic_has_its_own_number() -> None:
    hub = FakeHub()
    publisher = talker(hub, id="first")
    publisher.send("advertise", "/n", type=INT32, publisher=8, id="second")
    client, _ = listener(hub)
    publish(publisher, int32(1), number=NUMBER)
    publish(publisher, int32(2), number=8)
    assert messages(client) == [int32(1), int32(2)]

    publisher.send("unadvertise", "/n", id="first")
    publish(publisher, int32(3), number=8)
    assert messages(client) == [int32(3)]
    publish(publisher, int32(4), number=NUMBER)
    assert error(publisher)[0] == "unknown_publisher"


def test_advertisements_that_share_a_number_keep_it_until_the_last_is_taken_back() -> None:
    hub = FakeHub()
    publisher = talker(hub, id="first")
    publisher.send("advertise", "/n", type=INT32, publisher=NUMBER, id="second")
    client, _ = listener(hub)
    publisher.send("unadvertise", "/n", id="first")
    publish(publisher, int32(1))
    assert messages(client) == [int32(1)]


def test_advertising_again_under_the_same_id_replaces_the_number() -> None:
    hub = FakeHub()
    publisher = talker(hub, id="a")
    publisher.send("advertise", "/n", type=INT32, publisher=8, id="a")
    client, _ = listener(hub)
    publish(publisher, int32(1), number=8)
    assert messages(client) == [int32(1)]
    publish(publisher, int32(2), number=NUMBER)
    assert error(publisher)[0] == "unknown_publisher"


def test_number_may_be_used_for_another_topic_after_unadvertise() -> None:
    hub = FakeHub()
    publisher = talker(hub, "/a")
    publisher.send("unadvertise", "/a")
    publisher.send("advertise", "/b", type=STRING, publisher=NUMBER)
    client, _ = listener(hub, "/b", STRING)
    publish(publisher, string("x"))
    assert messages(client) == [string("x")]
    assert publisher.receive() == []


def test_number_that_moved_to_another_topic_survives_the_older_unadvertise() -> None:
    hub = FakeHub()
    publisher = talker(hub, "/a")
    publisher.send("advertise", "/b", type=INT32, publisher=NUMBER)
    client, _ = listener(hub, "/b")
    publisher.send("unadvertise", "/a")
    publish(publisher, int32(1))
    assert messages(client) == [int32(1)]


def test_numbers_belong_to_one_connection() -> None:
    hub = FakeHub()
    first = talker(hub, "/a", node="/first")
    second = talker(hub, "/b", node="/second")
    client, _ = listener(hub, "/a")
    publish(second, int32(2))
    publish(first, int32(1))
    assert messages(client) == [int32(1)]


def test_nothing_is_left_when_the_clients_have_left() -> None:
    hub = FakeHub()
    publisher = talker(hub, latch=True)
    client, _ = listener(hub)
    publish(publisher, int32(1))
    for each in (client, publisher):
        each.disconnect()
        assert each.forgotten
    assert hub.empty


# Errors: the client lives on.


def test_unknown_publisher_number_is_an_error_that_names_it() -> None:
    hub = FakeHub()
    client = hub.client(serialized=True)
    publish(client, int32(5), number=1234)
    code, text = error(client)
    assert code == "unknown_publisher"
    assert "1234" in text


@pytest.mark.parametrize(
    ("type_", "data", "field"),
    [
        (INT32, b"", "data"),
        (INT32, b"123", "data"),
        (INT32, b"12345", ""),
        (STRING, string("hello")[:-1], "data"),
        (STRING, b"\xff\xff\xff\xff", "data"),
        ("geometry_msgs/Point", bytes(23), "z"),
        (IMAGE, serialized(IMAGE, {"data": "AAAA"})[:-1], "data"),
    ],
)
def test_malformed_message_is_an_error_that_names_topic_and_field(
    type_: str, data: bytes, field: str
) -> None:
    hub = FakeHub()
    publisher = talker(hub, "/picture", type_)
    client, _ = listener(hub, "/picture", type_)
    publish(publisher, data)
    code, text = error(publisher)
    assert code == "invalid_message"
    assert "/picture" in text
    assert field in text
    assert client.receive_frames() == []

    good = serialized(type_, {})
    publish(publisher, good)
    assert len(messages(client)) == 1


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\0",
        b"\1",
        b"\1\7\0\0",
        b"\2\7\0\0\0",
        b"\2\7\0\0\0\5\0/abc",
        b"\3\7\0\0\0" + int32(5),
        b"\xff" * 20,
        b'{"op":"publish","topic":"/n","msg":{"data":1}}',
        cbor2.dumps({"op": "publish", "topic": "/n", "msg": {"data": 1}}),
        b"\2\7\0\0\0\2\0\xff\xfe" + int32(5),
    ],
)
def test_malformed_frame_is_an_error_and_the_client_lives_on(data: bytes) -> None:
    hub = FakeHub()
    publisher = talker(hub)
    client, _ = listener(hub)
    publisher.send_binary(data)
    code, text = error(publisher)
    assert code == "invalid_operation"
    assert "binary frame" in text
    publish(publisher, int32(5))
    assert messages(client) == [int32(5)]


def test_publishing_serialized_messages_needs_the_definition() -> None:
    hub = FakeHub()
    publisher = hub.client("/talker", serialized=True)
    publisher.send("advertise", "/n", type="my_msgs/T", publisher=NUMBER)
    publish(publisher, int32(5))
    _, text = error(publisher)
    assert "definition" in text
    assert "my_msgs/T" in text


def test_subscribing_to_serialized_messages_needs_the_definition() -> None:
    hub = FakeHub()
    client = hub.client(serialized=True)
    client.send("subscribe", "/n", type="my_msgs/T", compression="ros1")
    _, text = error(client)
    assert "definition" in text
    assert "my_msgs/T" in text
    assert hub.graph.topics == {}


def test_serialized_messages_of_a_type_whose_definition_a_publisher_brought() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_="my_msgs/T", definition="int32 data")
    client, _ = listener(hub, type_=None)
    publish(publisher, int32(5))
    assert messages(client) == [int32(5)]


def test_ros1_on_a_plain_connection_gives_a_warning_and_json() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    client = hub.client("/plain")
    client.send("set_level", level="warning")
    client.send("subscribe", "/n", compression="ros1", id="s")
    status = client.receive_one("status")
    assert (status["level"], status["id"]) == ("warning", "s")
    assert "ros1" in status["msg"]
    publish(publisher, int32(5))
    assert client.receive_numbers("/n") == [5]


def test_subscribe_without_a_type_is_answered_once_the_topic_has_one() -> None:
    hub = FakeHub()
    client = hub.client(serialized=True)
    client.send("subscribe", "/n", compression="ros1", id="s")
    assert client.receive() == []
    publisher = talker(hub)
    publish(publisher, int32(5))
    publish(publisher, int32(6))
    (first, answer), *rest = client.receive_frames()
    assert first == TEXT
    fields = json.loads(answer)
    assert (fields["op"], fields["id"], fields["type"]) == ("subscribed", "s", INT32)
    head = deliver_head(fields["topic_id"], NANOSECONDS)
    assert rest == [(BINARY, head + int32(5)), (BINARY, head + int32(6))]


def test_subscribe_without_a_type_to_a_typed_topic_is_answered_at_once() -> None:
    hub = FakeHub()
    talker(hub)
    assert subscribe(hub.client(serialized=True), type_=None)


@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_other_md5sum_is_refused(op: str) -> None:
    hub = FakeHub()
    client = hub.client(serialized=True)
    fields = {"type": INT32, "compression": "ros1"} if op == "subscribe" else {"type": INT32}
    client.send(op, "/n", **fields, md5sum="0123")
    code, text = error(client)
    assert code == "type_conflict"
    assert "0123" in text
    assert INT32_MD5 in text
    assert hub.graph.topics == {}


@pytest.mark.parametrize("md5sum", [INT32_MD5, "*"])
def test_own_md5sum_and_asterisk_are_accepted(md5sum: str) -> None:
    hub = FakeHub()
    publisher = talker(hub, md5sum=md5sum)
    client, _ = listener(hub, md5sum=md5sum)
    publish(publisher, int32(5))
    assert messages(client) == [int32(5)]


# JSON clients and serialized clients.


def test_json_publisher_and_serialized_subscriber() -> None:
    hub = FakeHub()
    client, topic = listener(hub)
    publisher = hub.client("/talker")
    publisher.send("advertise", "/n", type=INT32)
    publisher.send("publish", "/n", msg={"data": 5})
    assert deliveries(client) == [Delivered(topic, NANOSECONDS, None, int32(5))]


def test_serialized_publisher_and_json_subscriber() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_="sensor_msgs/LaserScan")
    client = hub.client("/plain")
    client.send("subscribe", "/n")
    values = {"header": {"frame_id": "laser"}, "range_max": 2.5, "ranges": [1.0, 0.5]}
    publish(publisher, serialized("sensor_msgs/LaserScan", values))
    [msg] = client.receive_messages("/n")
    assert msg["header"]["frame_id"] == "laser"
    assert (msg["header"]["seq"], msg["range_max"], msg["ranges"]) == (1, 2.5, [1.0, 0.5])


def test_client_of_fibws_v1_may_publish_and_subscribe_in_json() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    client = hub.client("/listener", serialized=True)
    client.send("subscribe", "/n")
    publisher.send("publish", "/n", msg={"data": 5})
    publish(publisher, int32(6))
    assert client.receive_numbers("/n") == [5, 6]


@pytest.mark.parametrize("compression", ["none", "cbor", "cbor-raw", "png"])
def test_frames_do_not_depend_on_how_the_message_arrived(compression: str) -> None:
    type_ = "sensor_msgs/LaserScan"
    values = {"header": {"frame_id": "ä"}, "angle_min": -0.5, "ranges": [1.0, 2.0]}

    def frames_of(*, binary: bool) -> list[tuple[int, bytes]]:
        hub = FakeHub()
        publisher = talker(hub, type_=type_)
        client = hub.client("/listener")
        client.send("subscribe", "/n", compression=compression)
        if binary:
            publish(publisher, serialized(type_, values))
        else:
            publisher.send("publish", "/n", msg=values)
        return client.receive_frames()

    found = frames_of(binary=True)
    assert len(found) == 1
    assert found == frames_of(binary=False)


@pytest.mark.parametrize("binary", [True, False])
def test_latched_message_reaches_late_serialized_and_json_subscribers(binary: bool) -> None:
    hub = FakeHub()
    publisher = talker(hub, latch=True)
    if binary:
        publish(publisher, int32(5))
    else:
        publisher.send("publish", "/n", msg={"data": 5})
    late = hub.client("/late", serialized=True)
    late.send("subscribe", "/n", type=INT32, compression="ros1")
    (first, answer), (second, payload) = late.receive_frames()
    assert (first, second) == (TEXT, BINARY)
    topic = json.loads(answer)["topic_id"]  # It comes before the message that needs it.
    assert payload == deliver_head(topic, NANOSECONDS) + int32(5)
    plain = hub.client("/plain")
    plain.send("subscribe", "/n")
    assert plain.receive_numbers("/n") == [5]


def test_number_of_a_topic_stands_for_one_type() -> None:
    """Messages of both types may be on their way to a client."""
    hub = FakeHub()
    client, first = listener(hub, type_=INT32)
    client.send("unsubscribe", "/n")
    again = subscribe(client, type_=INT32)
    client.send("unsubscribe", "/n")
    waiting = hub.client("/waiting")
    waiting.send("subscribe", "/n")
    subscribe(client, type_=INT32, id="a")
    client.send("unsubscribe", "/n", id="a")
    assert subscribe(client, type_=STRING) not in (first, again)


def test_latched_message_is_not_changed_by_the_bytes_of_a_later_one() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_=IMAGE, latch=True)
    data = bytearray(publish_head(NUMBER) + serialized(IMAGE, {"height": 3}))
    publisher.session.receive_binary(data)
    data[:] = bytes(len(data))  # The connection's buffer is used for something else.
    late = hub.client("/late")
    late.send("subscribe", "/n")
    [msg] = late.receive_messages("/n")
    assert (msg["height"], msg["header"]["seq"]) == (3, 1)


def test_merged_requests_of_one_client_get_the_serialized_form() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    client = hub.client("/listener", serialized=True)
    client.send("subscribe", "/n", id="json")
    assert client.receive() == []
    subscribe(client, type_=None, id="binary")
    publish(publisher, int32(5))
    assert messages(client) == [int32(5)]
    client.send("unsubscribe", "/n", id="binary")
    publish(publisher, int32(6))
    assert client.receive_numbers("/n") == [6]


# Throttles and queues.


def test_throttle_rate_holds_for_serialized_messages() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    client, _ = listener(hub, throttle_rate=100)
    for data in range(3):
        publish(publisher, int32(data))
    assert messages(client) == [int32(0)]
    hub.clock.advance(0.1)
    publish(publisher, int32(3))
    assert messages(client) == [int32(3)]


def test_throttled_serialized_messages_wait_in_the_queue() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    client, _ = listener(hub, throttle_rate=100, queue_length=2)
    for data in range(5):
        publish(publisher, int32(data))
    hub.clock.advance(1)
    assert messages(client) == [int32(0), int32(3), int32(4)]


def test_queue_length_bounds_serialized_messages_of_a_slow_client() -> None:
    hub = FakeHub()
    publisher = talker(hub)
    client, _ = listener(hub, queue_length=2)
    client.queue.pause()
    for data in range(5):
        publish(publisher, int32(data))
    client.queue.resume()
    assert messages(client) == [int32(3), int32(4)]
    [sink] = hub.graph.topics["/n"].sinks()
    report = sink.report()
    assert (report.messages, report.dropped, report.encoding) == (5, 3, "ros1")


# Strings that are not UTF-8.


def test_one_warning_for_strings_that_are_not_utf8_to_a_json_subscriber() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_=STRING)
    client = hub.client("/plain")
    client.send("set_level", level="warning")
    client.send("subscribe", "/n", id="s")
    for _ in range(3):
        publish(publisher, string(b"caf\xe9"))
    received = client.receive()
    statuses = [each for each in received if each["op"] == "status"]
    [status] = statuses
    assert (status["level"], status["id"]) == ("warning", "s")
    assert "/n" in status["msg"]
    assert "UTF-8" in status["msg"]
    assert [each["msg"]["data"] for each in received if each not in statuses] == ["caf\ufffd"] * 3


def test_warning_about_utf8_for_a_message_to_one_node() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_=STRING)
    client = hub.client("/plain")
    client.send("set_level", level="warning")
    client.send("subscribe", "/n")
    publish(publisher, string(b"\xe9"), to="/plain")
    assert {each["op"] for each in client.receive()} == {"publish", "status"}


def test_strings_that_are_not_utf8_reach_serialized_subscribers_unchanged() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_=STRING)
    client, _ = listener(hub, type_=STRING)
    client.send("set_level", level="warning")
    json_client = hub.client("/plain")
    json_client.send("subscribe", "/n")
    publish(publisher, string(b"caf\xe9"))
    assert messages(client) == [string(b"caf\xe9")]


def test_messages_are_not_decoded_for_serialized_subscribers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hub = FakeHub()
    publisher = talker(hub)
    client, _ = listener(hub)
    monkeypatch.setattr("fibws.hub.graph.publication.Publication.values", None)
    publish(publisher, int32(5))
    assert messages(client) == [int32(5)]


def test_large_and_small_frames_keep_their_order() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_=STRING)
    client, _ = listener(hub, type_=STRING)
    sent = [string("x" * size) for size in (1, 200_000, 2, 100_000, 3)]
    for message in sent:
        publish(publisher, message)
    assert messages(client) == sent


def test_large_message_is_shared_by_all_subscribers_without_a_copy() -> None:
    hub = FakeHub()
    publisher = talker(hub, type_=STRING)
    clients = [listener(hub, type_=STRING)[0] for _ in range(3)]
    data = publish_head(NUMBER) + string("x" * 100_000)
    publisher.send_binary(data)
    hub.clock.turn()
    bodies = [client.writes[-1] for client in clients]
    assert all(isinstance(each, memoryview) and each.obj is data for each in bodies)


def test_message_too_heavy_for_json_reaches_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fibws.hub.graph.types.FEWEST_BYTES", 0)
    monkeypatch.setattr("fibws.interfaces.serialization.MOST_WEIGHT", 1000)
    hub = FakeHub()
    publisher = talker(hub, "/map", "std_msgs/Int8MultiArray")
    viewer, page = hub.client(), hub.client()
    viewer.send("subscribe", "/map")
    page.send("subscribe", "/map", compression="cbor")
    client, _ = listener(hub, "/map", None)
    message = struct.pack("<III", 0, 0, 100) + bytes(100)
    for _ in range(2):
        publish(publisher, message)
    text = "a message of 112 bytes of type std_msgs/Int8MultiArray has too many values for JSON"
    assert viewer.receive_statuses() == [
        f"subscribe: {text}; subscribe with compression cbor or cbor-raw"
    ]
    assert len(page.receive_frames()) == 2
    assert messages(client) == [message, message]
    publish(publisher, struct.pack("<III", 0, 0, 1) + b"\7")
    assert viewer.receive_one("publish")["msg"]["data"] == [7]
