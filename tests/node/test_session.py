"""A node's side of the conversation: text in, text out, no socket and no loop."""

from __future__ import annotations

import json
import logging
from typing import Any

import pytest

from fibws.errors import NodeClosed, NodeReplaced, OperationRejected
from fibws.node.outbox import Advertisement
from fibws.node.session import Session
from fibws.node.subscription import Subscription
from fibws.protocol.operations import Advertise, Subscribe

INT32 = "std_msgs/Int32"


@pytest.fixture
def session() -> Session:
    session = Session(logging.Logger("test"))
    session.outbox.open()
    return session


def advertise(session: Session, topic: str, *, latch: bool = False) -> Advertisement:
    id_ = session.id("advertise", topic)
    return session.advertise(Advertise(id=id_, topic=topic, type=INT32, latch=latch))


def subscribe(session: Session, topic: str) -> Subscription[Any]:
    operation = Subscribe(id=session.id("subscribe", topic), topic=topic, type=INT32)
    subscription: Subscription[Any] = Subscription(
        operation, INT32, 10, lambda msg: msg, session.unsubscribe, logging.Logger("test")
    )
    session.subscribe(subscription)
    return subscription


def said(session: Session) -> list[tuple[str, str]]:
    """The operations that wait, by name and topic."""
    operations = [json.loads(session.outbox.pop()) for _ in range(len(session.outbox))]
    return [(each["op"], each["topic"]) for each in operations]


def greeted(session: Session) -> list[tuple[str, str]]:
    operations = [json.loads(text) for text in session.greeting()]
    return [(each["op"], each["topic"]) for each in operations]


def test_registrations_are_said_as_they_come_and_go(session: Session) -> None:
    advertisement = advertise(session, "/a")
    subscription = subscribe(session, "/s")
    session.unadvertise(advertisement)
    subscription.close()
    assert said(session) == [
        ("advertise", "/a"),
        ("subscribe", "/s"),
        ("unadvertise", "/a"),
        ("unsubscribe", "/s"),
    ]
    assert session.topics() == []


def test_registrations_that_are_taken_back_twice_are_said_once(session: Session) -> None:
    advertisement = advertise(session, "/a")
    subscription = subscribe(session, "/s")
    said(session)
    for _ in range(2):
        session.unadvertise(advertisement)
        session.unsubscribe(subscription)
    assert said(session) == [("unadvertise", "/a"), ("unsubscribe", "/s")]


def test_without_a_hub_they_wait_for_the_greeting(session: Session) -> None:
    session.outbox.lose()
    advertise(session, "/a")
    subscribe(session, "/s")
    gone = advertise(session, "/gone")
    session.unadvertise(gone)
    assert said(session) == []
    assert greeted(session) == [("advertise", "/a"), ("subscribe", "/s")]


def test_a_greeting_ends_in_what_is_latched_unless_newer_messages_wait(session: Session) -> None:
    sent = advertise(session, "/sent", latch=True)
    waiting = advertise(session, "/waiting", latch=True)
    unlatched = advertise(session, "/unlatched")
    advertise(session, "/silent", latch=True)
    for each in (sent, waiting, unlatched):
        topic = each.operation.topic
        session.publish(each, json.dumps({"op": "publish", "topic": topic}).encode())
    said(session)
    session.outbox.lose()
    session.publish(waiting, b'{"op":"publish","topic":"/waiting"}')
    assert greeted(session)[4:] == [("publish", "/sent")]


def test_ids_differ(session: Session) -> None:
    assert session.id("advertise", "/a") != session.id("advertise", "/a")


async def test_a_frame_may_hold_several_operations(session: Session) -> None:
    subscription = subscribe(session, "/s")
    session.receive(b'{"op":"publish","topic":"/s","msg":1} {"op":"publish","topic":"/s","msg":2}')
    subscription.end()
    assert [message async for message in subscription] == [1, 2]


def test_a_refusal_reaches_its_publisher_alone(session: Session) -> None:
    refused, other = advertise(session, "/a"), advertise(session, "/b")
    status = {"op": "status", "level": "error", "id": refused.operation.id, "msg": "no"}
    session.receive(json.dumps(status).encode())
    with pytest.raises(OperationRejected, match="no"):
        session.publish(refused, b"{}")
    session.publish(other, b"{}")
    assert session.topics() == ["/b"]


def test_a_warning_about_a_registration_does_not_end_it(session: Session) -> None:
    advertisement = advertise(session, "/a")
    status = {"op": "status", "level": "warning", "id": advertisement.operation.id, "msg": "hm"}
    session.receive(json.dumps(status).encode())
    session.publish(advertisement, b"{}")


def test_what_is_closed_or_over_cannot_publish(session: Session) -> None:
    closed, open_ = advertise(session, "/closed"), advertise(session, "/open")
    session.unadvertise(closed)
    with pytest.raises(NodeClosed, match="/closed"):
        session.publish(closed, b"{}")
    session.end()
    with pytest.raises(NodeClosed, match="the node has ended"):
        session.publish(open_, b"{}")


def test_the_first_reason_for_the_end_is_the_one_that_counts(session: Session) -> None:
    session.end(NodeReplaced("by another"))
    session.end()
    assert session.over
    with pytest.raises(NodeReplaced):
        session.check()
