"""The five topics of an action, from either end."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import NodeError
from fibws.node.actions.action_topics import CANCEL, FEEDBACK, GOAL, RESULT, STATUS, ActionTopics
from fibws.node.actions.actions import Actions
from fibws.node.session import Session

from ..conftest import Lines, greeted, hears, said


@pytest.fixture
def refusals() -> list[NodeError]:
    return []


@pytest.fixture
def topics(actions: Actions, refusals: list[NodeError]) -> ActionTopics:
    return ActionTopics(actions, "/fibonacci", "actionlib_tutorials/Fibonacci", refusals.append)


def test_they_have_actionlibs_names_and_types(session: Session, topics: ActionTopics) -> None:
    for kind in (GOAL, CANCEL, STATUS, FEEDBACK, RESULT):
        topics.sender(kind, queue_size=1)
        topics.receiver(kind, print, queue_size=7)
    names = {(each["op"], each["topic"], each["type"]) for each in said(session)}
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
    assert len(greeted(session)) == 10


def test_messages_of_all_topics_are_taken_in_the_order_in_which_they_came(
    session: Session, topics: ActionTopics
) -> None:
    taken: list[Any] = []
    topics.receiver(GOAL, lambda message: taken.append(message.goal.order), queue_size=1)
    topics.receiver(CANCEL, lambda message: taken.append(message.id), queue_size=1)
    for number in range(3):
        hears(session, "publish", topic="/fibonacci/goal", msg={"goal": {"order": number}})
        hears(session, "publish", topic="/fibonacci/cancel", msg={"id": f"c{number}"})
    assert taken == [0, "c0", 1, "c1", 2, "c2"]


def test_a_message_that_does_not_fit_is_dropped_and_named(
    session: Session, topics: ActionTopics, lines: Lines
) -> None:
    topics.receiver(CANCEL, print, queue_size=1)
    hears(session, "publish", topic="/fibonacci/cancel", msg={"id": 5})
    (line,) = lines.seen()
    assert line.startswith("Dropped a message on /fibonacci/cancel: actionlib_msgs/GoalID message")


def test_a_header_left_out_has_the_time(session: Session, topics: ActionTopics) -> None:
    sender = topics.sender(GOAL, queue_size=1)
    sender.put(goal_id={"id": "a"}, goal={"order": 3})
    _, message = said(session)
    assert message["msg"]["header"]["stamp"]["secs"] > 1_700_000_000
    assert message["msg"]["goal_id"] == {"stamp": {"secs": 0, "nsecs": 0}, "id": "a"}
    assert message["msg"]["goal"] == {"order": 3}


def test_a_latched_message_is_told_to_the_next_hub(session: Session, topics: ActionTopics) -> None:
    topics.sender(STATUS, queue_size=1, latch=True).put(status_list=[])
    said(session)
    assert [each["op"] for each in greeted(session)] == ["advertise", "publish"]


def test_what_is_closed_is_taken_back_and_says_nothing(
    session: Session, topics: ActionTopics, refusals: list[NodeError]
) -> None:
    sender = topics.sender(STATUS, queue_size=1)
    topics.receiver(CANCEL, print, queue_size=1)
    said(session)
    topics.close()
    sender.put(status_list=[])
    assert [each["op"] for each in said(session)] == ["unadvertise", "unsubscribe"]
    assert (greeted(session), refusals) == ([], [])


def test_a_refusal_to_listen_is_told_at_once(
    session: Session, topics: ActionTopics, refusals: list[NodeError]
) -> None:
    topics.receiver(CANCEL, print, queue_size=1)
    (subscribe,) = said(session)
    hears(session, "status", level="error", id=subscribe["id"], msg="no")
    assert [str(fault) for fault in refusals] == ["no"]


def test_a_refusal_to_publish_is_told_at_once(
    session: Session, topics: ActionTopics, refusals: list[NodeError]
) -> None:
    sender = topics.sender(STATUS, queue_size=1)
    (advertise,) = said(session)
    hears(session, "status", level="error", id=advertise["id"], msg="no")
    assert [str(fault) for fault in refusals] == ["no"]
    sender.put(status_list=[])
    assert (len(refusals), said(session)) == (1, [])
