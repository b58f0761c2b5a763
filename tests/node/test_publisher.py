"""The sending end of a topic."""

from __future__ import annotations

import json
import logging
import time
from typing import Any

import pytest

from fibws.errors import InvalidMessage, NodeClosed
from fibws.msg.geometry_msgs import Point, Vector3
from fibws.node.publisher import Publisher
from fibws.node.session import Session
from fibws.node.topics import Topics
from fibws.node.types import Types
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
