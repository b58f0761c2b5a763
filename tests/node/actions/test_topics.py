"""The topics of an action, and the ids of goals over topics."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import NodeError
from fibws.node.actions.topics import ActionTopics, GoalIdGenerator
from fibws.node.topics import NodeTopics
from fibws.node.types import NodeTypes
from fibws.protocol.goals import CANCEL, FEEDBACK, GOAL, RESULT, STATUS

from ..conftest import FakeSession, Lines, deliver, reconnected, sent_operations
from .conftest import NOW


@pytest.fixture
def refusals() -> list[NodeError]:
    return []


@pytest.fixture
def topics(session: FakeSession, types: NodeTypes, refusals: list[NodeError]) -> ActionTopics:
    return ActionTopics(
        NodeTopics(session), types, "/fibonacci", "actionlib_tutorials/Fibonacci", refusals.append
    )


def test_goal_ids_differ_even_at_the_same_time() -> None:
    goal_ids = GoalIdGenerator("/node", lambda: NOW)
    assert [goal_ids.generate() for _ in range(2)] == [
        "/node-1-1700000000.500",
        "/node-2-1700000000.500",
    ]


async def test_topics_have_the_names_and_types_of_actionlib(
    session: FakeSession, topics: ActionTopics
) -> None:
    for topic in (GOAL, CANCEL, STATUS, FEEDBACK, RESULT):
        topics.advertise(topic, queue_size=1)
        topics.subscribe(topic, print, queue_size=7)
    names = {(each["op"], each["topic"], each["type"]) for each in sent_operations(session)}
    assert names == {
        (op, f"/fibonacci/{topic}", type_)
        for op in ("advertise", "subscribe")
        for topic, type_ in (
            ("goal", "actionlib_tutorials/FibonacciActionGoal"),
            ("cancel", "actionlib_msgs/GoalID"),
            ("status", "actionlib_msgs/GoalStatusArray"),
            ("feedback", "actionlib_tutorials/FibonacciActionFeedback"),
            ("result", "actionlib_tutorials/FibonacciActionResult"),
        )
    }
    assert len(reconnected(session)) == 10


async def test_messages_of_several_topics_stay_in_order(
    session: FakeSession, topics: ActionTopics
) -> None:
    received: list[Any] = []
    topics.subscribe(GOAL, lambda message: received.append(message.goal.order), queue_size=1)
    topics.subscribe(CANCEL, lambda message: received.append(message.id), queue_size=1)
    for number in range(3):
        deliver(session, "publish", topic="/fibonacci/goal", msg={"goal": {"order": number}})
        deliver(session, "publish", topic="/fibonacci/cancel", msg={"id": f"c{number}"})
    assert received == [0, "c0", 1, "c1", 2, "c2"]


async def test_invalid_message_is_dropped_and_logged(
    session: FakeSession, topics: ActionTopics, lines: Lines
) -> None:
    topics.subscribe(CANCEL, print, queue_size=1)
    deliver(session, "publish", topic="/fibonacci/cancel", msg={"id": 5})
    (line,) = lines.seen()
    assert line.startswith("Dropped a message on /fibonacci/cancel: actionlib_msgs/GoalID message")


async def test_default_stamp_of_a_header_is_the_time(
    session: FakeSession, topics: ActionTopics
) -> None:
    publisher = topics.advertise(GOAL, queue_size=1)
    publisher.publish(goal_id={"id": "a"}, goal={"order": 3})
    _, message = sent_operations(session)
    assert message["msg"]["header"]["stamp"]["secs"] > 1_700_000_000
    assert message["msg"]["goal_id"] == {"stamp": {"secs": 0, "nsecs": 0}, "id": "a"}
    assert message["msg"]["goal"] == {"order": 3}


async def test_latched_message_is_sent_on_the_next_connection(
    session: FakeSession, topics: ActionTopics
) -> None:
    topics.advertise(STATUS, queue_size=1, latch=True).publish(status_list=[])
    sent_operations(session)
    assert [each["op"] for each in reconnected(session)] == ["advertise", "publish"]


async def test_close_unregisters_and_stops_publishing(
    session: FakeSession, topics: ActionTopics, refusals: list[NodeError]
) -> None:
    publisher = topics.advertise(STATUS, queue_size=1)
    topics.subscribe(CANCEL, print, queue_size=1)
    sent_operations(session)
    topics.close()
    publisher.publish(status_list=[])
    assert [each["op"] for each in sent_operations(session)] == ["unadvertise", "unsubscribe"]
    assert (reconnected(session), refusals) == ([], [])


async def test_refused_subscription_is_reported(
    session: FakeSession, topics: ActionTopics, refusals: list[NodeError]
) -> None:
    topics.subscribe(CANCEL, print, queue_size=1)
    (subscribe,) = sent_operations(session)
    deliver(session, "status", level="error", id=subscribe["id"], msg="no")
    assert [str(error) for error in refusals] == ["no"]


async def test_refused_advertisement_is_reported(
    session: FakeSession, topics: ActionTopics, refusals: list[NodeError]
) -> None:
    publisher = topics.advertise(STATUS, queue_size=1)
    (advertise,) = sent_operations(session)
    deliver(session, "status", level="error", id=advertise["id"], msg="no")
    assert [str(error) for error in refusals] == ["no"]
    publisher.publish(status_list=[])
    assert (len(refusals), sent_operations(session)) == (1, [])
