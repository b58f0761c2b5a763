"""The sending end of a topic."""

from __future__ import annotations

import asyncio
import re
from typing import Any

import pytest

from fibws.errors import InvalidMessage, NodeClosed, OperationRejected
from fibws.msg.geometry_msgs import Point, Vector3
from fibws.node.publisher import Publisher
from fibws.node.topics import NodeTopics
from fibws.node.types import NodeTypes
from fibws.protocol.operations import Advertise
from fibws.protocol.serialized import read_publish
from fibws.protocol.websocket import client_payload

from .conftest import FakeSession, Lines, deliver, reconnected, sent_operations


@pytest.fixture
def topics(session: FakeSession) -> NodeTopics:
    return NodeTopics(session)


def advertise(topics: NodeTopics, types: NodeTypes, **options: Any) -> Publisher[Point]:
    return topics.advertise("/points", types.codec(Point), **{"queue_size": 2, **options})


@pytest.fixture
def points(session: FakeSession, topics: NodeTopics, types: NodeTypes) -> Publisher[Point]:
    points = advertise(topics, types)
    sent_operations(session)
    return points


def published(session: FakeSession) -> list[list[float]]:
    return [list(each["msg"].values()) for each in sent_operations(session)]


async def test_message_is_given_whole_or_by_its_fields(
    session: FakeSession, points: Publisher[Point]
) -> None:
    await points.publish(Point(1, 2, 3))
    await points.publish(1, 2, 3)
    await points.publish(z=3)
    await points.publish()
    assert published(session) == [[1, 2, 3], [1, 2, 3], [0, 0, 3], [0, 0, 0]]


def test_frame_has_the_publishers_number_and_the_serialized_message(
    topics: NodeTopics, types: NodeTypes
) -> None:
    first, second = advertise(topics, types), advertise(topics, types)
    codec = types.codec(Point)
    numbers = set()
    for publisher in (first, second):
        frame = publisher._encode(1, 2, 3)
        assert frame[2:6] == bytes(4), "the masking key"
        number, node, message = read_publish(client_payload(frame))
        assert (node, bytes(message)) == (None, codec.serialize(Point(1, 2, 3)))
        numbers.add(number)
    assert len(numbers) == 2


async def test_advertisement_has_number_and_md5_only_with_a_hub_of_fibws(
    session: FakeSession, points: Publisher[Point]
) -> None:
    plain = points._registration()
    assert (plain.publisher, plain.md5sum) == (None, None)
    session.serialized = True
    ours = points._registration()
    number = read_publish(client_payload(points._encode())).publisher
    assert (ours.publisher, ours.md5sum) == (number, "4a842b65f413084dc2b10fb484ea7f17")
    assert ours.id == plain.id


async def test_headers_can_be_changed(session: FakeSession, points: Publisher[Point]) -> None:
    points._introduce({})
    assert sent_operations(session) == []
    points._introduce({"user": "ann"})
    (advertised,) = sent_operations(session)
    assert (advertised["op"], advertised["headers"]) == ("advertise", {"user": "ann"})
    assert advertised["id"] == points._id
    assert [each.get("headers") for each in reconnected(session)] == [{"user": "ann"}]
    with pytest.raises(ValueError, match="headers must be an object of strings"):
        points._introduce({"": "nobody"})
    points.close()
    points._introduce({"user": "bob"})
    assert [each["op"] for each in sent_operations(session)] == ["unadvertise"]


async def test_publisher_can_be_closed_before_its_node(
    session: FakeSession, points: Publisher[Point]
) -> None:
    assert repr(points) == "<Publisher /points [geometry_msgs/Point]>"
    async with points:
        await points.publish()
    with pytest.raises(NodeClosed, match="the publisher of /points was closed"):
        await points.publish()
    points._send_while_open(points._encode())
    points.close()
    assert [each["op"] for each in sent_operations(session)] == ["publish", "unadvertise"]


async def test_refused_publisher_raises(session: FakeSession, points: Publisher[Point]) -> None:
    deliver(session, "status", level="error", id=points._id, msg="no", code="not_allowed")
    for _ in range(2):
        with pytest.raises(OperationRejected, match="no") as refusal:
            points._send(points._encode())
        assert refusal.value.code == "not_allowed"
    assert points.fault is refusal.value
    assert reconnected(session) == []


async def test_while_the_node_ends_a_frame_can_still_be_sent(
    session: FakeSession, points: Publisher[Point]
) -> None:
    session.end()
    with pytest.raises(NodeClosed, match="the node has ended"):
        points._send(points._encode())
    points._send_while_open(points._encode(1))
    assert published(session) == [[1, 0, 0]]


@pytest.mark.parametrize(
    ("fields", "named"), [((1,), {"y": 2}), ((1, 2, 3, 4), {}), ((), {"w": 1}), ((Vector3(),), {})]
)
async def test_other_arguments_raise(
    points: Publisher[Point], fields: tuple[Any, ...], named: dict[str, Any]
) -> None:
    with pytest.raises(TypeError):
        await points.publish(*fields, **named)
    with pytest.raises(TypeError):
        points._encode_to("/listener", *fields, **named)


@pytest.mark.parametrize(
    ("fields", "named", "text"),
    [
        ((), {"X": 1}, "geometry_msgs/Point does not have a field X; did you mean x?"),
        ((), {"angle": 1}, "geometry_msgs/Point does not have a field angle; known are x, y, z"),
        ((1, 2, 3, 4), {}, "geometry_msgs/Point has 3 fields, got 4: x, y, z"),
    ],
)
def test_wrong_fields_are_told_the_right_ones(
    points: Publisher[Point], fields: tuple[Any, ...], named: dict[str, Any], text: str
) -> None:
    with pytest.raises(TypeError, match=re.escape(text)):
        points._encode(*fields, **named)


async def test_fields_may_be_a_dict(session: FakeSession, points: Publisher[Point]) -> None:
    await points.publish({"y": 2, "x": 1})
    assert published(session) == [[1, 2, 0]]
    with pytest.raises(InvalidMessage, match="does not have a field X; did you mean x"):
        await points.publish({"X": 1})
    with pytest.raises(InvalidMessage, match="requires a float64 for field x"):
        await points.publish({"x": "a"})


def test_message_of_another_class_raises(points: Publisher[Point]) -> None:
    with pytest.raises(TypeError, match=r"expected \[geometry_msgs/Point\] but got"):
        points._encode(Vector3())


async def test_invalid_message_raises_and_is_not_sent(
    session: FakeSession, points: Publisher[Point]
) -> None:
    with pytest.raises(InvalidMessage, match="y"):
        await points.publish(1, "2", 3)
    assert published(session) == []


async def test_newest_messages_are_kept_without_a_hub(
    session: FakeSession, points: Publisher[Point]
) -> None:
    session.on_disconnect()
    for number in range(3):
        await points.publish(number)
    for number in range(3, 5):
        points._send(points._encode(number))
    assert points.dropped == 3
    session.reopen()
    assert published(session) == [[3, 0, 0], [4, 0, 0]]


async def test_message_can_be_encoded_in_another_thread(
    session: FakeSession, points: Publisher[Point]
) -> None:
    frames = await asyncio.to_thread(
        lambda: [points._encode(Point(1, 2, 3)), points._encode(1), points._encode(z=3)]
    )
    assert published(session) == []
    for frame in frames:
        await points._room()
        points._send(frame)
    assert published(session) == [[1, 2, 3], [1, 0, 0], [0, 0, 3]]


async def test_publisher_waits_for_room(session: FakeSession, points: Publisher[Point]) -> None:
    assert (points._has_room, points._is_idle) == (True, True)
    session.fill()
    assert (points._has_room, points._is_idle) == (False, False)
    waiting = asyncio.create_task(points.publish(1))
    await asyncio.sleep(0)
    assert published(session) == []
    session.fill()
    session.drain()
    await waiting
    assert published(session) == [[1, 0, 0]]


async def test_message_for_one_subscriber_names_it(
    session: FakeSession, points: Publisher[Point]
) -> None:
    points._send(points._encode_to("/listener", Point(1, 2, 3)))
    points._send(points._encode_to("/grün", z=3))
    points._send(points._encode())
    assert [each.get("to") for each in sent_operations(session)] == ["/listener", "/grün", None]


async def test_message_for_one_subscriber_is_not_latched(
    session: FakeSession, topics: NodeTopics, types: NodeTypes
) -> None:
    points = advertise(topics, types, latch=True)
    points._send(points._encode(1))
    points._send(points._encode_to("/listener", 2))
    assert [each["msg"]["x"] for each in reconnected(session)[1:]] == [1]


async def test_message_that_is_serialized_already_is_sent_as_it_is(
    session: FakeSession, points: Publisher[Point], types: NodeTypes
) -> None:
    message = types.codec(Point).serialize(Point(1, 2, 3))
    points._send(points._encode_serialized(message))
    points._send(points._encode_serialized(message, "/listener"))
    assert published(session) == 2 * [[1, 2, 3]]


@pytest.mark.parametrize("type_", ["geometry_msgs/Point", "unknown_msgs/Type"])
async def test_serialized_messages_are_published_as_bytes(
    topics: NodeTopics, types: NodeTypes, lines: Lines, type_: str
) -> None:
    codec = types.serialized(type_, "1" * 32, "float64 x")
    publisher = topics.advertise("/points", codec, queue_size=2)
    operation = publisher._registration()
    assert (operation.type, operation.definition) == (type_, "float64 x")
    data = types.codec(Point).serialize(Point(1, 2, 3))
    frame = publisher._encode(data)
    assert frame == publisher._encode_serialized(data)
    assert bytes(read_publish(client_payload(frame)).message) == data
    as_json = publisher._lane.to_json(frame)
    if type_ == "geometry_msgs/Point":
        assert as_json.endswith(b'"msg":{"x":1.0,"y":2.0,"z":3.0}}')
    else:
        assert not as_json
        (line,) = lines.seen()
        assert line.startswith("Dropped a message for /points: cannot be sent as JSON: ")


def test_definition_of_serialized_standard_types_is_not_sent(types: NodeTypes) -> None:
    for md5sum in (None, types.codec(Point).md5sum):
        assert types.serialized("geometry_msgs/Point", md5sum, "float64 x").definition is None


async def test_invalid_bytes_are_not_sent_to_a_server_without_fibws_v1(
    points: Publisher[Point], lines: Lines
) -> None:
    assert points._lane.to_json(points._encode_serialized(b"short")) == b""
    (line,) = lines.seen()
    assert line.startswith("Dropped a message for /points: ")


async def test_infinity_is_exact_and_nan_is_null_in_json(
    session: FakeSession, points: Publisher[Point]
) -> None:
    points._send(points._encode(float("inf"), float("nan"), 1))
    assert published(session) == [[float("inf"), None, 1]]


def test_definition_of_standard_types_is_not_sent(points: Publisher[Point]) -> None:
    assert isinstance(points._registration(), Advertise)
    assert points._registration().definition is None
