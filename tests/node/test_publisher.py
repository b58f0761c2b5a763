"""The sending end of a topic."""

from __future__ import annotations

import asyncio
import json
import logging
import time
from typing import Any

import pytest

from fibws.errors import InvalidMessage, NodeClosed
from fibws.interfaces import Message
from fibws.msg.geometry_msgs import Point, Vector3
from fibws.node.outbox import LIMIT
from fibws.node.publisher import Publisher
from fibws.node.session import Session
from fibws.node.topics import Topics
from fibws.node.types import Types
from fibws.node.wire import Wire
from fibws.protocol.operations import Advertise


@pytest.fixture
def session() -> Session:
    return Session(logging.Logger("test"))


@pytest.fixture
def points(session: Session) -> Publisher[Point]:
    operation = Advertise(id=1, topic="/points", type=Point._type, queue_size=2)
    wire = Types(time.time_ns).wire(Point)
    topics = Topics(session)
    return Publisher(topics, topics.advertise(operation), wire)


def published(session: Session) -> list[dict[str, Any]]:
    return [json.loads(session.outbox.pop())["msg"] for _ in range(len(session.outbox))]


async def test_a_message_is_given_whole_or_by_its_fields(
    session: Session, points: Publisher[Point]
) -> None:
    await points.publish(Point(1, 2, 3))
    await points.publish(1, 2, 3)
    assert published(session) == 2 * [{"x": 1.0, "y": 2.0, "z": 3.0}]
    await points.publish(z=3)
    await points.publish()
    assert published(session) == [{"x": 0.0, "y": 0.0, "z": 3.0}, {"x": 0.0, "y": 0.0, "z": 0.0}]


async def test_it_may_introduce_itself_anew(session: Session, points: Publisher[Point]) -> None:
    session.outbox.open()
    points.introduce({})
    assert not session.outbox
    points.introduce({"user": "ann"})
    advertised = json.loads(session.outbox.pop())
    assert (advertised["op"], advertised["id"]) == ("advertise", 1)
    assert advertised["headers"] == {"user": "ann"}
    session.lose()
    assert [json.loads(text)["headers"] for text in session.greeting()] == [{"user": "ann"}]
    with pytest.raises(ValueError, match="headers are an object of strings"):
        points.introduce({"": "nobody"})
    session.outbox.open()
    points.close()
    points.introduce({"user": "bob"})
    assert json.loads(session.outbox.pop())["op"] == "unadvertise"
    assert not session.outbox


async def test_it_may_be_left_before_its_node(session: Session, points: Publisher[Point]) -> None:
    assert repr(points) == "<Publisher /points [geometry_msgs/Point]>"
    async with points:
        await points.publish()
    with pytest.raises(NodeClosed):
        await points.publish()
    assert len(published(session)) == 1


@pytest.mark.parametrize(
    ("fields", "named"), [((1,), {"y": 2}), ((1, 2, 3, 4), {}), ((), {"w": 1}), ((Vector3(),), {})]
)
async def test_what_is_no_such_message_raises(
    points: Publisher[Point], fields: tuple[Any, ...], named: dict[str, Any]
) -> None:
    with pytest.raises(TypeError):
        await points.publish(*fields, **named)


async def test_what_does_not_fit_raises_and_is_not_sent(
    session: Session, points: Publisher[Point]
) -> None:
    with pytest.raises(InvalidMessage, match="field y"):
        await points.publish(1, "2", 3)
    assert published(session) == []


async def test_without_a_hub_the_newest_are_kept(
    session: Session, points: Publisher[Point]
) -> None:
    for number in range(5):
        await points.publish(number)
    assert points.dropped == 3
    assert [each["x"] for each in published(session)] == [3.0, 4.0]


# The three steps of publish


async def test_what_is_encoded_in_another_thread_is_sent_as_it_is(
    session: Session, points: Publisher[Point]
) -> None:
    texts = await asyncio.to_thread(
        lambda: [points.encode(Point(1, 2, 3)), points.encode(1), points.encode(z=3)]
    )
    assert published(session) == []
    session.outbox.open()
    for text in texts:
        await points.room()
        points.send(text)
    assert [list(each.values()) for each in published(session)] == [
        [1.0, 2.0, 3.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, 3.0],
    ]


def test_what_does_not_fit_is_not_encoded(points: Publisher[Point]) -> None:
    with pytest.raises(InvalidMessage, match="field y"):
        points.encode(1, "2", 3)
    with pytest.raises(TypeError, match=r"expected \[geometry_msgs/Point\]"):
        points.encode(Vector3())
    with pytest.raises(TypeError, match="arguments or keywords, but not both"):
        points.encode_to("/listener", 1, y=2)


def test_what_is_sent_without_a_hub_is_kept_as_far_as_there_is_room(
    session: Session, points: Publisher[Point]
) -> None:
    for number in range(5):
        points.send(points.encode(number))
    assert points.dropped == 3
    assert [each["x"] for each in published(session)] == [3.0, 4.0]


def test_what_is_closed_sends_nothing(session: Session, points: Publisher[Point]) -> None:
    text = points.encode()
    points.close()
    with pytest.raises(NodeClosed, match="publish on /points: it was closed"):
        points.send(text)
    assert published(session) == []


async def test_room_is_waited_for(session: Session, points: Publisher[Point]) -> None:
    session.outbox.open()
    session.outbox.put(bytes(LIMIT))
    waiting = asyncio.create_task(points.room())
    await asyncio.sleep(0)
    assert not waiting.done()
    session.outbox.pop()
    await waiting


# To one peer


class Fields(Message):
    """A message whose fields have the names that a method's own arguments might have."""

    _type = "geometry_msgs/Point"

    def __init__(self, **fields: Any) -> None:
        self.fields = fields

    def to_dict(self) -> dict[str, Any]:
        return self.fields


def test_a_message_may_be_for_one_peer(session: Session, points: Publisher[Point]) -> None:
    for text in (points.encode_to("/listener", Point(1, 2, 3)), points.encode_to("/x", z=3)):
        points.send(text)
    first, second = (json.loads(session.outbox.pop()) for _ in range(2))
    assert first == {
        "op": "publish",
        "topic": "/points",
        "msg": {"x": 1.0, "y": 2.0, "z": 3.0},
        "to": "/listener",
    }
    assert (second["to"], second["msg"]["z"]) == ("/x", 3.0)
    assert "to" not in json.loads(points.encode())


def test_a_field_may_have_any_name(session: Session) -> None:
    topics = Topics(session)
    advertisement = topics.advertise(Advertise(id=1, topic="/odd", type="odd_msgs/Odd"))
    odd = Publisher(topics, advertisement, Wire(Fields, lambda given: dict(given)))
    fields = {"node": 1, "to": 2, "self": 3, "message": 4, "fields": 5}
    del fields["self"]  # which Python keeps for itself
    for text in (odd.encode(**fields), odd.encode_to("/listener", **fields)):
        assert json.loads(text)["msg"] == fields


def test_what_is_for_one_peer_is_not_kept_for_the_next_hub(session: Session) -> None:
    operation = Advertise(id=1, topic="/points", type=Point._type, latch=True)
    topics = Topics(session)
    points = Publisher(topics, topics.advertise(operation), Types(time.time_ns).wire(Point))
    points.send(points.encode(1))
    points.send(points.encode_to("/listener", 2))
    published(session)
    latched = [json.loads(text) for text in session.greeting()][-1]
    assert latched["msg"]["x"] == 1.0
