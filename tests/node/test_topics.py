"""A node's publishers and subscriptions, as its hub hears of them: no socket and no loop."""

from __future__ import annotations

import json
import logging
from typing import Any

import pytest

from fibws.errors import NodeClosed, NodeError, OperationRejected
from fibws.node.advertisement import Advertisement
from fibws.node.outbox import LIMIT
from fibws.node.session import Session
from fibws.node.subscription import Subscription
from fibws.node.topics import Topics
from fibws.protocol.operations import Advertise, Subscribe

from .conftest import greeted, hears, said

INT32 = "std_msgs/Int32"


@pytest.fixture
def topics(session: Session) -> Topics:
    return Topics(session)


def advertise(
    topics: Topics, topic: str, *, latch: bool = False, peers: bool | None = None
) -> Advertisement:
    operation = Advertise(
        id=f"advertise:{topic}", topic=topic, type=INT32, latch=latch, peers=peers
    )
    return topics.advertise(operation)


def subscribe(topics: Topics, topic: str, id_: str | None = None) -> Subscription[Any]:
    operation = Subscribe(id=id_ or f"subscribe:{topic}", topic=topic, type=INT32)
    subscription: Subscription[Any] = Subscription(
        operation, INT32, 10, lambda msg: msg, topics.unsubscribe, logging.Logger("test")
    )
    topics.subscribe(subscription)
    return subscription


def names(operations: list[dict[str, Any]]) -> list[tuple[str, str]]:
    return [(each["op"], each["topic"]) for each in operations]


def test_registrations_are_said_as_they_come_and_go(session: Session, topics: Topics) -> None:
    advertisement = advertise(topics, "/a")
    subscription = subscribe(topics, "/s")
    topics.unadvertise(advertisement)
    subscription.close()
    assert names(said(session)) == [
        ("advertise", "/a"),
        ("subscribe", "/s"),
        ("unadvertise", "/a"),
        ("unsubscribe", "/s"),
    ]
    assert topics.names() == []


def test_registrations_that_are_taken_back_twice_are_said_once(
    session: Session, topics: Topics
) -> None:
    advertisement = advertise(topics, "/a")
    subscription = subscribe(topics, "/s")
    said(session)
    for _ in range(2):
        topics.unadvertise(advertisement)
        topics.unsubscribe(subscription)
    assert names(said(session)) == [("unadvertise", "/a"), ("unsubscribe", "/s")]


def test_without_a_hub_they_wait_for_the_greeting(session: Session, topics: Topics) -> None:
    session.lose()
    advertise(topics, "/a")
    subscribe(topics, "/s")
    gone = advertise(topics, "/gone")
    topics.unadvertise(gone)
    assert names(said(session)) == []
    assert names(greeted(session)) == [("advertise", "/a"), ("subscribe", "/s")]


def test_a_greeting_ends_in_what_is_latched_unless_newer_messages_wait(
    session: Session, topics: Topics
) -> None:
    sent = advertise(topics, "/sent", latch=True)
    waiting = advertise(topics, "/waiting", latch=True)
    unlatched = advertise(topics, "/unlatched")
    advertise(topics, "/silent", latch=True)
    for each in (sent, waiting, unlatched):
        topic = each.operation.topic
        topics.publish(each, json.dumps({"op": "publish", "topic": topic}).encode())
    said(session)
    session.lose()
    topics.publish(waiting, b'{"op":"publish","topic":"/waiting"}')
    assert names(greeted(session))[4:] == [("publish", "/sent")]


def test_a_greeting_has_what_is_latched_though_a_message_for_one_node_waits(
    session: Session, topics: Topics
) -> None:
    latching = advertise(topics, "/a", latch=True)
    topics.publish(latching, b'{"op":"publish","topic":"/a","msg":1}')
    said(session)
    session.lose()
    topics.publish(latching, b'{"op":"publish","topic":"/a","to":"/b","msg":2}', to_all=False)
    assert [each["msg"] for each in greeted(session)[1:]] == [1]
    assert [each["msg"] for each in said(session)] == [2]


async def test_messages_reach_their_listeners_alone(session: Session, topics: Topics) -> None:
    subscription, other = subscribe(topics, "/s"), subscribe(topics, "/o")
    session.receive(b'{"op":"publish","topic":"/s","msg":1}')
    session.receive(b'{"op":"publish","topic":"/late","msg":2}')
    session.end()
    assert [message async for message in subscription] == [1]
    assert [message async for message in other] == []


def test_who_closes_while_it_is_given_a_message_keeps_it_from_nobody(
    session: Session, topics: Topics
) -> None:
    first, second, third = (subscribe(topics, "/s", id_) for id_ in ("1", "2", "3"))
    heard: list[tuple[str, object]] = []

    def take(message: object) -> None:
        heard.append(("first", message))
        first.close()
        third.close()

    first.hand_to(take)
    second.hand_to(lambda message: heard.append(("second", message)))
    third.hand_to(lambda message: heard.append(("third", message)))
    for number in (1, 2):
        hears(session, "publish", topic="/s", msg=number)
    assert heard == [("first", 1), ("second", 1), ("second", 2)]
    second.close()
    assert topics.names() == []


async def test_what_is_no_message_is_for_others(session: Session, topics: Topics) -> None:
    subscription = subscribe(topics, "/s")
    hears(session, "service_response", service="/s", id="subscribe:/s", values={}, result=True)
    session.end()
    assert [message async for message in subscription] == []


def test_a_refusal_reaches_its_publisher_alone(session: Session, topics: Topics) -> None:
    refused, other = advertise(topics, "/a"), advertise(topics, "/b")
    hears(session, "status", level="error", id="advertise:/a", msg="no")
    with pytest.raises(OperationRejected, match="no"):
        topics.publish(refused, b"{}")
    topics.publish(other, b"{}")
    assert topics.names() == ["/b"]


def test_the_names_are_those_of_now(session: Session, topics: Topics) -> None:
    refused = advertise(topics, "/b")
    closed = advertise(topics, "/c")
    heard = subscribe(topics, "/a")
    assert topics.names() == topics.names() == ["/a", "/b", "/c"]
    hears(session, "status", level="error", id=refused.operation.id, msg="no")
    assert topics.names() == ["/a", "/c"]
    topics.unadvertise(closed)
    assert topics.names() == ["/a"]
    heard.close()
    assert topics.names() == []
    advertise(topics, "/d")
    assert topics.names() == ["/d"]


def test_whoever_asks_is_told_of_a_refusal(session: Session, topics: Topics) -> None:
    told: list[NodeError] = []
    operation = Advertise(id="mine", topic="/a", type="std_msgs/Int32", queue_size=1)
    topics.advertise(operation, told.append)
    hears(session, "status", level="error", id="mine", msg="no")
    assert [str(fault) for fault in told] == ["no"]


async def test_a_refusal_reaches_its_reader_alone(session: Session, topics: Topics) -> None:
    refused, other = subscribe(topics, "/a"), subscribe(topics, "/b")
    hears(session, "status", level="error", id="subscribe:/a", msg="no")
    session.receive(b'{"op":"publish","topic":"/b","msg":1}')
    with pytest.raises(OperationRejected, match="no"):
        await anext(refused)
    assert await anext(other) == 1


def test_a_warning_about_a_registration_does_not_end_it(session: Session, topics: Topics) -> None:
    advertisement = advertise(topics, "/a")
    hears(session, "status", level="warning", id="advertise:/a", msg="hm")
    topics.publish(advertisement, b"{}")


def test_what_is_closed_or_over_cannot_publish(session: Session, topics: Topics) -> None:
    closed, open_ = advertise(topics, "/closed"), advertise(topics, "/open")
    topics.unadvertise(closed)
    with pytest.raises(NodeClosed, match="/closed"):
        topics.publish(closed, b"{}")
    session.end()
    assert topics.over
    with pytest.raises(NodeClosed, match="the node has ended"):
        topics.publish(open_, b"{}")


def test_peers_are_told_to_who_asked_by_the_id(session: Session, topics: Topics) -> None:
    first, second = advertise(topics, "/a", peers=True), advertise(topics, "/b", peers=True)
    subscription = subscribe(topics, "/a")
    hears(session, "peers", id="advertise:/a", topic="/a", nodes=["/listener"])
    hears(session, "peers", id="subscribe:/a", topic="/a", nodes=["/talker"])
    hears(session, "peers", id="of none", topic="/a", nodes=["/nobody"])
    assert [each.peers.names for each in (first, second)] == [["/listener"], []]
    assert subscription.peers.names == ["/talker"]


@pytest.mark.parametrize("end", ["lose", "close", "refuse", "end"])
def test_peers_go_with_the_hub_or_with_who_asked(
    session: Session, topics: Topics, end: str
) -> None:
    advertisement, subscription = advertise(topics, "/a", peers=True), subscribe(topics, "/a")
    for id_ in ("advertise:/a", "subscribe:/a"):
        hears(session, "peers", id=id_, topic="/a", nodes=["/b"])
    match end:
        case "lose":
            session.lose()
        case "close":
            topics.unadvertise(advertisement)
            subscription.close()
        case "refuse":
            for id_ in ("advertise:/a", "subscribe:/a"):
                hears(session, "status", level="error", id=id_, msg="no")
        case "end":
            session.end()
    assert advertisement.peers.names == subscription.peers.names == []


def test_a_header_goes_to_the_listeners_with_its_message(session: Session, topics: Topics) -> None:
    subscription = subscribe(topics, "/a")
    hears(session, "publish", topic="/a", msg={"data": 1}, header={"callerid": "/b"})
    hears(session, "publish", topic="/a", msg={"data": 2}, header="none")
    assert list(subscription._messages) == [({"data": 1}, {"callerid": "/b"}), ({"data": 2}, None)]


def test_the_session_hears_when_a_reader_has_no_place_left(
    session: Session, topics: Topics
) -> None:
    subscribe(topics, "/a")
    for number in range(10):
        assert not session.crowded
        hears(session, "publish", topic="/a", msg=number)
    assert session.crowded


def test_there_is_room_until_the_outbox_is_full(session: Session, topics: Topics) -> None:
    seen = [topics.has_room]
    session.outbox.put(bytes(LIMIT))
    seen.append(topics.has_room)
    session.lose()
    seen.append(topics.has_room)
    assert seen == [True, False, True]
